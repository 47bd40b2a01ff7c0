//! Judges which direction of a scene is up, by the floors in all six.

use super::floors::FloorSurvey;

/// A direction whose line has at least this part of the most floor may be up.
const LIKELY_SHARE: f64 = 1.0 / 1.5;
/// The same for a direction in which things stand on the floor.
const LIKELY_WITH_THINGS_SHARE: f64 = 1.0 / 2.5;
/// How many times the things that hang must be outnumbered by those that stand, to say which end of a line is up.
const CLEARLY_STANDING: f64 = 3.0;
/// Least area of the things that stand, square metres and as a share of the floor.
const MIN_STANDING_M2: f64 = 1.0;
const MIN_STANDING_SHARE: f64 = 0.005;
/// How much more floor one end of a line must have than the other to be up without a thing on it.
const CLEARLY_MORE_FLOOR: f64 = 3.0;
/// So much more floor at the other end speaks against the things that stand.
const CONTRARY_FLOOR: f64 = 1.5;
/// Floors below this say nothing, square metres.
const MIN_FLOOR_M2: f64 = 2.0;

/// One of six directions: an axis (0 is x), and whether it points along or against it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AxisDirection {
    pub(super) axis: usize,
    pub(super) is_negative: bool,
}

/// The direction in which scenes are read: z.
pub(super) const AS_READ: AxisDirection = AxisDirection { axis: 2, is_negative: false };

/// The floors of a scene in all six directions: for each axis along it, and against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SixFloors(pub(super) [[FloorSurvey; 2]; 3]);

/// Which direction is up.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum UpVerdict {
    /// The direction in which the scene is read, or nothing can be told.
    AsRead,
    /// Clearly another one.
    Other(AxisDirection),
    /// Another one, but which of them cannot be told.
    Doubtful,
}

impl SixFloors {
    pub(super) fn at(&self, direction: AxisDirection) -> FloorSurvey {
        self.0[direction.axis][usize::from(direction.is_negative)]
    }

    /// All directions, the one with the most floor first.
    pub(super) fn by_worth(&self) -> Vec<(AxisDirection, FloorSurvey)> {
        let directions = (0..3).flat_map(|axis| [false, true].map(|is_negative| AxisDirection { axis, is_negative }));
        let mut all: Vec<_> = directions.map(|direction| (direction, self.at(direction))).collect();
        all.sort_by(|a, b| b.1.worth_m2.total_cmp(&a.1.worth_m2));
        all
    }

    /// Judges which direction is up.
    pub(super) fn judge_up(&self) -> UpVerdict {
        let candidates = self.candidates();
        match candidates[..] {
            [] => UpVerdict::AsRead,
            _ if candidates.contains(&AS_READ) => UpVerdict::AsRead,
            [only] => UpVerdict::Other(only),
            _ => UpVerdict::Doubtful,
        }
    }

    /// Whether the direction as read has no floor to speak of, and another has much.
    pub(super) fn cannot_be_as_read(&self) -> bool {
        /// Least floor of the other direction, square metres.
        const MUCH_FLOOR_M2: f64 = 5.0;
        /// Greatest part of it that counts as no floor.
        const NO_FLOOR_SHARE: f64 = 0.05;
        let best = self.by_worth().first().map(|(_, floor)| *floor).unwrap_or_default();
        best.floor_m2 >= MUCH_FLOOR_M2 && self.at(AS_READ).worth_m2 <= NO_FLOOR_SHARE * best.worth_m2
    }

    /// The directions that may be up. If things stand on the floor in some of them, only those.
    fn candidates(&self) -> Vec<AxisDirection> {
        let lines = self.0.map(|[along, against]| along.worth_m2.max(against.worth_m2));
        let most = lines.iter().copied().fold(0.0, f64::max);
        if self.0.iter().flatten().all(|floor| floor.floor_m2 < MIN_FLOOR_M2) {
            return Vec::new();
        }
        let mut candidates: Vec<(AxisDirection, bool)> = Vec::new();
        for (axis, worth_m2) in lines.into_iter().enumerate() {
            for is_negative in self.likely_ends(axis) {
                let direction = AxisDirection { axis, is_negative };
                let has_things = has_standing_things(&self.at(direction));
                let least_share = if has_things { LIKELY_WITH_THINGS_SHARE } else { LIKELY_SHARE };
                if worth_m2 >= least_share * most {
                    candidates.push((direction, has_things));
                }
            }
        }
        let any_things = candidates.iter().any(|(_, has_things)| *has_things);
        candidates.into_iter().filter(|(_, has_things)| *has_things || !any_things).map(|(up, _)| up).collect()
    }

    /// The ends of a line that may be up: `false` is the one along the axis.
    fn likely_ends(&self, axis: usize) -> Vec<bool> {
        let [along, against] = self.0[axis];
        let ends = [(false, along, against), (true, against, along)];
        let by_things = ends
            .iter()
            .find(|(_, here, there)| has_standing_things(here) && there.worth_m2 < CONTRARY_FLOOR * here.worth_m2);
        let by_floor = || ends.iter().find(|(_, here, there)| here.worth_m2 >= CLEARLY_MORE_FLOOR * there.worth_m2);
        match by_things.or_else(by_floor) {
            Some((is_negative, ..)) => vec![*is_negative],
            None => vec![false, true],
        }
    }
}

/// Whether things clearly stand on a floor, and do not hang.
fn has_standing_things(floor: &FloorSurvey) -> bool {
    floor.standing_m2 >= CLEARLY_STANDING * floor.hanging_m2
        && floor.standing_m2 >= MIN_STANDING_M2.max(MIN_STANDING_SHARE * floor.floor_m2)
}
