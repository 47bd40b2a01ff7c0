//! Straight on: past things, and along hallways.

use super::{Clause, FILLER, LONG_M, MAIN, Planner, SIDE, STOPPED_AT, WALKED_PAST, usable_room};
use crate::{
    style::way::{Kind, Way},
    writer::{
        landmarks::{Landmark, Use},
        phrases::draw,
    },
};
use rand::Rng;
use wayword_core::Side;
use wayword_language::lexicon::room_name;

impl Planner<'_, '_, '_> {
    pub(super) fn along(&mut self, at: usize, room: &str, weight: u8) {
        self.push(Clause::new(Kind::Along, at, weight).room(room));
        self.enter(Some(room));
        self.along = true;
    }

    /// A hop within a room: past a landmark, along the hallway, or at least straight on.
    pub(super) fn onwards(&mut self, at: usize) {
        let is_last = at + 2 >= self.memory.frames();
        let was_onward = self.clauses.last().is_some_and(|before| {
            matches!(before.kind, Kind::Pass | Kind::PassOnSide | Kind::To | Kind::Straight) && before.at == at
        });
        let names_thing = self.clauses.iter().any(|clause| clause.thing.is_some());
        if (!was_onward && self.rng.random_bool(if is_last { 0.3 } else { 0.5 })) || !names_thing {
            let thing = self.landmarks.find(at + 1, WALKED_PAST, Use::Here, self.rng);
            let thing = thing.or_else(|| self.landmarks.find(at + 1, STOPPED_AT, Use::Here, self.rng));
            let thing =
                thing.or_else(|| self.landmarks.find(at, WALKED_PAST, Use::Here, self.rng).filter(|_| !names_thing));
            if let Some(thing) = thing {
                return self.pass(at, thing);
            }
        }
        let room = self.memory.room(at + 1).and_then(usable_room);
        let hall = room.filter(|room| room_name(room) == Some("hallway"));
        if let Some(hall) = hall.filter(|_| !self.along && self.rng.random_bool(0.7)) {
            return self.along(at, &hall, SIDE);
        }
        let is_long = self.brief.walk.moves.get(at).is_none_or(|step| step.distance_m >= LONG_M);
        if is_long && !was_onward && !self.along && self.rng.random_bool(0.25) {
            self.push(Clause::new(Kind::Straight, at, FILLER));
        }
    }

    pub(super) fn pass(&mut self, at: usize, thing: Landmark) {
        let side = thing.passed.filter(|(frame, _)| (at..=at + 1).contains(frame)).map(|(_, side)| side);
        let kinds = self.ways_past(side, thing.side);
        let kind = draw(&kinds, self.rng).unwrap_or(Kind::Pass);
        let names_thing = self.clauses.iter().any(|clause| clause.thing.is_some());
        let mut clause = Clause::new(kind, at, if names_thing { SIDE } else { MAIN }).by(thing);
        clause.side = side.filter(|_| kind == Kind::PassOnSide);
        self.push(clause);
    }

    /// How one goes on by a thing, with the side on which one passes it, and that on which it lies.
    fn ways_past(&self, passed: Option<Side>, side: Option<Side>) -> Vec<(f64, Kind)> {
        ways_past(&self.brief.profile.way, &self.clauses, passed, side)
    }
}

/// How one goes on by a thing. What was done already in a text is done less often.
pub(super) fn ways_past(way: &Way, told: &[Clause], passed: Option<Side>, side: Option<Side>) -> Vec<(f64, Kind)> {
    let again = |kind: Kind| 0.35_f64.powi(told.iter().filter(|clause| clause.kind == kind).count() as i32);
    let share = |kind: Kind, times: f64| (way.count(kind) * times * again(kind), kind);
    let mut kinds = vec![share(Kind::Pass, 0.5)];
    if passed.is_some() {
        kinds.push(share(Kind::PassOnSide, 2.0));
    }
    if side != Some(Side::Behind) {
        kinds.push(share(Kind::To, 1.5));
    }
    kinds
}
