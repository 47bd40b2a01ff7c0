//! The tables of features. Each table has a consecutive range of feature numbers, one for each combination of its
//! dimensions.

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
    /// A feature of the table, by its places in each dimension and the sizes of the dimensions.
    pub(crate) fn feature_at<const N: usize>(&self, places: [(usize, usize); N]) -> u32 {
        let place = places.iter().fold(0, |place, (at, size)| {
            debug_assert!(at < size, "{} in {}", at, self.name);
            place * size + at
        });
        debug_assert!(place < self.size, "{place} in {}", self.name);
        (self.from + place) as u32
    }
}

macro_rules! tables {
    ($($name:ident $kind:ident $size:expr;)*) => {
        tables!(@ 0; $($name $kind $size;)*);
        /// All tables, in the order of their numbers.
        pub(crate) const ALL: &[FeatureTable] = &[$($name),*];
    };
    (@ $from:expr; $name:ident $kind:ident $size:expr; $($rest:tt)*) => {
        pub(crate) const $name: FeatureTable =
            FeatureTable { name: stringify!($name), from: $from, size: $size, is_fine: tables!(= $kind) };
        tables!(@ $from + $size; $($rest)*);
    };
    (@ $from:expr;) => {
        /// Number of features.
        pub(crate) const COUNT: usize = $from;
    };
    (= fine) => { true };
    (= coarse) => { false };
}

const KINDS: usize = GuideStepKind::COUNT;
/// Number of relations.
pub(crate) const RELATIONS: usize = StepRelation::ALL.len();
/// Number of groups of relations.
pub(crate) const GROUPS: usize = 6;
/// Classes of hops: 0 to 6, and more.
pub(crate) const HOPS_CLASSES: usize = 8;
/// Classes of angles.
pub(crate) const ANGLES: usize = 24;
/// Classes of storeys that a text can give: 1, 2, 3, any above or the top one, upstairs, downstairs.
pub(crate) const LEVELS: usize = 6;
/// Classes of hops of a whole walk.
pub(crate) const WALK_HOPS: usize = 12;
/// Number of marking words; a test compares it with the list.
pub(crate) const MARKS: usize = 90;

tables! {
    // The stretch itself: how long, how it bends, how it climbs.
    HOPS coarse KINDS * 2 * HOPS_CLASSES;
    STOPS coarse 2 * 2 * HOPS_CLASSES;
    CONDITION coarse 2 * HOPS_CLASSES;
    FIRST_TURN coarse KINDS * ANGLES;
    WHOLE_TURN coarse KINDS * ANGLES;
    WIDEST_TURN coarse KINDS * ANGLES;
    OPENING_TURN coarse KINDS * ANGLES;
    TURN_AFTER_OPENING coarse KINDS * ANGLES;
    LATER_TURNS coarse KINDS * 3;
    RISE coarse 2 * 11;
    LENGTH coarse KINDS * 8;
    ONWARD coarse KINDS * 2 * 2;
    HOPS_OF_STEPS fine 3 * KINDS * 2 * HOPS_CLASSES;
    NEXT_STEP fine KINDS * KINDS * 5;
    HOPS_OF_MENTIONS fine KINDS * 2 * 4 * 5;
    TURN_BEFORE coarse 3 * 2 * ANGLES;
    CROSSING_ENDS fine 4 * 2 * 2 * 2 * 2;
    STRAIGHTER coarse KINDS * 3;
    SQUARER coarse KINDS * 3;
    SKIPPED coarse KINDS * 3 * 3;
    LEVEL coarse LEVELS * 4 * 3;
    LEVEL_RISE coarse LEVELS * 7;
    // Doors, stairs, rooms that it passes.
    CROSSINGS coarse 4 * 4;
    SAME_ROOM coarse KINDS * 2;
    BORDER coarse 4 * 2 * 3;
    STAIRS_AT coarse 3 * 2 * 2 * 4;
    SIDE_OF_TURN coarse 4 * 12;
    // The places that it names.
    THING fine RELATIONS * 3 * 3 * CLASSES;
    THING_AT_END fine RELATIONS * CLASSES;
    ROOM fine RELATIONS * 3 * CLASSES;
    ROOM_AT_END fine RELATIONS * CLASSES;
    ROOM_MOVE fine RELATIONS * 4;
    GROUP_THING coarse GROUPS * 3 * CLASSES;
    GROUP_ROOM coarse GROUPS * 3 * CLASSES;
    TURN_AT coarse 2 * CLASSES;
    TOWARDS fine RELATIONS * 2 * 4;
    SIDE_OF_PLACE coarse 12;
    AHEAD fine RELATIONS * 2 * 3 * 4;
    NEAREST fine GROUPS * 2 * 2 * 4;
    // Its words.
    MARK_HOPS fine MARKS * 5;
    MARK_TURN fine MARKS * 4;
    MARK_CROSSINGS fine MARKS * 3;
    // The walk that ends.
    LAST_ROOM coarse 2 * GROUPS * CLASSES;
    LAST_THING coarse 2 * GROUPS * CLASSES;
    NAMED_ROOM coarse 2 * CLASSES;
    NAMED_THING coarse 2 * 3 * CLASSES;
    UNNAMED_PASSED coarse 2 * 5;
    UNNAMED_END coarse 2 * 2 * 3;
    TURNS_TOLD coarse 7 * 7;
    // The walk of a text without any step.
    UNTOLD_HOPS coarse WALK_HOPS;
    UNTOLD_LENGTH coarse 8;
}

/// The group of a relation.
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
