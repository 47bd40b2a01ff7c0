//! More to say of a way that is told in fewer words than the texts of its style.

use super::{Clause, FILLER, MAIN, SIDE, STOPPED_AT, WALKED_PAST, onward::past, usable_room};
use crate::{
    style::way::Kind,
    writer::{
        Brief,
        dice::Dice,
        landmarks::{Landmark, Landmarks, Use},
        phrases::draw,
    },
};
use rand::{
    Rng,
    seq::{IndexedRandom, SliceRandom},
};
use rand_chacha::ChaCha8Rng;
use wayword_language::lexicon::room_name;

/// What more there may be to say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum More {
    /// A thing that one passes.
    Landmark,
    /// The side of one.
    Side,
    /// A second thing beside one.
    Pair,
    /// A room that one crosses.
    Room,
    /// A door through which one goes.
    Door,
    /// What stands in a room that one enters.
    With,
    /// The room in which one stops.
    StopRoom,
    /// That one goes on.
    Onward,
}

const ALL: [(f64, More); 8] = [
    (4.0, More::Landmark),
    (1.0, More::Side),
    (1.5, More::Pair),
    (1.5, More::Room),
    (2.0, More::Door),
    (1.5, More::With),
    (1.5, More::StopRoom),
    (0.2, More::Onward),
];

/// How often a thing that is hardly a landmark fills a text.
const LESS_SALIENT: f64 = 0.25;

/// Says one thing more; `false` where nothing more is known.
pub(in crate::writer) fn fill(
    clauses: &mut Vec<Clause>,
    brief: &Brief<'_>,
    landmarks: &mut Landmarks<'_>,
    dice: Dice,
) -> bool {
    let mut left = ALL.to_vec();
    let mut rng = dice.by(&["more"]);
    while let Some(more) = draw(&left, &mut rng) {
        let mut filler = Filler { clauses, brief, landmarks, rng: dice.by(&["more of", &format!("{more:?}")]) };
        let is_told = match more {
            More::Landmark => filler.landmark(),
            More::Side => filler.side(),
            More::Pair => filler.pair(),
            More::Room => filler.room(),
            More::Door => filler.door(),
            More::With => filler.with(),
            More::StopRoom => filler.stop_room(),
            More::Onward => filler.onward(),
        };
        if is_told {
            return true;
        }
        left.retain(|(_, other)| *other != more);
    }
    false
}

/// Says a thing that one passes in a text that names none on the way.
pub(in crate::writer) fn name_a_thing(
    clauses: &mut Vec<Clause>,
    brief: &Brief<'_>,
    landmarks: &mut Landmarks<'_>,
    dice: Dice,
) {
    if names_none(clauses) {
        Filler { clauses, brief, landmarks, rng: dice.by(&["one thing"]) }.landmark();
    }
}

/// Whether a text names no thing before its last clause.
fn names_none(clauses: &[Clause]) -> bool {
    clauses.iter().rev().skip(1).all(|clause| clause.thing.is_none())
}

struct Filler<'a, 'b> {
    clauses: &'a mut Vec<Clause>,
    brief: &'a Brief<'a>,
    landmarks: &'a mut Landmarks<'b>,
    rng: ChaCha8Rng,
}

impl Filler<'_, '_> {
    /// Puts a clause before the first one that is said at its frame or later.
    fn insert(&mut self, clause: Clause) {
        let at = self.clauses.iter().position(|other| other.at >= clause.at).unwrap_or(self.clauses.len());
        self.clauses.insert(at, clause);
    }

    /// Frames between the ends that lie on no stairs, in any order.
    fn frames(&mut self) -> Vec<usize> {
        let memory = self.brief.memory;
        let on_stairs = |frame: &usize| memory.flights.iter().any(|flight| flight.from < *frame && *frame < flight.to);
        let mut frames: Vec<usize> = (1..memory.frames().saturating_sub(1)).filter(|frame| !on_stairs(frame)).collect();
        frames.shuffle(&mut self.rng);
        frames
    }

    fn landmark(&mut self) -> bool {
        for frame in self.frames() {
            if self.clauses.iter().any(|clause| clause.at == frame && clause.thing.is_some()) {
                continue;
            }
            let Some(thing) = self.thing_at(frame) else { continue };
            let way = &self.brief.profile.way;
            let side = thing.passed.filter(|(passed, _)| *passed <= frame && *passed + 2 > frame).map(|(_, side)| side);
            let kind = past(way, self.clauses, side, thing.side, &mut self.rng);
            let is_only = names_none(self.clauses);
            let mut clause = Clause::new(kind, frame, if is_only { MAIN } else { SIDE }).by(thing);
            clause.side = side.filter(|_| kind == Kind::PassOnSide);
            self.insert(clause);
            return true;
        }
        false
    }

    fn thing_at(&mut self, frame: usize) -> Option<Landmark> {
        let is_only = names_none(self.clauses);
        let is_faint = self.rng.random_bool(LESS_SALIENT);
        let tries = [
            (true, WALKED_PAST, Use::Onward),
            (is_faint || is_only, STOPPED_AT, Use::Onward),
            (is_only, STOPPED_AT, Use::Beside),
        ];
        let tries = tries.into_iter().filter(|(may, ..)| *may);
        tries.into_iter().find_map(|(_, salience, to)| self.landmarks.find(frame, salience, to))
    }

    fn side(&mut self) -> bool {
        let passed = self.clauses.iter_mut().find_map(|clause| {
            let thing = clause.thing.as_ref().filter(|thing| thing.with.is_none() && clause.kind == Kind::Pass)?;
            let (frame, side) = thing.passed?;
            (clause.at..=clause.at + 1).contains(&frame).then_some((clause, side))
        });
        let Some((clause, side)) = passed else { return false };
        (clause.kind, clause.side) = (Kind::PassOnSide, Some(side));
        true
    }

    fn pair(&mut self) -> bool {
        for clause in self.clauses.iter_mut().rev() {
            let to = match clause.kind {
                Kind::StopAt | Kind::StopAtIn => Use::Stop,
                Kind::Pass | Kind::TurnAt => Use::Here,
                _ => continue,
            };
            if let Some(thing) = clause.thing.as_mut().filter(|thing| thing.with.is_none()) {
                thing.with = self.landmarks.beside(thing, clause.at, to);
                if thing.with.is_some() {
                    return true;
                }
            }
        }
        false
    }

    /// A room on the way that no clause names.
    fn room(&mut self) -> bool {
        let memory = self.brief.memory;
        let last = memory.frames().saturating_sub(1);
        let crossed = memory.stays.iter().filter(|stay| stay.entered > 0 && stay.left < last);
        for stay in crossed {
            let Some(room) = usable_room(&stay.room) else { continue };
            let is_named = |clause: &Clause| clause.room.as_ref() == Some(&room) || clause.from.as_ref() == Some(&room);
            if self.clauses.iter().any(is_named) {
                continue;
            }
            let is_hall = room_name(&room) == Some("hallway");
            let kind = if is_hall { Kind::Along } else { Kind::Through };
            self.insert(Clause::new(kind, stay.entered, SIDE).room(&room));
            return true;
        }
        false
    }

    /// A door or doorway of which no clause speaks.
    fn door(&mut self) -> bool {
        let doors = self.brief.memory.openings.iter().filter(|opening| opening.has_door);
        for opening in doors {
            let told = self.clauses.iter().position(|clause| clause.at == opening.before);
            let Some(at) = told else {
                self.insert(Clause::new(Kind::ThroughDoor, opening.before, SIDE));
                return true;
            };
            let kind = match self.clauses[at].kind {
                Kind::Enter if self.rng.random_bool(0.5) => {
                    self.clauses.insert(at, Clause::new(Kind::ThroughDoor, opening.before, SIDE));
                    return true;
                }
                Kind::Enter => Kind::EnterThroughDoor,
                Kind::Leave => Kind::LeaveByDoor,
                _ => continue,
            };
            self.clauses[at].kind = kind;
            return true;
        }
        false
    }

    /// What stands in a room that one enters.
    fn with(&mut self) -> bool {
        for at in 0..self.clauses.len() {
            let clause = &self.clauses[at];
            let opening = self.brief.memory.openings.iter().find(|opening| opening.before == clause.at);
            let Some(opening) = opening.filter(|_| clause.kind == Kind::Enter) else { continue };
            if let Some(thing) = self.landmarks.find(opening.behind, WALKED_PAST, Use::Here) {
                self.clauses[at].kind = Kind::EnterWith;
                self.clauses[at].thing = Some(thing);
                return true;
            }
        }
        false
    }

    fn stop_room(&mut self) -> bool {
        let Some(stop) = self.clauses.last_mut().filter(|stop| stop.room.is_some()) else { return false };
        stop.kind = match stop.kind {
            Kind::StopAt => Kind::StopAtIn,
            Kind::Stop => Kind::StopIn,
            _ => return false,
        };
        true
    }

    /// One goes on before what comes next.
    fn onward(&mut self) -> bool {
        let goes_on =
            |clause: &Clause| matches!(clause.kind, Kind::Straight | Kind::Pass | Kind::PassOnSide | Kind::To);
        let is_free = |at: &usize| {
            let now = &self.clauses[*at];
            let is_after = *at == 0 || now.at > self.clauses[*at - 1].at && !goes_on(&self.clauses[*at - 1]);
            is_after && !goes_on(now) && (now.at > 0 || !now.is_bare())
        };
        let free: Vec<usize> = (0..self.clauses.len()).filter(is_free).collect();
        let Some(at) = free.choose(&mut self.rng).copied() else { return false };
        let frame = self.clauses[at].at;
        self.clauses.insert(at, Clause::new(Kind::Straight, frame, FILLER));
        true
    }
}
