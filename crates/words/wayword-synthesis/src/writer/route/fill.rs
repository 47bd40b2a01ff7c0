//! Adds details to the plan of a text that is shorter than the texts of its style. Like the plan, this depends on the
//! way alone.

use super::{
    FILLER_WEIGHT, MAIN_WEIGHT, OfferRole, SIDE_WEIGHT, ThingOffer, WayClause,
    offer::{OfferThings, free_hops, insert_offer},
    usable_room,
};
use crate::{
    style::way::ClauseKind,
    writer::{WritingBrief, dice::TextDice, phrases::draw_option},
};
use rand::{Rng, seq::IndexedRandom};
use rand_chacha::ChaCha8Rng;
use wayword_language::lexicon::room_name;

/// A detail that can be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FillerKind {
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

impl FillerKind {
    /// The kind of clause that it makes, where a style may hardly have that.
    fn clause(self) -> Option<ClauseKind> {
        match self {
            Self::Room => Some(ClauseKind::Through),
            Self::Door => Some(ClauseKind::ThroughDoor),
            Self::With => Some(ClauseKind::EnterWith),
            Self::StopRoom => Some(ClauseKind::StopAtIn),
            Self::Landmark | Self::Side | Self::Pair | Self::Onward => None,
        }
    }
}

/// How often each kind is tried first, relative to the others.
const FILLER_SHARES: [(f64, FillerKind); 8] = [
    (4.0, FillerKind::Landmark),
    (1.0, FillerKind::Side),
    (1.5, FillerKind::Pair),
    (1.5, FillerKind::Room),
    (2.0, FillerKind::Door),
    (1.5, FillerKind::With),
    (1.5, FillerKind::StopRoom),
    (0.2, FillerKind::Onward),
];

/// Share of the added places for things that accept poor landmarks too.
const POOR_LANDMARK_SHARE: f64 = 0.25;
/// Least number of places for things before the end of a text.
const MIN_OFFERS: usize = 2;

/// Adds one detail; `false` if there is none to add.
pub(in crate::writer) fn fill_plan(clauses: &mut Vec<WayClause>, brief: &WritingBrief<'_>, dice: TextDice) -> bool {
    let way = &brief.profile.way;
    let share =
        |(share, kind): &(f64, FillerKind)| (share * kind.clause().map_or(1.0, |kind| way.usual_share(kind)), *kind);
    let mut untried: Vec<(f64, FillerKind)> = FILLER_SHARES.iter().map(share).collect();
    let mut rng = dice.named_rng(&["more"]);
    while let Some(more) = draw_option(&untried, &mut rng) {
        let mut filler = PlanFiller { clauses, brief, rng: dice.named_rng(&["more of", &format!("{more:?}")]) };
        let is_added = match more {
            FillerKind::Landmark => filler.add_landmark(),
            FillerKind::Side => filler.add_side(),
            FillerKind::Pair => filler.add_pair(),
            FillerKind::Room => filler.add_room(),
            FillerKind::Door => filler.add_door(),
            FillerKind::With => filler.add_thing_in_room(),
            FillerKind::StopRoom => filler.add_stop_room(),
            FillerKind::Onward => filler.add_onward(),
        };
        if is_added {
            return true;
        }
        untried.retain(|(_, other)| *other != more);
    }
    false
}

/// Makes sure that a text has places for things on the way, which accept almost any thing and are never dropped.
pub(in crate::writer) fn offer_places(clauses: &mut Vec<WayClause>, brief: &WritingBrief<'_>, dice: TextDice) {
    let offers = |clauses: &[WayClause]| clauses.iter().rev().skip(1).filter(|clause| clause.offer.is_some()).count();
    let mut times = 0;
    while offers(clauses) < MIN_OFFERS {
        if !(PlanFiller { clauses, brief, rng: dice.other_draws(times).named_rng(&["one thing"]) }).add_landmark() {
            break;
        }
        times += 1;
    }
    for clause in clauses.iter_mut().rev().skip(1).filter(|clause| clause.offer.is_some()).take(MIN_OFFERS) {
        clause.weight = clause.weight.max(MAIN_WEIGHT);
    }
    for offer in clauses.iter_mut().filter_map(|clause| clause.offer.as_mut()) {
        offer.things = OfferThings::Any;
    }
}

/// Adds details to the clauses of a plan. Each `add_...` returns whether it found something to add.
struct PlanFiller<'a> {
    clauses: &'a mut Vec<WayClause>,
    brief: &'a WritingBrief<'a>,
    rng: ChaCha8Rng,
}

impl PlanFiller<'_> {
    /// Inserts a clause before the first one of its frame or a later frame.
    fn insert_clause(&mut self, clause: WayClause) {
        let at = self.clauses.iter().position(|other| other.at >= clause.at).unwrap_or(self.clauses.len());
        self.clauses.insert(at, clause);
    }

    /// A place for a thing between the ends.
    fn add_landmark(&mut self) -> bool {
        let Some(hop) = free_hops(self.clauses, self.brief.memory).choose(&mut self.rng).copied() else { return false };
        let is_faint = self.rng.random_bool(POOR_LANDMARK_SHARE);
        let things = if is_faint { OfferThings::Faint } else { OfferThings::Fair };
        insert_offer(self.clauses, hop, ThingOffer::new(OfferRole::Onward, hop + 1).with_things(things));
        true
    }

    /// The last offer that `says_less` accepts.
    fn find_offer(&mut self, says_less: impl Fn(&ThingOffer) -> bool) -> Option<&mut ThingOffer> {
        let mut offers = self.clauses.iter_mut().rev().filter_map(|clause| clause.offer.as_mut());
        offers.find(|offer| says_less(offer))
    }

    /// The side of a thing, at the last place that names neither a side nor a second thing.
    fn add_side(&mut self) -> bool {
        let offer = self.find_offer(|offer| offer.role == OfferRole::Onward && !offer.tells_side && !offer.pair);
        offer.map(|offer| offer.tells_side = true).is_some()
    }

    /// A second thing near one, at the last place that names neither a side nor a second thing.
    fn add_pair(&mut self) -> bool {
        let may = |role: OfferRole| matches!(role, OfferRole::Stop(_) | OfferRole::Onward | OfferRole::Turn);
        let offer = self.find_offer(|offer| may(offer.role) && !offer.pair && !offer.tells_side);
        offer.map(|offer| offer.pair = true).is_some()
    }

    /// A room on the way that no clause names.
    fn add_room(&mut self) -> bool {
        let memory = self.brief.memory;
        let last = memory.frame_count().saturating_sub(1);
        let crossed = memory.stays.iter().filter(|stay| stay.entered > 0 && stay.left < last);
        let knows_way = self.brief.walk.path.motion.is_known();
        for stay in crossed {
            let Some(room) = usable_room(&stay.room) else { continue };
            let is_named =
                |clause: &WayClause| clause.room.as_ref() == Some(&room) || clause.from.as_ref() == Some(&room);
            if self.clauses.iter().any(is_named) {
                continue;
            }
            let is_hall = room_name(&room) == Some("hallway");
            if is_hall && knows_way && !memory.goes_along(stay, stay.entered) {
                continue;
            }
            let kind = if is_hall { ClauseKind::Along } else { ClauseKind::Through };
            self.insert_clause(WayClause::new(kind, stay.entered, SIDE_WEIGHT).with_room(&room));
            return true;
        }
        false
    }

    /// A door or doorway that no clause mentions.
    fn add_door(&mut self) -> bool {
        let doors = self.brief.memory.openings.iter().filter(|opening| opening.has_door);
        for opening in doors {
            let same_place = self.clauses.iter().position(|clause| clause.at == opening.before && !clause.is_offer());
            let Some(at) = same_place else {
                self.insert_clause(WayClause::new(ClauseKind::ThroughDoor, opening.before, SIDE_WEIGHT));
                return true;
            };
            let kind = match self.clauses[at].kind {
                ClauseKind::Enter if self.clauses[at].offer.is_some() || self.rng.random_bool(0.5) => {
                    self.clauses.insert(at, WayClause::new(ClauseKind::ThroughDoor, opening.before, SIDE_WEIGHT));
                    return true;
                }
                ClauseKind::Enter => ClauseKind::EnterThroughDoor,
                ClauseKind::Leave => ClauseKind::LeaveByDoor,
                _ => continue,
            };
            self.clauses[at].kind = kind;
            return true;
        }
        false
    }

    /// A thing in a room that the walker enters.
    fn add_thing_in_room(&mut self) -> bool {
        for at in 0..self.clauses.len() {
            let clause = &self.clauses[at];
            let opening = self.brief.memory.openings.iter().find(|opening| opening.before == clause.at);
            let is_free = clause.kind == ClauseKind::Enter && clause.offer.is_none();
            if let Some(opening) = opening.filter(|_| is_free) {
                self.clauses[at].offer = Some(ThingOffer::new(OfferRole::EnterWith, opening.behind));
                return true;
            }
        }
        false
    }

    /// The room in the clause to stop, and in the role of its thing.
    fn add_stop_room(&mut self) -> bool {
        let Some(stop) = self.clauses.last_mut().filter(|stop| stop.room.is_some()) else { return false };
        let named = [(ClauseKind::StopAt, ClauseKind::StopAtIn), (ClauseKind::Stop, ClauseKind::StopIn)];
        let with_room = |kind: ClauseKind| named.iter().find(|(without, _)| *without == kind).map(|(_, with)| *with);
        let mut says_more = false;
        if let Some(kind) = with_room(stop.kind) {
            (stop.kind, says_more) = (kind, stop.offer.is_none());
        }
        if let Some(ThingOffer { role: OfferRole::Stop(kind), .. }) = &mut stop.offer
            && let Some(with) = with_room(*kind)
        {
            (*kind, says_more) = (with, true);
        }
        says_more
    }

    /// A "go straight" before another clause.
    fn add_onward(&mut self) -> bool {
        let goes_on = |clause: &WayClause| clause.is_offer() || clause.kind == ClauseKind::Straight;
        let is_free = |at: &usize| {
            let now = &self.clauses[*at];
            let is_after = *at == 0 || now.at > self.clauses[*at - 1].at && !goes_on(&self.clauses[*at - 1]);
            is_after && !goes_on(now) && (now.at > 0 || !now.is_bare())
        };
        let free: Vec<usize> = (0..self.clauses.len()).filter(is_free).collect();
        let Some(at) = free.choose(&mut self.rng).copied() else { return false };
        let frame = self.clauses[at].at;
        self.clauses.insert(at, WayClause::new(ClauseKind::Straight, frame, FILLER_WEIGHT));
        true
    }
}
