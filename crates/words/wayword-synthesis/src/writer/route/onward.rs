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
use rand_chacha::ChaCha8Rng;
use wayword_core::Side;
use wayword_language::lexicon::room_name;

impl Planner<'_, '_> {
    pub(super) fn along(&mut self, at: usize, room: &str, weight: u8) {
        self.push(Clause::new(Kind::Along, at, weight).room(room));
        self.along = true;
    }

    /// A hop within a room: past a landmark, along the hallway, or at least straight on.
    pub(super) fn onwards(&mut self, at: usize) {
        let is_last = at + 2 >= self.memory.frames();
        let was_onward = self.clauses.last().is_some_and(|before| {
            matches!(before.kind, Kind::Pass | Kind::PassOnSide | Kind::To | Kind::Straight) && before.at == at
        });
        let names_thing = self.clauses.iter().any(|clause| clause.thing.is_some());
        let often = if is_last { 0.3 } else { 0.5 };
        let tells_thing = (!was_onward && self.rng.random_bool(often)) || !names_thing;
        if let Some(thing) = tells_thing.then(|| self.thing_on_the_way(at, !names_thing)).flatten() {
            return self.pass(at, thing);
        }
        let room = self.memory.room(at + 1).and_then(usable_room);
        let hall = room.filter(|room| room_name(room) == Some("hallway"));
        if let Some(hall) = hall.filter(|_| !self.along && self.rng.random_bool(0.7)) {
            let left = self.memory.stay(at + 1).map_or(at, |stay| stay.left);
            let weight = if self.brief.walk.walked_m(at, left) >= LONG_M { MAIN } else { SIDE };
            return self.along(at, &hall, weight);
        }
        let is_long = self.brief.walk.moves.get(at).is_none_or(|step| step.distance_m >= LONG_M);
        if is_long && !was_onward && !self.along && self.rng.random_bool(0.25) {
            self.push(Clause::new(Kind::Straight, at, FILLER));
        }
    }

    /// A thing by which one goes on from a frame. Where a text `must` have one, things to the side will do.
    fn thing_on_the_way(&mut self, at: usize, must: bool) -> Option<Landmark> {
        let more =
            [(at + 1, STOPPED_AT, Use::Onward), (at, WALKED_PAST, Use::Onward), (at + 1, STOPPED_AT, Use::Beside)];
        let tries =
            std::iter::once((at + 1, WALKED_PAST, Use::Onward)).chain(more.into_iter().take(if must { 3 } else { 1 }));
        tries.into_iter().find_map(|(frame, salience, to)| self.landmarks.find(frame, salience, to))
    }

    pub(super) fn pass(&mut self, at: usize, thing: Landmark) {
        let side = thing.passed.filter(|(frame, _)| (at..=at + 1).contains(frame)).map(|(_, side)| side);
        let kind = past(&self.brief.profile.way, &self.clauses, side, thing.side, &mut self.rng);
        let names_thing = self.clauses.iter().any(|clause| clause.thing.is_some());
        let mut clause = Clause::new(kind, at, if names_thing { SIDE } else { MAIN }).by(thing);
        clause.side = side.filter(|_| kind == Kind::PassOnSide);
        self.push(clause);
    }
}

/// How one goes on by a thing: past what one passes, and otherwise to it. What was done already in a text is done less
/// often.
pub(super) fn past(way: &Way, told: &[Clause], passed: Option<Side>, side: Option<Side>, rng: &mut ChaCha8Rng) -> Kind {
    let again = |kind: Kind| 0.35_f64.powi(told.iter().filter(|clause| clause.kind == kind).count() as i32);
    let share = |kind: Kind, times: f64| (way.count(kind) * times * again(kind), kind);
    let mut kinds = Vec::new();
    if passed.is_some() || side.is_none() {
        kinds.push(share(Kind::Pass, 0.5));
    }
    if passed.is_some() {
        kinds.push(share(Kind::PassOnSide, 2.0));
    }
    if matches!(side, Some(Side::Ahead) | None) {
        kinds.push(share(Kind::To, 1.5));
    }
    draw(&kinds, rng).unwrap_or(if passed.is_some() { Kind::Pass } else { Kind::To })
}
