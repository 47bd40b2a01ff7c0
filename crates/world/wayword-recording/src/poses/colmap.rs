//! Reads the cameras of a COLMAP model in text form, `images.txt`: two lines for each picture, of which the second lists points.

use super::rows::{KnownConventions, PoseFacing, PoseKey, PoseRow, PoseRows, parse_number};
use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis},
    pose_reading::{NumberReading, QuaternionOrder, TransformDirection},
};
use wayword_core::DVec3;

const EXPECTED_LINE: &str = "expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of points after it";

/// Whether a text is such a file: its writer begins with comments that say so.
pub(super) fn is_colmap_text(text: &str) -> bool {
    text.lines().take_while(|line| line.starts_with('#')).any(|line| line.contains("IMAGE_ID, QW, QX, QY, QZ"))
}

/// Reads the poses: from the world into the camera's optical frame, with w first.
pub(super) fn read_colmap(text: &str) -> Result<PoseRows, String> {
    // A line of points may be empty, so lines are only left out before the first picture.
    let lines = text.lines().enumerate().skip_while(|(_, line)| line.starts_with('#')).step_by(2);
    let rows = lines.filter(|(_, line)| !line.trim().is_empty()).map(|(at, line)| {
        let wrong = |reason: &str| format!("line {}: {reason}", at + 1);
        let mut words = line.split_whitespace();
        let numbers: Vec<f64> =
            words.by_ref().take(9).map(parse_number).collect::<Result<_, _>>().map_err(|reason| wrong(&reason))?;
        let ([_, w, x, y, z, tx, ty, tz, _], Some(name)) =
            (<[f64; 9]>::try_from(numbers).unwrap_or([f64::NAN; 9]), words.next())
        else {
            return Err(wrong(EXPECTED_LINE));
        };
        Ok(PoseRow {
            at: at + 1,
            key: PoseKey::Picture(name.to_owned()),
            position: DVec3::new(tx, ty, tz),
            facing: PoseFacing::Quaternion([w, x, y, z]),
        })
    });
    let usual = PoseAxes { world: WorldUpAxis::YDown, ..PoseAxes::for_body(PoseBody::Optical) };
    let rows = PoseRows::new(usual, KnownConventions::ALL, rows.collect::<Result<_, _>>()?);
    let usual_numbers = NumberReading { order: QuaternionOrder::Wxyz, direction: TransformDirection::WorldToCamera };
    Ok(PoseRows { usual_numbers, ..rows })
}
