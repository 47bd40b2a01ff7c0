//! Reads poses from CSV with a header: a time or a picture, a position, and optionally the direction of the camera.

use super::{
    columns::{PoseColumns, is_euroc_header, normal_column_name},
    matrix,
    rows::{KnownConventions, PoseRows, parse_number},
};
use crate::axes::{PoseAxes, PoseBody, WorldUpAxis};
use std::borrow::Cow;

const HEADER_HINT: &str = "the header needs a column `time_s` or `image`, and `x`, `y`, `z`; `qx`, `qy`, `qz`, `qw`, \
                      `yaw_rad` or `heading_deg` say where the camera looks";
/// Columns of positions on the earth.
const GPS_COLUMNS: [&str; 5] = ["lat", "latitude", "lon", "lng", "longitude"];
const GPS_HINT: &str = "latitudes and longitudes are degrees: convert them into metres (UTM, or a local frame), and name the columns `x`, `y`, `z`";
/// The columns of the file that Stray Scanner (a phone's app) writes beside a video: ARKit's world, and an optical frame.
const STRAY_COLUMNS: [&str; 9] = ["timestamp", "frame", "x", "y", "z", "qx", "qy", "qz", "qw"];

/// Whether a header begins with Stray Scanner's columns. Its newer versions append the camera's intrinsics.
fn is_stray_header(names: &[String]) -> bool {
    names.len() >= STRAY_COLUMNS.len() && names.iter().zip(STRAY_COLUMNS).all(|(name, column)| name == column)
}

/// Reads the rows of a CSV file.
pub(super) fn read_csv(text: &str) -> Result<PoseRows, String> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, header) = lines.next().ok_or("is empty")?;
    let header = header.trim_start_matches('\u{feff}');
    let names: Vec<String> = CsvCells::from_line(header).plain.into_iter().map(normal_column_name).collect();
    if names.iter().all(|name| parse_number(name).is_ok()) {
        // Numbers without a header, as in a TUM file.
        return matrix::read_matrix(text);
    }
    let is_gps = names.iter().any(|name| GPS_COLUMNS.contains(&name.as_str()));
    let columns = PoseColumns::from_names(&names).ok_or_else(|| match is_gps {
        true => format!("line 1: {GPS_HINT}"),
        false => format!("line 1: {HEADER_HINT}"),
    })?;
    let (mut rows, mut frames) = (Vec::new(), Some(Vec::new()));
    let is_by_semicolons = header.contains(';') && !header.contains(',');
    for (at, line) in lines.filter(|(_, line)| !line.starts_with('#')) {
        let line = if is_by_semicolons { with_decimal_points(line) } else { Cow::Borrowed(line) };
        let cells = CsvCells::from_line(&line);
        let cell = |column: usize| cells.get(column);
        rows.push(columns.read_row(at + 1, &cell)?);
        frames = frames.zip(columns.read_frame(&cell)).map(|(mut all, frame)| {
            all.push(frame);
            all
        });
    }
    let (is_euroc, is_stray) = (is_euroc_header(header), is_stray_header(&names));
    let body = if is_euroc || is_stray { PoseBody::Optical } else { PoseBody::Robot };
    let world = if is_stray { WorldUpAxis::YUp } else { WorldUpAxis::ZUp };
    let known = KnownConventions {
        body_up: !is_euroc,
        order: columns.has_quaternion(),
        direction: is_euroc || is_stray,
        unit: is_euroc || is_stray || columns.names_unit,
        angle_unit: columns.names_angle_unit(),
    };
    // The further columns of these formats are known, and no poses.
    let unread = columns.describe_unread(&names).filter(|_| !is_euroc && !is_stray);
    let angle_name = columns.angle_name();
    Ok(PoseRows {
        frames,
        unread,
        angle_name,
        ..PoseRows::new(PoseAxes { world, ..PoseAxes::for_body(body) }, known, rows)
    })
}

/// A line between semicolons, with decimal points in its numbers: some countries' tables have commas there.
fn with_decimal_points(line: &str) -> Cow<'_, str> {
    if !line.contains(',') {
        return Cow::Borrowed(line);
    }
    let cells = line.split(';').map(|cell| {
        let pointed = cell.replacen(',', ".", 1);
        if parse_number(&pointed).is_ok() { Cow::Owned(pointed) } else { Cow::Borrowed(cell) }
    });
    Cow::Owned(cells.collect::<Vec<_>>().join(";"))
}

/// The cells of a line, up to a quoted cell that contains the separator: all cells after that one would be shifted.
struct CsvCells<'a> {
    plain: Vec<&'a str>,
    /// The separator that the first unread cell contains, if there is such a cell.
    quoted_separator: Option<char>,
}

impl<'a> CsvCells<'a> {
    fn from_line(line: &'a str) -> Self {
        // A name of a picture may have a comma.
        let separator = if line.matches(';').count() > line.matches(',').count() { ';' } else { ',' };
        let is_plain = |cell: &&str| !cell.starts_with('"') || (cell.len() > 1 && cell.ends_with('"'));
        let cells = || line.split(separator).map(str::trim);
        let plain: Vec<&str> = cells().take_while(is_plain).map(|cell| cell.trim_matches('"')).collect();
        let separator_in_cell = (plain.len() < cells().count()).then_some(separator);
        Self { plain, quoted_separator: separator_in_cell }
    }

    /// The text of a cell.
    fn get(&self, column: usize) -> Result<&'a str, String> {
        self.plain.get(column).copied().ok_or_else(|| match self.quoted_separator {
            Some(separator) => format!("a quoted cell contains {separator:?}, which cannot be read"),
            None => format!("has too few cells ({})", self.plain.len()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newer_scans_of_stray_scanner_have_more_columns() {
        let header = |columns: &str| columns.split(", ").map(str::to_owned).collect::<Vec<_>>();
        let old = "timestamp, frame, x, y, z, qx, qy, qz, qw";
        assert!(is_stray_header(&header(old)) && is_stray_header(&header(&format!("{old}, fx, fy, cx, cy"))));
        assert!(!is_stray_header(&header("timestamp, x, y, z, qx, qy, qz, qw, frame")));
    }
}
