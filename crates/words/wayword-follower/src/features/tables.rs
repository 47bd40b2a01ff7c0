//! The tables of features. Each table has a consecutive range of feature numbers, one for each combination of its
//! dimensions. For example, `HOPS` has a feature for "a step of kind 3 that is the last of its text takes 2 hops".

use crate::{guide::GuideStepKind, nearness::CLASSES};
use wayword_language::reading::steps::StepRelation;

/// A table of features.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FeatureTable {
    /// Its name in the file of weights.
    pub(crate) name: &'static str,
    /// The number of its first feature.
    pub(crate) from: usize,
    /// Number of its features.
    pub(crate) size: usize,
    /// Whether it distinguishes so finely that there are few examples for each feature: a fit keeps its weights closer
    /// to their start values.
    pub(crate) is_fine: bool,
}

impl FeatureTable {
    /// The number of a feature of the table, by pairs of the feature's place in each dimension and the size of that dimension.
    pub(crate) fn feature_at<const N: usize>(&self, places: [(usize, usize); N]) -> u32 {
        let place = places.iter().fold(0, |place, (at, size)| {
            debug_assert!(at < size, "{} in {}", at, self.name);
            place * size + at
        });
        debug_assert!(place < self.size, "{place} in {}", self.name);
        (self.from + place) as u32
    }
}

/// Defines a constant for each line `NAME fine|coarse SIZE;`. The tables follow each other without gaps.
macro_rules! feature_tables {
    ($($name:ident $kind:ident $size:expr;)*) => {
        feature_tables!(@ 0; $($name $kind $size;)*);
        /// All tables, in the order of their numbers.
        pub(crate) const ALL: &[FeatureTable] = &[$($name),*];
    };
    (@ $from:expr; $name:ident $kind:ident $size:expr; $($rest:tt)*) => {
        pub(crate) const $name: FeatureTable =
            FeatureTable { name: stringify!($name), from: $from, size: $size, is_fine: feature_tables!(= $kind) };
        feature_tables!(@ $from + $size; $($rest)*);
    };
    (@ $from:expr;) => {
        /// Number of features.
        pub(crate) const COUNT: usize = $from;
    };
    (= fine) => { true };
    (= coarse) => { false };
}
pub(crate) use feature_tables;

/// Number of kinds of steps.
const KINDS: usize = GuideStepKind::COUNT;
/// Number of relations of a step to a place ("to", "past", "out of" and so on).
pub(crate) const RELATIONS: usize = StepRelation::ALL.len();
/// Number of groups of relations.
pub(crate) const GROUPS: usize = 6;
/// Classes of hops: 0 to 6, and more.
pub(crate) const HOPS_CLASSES: usize = 8;
/// Classes of angles, of 15 degrees each.
pub(crate) const ANGLES: usize = 24;
/// Classes of storeys that a text can give: 1, 2, 3, any above or the top one, upstairs, downstairs.
pub(crate) const LEVELS: usize = 6;
/// Classes of hops of a whole walk: 0 to 10, and more.
pub(crate) const WALK_HOPS: usize = 12;
/// Number of marking words; a test compares it with the list.
pub(crate) const MARKS: usize = 90;

// Each comment lists the dimensions in their order. "Kind" is the kind of the step, "last" whether it is the last of its text, and
// "hops" the number of hops of the stretch.
feature_tables! {
    // The stretch itself: how long, how it bends, how it climbs.

    // Kind, last, hops.
    HOPS coarse KINDS * 2 * HOPS_CLASSES;
    // For steps that stop: last, whether it turns, hops.
    STOPS coarse 2 * 2 * HOPS_CLASSES;
    // For conditions: last, hops.
    CONDITION coarse 2 * HOPS_CLASSES;
    // Kind, angle of the turn before the first hop.
    FIRST_TURN coarse KINDS * ANGLES;
    // Kind, angle of all turns together.
    WHOLE_TURN coarse KINDS * ANGLES;
    // Kind, angle of the widest turn.
    WIDEST_TURN coarse KINDS * ANGLES;
    // Kind, angle of all turns of a stretch that begins the walk.
    OPENING_TURN coarse KINDS * ANGLES;
    // Kind, angle of these turns without the first.
    TURN_AFTER_OPENING coarse KINDS * ANGLES;
    // Kind, number of clear turns after the first hop.
    LATER_TURNS coarse KINDS * 3;
    // 0 if a climb is described, rise.
    RISE coarse 2 * 11;
    // Kind, length.
    LENGTH coarse KINDS * 8;
    // Kind, whether the text has "the end of", whether a way goes straight on.
    ONWARD coarse KINDS * 2 * 2;
    // Number of steps of the text, kind, last, hops.
    HOPS_OF_STEPS fine 3 * KINDS * 2 * HOPS_CLASSES;
    // Kind, kind of the next step, hops.
    NEXT_STEP fine KINDS * KINDS * 5;
    // Kind, last, number of places that the step names, hops.
    HOPS_OF_MENTIONS fine KINDS * 2 * 4 * 5;
    // Kind of the turn in the step before, whether the walk begins here, angle of the first turn.
    TURN_BEFORE coarse 3 * 2 * ANGLES;
    // Relation to doors, last, whether there are two hops, whether the first and the last hop change rooms.
    CROSSING_ENDS fine 4 * 2 * 2 * 2 * 2;
    // Kind, number of hops that left out a straighter way.
    STRAIGHTER coarse KINDS * 3;
    // Kind, number of ways nearer to a right angle at the first hop.
    SQUARER coarse KINDS * 3;
    // Kind, number of passed ways to the side of the next turn, whether such a way is at the end (2: no hop).
    SKIPPED coarse KINDS * 3 * 3;
    // Storey in the text, storey at the end, highest storey.
    LEVEL coarse LEVELS * 4 * 3;
    // Storey in the text, rise since the start of the walk.
    LEVEL_RISE coarse LEVELS * 7;

    // Doors, stairs, rooms that it passes.

    // Relation to doors, number of changes of room.
    CROSSINGS coarse 4 * 4;
    // Kind, whether the stretch ends in the room where it begins.
    SAME_ROOM coarse KINDS * 2;
    // Relation to doors, last, number of neighbours of the end in other rooms.
    BORDER coarse 4 * 2 * 3;
    // Part of the stairs, whether a climb is described, begin or end, ways up and down there.
    STAIRS_AT coarse 3 * 2 * 2 * 4;
    // Group of the relation, angle of the bend towards the side in the text.
    SIDE_OF_TURN coarse 4 * 12;

    // The places that it names.

    // Relation, commonness, begin or nearest or end, class of distance.
    THING fine RELATIONS * 3 * 3 * CLASSES;
    // Relation, class of distance at the end of the last step.
    THING_AT_END fine RELATIONS * CLASSES;
    // Relation, begin or nearest or end, class of distance.
    ROOM fine RELATIONS * 3 * CLASSES;
    // Relation, class of distance at the end of the last step.
    ROOM_AT_END fine RELATIONS * CLASSES;
    // Relation, whether the stretch begins in the room (2) and ends in it (1).
    ROOM_MOVE fine RELATIONS * 4;
    // Group of the relation, begin or nearest or end, class of distance.
    GROUP_THING coarse GROUPS * 3 * CLASSES;
    // The same for rooms.
    GROUP_ROOM coarse GROUPS * 3 * CLASSES;
    // Whether the place of the turn is a room, class of distance at the begin.
    TURN_AT coarse 2 * CLASSES;
    // Relation, room or thing, angle between the stretch and the place.
    TOWARDS fine RELATIONS * 2 * 4;
    // Angle of the place towards the side in the text.
    SIDE_OF_PLACE coarse 12;
    // Relation, room or thing, distance, angle from straight ahead at the end.
    AHEAD fine RELATIONS * 2 * 3 * 4;
    // Group of the relation, room or thing, last, whether the place was nearer before (2) and can come nearer (1).
    NEAREST fine GROUPS * 2 * 2 * 4;

    // The marking words of the step.

    // Word, hops.
    MARK_HOPS fine MARKS * 5;
    // Word, angle of the bend.
    MARK_TURN fine MARKS * 4;
    // Word, number of changes of room.
    MARK_CROSSINGS fine MARKS * 3;

    // The walk that ends.

    // Whether the text only names a goal, group of the relation, class of distance at the end of the walk.
    LAST_ROOM coarse 2 * GROUPS * CLASSES;
    // The same for things.
    LAST_THING coarse 2 * GROUPS * CLASSES;
    // Whether the text only names a goal, least class of distance on the walk.
    NAMED_ROOM coarse 2 * CLASSES;
    // The same for things, with the commonness before the distance.
    NAMED_THING coarse 2 * 3 * CLASSES;
    // Whether the text only names a goal, number of rooms that it does not name.
    UNNAMED_PASSED coarse 2 * 5;
    // Whether the text only names a goal, whether it names the room of the end, commonness of that room.
    UNNAMED_END coarse 2 * 2 * 3;
    // Number of turns in the text, number of clear turns of the walk.
    TURNS_TOLD coarse 7 * 7;

    // The walk of a text without any step.

    // Hops of the walk.
    UNTOLD_HOPS coarse WALK_HOPS;
    // Length of the walk.
    UNTOLD_LENGTH coarse 8;
}

/// The group of a relation: leaving, coming to, being at, passing, describing, and no preposition.
pub(crate) fn relation_group(relation: StepRelation) -> usize {
    match relation {
        StepRelation::OutOf => 0,
        StepRelation::Into | StepRelation::To => 1,
        StepRelation::In | StepRelation::At | StepRelation::Near | StepRelation::Before => 2,
        StepRelation::Through | StepRelation::Past | StepRelation::Along | StepRelation::Between => 3,
        StepRelation::With | StepRelation::Of => 4,
        StepRelation::Plain => 5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_marking_word_has_a_place() {
        assert_eq!(wayword_language::reading::steps::MARKING.len(), MARKS);
    }

    #[test]
    fn tables_follow_one_another() {
        let mut from = 0;
        for table in ALL {
            assert_eq!(table.from, from, "{}", table.name);
            from += table.size;
        }
        assert_eq!(from, COUNT);
    }
}
