//! Adds details to the plan of a text that is shorter than the texts of its style. Like the plan, this depends on the
//! way alone.

use super::{
    Clause, FILLER, MAIN, Offer, Role, SIDE,
    offer::{Things, free_hops, insert},
    usable_room,
};
use crate::{
    style::way::Kind,
    writer::{Brief, dice::Dice, phrases::draw},
};
use rand::{Rng, seq::IndexedRandom};
use rand_chacha::ChaCha8Rng;
use wayword_language::lexicon::room_name;

/// A detail that can be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum More {
    /// A thing that the walker passes.
    Landmark,
    /// The side of a thing.
    Side,
    /// A second thing near one.
    Pair,
    /// A room that the walker crosses.
    Room,
    /// A door that the walker goes through.
    Door,
    /// A thing in a room that the walker enters.
    With,
    /// The room of the stop.
    StopRoom,
    /// A "go straight".
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

/// Share of added things that may be poor landmarks.
const LESS_SALIENT: f64 = 0.25;
/// Least number of places for things before the end of a text.
const LEAST_OFFERS: usize = 2;

/// Adds one detail; `false` if there is none to add.
pub(in crate::writer) fn fill(clauses: &mut Vec<Clause>, brief: &Brief<'_>, dice: Dice) -> bool {
    let mut left = ALL.to_vec();
    let mut rng = dice.by(&["more"]);
    while let Some(more) = draw(&left, &mut rng) {
        let mut filler = Filler { clauses, brief, rng: dice.by(&["more of", &format!("{more:?}")]) };
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

/// Makes sure that a text has places for things on the way, which accept almost any thing and are never dropped.
pub(in crate::writer) fn offer_places(clauses: &mut Vec<Clause>, brief: &Brief<'_>, dice: Dice) {
    let offers = |clauses: &[Clause]| clauses.iter().rev().skip(1).filter(|clause| clause.offer.is_some()).count();
    let mut times = 0;
    while offers(clauses) < LEAST_OFFERS {
        if !(Filler { clauses, brief, rng: dice.other(times).by(&["one thing"]) }).landmark() {
            break;
        }
        times += 1;
    }
    for clause in clauses.iter_mut().rev().skip(1).filter(|clause| clause.offer.is_some()).take(LEAST_OFFERS) {
        clause.weight = clause.weight.max(MAIN);
    }
    for offer in clauses.iter_mut().filter_map(|clause| clause.offer.as_mut()) {
        offer.things = Things::Any;
    }
}

struct Filler<'a> {
    clauses: &'a mut Vec<Clause>,
    brief: &'a Brief<'a>,
    rng: ChaCha8Rng,
}

impl Filler<'_> {
    /// Inserts a clause before the first one of its frame or a later frame.
    fn insert(&mut self, clause: Clause) {
        let at = self.clauses.iter().position(|other| other.at >= clause.at).unwrap_or(self.clauses.len());
        self.clauses.insert(at, clause);
    }

    /// A place for a thing between the ends.
    fn landmark(&mut self) -> bool {
        let Some(hop) = free_hops(self.clauses, self.brief.memory).choose(&mut self.rng).copied() else { return false };
        let is_faint = self.rng.random_bool(LESS_SALIENT);
        let things = if is_faint { Things::Faint } else { Things::Fair };
        insert(self.clauses, hop, Offer::new(Role::Onward, hop + 1).taking(things));
        true
    }

    /// The last offer that `says_less` accepts.
    fn offers(&mut self, says_less: impl Fn(&Offer) -> bool) -> Option<&mut Offer> {
        let mut offers = self.clauses.iter_mut().rev().filter_map(|clause| clause.offer.as_mut());
        offers.find(|offer| says_less(offer))
    }

    fn side(&mut self) -> bool {
        let offer = self.offers(|offer| offer.role == Role::Onward && !offer.tells_side && !offer.pair);
        offer.map(|offer| offer.tells_side = true).is_some()
    }

    fn pair(&mut self) -> bool {
        let may = |role: Role| matches!(role, Role::Stop(_) | Role::Onward | Role::Turn);
        let offer = self.offers(|offer| may(offer.role) && !offer.pair && !offer.tells_side);
        offer.map(|offer| offer.pair = true).is_some()
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

    /// A door or doorway that no clause mentions.
    fn door(&mut self) -> bool {
        let doors = self.brief.memory.openings.iter().filter(|opening| opening.has_door);
        for opening in doors {
            let told = self.clauses.iter().position(|clause| clause.at == opening.before && !clause.is_offer());
            let Some(at) = told else {
                self.insert(Clause::new(Kind::ThroughDoor, opening.before, SIDE));
                return true;
            };
            let kind = match self.clauses[at].kind {
                Kind::Enter if self.clauses[at].offer.is_some() || self.rng.random_bool(0.5) => {
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

    /// A thing in a room that the walker enters.
    fn with(&mut self) -> bool {
        for at in 0..self.clauses.len() {
            let clause = &self.clauses[at];
            let opening = self.brief.memory.openings.iter().find(|opening| opening.before == clause.at);
            let is_free = clause.kind == Kind::Enter && clause.offer.is_none();
            if let Some(opening) = opening.filter(|_| is_free) {
                self.clauses[at].offer = Some(Offer::new(Role::EnterWith, opening.behind));
                return true;
            }
        }
        false
    }

    fn stop_room(&mut self) -> bool {
        let Some(stop) = self.clauses.last_mut().filter(|stop| stop.room.is_some()) else { return false };
        let named = [(Kind::StopAt, Kind::StopAtIn), (Kind::Stop, Kind::StopIn)];
        let with_room = |kind: Kind| named.iter().find(|(without, _)| *without == kind).map(|(_, with)| *with);
        let mut says_more = false;
        if let Some(kind) = with_room(stop.kind) {
            (stop.kind, says_more) = (kind, stop.offer.is_none());
        }
        if let Some(Offer { role: Role::Stop(kind), .. }) = &mut stop.offer
            && let Some(with) = with_room(*kind)
        {
            (*kind, says_more) = (with, true);
        }
        says_more
    }

    /// A "go straight" before another clause.
    fn onward(&mut self) -> bool {
        let goes_on = |clause: &Clause| clause.is_offer() || clause.kind == Kind::Straight;
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
