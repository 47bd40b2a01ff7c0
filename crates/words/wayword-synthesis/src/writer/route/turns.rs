//! Plans turns within a room, and the turn at the start.

use super::{LONG_HOP_M, MAIN_WEIGHT, OfferRole, ThingOffer, WayClause, WayPlanner, usable_room};
use crate::{style::way::ClauseKind, writer::phrases::draw_option};
use rand::Rng;
use wayword_checks::memory::{MAX_BARE_STOP_GAP_M, MAX_SILENT_WAY_M, WalkBend};
use wayword_core::{ClimbDirection, Side, motion, seeded_rng};
use wayword_language::lexicon::room_name;

impl WayPlanner<'_> {
    /// Plans a turn within a room: at a landmark, at the stairs, in the room, or right after the previous clause.
    pub(super) fn add_turn(&mut self, bend: WalkBend) {
        let (at, side) = (bend.first, bend.side());
        if at == 0 {
            return self.first_turn(bend);
        }
        if side == Side::Behind {
            return self.push(WayClause::new(ClauseKind::TurnAround, at, MAIN_WEIGHT));
        }
        if self.is_left_out(bend) {
            return;
        }
        let flight = self.memory.flights.iter().find(|flight| flight.to == at).map(|flight| flight.climb);
        let offers = self.rng.random_bool(if flight.is_some() { 0.25 } else { 0.75 });
        let is_silent =
            self.walked_since(at).is_some_and(|(from, _)| self.brief.walk.walked_m(from, at) > MAX_SILENT_WAY_M);
        let straight_from = self.straight_before(at) && !is_silent;
        if !offers || is_silent {
            self.go_on_to(at);
        }
        let is_small = bend.turn_rad.to_degrees().abs() < motion::TOLD_DEG;
        if is_small && !is_silent && self.is_untold_before(at) {
            self.push(WayClause::new(ClauseKind::Straight, at.saturating_sub(1), MAIN_WEIGHT));
        }
        let says_slightly = 0.5 * self.brief.profile.way.usual_share(ClauseKind::TurnSlightly);
        let slight = is_small || (bend.is_slight() && self.rng.random_bool(says_slightly));
        let bare = if slight { ClauseKind::TurnSlightly } else { ClauseKind::Turn };
        let follows = self.follows_a_place(at);
        let room = self.memory.room_at(at).and_then(usable_room);
        let is_hall = room.as_deref().and_then(room_name) == Some("hallway");
        let mut kinds = vec![(if follows || offers { 4.0 } else { 0.3 }, bare)];
        match flight {
            _ if is_small => {}
            Some(ClimbDirection::Up) => kinds.push((4.0, ClauseKind::TurnAtTop)),
            Some(ClimbDirection::Down) => kinds.push((4.0, ClauseKind::TurnAtBottom)),
            _ => {}
        }
        if is_hall && !self.along && self.walked_in(at) >= 2 && self.goes_along(at.saturating_sub(1)) {
            kinds.push((3.0, ClauseKind::Along));
        }
        if room.is_some() && room != self.here && !is_small {
            kinds.push((0.4, ClauseKind::TurnIn));
        }
        let kind = draw_option(&kinds, &mut self.rng).unwrap_or(bare);
        let room = room.unwrap_or_default();
        let turn = match kind {
            ClauseKind::Along => {
                self.go_along(at.saturating_sub(1), &room, MAIN_WEIGHT);
                WayClause::new(bare, at, MAIN_WEIGHT).with_side(side)
            }
            ClauseKind::TurnIn => WayClause::new(kind, at, MAIN_WEIGHT).with_side(side).with_room(&room),
            kind => WayClause::new(kind, at, MAIN_WEIGHT).with_side(side),
        };
        let offer = ThingOffer {
            or_straight: straight_from && kind != ClauseKind::Along,
            ..ThingOffer::new(OfferRole::Turn, at)
        };
        self.push(if offers { turn.with_offer(offer) } else { turn });
        self.along = false;
    }

    /// Whether the clause before a turn makes its place clear: it is no turn itself, and not far before it.
    fn follows_a_place(&self, at: usize) -> bool {
        let before = self.clauses.iter().rfind(|before| !before.is_offer());
        before.is_some_and(|before| !before.is_bare() && before.at + 1 >= at)
    }

    /// Number of hops that the walk has made in the room of a frame when it arrives there.
    fn walked_in(&self, at: usize) -> usize {
        self.memory.stay_at(at).map_or(0, |stay| at - stay.entered)
    }

    /// Where the walker has gone a long way in a room since the last clause, its first frame and the room.
    fn walked_since(&self, at: usize) -> Option<(usize, &str)> {
        let stay = self.memory.stay_at(at)?;
        let from = stay.entered.max(self.planned_until(at));
        (!self.along && self.brief.walk.walked_m(from, at) >= LONG_HOP_M).then_some((from, stay.room.as_str()))
    }

    /// Whether a walker who hears of a slight turn at a frame would take it at once, some way before it.
    fn is_untold_before(&self, at: usize) -> bool {
        let Some(before) = self.clauses.last() else { return false };
        !before.kind.goes_on() && self.memory.walked_m(self.planned_until(at), at) > MAX_BARE_STOP_GAP_M
    }

    /// Whether a turn that gets no thing needs a "go straight" before it.
    fn straight_before(&self, at: usize) -> bool {
        self.walked_since(at).is_some() && !self.clauses.last().is_some_and(WayClause::is_offer)
    }

    /// Adds "go straight" or "go along the hallway" before a turn or a door if the walker has gone a long way since the
    /// last clause.
    pub(super) fn go_on_to(&mut self, at: usize) {
        let Some((from, room)) = self.walked_since(at) else { return };
        let hall = usable_room(room).filter(|room| room_name(room) == Some("hallway"));
        match hall.filter(|_| self.says_along()) {
            Some(hall) => self.go_along(from, &hall, MAIN_WEIGHT),
            None => self.push(WayClause::new(ClauseKind::Straight, from, MAIN_WEIGHT)),
        }
    }

    /// Plans the turn at the start. It is mostly left out, because the first landmark shows the direction, and nothing shows where to turn.
    fn first_turn(&mut self, bend: WalkBend) {
        let side = bend.side();
        if self.leaves_out_first_turn(side) {
            return;
        }
        let leaves_soon =
            self.memory.openings.first().is_some_and(|opening| opening.before <= 1) && self.here.is_some();
        let kind = if side == Side::Behind { ClauseKind::TurnAround } else { ClauseKind::Turn };
        let is_told = match (side, leaves_soon) {
            (Side::Behind, _) if self.brief.profile.way.untold_first_turns > 0.0 => true,
            (Side::Behind, true) => self.rng.random_bool(0.03),
            (Side::Behind, false) => self.rng.random_bool(0.1),
            (_, true) => bend.turn_rad.to_degrees().abs() >= motion::TOLD_DEG && self.rng.random_bool(0.03),
            (_, false) => !bend.is_slight() && self.rng.random_bool(0.08),
        };
        if is_told {
            self.push(WayClause::new(kind, 0, MAIN_WEIGHT).with_side(side));
        }
    }

    /// Whether a turn at the start is left out because texts of the style hardly have one. What lies behind the walker is not left to be found.
    pub(super) fn leaves_out_first_turn(&mut self, side: Side) -> bool {
        let share = self.brief.profile.way.untold_first_turns;
        share > 0.0 && side != Side::Behind && self.rng.random_bool(share.min(1.0))
    }

    /// Whether a turn is left out: people do not mention small turns that the way requires anyway. All candidates of a
    /// text leave out the same ones, and the way back the same ones as the way there.
    pub(super) fn is_left_out(&self, bend: WalkBend) -> bool {
        if bend.turn_rad.to_degrees().abs() >= motion::TOLD_DEG || self.memory.faces_other_door(bend.first) {
            return false;
        }
        let brief = self.brief;
        let on_the_way: Vec<usize> =
            self.memory.bends.iter().filter(|bend| bend.first > 0).map(|bend| bend.last).collect();
        let place = on_the_way.iter().position(|last| *last == bend.last);
        let from_an_end = place.map_or(0, |place| 1 + place.min(on_the_way.len() - 1 - place));
        let names = ["left out", brief.style.draw_name(), &brief.walk.path.id, &from_an_end.to_string()];
        let told = (1.0 - LEFT_OUT_SHARE) * brief.profile.way.usual_share(ClauseKind::TurnSlightly);
        seeded_rng(brief.seed, &names).random_bool(1.0 - told)
    }
}

/// Share of the turns below [`motion::TOLD_DEG`] that is left out.
const LEFT_OUT_SHARE: f64 = 0.6;
