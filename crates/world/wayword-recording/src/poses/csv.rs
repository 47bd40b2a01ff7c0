//! Reads poses from CSV with a header: a time or a picture, a position, and optionally the direction of the camera.

use super::rows::{PoseFacing, PoseKey, PoseRow, PoseRows, parse_number, seconds_in_unit};
use crate::axes::{PoseAxes, PoseBody};
use wayword_core::DVec3;

/// The number of each column that is read, from 0.
struct CsvColumns {
    key: CsvKeyColumn,
    /// The columns of x, y and z. A file without heights has the column of x in the place of z.
    position: [usize; 3],
    facing: CsvFacing,
}

/// The column that gives the time or the picture of a row.
enum CsvKeyColumn {
    Time { column: usize, unit: Option<&'static str> },
    Picture(usize),
}

/// The columns that give the direction in which the body looks.
enum CsvFacing {
    /// There are none.
    Nowhere,
    Quaternion([usize; 4]),
    Yaw {
        column: usize,
        per_unit_rad: f64,
    },
    Heading {
        column: usize,
        per_unit_rad: f64,
    },
}

/// The beginning of the columns' names for positions in EuRoC (a dataset of flights).
const EUROC_POSITION: &str = "p_rs_r_";
const HEADER_HINT: &str = "the header needs a column `time_s` or `image`, and `x`, `y`, `z`; `qx`, `qy`, `qz`, `qw`, \
                      `yaw_rad` or `heading_deg` say where the camera looks";

/// Reads the rows of a CSV file.
pub(super) fn read_csv(text: &str) -> Result<PoseRows, String> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let (_, header) = lines.next().ok_or("is empty")?;
    let names: Vec<String> =
        CsvCells::from_line(header.trim_start_matches('\u{feff}')).plain.into_iter().map(normal_column_name).collect();
    let columns = CsvColumns::from_names(&names).ok_or_else(|| format!("line 1: {HEADER_HINT}"))?;
    let rows = lines.filter(|(_, line)| !line.starts_with('#')).map(|(at, line)| {
        columns.read_row(&CsvCells::from_line(line)).map_err(|reason| format!("line {}: {reason}", at + 1))
    });
    // The sensor of EuRoC has z ahead and x up (`body_T_cam` in its sensor.yaml).
    let is_euroc = header.to_ascii_lowercase().contains(EUROC_POSITION);
    let body = if is_euroc { PoseBody::Optical } else { PoseBody::Robot };
    Ok(PoseRows { usual: PoseAxes::for_body(body), knows_body_up: !is_euroc, rows: rows.collect::<Result<_, _>>()? })
}

/// The cells of a line, up to a quoted cell that contains the separator: all cells after that one would be shifted.
struct CsvCells<'a> {
    plain: Vec<&'a str>,
    /// The separator that the first unread cell contains, if there is such a cell.
    quoted_separator: Option<char>,
}

impl<'a> CsvCells<'a> {
    fn from_line(line: &'a str) -> Self {
        let separator = if line.contains(';') && !line.contains(',') { ';' } else { ',' };
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

/// A column's name in the form that is compared: `#timestamp [ns]` is `timestamp_ns`, `p_RS_R_x [m]` is `x`.
fn normal_column_name(cell: &str) -> String {
    let cell = cell.trim_start_matches('#').trim().to_ascii_lowercase();
    let (name, unit) = match cell.split_once('[') {
        Some((name, unit)) => (name.trim(), unit.trim_end_matches(']').trim()),
        None => (cell.as_str(), ""),
    };
    // EuRoC's names: position and quaternion of the sensor in the reference frame.
    let name = name.strip_prefix(EUROC_POSITION).or_else(|| name.strip_prefix("q_rs_").map(|_| name)).unwrap_or(name);
    let name = name.strip_prefix("q_rs_").map_or_else(|| name.to_owned(), |part| format!("q{part}"));
    if matches!(unit, "s" | "ms" | "us" | "ns" | "rad" | "deg") { format!("{name}_{unit}") } else { name }
}

impl CsvColumns {
    /// Finds the columns by their names; `None` without a time or picture, or without x and y.
    fn from_names(names: &[String]) -> Option<Self> {
        let find = |name: &str| names.iter().position(|other| other == name);
        let any = |names: &[&str]| names.iter().find_map(|name| find(name));
        let time = || {
            let bare =
                any(&["time", "timestamp", "t", "stamp"]).map(|column| CsvKeyColumn::Time { column, unit: None });
            let with_unit = ["s", "ms", "us", "ns"].into_iter().find_map(|unit| {
                let names = ["time", "timestamp", "t", "stamp"].map(|name| format!("{name}_{unit}"));
                let column = names.iter().find_map(|name| find(name))?;
                Some(CsvKeyColumn::Time { column, unit: Some(unit) })
            });
            with_unit.or(bare)
        };
        let key = any(&["image", "file", "filename", "picture", "name"]).map(CsvKeyColumn::Picture).or_else(time)?;
        let axis = |axis: &str| any(&[axis, &format!("t{axis}"), &format!("p{axis}"), &format!("{axis}_m")]);
        Some(Self {
            key,
            position: [axis("x")?, axis("y")?, axis("z").or_else(|| axis("x"))?],
            facing: CsvFacing::from_columns(&find),
        })
    }

    fn read_row(&self, cells: &CsvCells<'_>) -> Result<PoseRow, String> {
        let cell = |column: usize| cells.get(column);
        let value = |column: usize| parse_number(cell(column)?);
        let key = match self.key {
            CsvKeyColumn::Time { column, unit } => PoseKey::Time(seconds_in_unit(value(column)?, unit)),
            CsvKeyColumn::Picture(column) => PoseKey::Picture(cell(column)?.to_owned()),
        };
        let [x, y, z] = self.position;
        // A robot on a plane has no z.
        let height_m = if z == x { 0.0 } else { value(z)? };
        let position = DVec3::new(value(x)?, value(y)?, height_m);
        let facing = match self.facing {
            CsvFacing::Nowhere => PoseFacing::Unknown,
            CsvFacing::Quaternion([x, y, z, w]) => PoseFacing::Quaternion([value(x)?, value(y)?, value(z)?, value(w)?]),
            CsvFacing::Yaw { column, per_unit_rad } => PoseFacing::Yaw(value(column)? * per_unit_rad),
            CsvFacing::Heading { column, per_unit_rad } => PoseFacing::Heading(value(column)? * per_unit_rad),
        };
        Ok(PoseRow { key, position, facing })
    }
}

impl CsvFacing {
    fn from_columns(find: &dyn Fn(&str) -> Option<usize>) -> Self {
        let quaternion = || Some(Self::Quaternion([find("qx")?, find("qy")?, find("qz")?, find("qw")?]));
        let rad_per_deg = 1_f64.to_radians();
        let angle = |name: &str| {
            let rad = find(&format!("{name}_rad")).map(|column| (column, 1.0));
            rad.or_else(|| find(&format!("{name}_deg")).map(|column| (column, rad_per_deg)))
        };
        let yaw = || {
            let found = angle("yaw").or_else(|| find("yaw").or_else(|| find("theta")).map(|column| (column, 1.0)));
            found.map(|(column, per_unit_rad)| Self::Yaw { column, per_unit_rad })
        };
        let heading = || angle("heading").map(|(column, per_unit_rad)| Self::Heading { column, per_unit_rad });
        quaternion().or_else(heading).or_else(yaw).unwrap_or(Self::Nowhere)
    }
}
