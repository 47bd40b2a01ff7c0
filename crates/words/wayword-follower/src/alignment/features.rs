//! Computes the features of a part of a text on a stretch of a walk.

use super::{
    parts::{PartKind, PartedText},
    tables::{
        ANGLES, CLIMB_AFTER, CLIMB_BEFORE, CLIMB_RISE, EQUAL_SHIFT, FLAT_RISE, FOLLOWER, HOPS, KIND_BEFORE, KIND_HOPS,
        KIND_METRES, KIND_NEXT, KIND_ROOMS, KINDS, METRE_SHIFT, METRES, PACE_HOPS, PACES, PLACE_HOPS, PLACE_METRES,
        PLACES, RISES, SHIFTS, TURN_AFTER, TURN_BEFORE, TURN_BEND, TURN_FIRST, TURN_LATER, UNTOLD_FIRST, UNTOLD_LATER,
        WIDTHS, WORD_HOPS, WORD_SHIFT, WORDS,
    },
};
use crate::{
    building::{KnownBuilding, wrap_angle},
    features::{FeatureNumber, limit_class},
    tree::WalkTree,
};
use wayword_core::{ClimbDirection, Side};

/// A feature and its value: 1 for a yes-or-no statement.
pub(super) type ValuedFeature = (FeatureNumber, f64);

/// A walk as the alignment needs it. Places are numbered along the walk, from 0.
#[derive(Debug)]
pub(super) struct AlignedWalk {
    /// The turn at each place but the last, before going on, radians, positive right. The first is from the walker's first direction.
    turns_rad: Vec<f64>,
    /// The way from the start to each place, metres.
    along_m: Vec<f64>,
    /// The height of each place, metres.
    heights_m: Vec<f64>,
    /// Whether the room of each place but the first is another than that of the place before.
    changes_room: Vec<bool>,
}

impl AlignedWalk {
    pub(super) fn new(building: &KnownBuilding, tree: &WalkTree) -> Self {
        let viewpoint = |node: usize| &building.viewpoints[tree.nodes[node].viewpoint];
        let mut way_m = 0.0;
        let along_m = tree.nodes.iter().map(|node| {
            way_m += node.length_m;
            way_m
        });
        Self {
            along_m: along_m.collect(),
            turns_rad: tree.turns_rad(tree.len() - 1),
            heights_m: (0..tree.len()).map(|node| viewpoint(node).position.z).collect(),
            changes_room: (1..tree.len()).map(|node| viewpoint(node).room != viewpoint(node - 1).room).collect(),
        }
    }

    /// Number of the last place.
    pub(super) fn last_place(&self) -> usize {
        self.along_m.len() - 1
    }

    /// The turn at a place, radians; 0 at the last.
    fn turn_at(&self, place: usize) -> f64 {
        self.turns_rad.get(place).copied().unwrap_or_default()
    }

    /// The rise between two places, metres; beyond the ends of the walk it is that up to the end.
    fn rise_m(&self, from: usize, to: usize) -> f64 {
        self.heights_m[to.min(self.last_place())] - self.heights_m[from]
    }
}

/// A text on a walk.
#[derive(Debug)]
pub(super) struct PartedTrial<'a> {
    pub(super) text: &'a PartedText,
    pub(super) walk: AlignedWalk,
}

impl PartedTrial<'_> {
    /// Adds the features that need no word of the text but the number of words of each part.
    pub(super) fn length_features(&self, part: usize, [from, to]: [usize; 2], found: &mut Vec<ValuedFeature>) {
        let (parts, walk) = (&self.text.parts, &self.walk);
        let (count, end) = (parts.len(), walk.last_place());
        let hops = (hops_class(to - from), HOPS);
        let place = (self.place_in_text(part), PLACES);
        let words = limit_class(parts[part].word_count as f64, &[2.5, 3.5, 5.5, 7.5, 10.5, 14.5]);
        let pace = limit_class(end as f64 / count as f64, &[0.75, 1.1, 1.4, 1.8, 2.2, 2.8, 3.8]);
        let mut add = |feature: FeatureNumber| found.push((feature, 1.0));
        add(PLACE_HOPS.feature_at([place, hops]));
        add(WORD_HOPS.feature_at([(words, WORDS), hops]));
        add(PACE_HOPS.feature_at([(pace, PACES), place, hops]));
        add(PLACE_METRES.feature_at([place, (self.metres_class([from, to]), METRES)]));
        if part + 1 < count {
            let words_to = |part: usize| parts[..part].iter().map(|part| part.word_count).sum::<usize>() as f64;
            let word_share = words_to(part + 1) / words_to(count).max(1.0);
            let part_share = (part + 1) as f64 / count as f64;
            let shift = |off: f64| (limit_class(off, &SHIFT_LIMITS), SHIFTS);
            add(WORD_SHIFT.feature_at([shift(to as f64 - word_share * end as f64)]));
            add(EQUAL_SHIFT.feature_at([shift(to as f64 - part_share * end as f64)]));
            let off_m = walk.along_m[to] - word_share * walk.along_m[end];
            add(METRE_SHIFT.feature_at([shift(off_m / METRES_PER_HOP)]));
        }
    }

    /// Adds the features of what the words ask for. `follower_score` is the follower's score of the part's steps on the stretch.
    pub(super) fn word_features(
        &self,
        part: usize,
        [from, to]: [usize; 2],
        follower_score: f64,
        found: &mut Vec<ValuedFeature>,
    ) {
        let parts = &self.text.parts;
        let kind = (parts[part].kind as usize, KINDS);
        let kind_or_none = |part: Option<usize>| {
            (part.and_then(|at| parts.get(at)).map_or(KINDS, |part| part.kind as usize), KINDS + 1)
        };
        let hops = to - from;
        let few_hops = (hops.min(3), 4);
        let mut add = |feature: FeatureNumber| found.push((feature, 1.0));
        add(KIND_HOPS.feature_at([kind, (self.place_in_text(part), PLACES), (hops_class(hops), HOPS)]));
        add(KIND_METRES.feature_at([kind, (self.metres_class([from, to]), METRES)]));
        add(KIND_NEXT.feature_at([kind, kind_or_none(Some(part + 1)), few_hops]));
        add(KIND_BEFORE.feature_at([kind, kind_or_none(part.checked_sub(1)), few_hops]));
        self.turn_features(part, [from, to], found);
        self.rise_features(part, [from, to], found);
        let changes = |hop: usize| self.walk.changes_room.get(hop).copied().unwrap_or_default();
        let at_last = hops > 0 && changes(to - 1);
        let before_last = (from..to.saturating_sub(1)).any(changes);
        let flag = |is: bool| (usize::from(is), 2);
        found.push((KIND_ROOMS.feature_at([kind, flag(at_last), flag(before_last), flag(changes(to))]), 1.0));
        found.push((FOLLOWER.feature_at([(0, 1)]), follower_score));
    }

    fn turn_features(&self, part: usize, [from, to]: [usize; 2], found: &mut Vec<ValuedFeature>) {
        let described = &self.text.parts[part];
        let turns_rad = |from: usize, to: usize| (from..to).map(|place| self.walk.turn_at(place));
        let widest =
            |from: usize, to: usize| turns_rad(from, to).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or_default();
        let mut add = |feature: FeatureNumber| found.push((feature, 1.0));
        let Some(side) = described.turn_side(&self.text.guide) else {
            let kind = (described.kind as usize, KINDS);
            if to > from && from > 0 {
                add(UNTOLD_FIRST.feature_at([kind, (width_class(self.walk.turn_at(from)), WIDTHS)]));
            }
            if to > from + 1 {
                add(UNTOLD_LATER.feature_at([kind, (width_class(widest(from + 1, to)), WIDTHS)]));
            }
            return;
        };
        let sign = if side == Side::Left { -1.0 } else { 1.0 };
        let angle = |rad: f64| (limit_class(rad.to_degrees() * sign, &ANGLE_LIMITS_DEG), ANGLES);
        let bare = (usize::from(described.kind == PartKind::BareTurn), 2);
        if to > from {
            add(TURN_FIRST.feature_at([(usize::from(from == 0), 2), bare, angle(self.walk.turn_at(from))]));
            add(TURN_BEND.feature_at([bare, angle(wrap_angle(turns_rad(from, to).sum()))]));
        }
        if to > from + 1 {
            add(TURN_LATER.feature_at([bare, angle(widest(from + 1, to))]));
        }
        if to < self.walk.last_place() {
            add(TURN_AFTER.feature_at([angle(self.walk.turn_at(to))]));
        }
        if from > 0 {
            add(TURN_BEFORE.feature_at([angle(self.walk.turn_at(from - 1))]));
        }
    }

    fn rise_features(&self, part: usize, [from, to]: [usize; 2], found: &mut Vec<ValuedFeature>) {
        let (guide, described) = (&self.text.guide, &self.text.parts[part]);
        let mut add = |feature: FeatureNumber| found.push((feature, 1.0));
        let Some(climb) = described.climb(guide) else {
            let has_climb = guide.steps.iter().any(|step| step.step.climb.is_some());
            let rise = limit_class(self.walk.rise_m(from, to).abs(), &[0.15, 0.5, 1.0, 2.0]);
            let kind = (described.kind as usize, KINDS);
            add(FLAT_RISE.feature_at([(usize::from(has_climb), 2), kind, (rise, WIDTHS)]));
            return;
        };
        let sign = if climb == ClimbDirection::Up { 1.0 } else { -1.0 };
        let class = |rise_m: f64| (limit_class(rise_m * sign, &RISE_LIMITS_M), RISES);
        add(CLIMB_RISE.feature_at([class(self.walk.rise_m(from, to))]));
        if to < self.walk.last_place() {
            add(CLIMB_AFTER.feature_at([class(self.walk.rise_m(to, to + 1))]));
        }
        if from > 0 {
            add(CLIMB_BEFORE.feature_at([class(self.walk.rise_m(from - 1, from))]));
        }
    }

    /// Which of the [`PLACES`] a part has in its text.
    fn place_in_text(&self, part: usize) -> usize {
        match (part == 0, part + 1 == self.text.parts.len()) {
            (true, true) => 0,
            (true, false) => 1,
            (false, false) => 2,
            (false, true) => 3,
        }
    }

    /// The class of the length of a stretch.
    fn metres_class(&self, [from, to]: [usize; 2]) -> usize {
        limit_class(self.walk.along_m[to] - self.walk.along_m[from], &[0.1, 1.5, 2.5, 3.5, 5.0, 7.0, 10.0])
    }
}

/// The length of a hop that is usual in R2R, metres: puts metres and hops on one scale.
const METRES_PER_HOP: f64 = 2.2;
/// Limits of the classes of shifts, hops.
const SHIFT_LIMITS: [f64; SHIFTS - 1] = [-2.5, -1.75, -1.25, -0.75, -0.4, -0.1, 0.1, 0.4, 0.75, 1.25, 1.75, 2.5];
/// Limits of the classes of angles towards a side, degrees.
const ANGLE_LIMITS_DEG: [f64; ANGLES - 1] = [-75.0, -40.0, -15.0, 10.0, 25.0, 45.0, 70.0, 110.0];
/// Limits of the classes of rises in the direction of the text, metres.
const RISE_LIMITS_M: [f64; RISES - 1] = [-1.0, -0.3, -0.1, 0.1, 0.3, 0.7, 1.3, 2.2];

fn hops_class(hops: usize) -> usize {
    hops.min(HOPS - 1)
}

fn width_class(rad: f64) -> usize {
    limit_class(rad.abs().to_degrees(), &[15.0, 35.0, 60.0, 90.0])
}

#[cfg(test)]
mod tests;
