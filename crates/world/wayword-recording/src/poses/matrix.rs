//! Reads poses from lines of bare numbers: TUM (`time x y z qx qy qz qw`) and KITTI (a 3 x 4 matrix per picture).

use super::rows::{PoseFacing, PoseKey, PoseRow, PoseRows, parse_number, seconds_in_unit};
use crate::axes::{PoseAxes, PoseBody, WorldUpAxis};
use wayword_core::DVec3;

/// Reads either format; the length of the first line decides between them.
pub(super) fn read_matrix(text: &str) -> Result<PoseRows, String> {
    let lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let mut rows = Vec::new();
    let mut columns = None;
    for (at, line) in lines {
        let numbers: Vec<f64> = line
            .split([' ', '\t', ','])
            .filter(|word| !word.is_empty())
            // One more than the longest valid line has, so that a longer line is noticed.
            .take(13)
            .map(parse_number)
            .collect::<Result<_, _>>()
            .map_err(|reason| format!("line {}: {reason}", at + 1))?;
        let expected = *columns.get_or_insert(numbers.len());
        let row = if numbers.len() == expected { row_from_numbers(&numbers, rows.len()) } else { None };
        rows.push(row.ok_or_else(|| {
            let count = numbers.len();
            let at = at + 1;
            format!(
                "line {at}: every line needs 8 numbers (time x y z qx qy qz qw), or every line 12 (a 3 x 4 matrix); \
                 this one has {count}"
            )
        })?);
    }
    let kitti = PoseAxes { world: WorldUpAxis::YDown, ..PoseAxes::for_body(PoseBody::Optical) };
    let usual = if columns == Some(12) { kitti } else { PoseAxes::for_body(PoseBody::Optical) };
    Ok(PoseRows { usual, knows_body_up: true, rows })
}

/// The pose on a line. `at` is the number of the line's picture, which counts for a matrix without a time.
fn row_from_numbers(numbers: &[f64], at: usize) -> Option<PoseRow> {
    match *numbers {
        [time, x, y, z, qx, qy, qz, qw] => Some(PoseRow {
            key: PoseKey::Time(seconds_in_unit(time, None)),
            position: DVec3::new(x, y, z),
            facing: PoseFacing::Quaternion([qx, qy, qz, qw]),
        }),
        [a, b, c, x, d, e, f, y, g, h, i, z] => Some(PoseRow {
            key: PoseKey::Number(at),
            position: DVec3::new(x, y, z),
            facing: PoseFacing::Columns([DVec3::new(a, d, g), DVec3::new(b, e, h), DVec3::new(c, f, i)]),
        }),
        _ => None,
    }
}
