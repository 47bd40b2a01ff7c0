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

/// The angles of a file's rows that give a direction, with their places.
struct RecordedAngles {
    axes: PoseAxes,
    places: Vec<(DVec3, PoseFacing)>,
    /// The largest of them, in the file's unit if that has no name, else in radians.
    largest: f64,
}

impl RecordedAngles {
    fn from_rows(rows: &PoseRows, axes: PoseAxes) -> Self {
        let (mut places, mut largest) = (Vec::new(), 0_f64);
        for row in &rows.rows {
            if let PoseFacing::Yaw(angle) | PoseFacing::Heading(angle) = row.facing {
                places.push((axes.wayword_from_recorded(row.position), row.facing));
                largest = largest.max(angle.abs());
            }
        }
        Self { axes, places, largest }
    }

    /// How much they point along the path if they are multiplied by a factor, as a mean cosine.
    fn along_path(&self, factor: f64) -> f64 {
        let heading = |facing: &PoseFacing| match facing {
            PoseFacing::Yaw(yaw) => self.axes.heading_by_yaw(yaw * factor),
            PoseFacing::Heading(rad) => Heading::new(rad * factor + self.axes.mount_rad).ok(),
            PoseFacing::Unknown | PoseFacing::Quaternion(_) | PoseFacing::Columns(_) => None,
        };
        let (mut looked_m, mut walked_m) = (0.0, 0.0);
        for [(from, facing), (to, _)] in self.places.array_windows() {
            let (Some(looking), Some(walking)) = (heading(facing), Heading::towards(*from, *to)) else { continue };
            let step_m = from.distance(*to);
            looked_m += step_m * libm::cos(looking.turn_to(walking));
            walked_m += step_m;
        }
        looked_m / f64::max(walked_m, f64::MIN_POSITIVE)
    }

    /// Whether they point along the path if they are multiplied by a factor, and less as they are.
    fn fit_better(&self, factor: f64) -> bool {
        let fits = self.along_path(factor);
        fits >= YAW_FITS && fits > self.along_path(1.0) + YAW_FITS_BETTER
    }
}

/// The doubt that angles are in the unit that their column names; `None` if they may be.
pub(super) fn find_named_angle_doubt(rows: &PoseRows, axes: PoseAxes, name: &str) -> Option<String> {
    let angles = RecordedAngles::from_rows(rows, axes);
    let stem = name.rsplit_once('_').map_or(name, |(stem, _)| stem);
    let rad_per_deg = 1_f64.to_radians();
    let ask = |found: f64, other: &str, unit: &str, setting: &str| {
        format!(
            "{name} goes to {}, and in {other} it points along the path: name it {stem}_{unit}, or write angle_unit = \
             \"{setting}\" into a recording.toml beside it if it is right as it is",
            (found * 1000.0).round() / 1000.0
        )
    };
    if name.ends_with("_rad") {
        let is_in_degrees = angles.largest > LARGE_YAW_RAD && angles.fit_better(rad_per_deg);
        return is_in_degrees.then(|| ask(angles.largest, "degrees", "deg", "rad"));
    }
    let largest_deg = angles.largest.to_degrees();
    let is_in_radians = largest_deg <= LARGE_YAW_RAD && angles.fit_better(1.0 / rad_per_deg);
    is_in_radians.then(|| ask(largest_deg, "radians", "rad", "deg"))
}

/// The doubt that a yaw without a unit is in radians; `None` if it may be.
pub(super) fn find_angle_doubt(rows: &PoseRows, axes: PoseAxes) -> Option<String> {
    let yaws = RecordedAngles::from_rows(rows, axes);
    let is_in_degrees = yaws.largest > LARGE_YAW_RAD && yaws.fit_better(1_f64.to_radians());
    is_in_degrees.then(|| {
        "read in degrees, the yaw points along the path, and in radians it does not. Write angle_unit = \
         \"deg\" into a recording.toml beside it, or angle_unit = \"rad\" if the yaw is right as it is"
            .to_owned()
    })
}

#[cfg(test)]
mod tests {
    use crate::{describe::RecordingDescription, poses::read_track};

    /// The error about a file `poses.csv` or `poses.json`, if it is refused.
    fn refusal(name: &str, text: &str, settings: &str) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        let toml = folder.path().join("recording.toml");
        std::fs::write(&toml, settings).unwrap();
        let times_s: Vec<f64> = (0..60).map(f64::from).collect();
        let described = RecordingDescription::read(&toml).unwrap();
        read_track(&file, &described, &times_s, &|at| format!("{at}.png")).err().map(|error| error.to_string())
    }

    /// A walk along an arc; `angle` makes the angle of its poses of the direction of the walk, radians counter-clockwise from +x.
    fn arc(column: &str, angle: &dyn Fn(f64) -> f64) -> String {
        let mut text = format!("time_s,x,y,z,{column}\n");
        let (mut x, mut y) = (0.0, 0.0);
        for at in 0..60 {
            let direction = 1.6 + 0.1 * f64::from(at);
            text += &format!("{at},{x},{y},1.5,{}\n", angle(direction));
            x += 0.5 * libm::cos(direction);
            y += 0.5 * libm::sin(direction);
        }
        text
    }

    #[test]
    fn angles_in_another_unit_than_their_column_names_are_asked_about() {
        let heading = |direction: f64| std::f64::consts::FRAC_PI_2 - direction;
        for (column, angle, told) in [
            ("yaw_rad", &f64::to_degrees as &dyn Fn(f64) -> f64, "yaw_rad goes to 429.7"),
            ("heading_rad", &|direction| heading(direction).to_degrees(), "name it heading_deg"),
            (
                "yaw_deg",
                &|direction| direction % std::f64::consts::TAU,
                "in radians it points along the path: name it yaw_rad",
            ),
            ("heading_deg", &heading, "name it heading_rad"),
        ] {
            let error = refusal("poses.csv", &arc(column, angle), "").unwrap_or_default();
            assert!(error.contains(told), "{column}: {error}");
            let unit = column.rsplit_once('_').unwrap().1;
            let asked = format!("angle_unit = \"{unit}\"");
            assert!(error.contains(&asked), "{error}");
            assert_eq!(refusal("poses.csv", &arc(column, angle), &asked), None, "{column}");
        }
        for (column, angle) in [
            ("yaw_rad", &(|direction| direction) as &dyn Fn(f64) -> f64),
            ("yaw_deg", &f64::to_degrees),
            ("heading_rad", &heading),
            ("heading_deg", &|direction| heading(direction).to_degrees()),
            // A camera that does not look along the path, whatever the unit.
            ("yaw_rad", &|direction| 37.0 * direction),
        ] {
            assert_eq!(refusal("poses.csv", &arc(column, angle), ""), None, "{column}");
        }
        let other = refusal("poses.csv", &arc("yaw_rad", &|direction| direction), "angle_unit = \"deg\"").unwrap();
        assert!(other.contains("yaw_rad names its unit itself"), "{other}");
    }

    #[test]
    fn times_in_another_unit_are_asked_about() {
        let timed = |column: &str, per_s: f64| {
            let rows = (0..60).map(|at| format!("{},{},0,1.5\n", f64::from(at) * per_s, f64::from(at) * 0.5));
            format!("{column},x,y,z\n{}", rows.collect::<String>())
        };
        for (column, per_s, told) in [
            (
                "time_s",
                1e3,
                "59 of 60 pictures have no pose: the poses go from 0 to 59000 s, and the pictures from 0 to 59 s",
            ),
            ("time_s", 1e3, "are the times milliseconds? then name the column time_ms"),
            ("time", 1e6, "microseconds? then name the column time_us"),
            ("timestamp", 1e9, "nanoseconds? then name the column time_ns"),
            ("time_ms", 1.0, "are the times seconds? then name the column time_s"),
        ] {
            let error = refusal("poses.csv", &timed(column, per_s), "").unwrap_or_default();
            assert!(error.contains(told), "{column}: {error}");
        }
        assert_eq!(refusal("poses.csv", &timed("time_s", 1.0), ""), None);
        assert_eq!(refusal("poses.csv", &timed("time_ms", 1e3), ""), None);
        // Poses of a whole day, of which the pictures are a part.
        let day = (0..2000).map(|at| format!("{at},{},0,1.5\n", f64::from(at) * 0.5)).collect::<String>();
        assert_eq!(refusal("poses.csv", &format!("time_s,x,y,z\n{day}"), ""), None);
    }

    #[test]
    fn numbers_with_a_decimal_comma_are_read_between_semicolons() {
        let rows = |separator: &str, comma: &str| {
            let row =
                |at: usize| format!("walk,{at}.png{separator}{}{comma}5{separator}0{separator}1{comma}5\n", at / 2);
            format!("image{separator}x{separator}y{separator}z\n{}", (0..10).map(row).collect::<String>())
        };
        let read = |text: &str| {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join("poses.csv");
            std::fs::write(&file, text).unwrap();
            let times_s: Vec<f64> = (0..10).map(f64::from).collect();
            read_track(&file, &RecordingDescription::default(), &times_s, &|at| format!("walk,{at}.png"))
                .map_err(|error| error.to_string())
        };
        let by_comma = read(&rows(";", ",")).unwrap();
        assert_eq!(by_comma, read(&rows(";", ".")).unwrap());
        assert_eq!(by_comma.fix_at(4.0).unwrap().position.x, 2.5);
        assert!(read(&rows(";", ",,")).unwrap_err().contains("is not a number"));
    }

    #[test]
    fn poses_of_pictures_that_are_not_here_are_named() {
        let none = (0..10).map(|at| format!("frame_{at}.jpg,{at},0,1.5\n")).collect::<String>();
        let error = refusal("poses.csv", &format!("image,x,y,z\n{none}"), "").unwrap();
        assert!(error.contains("10 of 10 poses are of pictures that are not here"), "{error}");
        assert!(error.contains("line 2 names \"frame_0.jpg\", and the first picture here is \"0.png\""), "{error}");
    }
}
