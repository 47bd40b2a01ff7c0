//! Finds out whether a yaw without a unit is in radians or in degrees: a robot mostly moves where it looks.

use crate::pose_reading::AngleUnit;
use wayword_core::DVec3;

/// A yaw beyond this is more than a full turn in radians. Robots that add up their turns get there, and degrees do.
const FULL_TURN_RAD: f64 = std::f64::consts::TAU + 0.1;
/// Least length of a step, metres: shorter ones are noise.
const MIN_STEP_M: f64 = 0.1;
/// Fewest steps from which a unit is judged.
const MIN_STEPS: usize = 4;
/// The path follows a yaw if the cosine between them is this (that of 10 degrees) at most steps, or its opposite: a robot may
/// drive backwards.
const FOLLOWS: f64 = 0.985;
/// It does not if the cosine is less than this (that of 16 degrees). Two corridors can fit a wrong unit nearly.
const FITS_NEARLY: f64 = 0.96;
/// Within a full turn, radians are doubted only if the path leads elsewhere, by 60 degrees (this is the cosine).
const LEADS_ELSEWHERE: f64 = 0.5;
/// The share of steps that may fit less well: those at corners.
const CORNER_SHARE: f64 = 0.2;

/// The unit of yaws, counter-clockwise from +x, by the positions at which they were recorded. The error gives the reason why it
/// cannot be known.
pub(super) fn judge_yaw_unit(poses: &[(DVec3, f64)]) -> Result<AngleUnit, String> {
    let most = poses.iter().map(|(_, yaw)| yaw.abs()).filter(|yaw| yaw.is_finite()).fold(0.0, f64::max);
    let (steps, by_rad) = follow_path(poses, AngleUnit::Radians);
    let (_, by_deg) = follow_path(poses, AngleUnit::Degrees);
    let is_large = most > FULL_TURN_RAD;
    if steps < MIN_STEPS {
        return if is_large {
            Err(describe_doubt(most, "the path is too short to show"))
        } else {
            Ok(AngleUnit::Radians)
        };
    }
    if is_large {
        return match (by_rad.abs(), by_deg.abs()) {
            (FOLLOWS.., ..FITS_NEARLY) => Ok(AngleUnit::Radians),
            (..FITS_NEARLY, FOLLOWS..) => Ok(AngleUnit::Degrees),
            _ => Err(describe_doubt(most, "the path does not show")),
        };
    }
    // Small numbers of degrees are a path that leads nearly along x.
    if by_deg >= FOLLOWS && by_rad < LEADS_ELSEWHERE {
        return Err("the path follows it only if it is in degrees".to_owned());
    }
    Ok(AngleUnit::Radians)
}

fn describe_doubt(most: f64, path: &str) -> String {
    format!("goes up to {most:.1}, which is more than a full turn in radians, and {path} whether it is in degrees")
}

/// The number of steps of the path, and how well it follows the yaws: 1 where the robot moves as it looks, and -1 backwards.
fn follow_path(poses: &[(DVec3, f64)], unit: AngleUnit) -> (usize, f64) {
    let mut poses = poses.iter().filter(|(position, yaw)| position.is_finite() && yaw.is_finite());
    let Some(mut from) = poses.next() else { return (0, 0.0) };
    let mut cosines = Vec::new();
    for to in poses {
        let step = to.0 - from.0;
        if libm::hypot(step.x, step.y) < MIN_STEP_M {
            continue;
        }
        cosines.push(libm::cos(libm::atan2(step.y, step.x) - unit.to_rad(from.1)));
        from = to;
    }
    let sign = if cosines.iter().sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    cosines.iter_mut().for_each(|cosine| *cosine *= sign);
    cosines.sort_by(f64::total_cmp);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length is an index")]
    let corners = (cosines.len() as f64 * CORNER_SHARE) as usize;
    (cosines.len(), sign * cosines.get(corners).copied().unwrap_or(0.0).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poses on a path that turns by `turn_deg` at each of 40 steps. `yaw` makes the recorded number from the true degrees.
    fn walk(first_deg: f64, turn_deg: f64, yaw: impl Fn(f64) -> f64) -> Vec<(DVec3, f64)> {
        let mut position = DVec3::ZERO;
        let pose = |at: usize| {
            let deg = first_deg + turn_deg * at as f64;
            let here = position;
            position += DVec3::new(deg.to_radians().cos(), deg.to_radians().sin(), 0.0) * 0.25;
            (here, yaw(deg))
        };
        (0..40).map(pose).collect()
    }

    #[test]
    fn the_path_tells_degrees_from_radians() {
        for (first, turn) in [(0.0, 4.0), (90.0, -6.0), (-120.0, 9.0), (45.0, 20.0)] {
            assert_eq!(judge_yaw_unit(&walk(first, turn, |deg| deg)), Ok(AngleUnit::Degrees), "{first} {turn}");
            // Turns that add up beyond a full turn, and those that do not.
            assert_eq!(judge_yaw_unit(&walk(first, turn, f64::to_radians)), Ok(AngleUnit::Radians), "{first} {turn}");
            let wrapped = |deg: f64| (deg + 180.0).rem_euclid(360.0) - 180.0;
            let in_rad = walk(first, turn, |deg| wrapped(deg).to_radians());
            assert_eq!(judge_yaw_unit(&in_rad), Ok(AngleUnit::Radians), "{first} {turn}");
            let backwards = walk(first, turn, |deg| wrapped(deg + 180.0));
            assert_eq!(judge_yaw_unit(&backwards), Ok(AngleUnit::Degrees), "{first} {turn}");
        }
    }

    /// Poses along two corridors at a right angle.
    fn corridors(yaw: impl Fn(f64) -> f64) -> Vec<(DVec3, f64)> {
        let pose = |at: u32| {
            let (x, y) = if at < 20 { (f64::from(at), 0.0) } else { (20.0, f64::from(at) - 20.0) };
            // It turns after the first step around the corner.
            (DVec3::new(x, y, 0.0) * 0.25, yaw(if at <= 20 { 0.0 } else { 90.0 }))
        };
        (0..40).map(pose).collect()
    }

    #[test]
    fn two_corridors_do_not_fit_a_wrong_unit_by_chance() {
        assert_eq!(judge_yaw_unit(&corridors(|deg| deg)), Ok(AngleUnit::Degrees));
        assert_eq!(
            judge_yaw_unit(&corridors(|deg| deg.to_radians() + std::f64::consts::TAU * 3.0)),
            Ok(AngleUnit::Radians)
        );
        // 270 and 360 radians are nearly the directions of the corridors.
        assert!(judge_yaw_unit(&corridors(|deg| deg + 270.0)).is_err());
    }

    #[test]
    fn what_the_path_does_not_show_is_asked_about() {
        // A robot that moves sideways, one that stands, and one whose few degrees could be radians.
        let sideways = judge_yaw_unit(&walk(0.0, 4.0, |deg| deg + 90.0)).unwrap_err();
        assert!(sideways.contains("goes up to 246.0"), "{sideways}");
        assert!(judge_yaw_unit(&[(DVec3::ZERO, 200.0); 30]).unwrap_err().contains("too short"));
        let little = judge_yaw_unit(&walk(2.0, 0.05, |deg| deg)).unwrap_err();
        assert!(little.contains("only if it is in degrees"), "{little}");
        // Sideways within a full turn is read as before.
        assert_eq!(judge_yaw_unit(&walk(0.0, 1.0, |deg| (deg + 90.0).to_radians())), Ok(AngleUnit::Radians));
        assert_eq!(judge_yaw_unit(&[]), Ok(AngleUnit::Radians));
    }
}
