//! Checks whether the units of a pose file are plausible: of its positions by the speed of the walk, and of a yaw by its direction.

use super::rows::{PoseFacing, PoseKey, PoseRows};
use crate::axes::PoseAxes;
use wayword_core::{DVec3, Heading};

/// Nobody walks, drives or flies a camera faster than this, metres per second.
const MAX_SPEED_M_PER_S: f64 = 40.0;
/// Pictures without times are nearer to each other than this, metres.
const MAX_PICTURE_STEP_M: f64 = 20.0;
/// Speeds and steps that people and robots have, metres per second and metres.
const USUAL_SPEEDS_M_PER_S: std::ops::RangeInclusive<f64> = 0.1..=10.0;
const USUAL_STEPS_M: std::ops::RangeInclusive<f64> = 0.01..=5.0;
/// Fewer steps are not judged.
const LEAST_STEPS: usize = 4;
/// A yaw in radians is rarely larger than this.
const LARGE_YAW_RAD: f64 = 6.5;
/// How much a yaw has to point along the path to be right, as a mean cosine, and how much more than in another unit.
const YAW_FITS: f64 = 0.8;
const YAW_FITS_BETTER: f64 = 0.04;

/// The doubt that positions are in metres; `None` if they may be. `may_be_unreal`: whether the user has not named the world.
pub(super) fn find_unit_doubt(rows: &PoseRows, may_be_unreal: bool) -> Option<String> {
    let (steps, is_timed) = step_sizes(rows);
    let middle = steps.get(steps.len() / 2).filter(|_| steps.len() >= LEAST_STEPS)?;
    let (most, usual) =
        if is_timed { (MAX_SPEED_M_PER_S, USUAL_SPEEDS_M_PER_S) } else { (MAX_PICTURE_STEP_M, USUAL_STEPS_M) };
    if *middle <= most {
        return None;
    }
    let fits = |per_unit: f64| usual.contains(&(middle * per_unit));
    let mut choices = Vec::new();
    // A robot's world and Unreal Engine's look alike but for the unit, and for left and right.
    if fits(0.01) && may_be_unreal {
        choices.push("world = \"unreal\" if they are Unreal Engine's (left-handed, centimetres)".to_owned());
    }
    let units = [("cm", 0.01), ("mm", 0.001)].into_iter().filter(|(_, per_unit)| fits(*per_unit));
    choices.extend(units.map(|(name, _)| format!("unit = \"{name}\"")));
    choices.push("unit = \"m\" if they are right as they are".to_owned());
    let what = if is_timed { "the camera moves at" } else { "from one picture to the next the camera moves" };
    let per = if is_timed { "m/s" } else { "m" };
    Some(format!(
        "read in metres, {what} {middle:.0} {per}. Write into a recording.toml beside it {}",
        choices.join(", or ")
    ))
}

/// The speeds between rows with times, metres per second, or the steps between rows of pictures, metres; sorted. And whether these
/// are speeds.
fn step_sizes(rows: &PoseRows) -> (Vec<f64>, bool) {
    let time_s = |key: &PoseKey| match key {
        PoseKey::Time(time_s) => Some(*time_s),
        PoseKey::Picture(_) | PoseKey::Number(_) => None,
    };
    let is_timed = rows.rows.first().is_some_and(|row| time_s(&row.key).is_some());
    let steps = rows.rows.array_windows().filter_map(|[before, after]| {
        let length = before.position.distance(after.position);
        let step = match (time_s(&before.key), time_s(&after.key)) {
            (Some(from_s), Some(to_s)) => length / (to_s - from_s),
            _ => length,
        };
        (step.is_finite() && step > 0.0).then_some(step)
    });
    let mut steps: Vec<f64> = steps.collect();
    steps.sort_by(f64::total_cmp);
    (steps, is_timed)
}

/// The doubt that a yaw without a unit is in radians; `None` if it may be.
pub(super) fn find_angle_doubt(rows: &PoseRows, axes: PoseAxes) -> Option<String> {
    let yaws = rows.rows.iter().filter_map(|row| match row.facing {
        PoseFacing::Yaw(yaw) => Some((axes.wayword_from_recorded(row.position), yaw)),
        _ => None,
    });
    let yaws: Vec<(DVec3, f64)> = yaws.collect();
    let largest = yaws.iter().map(|(_, yaw)| yaw.abs()).fold(0.0, f64::max);
    let along = |rad_per_unit: f64| {
        let (mut looked_m, mut walked_m) = (0.0, 0.0);
        for [(from, yaw), (to, _)] in yaws.array_windows() {
            let (Some(looking), Some(walking)) =
                (axes.heading_by_yaw(yaw * rad_per_unit), Heading::towards(*from, *to))
            else {
                continue;
            };
            let step_m = from.distance(*to);
            looked_m += step_m * libm::cos(looking.turn_to(walking));
            walked_m += step_m;
        }
        looked_m / f64::max(walked_m, f64::MIN_POSITIVE)
    };
    let in_degrees = along(1_f64.to_radians());
    let is_in_degrees = largest > LARGE_YAW_RAD && in_degrees >= YAW_FITS && in_degrees > along(1.0) + YAW_FITS_BETTER;
    is_in_degrees.then(|| {
        "read in degrees, the yaw points along the path, and in radians it does not. Write angle_unit = \
         \"deg\" into a recording.toml beside it, or angle_unit = \"rad\" if the yaw is right as it is"
            .to_owned()
    })
}
