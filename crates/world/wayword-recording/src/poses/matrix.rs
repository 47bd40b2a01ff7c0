//! Reads poses from lines of bare numbers: TUM (`time x y z qx qy qz qw`), KITTI (a 3 x 4 matrix per picture), 4 x 4 matrices, and
//! lines whose columns a comment names.

use super::{
    columns::{PoseColumns, header_names, is_euroc_header},
    rows::{
        KnownConventions, PoseFacing, PoseKey, PoseRow, PoseRows, parse_number, pose_from_matrix, seconds_in_unit,
        whole_number,
    },
};
use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis, rotation_columns},
    pose_reading::{NumberReading, TransformDirection},
};
use wayword_core::DVec3;

/// Most numbers that a line can have: one before a 4 x 4 matrix.
const MOST_NUMBERS: usize = 17;
/// How far the length of a quaternion may be from 1.
const QUATERNION_LENGTH_SLACK: f64 = 0.02;
const EXPECTED_LINES: &str = "every line needs 8 numbers (time x y z qx qy qz qw), or every line 12 (a 3 x 4 matrix), or \
                         every line 16 (a 4 x 4 matrix)";

/// Reads any of these formats; a comment that names the columns decides, else the length of the first line.
pub(super) fn read_matrix(text: &str) -> Result<PoseRows, String> {
    let lines = number_lines(text)?;
    let usual = PoseAxes::for_body(PoseBody::Optical);
    let width = lines.first().map_or(0, |line| line.numbers.len());
    if let Some((header, columns)) = named_columns(text, width) {
        let rows = lines.iter().map(|line| {
            let cell = |column: usize| line.words.get(column).copied().ok_or_else(|| "has too few numbers".to_owned());
            columns.read_row(line.at, &cell)
        });
        let is_euroc = is_euroc_header(header);
        let known = KnownConventions {
            body_up: !is_euroc,
            order: columns.has_quaternion(),
            direction: is_euroc,
            unit: is_euroc || columns.names_unit,
            angle_unit: columns.names_angle_unit(),
        };
        let unread = columns.describe_unread(&header_names(header)).filter(|_| !is_euroc);
        return Ok(PoseRows { unread, ..PoseRows::new(usual, known, rows.collect::<Result<_, _>>()?) });
    }
    let mut rows = Vec::with_capacity(lines.len());
    for line in &lines {
        let fits = line.numbers.len() == width;
        let row = if fits { row_from_numbers(&line.numbers, rows.len()) } else { None };
        let row = row.map(|row| PoseRow { at: line.at, ..row });
        rows.push(row.ok_or_else(|| {
            let count = line.numbers.len();
            let more = if count > MOST_NUMBERS { "more than ".to_owned() } else { String::new() };
            let count = count.min(MOST_NUMBERS);
            let column = if fits && count == 9 {
                ": one column too many (if a ninth column numbers the poses, it has to hold whole numbers, after a quaternion)"
            } else {
                ""
            };
            format!("line {}: {EXPECTED_LINES}; this one has {more}{count}{column}", line.at)
        })?);
    }
    let kitti = PoseAxes { world: WorldUpAxis::YDown, ..usual };
    let is_matrix = matches!(width, 12 | 13 | 16 | 17);
    let unread = (width == 9).then(|| "column 9 is not read: it numbers the poses".to_owned());
    let rows = PoseRows::new(if is_matrix { kitti } else { usual }, KnownConventions::BODY_ONLY, rows);
    Ok(PoseRows { unread, ..rows })
}

/// Reads ARKitScenes' trajectories: `time`, an axis of rotation whose length is the angle in radians, and a translation, from the
/// world into an optical frame (apple/ARKitScenes, DATA.md).
pub(super) fn read_axis_angles(text: &str) -> Result<PoseRows, String> {
    let rows = number_lines(text)?.into_iter().map(|line| {
        let [time, ax, ay, az, x, y, z] = *line.numbers.as_slice() else {
            return Err(format!("line {}: needs 7 numbers (time, axis of rotation, translation)", line.at));
        };
        let axis = DVec3::new(ax, ay, az);
        let angle_rad = axis.length();
        let half = axis.normalize_or_zero() * libm::sin(angle_rad / 2.0);
        let columns = rotation_columns([half.x, half.y, half.z, libm::cos(angle_rad / 2.0)]);
        let facing = columns.map_or(PoseFacing::Unknown, PoseFacing::Columns);
        Ok(PoseRow { at: line.at, key: PoseKey::Time(time), position: DVec3::new(x, y, z), facing })
    });
    let usual_numbers = NumberReading { direction: TransformDirection::WorldToCamera, ..NumberReading::default() };
    let rows =
        PoseRows::new(PoseAxes::for_body(PoseBody::Optical), KnownConventions::ALL, rows.collect::<Result<_, _>>()?);
    Ok(PoseRows { usual_numbers, ..rows })
}

/// A line of numbers.
struct NumberLine<'a> {
    /// Counted from 1.
    at: usize,
    words: Vec<&'a str>,
    numbers: Vec<f64>,
}

/// Whether a line is neither empty nor a comment.
fn is_data(line: &str) -> bool {
    let line = line.trim();
    !line.is_empty() && !line.starts_with(['#', '%'])
}

/// The words of a line, at most one more than a valid line can have, so that a longer line is noticed.
fn line_words(line: &str) -> Vec<&str> {
    line.split([' ', '\t', ',', ';']).map(str::trim).filter(|word| !word.is_empty()).take(MOST_NUMBERS + 1).collect()
}

/// The lines with numbers: all but comments, empty lines, and a first line that begins with a word.
fn number_lines(text: &str) -> Result<Vec<NumberLine<'_>>, String> {
    let lines = text.lines().enumerate().filter(|(_, line)| is_data(line));
    let is_header =
        |place: usize, line: &str| place == 0 && line_words(line).iter().all(|word| parse_number(word).is_err());
    let lines = lines.enumerate().filter(|(place, (_, line))| !is_header(*place, line)).map(|(_, line)| line);
    let lines = lines.map(|(at, line)| {
        let words = line_words(line);
        let numbers = words.iter().map(|word| parse_number(word)).collect::<Result<_, _>>();
        Ok(NumberLine { at: at + 1, numbers: numbers.map_err(|reason| format!("line {}: {reason}", at + 1))?, words })
    });
    lines.collect()
}

/// The line before the numbers that names their columns, if there is one: a comment or a bare line with as many names as a line
/// has numbers.
fn named_columns(text: &str, width: usize) -> Option<(&str, PoseColumns)> {
    let is_numbers = |line: &&str| is_data(line) && line_words(line).iter().any(|word| parse_number(word).is_ok());
    let head = text.lines().take_while(|line| !is_numbers(line));
    let named = head.map(|line| (line, header_names(line))).filter(|(_, names)| names.len() == width);
    named.filter_map(|(line, names)| Some((line, PoseColumns::from_names(&names)?))).last()
}

/// The pose on a line. `at` is the number of the line's picture, which counts for a matrix without a time.
fn row_from_numbers(numbers: &[f64], at: usize) -> Option<PoseRow> {
    match *numbers {
        [time, x, y, z, a, b, c, d] => Some(row_from_quaternion(time, DVec3::new(x, y, z), [a, b, c, d])),
        // RTAB-Map's format with the number of the pose at the end.
        [time, x, y, z, a, b, c, d, id] => {
            let length = libm::sqrt(a * a + b * b + c * c + d * d);
            let is_rotation = (length - 1.0).abs() <= QUATERNION_LENGTH_SLACK || length.is_nan();
            (is_rotation && id.fract() == 0.0).then(|| row_from_quaternion(time, DVec3::new(x, y, z), [a, b, c, d]))
        }
        ref matrix if matches!(matrix.len(), 12 | 16) => row_from_matrix(PoseKey::Number(at), matrix),
        // The number of a picture, or a time, before the matrix (KITTI-360).
        [first, ref matrix @ ..] if matches!(matrix.len(), 12 | 16) => {
            let key = whole_number(first).map_or_else(|| PoseKey::Time(seconds_in_unit(first, None)), PoseKey::Number);
            row_from_matrix(key, matrix)
        }
        _ => None,
    }
}

fn row_from_quaternion(time: f64, position: DVec3, quaternion: [f64; 4]) -> PoseRow {
    let key = PoseKey::Time(seconds_in_unit(time, None));
    PoseRow { at: 0, key, position, facing: PoseFacing::Quaternion(quaternion) }
}

/// The pose of a 3 x 4 or 4 x 4 matrix, row by row; `None` for other numbers, such as a matrix column by column.
pub(super) fn row_from_matrix(key: PoseKey, numbers: &[f64]) -> Option<PoseRow> {
    let (matrix, last) = numbers.split_first_chunk::<12>()?;
    // A scanner that lost its place writes -inf everywhere.
    let is_last_row = last.is_empty() || *last == [0.0, 0.0, 0.0, 1.0] || last.iter().any(|number| !number.is_finite());
    let (position, columns) = pose_from_matrix(*matrix);
    is_last_row.then_some(PoseRow { at: 0, key, position, facing: PoseFacing::Columns(columns) })
}
