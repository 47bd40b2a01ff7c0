//! How much floor for people a scene has if one of its directions is up: level ground with room above, connected, and things that
//! stand on it rather than hang over it.

use super::columns::{ColumnGap, FreeColumns};

/// Least room above a floor, metres: Habitat's agent.
const MIN_ROOM_M: f64 = 1.5;
/// Greatest step between two neighbouring columns of a floor, metres.
const MAX_STEP_M: f64 = 0.3;
/// Distance from a main level to the top of a thing that stands on it, or to the bottom of one that hangs from it, metres.
const THING_M: std::ops::RangeInclusive<f64> = 0.3..=1.5;
/// Heights are counted in bins of this size, metres.
const BIN_M: f64 = 0.1;
/// Least share of the fullest bin for a bin to be a main level.
const MAIN_LEVEL_SHARE: f64 = 0.25;

/// The floor in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FloorSurvey {
    /// Area of the largest connected floor, square metres.
    pub(super) floor_m2: f64,
    /// The same area, less where the room above is unusual for people.
    pub(super) worth_m2: f64,
    /// Area of the things that stand on a floor.
    pub(super) standing_m2: f64,
    /// Area of the things that hang from a ceiling.
    pub(super) hanging_m2: f64,
}

impl FloorSurvey {
    pub(super) fn from_columns(columns: &FreeColumns) -> Self {
        let cell_m2 = columns.cell_area;
        let (floor, worth) = largest_island(columns, room_weight);
        let (standing, hanging) = count_things(columns);
        Self {
            floor_m2: floor as f64 * cell_m2,
            worth_m2: worth * cell_m2,
            standing_m2: standing as f64 * cell_m2,
            hanging_m2: hanging as f64 * cell_m2,
        }
    }
}

/// How likely people walk on ground with this room above, in metres; 0 to 1. `None` is the open sky.
pub(super) fn room_weight(room_m: Option<f64>) -> f64 {
    match room_m {
        None => 0.7,
        Some(room_m) if room_m < MIN_ROOM_M => 0.0,
        Some(room_m) if room_m < 2.0 => 0.5,
        Some(room_m) if room_m <= 3.3 => 1.0,
        Some(room_m) if room_m <= 5.0 => 0.8,
        Some(_) => 0.7,
    }
}

/// The height and the weight of the floor in a free space; `None` if it has no floor.
fn floor_of(gap: &ColumnGap, gaps: &[ColumnGap], room_weight: impl Fn(Option<f64>) -> f64) -> Option<(f64, f64)> {
    let floor = gap.below.filter(|below| below.is_level)?;
    // Ground under the sky with a room below it is a roof.
    let is_room = |other: &ColumnGap| other.height().is_some_and(|room_m| room_m >= MIN_ROOM_M);
    let is_roof = gap.above.is_none() && gaps.iter().any(is_room);
    let weight = if is_roof { 0.0 } else { room_weight(gap.height()) };
    (weight > 0.0).then_some((floor.height, weight))
}

/// The number of columns of the largest connected floor, and their sum of weights, by the room above them.
pub(super) fn largest_island(columns: &FreeColumns, room_weight: impl Fn(Option<f64>) -> f64) -> (usize, f64) {
    // The floors of each column, numbered through.
    let mut floors = Vec::new();
    let mut starts = vec![0];
    for gaps in &columns.gaps {
        floors.extend(gaps.iter().filter_map(|gap| floor_of(gap, gaps, &room_weight)));
        starts.push(floors.len());
    }
    let mut parents: Vec<usize> = (0..floors.len()).collect();
    let [wide, deep] = columns.size;
    for here in 0..wide * deep {
        let beside = [(here % wide + 1 < wide).then_some(here + 1), (here + wide < wide * deep).then_some(here + wide)];
        for there in beside.into_iter().flatten() {
            for a in starts[here]..starts[here + 1] {
                let joined =
                    (starts[there]..starts[there + 1]).filter(|b| (floors[a].0 - floors[*b].0).abs() <= MAX_STEP_M);
                for b in joined {
                    let (a, b) = (root_of(&mut parents, a), root_of(&mut parents, b));
                    parents[a.max(b)] = a.min(b);
                }
            }
        }
    }
    let mut islands = vec![(0, 0.0); floors.len()];
    for (number, (_, weight)) in floors.iter().enumerate() {
        let island = &mut islands[root_of(&mut parents, number)];
        *island = (island.0 + 1, island.1 + weight);
    }
    islands.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
}

/// The island that a floor belongs to; the way to it becomes shorter.
fn root_of(parents: &mut [usize], mut number: usize) -> usize {
    while parents[number] != number {
        parents[number] = parents[parents[number]];
        number = parents[number];
    }
    number
}

/// The number of columns in which a thing stands on a main floor, and in which one hangs from a main ceiling.
fn count_things(columns: &FreeColumns) -> (usize, usize) {
    let roomy = || columns.gaps.iter().flatten().filter(|gap| room_weight(gap.height()) > 0.0);
    let floors = main_levels(roomy().filter_map(|gap| gap.below).map(|end| end.height));
    let ceilings = main_levels(roomy().filter_map(|gap| gap.above).map(|end| end.height));
    let is_main = |levels: &[f64], height: f64| levels.iter().any(|level| (level - height).abs() <= 1.5 * BIN_M);
    let is_standing = |gap: &&ColumnGap| {
        let over = |below: f64| floors.iter().any(|floor| THING_M.contains(&(below - floor)));
        gap.below.is_some_and(|below| !is_main(&floors, below.height) && over(below.height))
            && gap.above.is_none_or(|above| is_main(&ceilings, above.height))
    };
    let is_hanging = |gap: &&ColumnGap| {
        let under = |above: f64| ceilings.iter().any(|ceiling| THING_M.contains(&(ceiling - above)));
        gap.above.is_some_and(|above| !is_main(&ceilings, above.height) && under(above.height))
            && gap.below.is_none_or(|below| is_main(&floors, below.height))
    };
    let all = || columns.gaps.iter().flatten();
    (all().filter(is_standing).count(), all().filter(is_hanging).count())
}

/// The heights at which many surfaces lie.
fn main_levels(heights: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut bins: std::collections::BTreeMap<i64, usize> = std::collections::BTreeMap::new();
    for height in heights {
        // The cast saturates.
        *bins.entry((height / BIN_M).round() as i64).or_default() += 1;
    }
    let fullest = bins.values().copied().max().unwrap_or_default() as f64;
    let main = bins.iter().filter(|(_, count)| **count as f64 >= MAIN_LEVEL_SHARE * fullest);
    main.map(|(bin, _)| *bin as f64 * BIN_M).collect()
}
