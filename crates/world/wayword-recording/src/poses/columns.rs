//! The columns of a pose file by their names: those of a CSV's header, or of a comment before lines of numbers.

use super::rows::{PoseFacing, PoseKey, PoseRow, parse_number, seconds_in_unit, whole_number};
use wayword_core::DVec3;

/// The number of each column that is read, from 0.
pub(super) struct PoseColumns {
    key: KeyColumn,
    /// The columns of x, y and z. A file without heights has the column of x in the place of z.
    position: [usize; 3],
    facing: FacingColumns,
    /// The column that counts the pictures, beside a time.
    frame: Option<usize>,
    /// Whether the names say that positions are in metres.
    pub(super) names_unit: bool,
}

/// The column that gives the time or the picture of a row.
enum KeyColumn {
    Time { column: usize, unit: Option<&'static str> },
    Picture(usize),
    Frame(usize),
}

/// The columns that give the direction in which the body looks.
enum FacingColumns {
    /// There are none.
    Nowhere,
    /// x, y, z, w.
    Quaternion([usize; 4]),
    /// The name is that of a column with a unit.
    Yaw {
        column: usize,
        name: Option<&'static str>,
    },
    Heading {
        column: usize,
        name: &'static str,
    },
}

/// The beginning of the columns' names for positions in EuRoC (a dataset of flights).
const EUROC_POSITION: &str = "p_rs_r_";
/// Most columns that a message names, and most characters of a name.
const MAX_NAMED_COLUMNS: usize = 6;
const MAX_NAME_CHARS: usize = 30;
/// Names of a column that counts pictures.
const FRAME_NAMES: [&str; 3] = ["frame", "frame_number", "frame_index"];

/// A column's name in the form that is compared: `#timestamp [ns]` is `timestamp_ns`, `p_RS_R_x [m]` is `x`, and
/// `pose.pose.orientation.w` is `qw`.
pub(super) fn normal_column_name(cell: &str) -> String {
    let cell = cell.trim_start_matches('#').trim().to_ascii_lowercase();
    let (name, unit) = match cell.split_once('[') {
        Some((name, unit)) => (name.trim(), unit.trim_end_matches(']').trim()),
        None => (cell.as_str(), ""),
    };
    // EuRoC's names: position and quaternion of the sensor in the reference frame.
    let name = match (name.strip_prefix(EUROC_POSITION), name.strip_prefix("q_rs_")) {
        (Some(axis), _) => axis.to_owned(),
        (None, Some(part)) => format!("q{part}"),
        // ROS's messages as tables.
        (None, None) => match (name.rsplit_once("position."), name.rsplit_once("orientation.")) {
            (Some((_, axis)), _) => axis.to_owned(),
            (None, Some((_, part))) => format!("q{part}"),
            (None, None) => name.to_owned(),
        },
    };
    if matches!(unit, "s" | "ms" | "us" | "ns" | "rad" | "deg" | "m") { format!("{name}_{unit}") } else { name }
}

/// The names in a line that may be a header: its words, or what stands between its commas.
pub(super) fn header_names(line: &str) -> Vec<String> {
    let line = line.trim().trim_start_matches(['#', '%']).trim();
    let separator = [',', ';'].into_iter().find(|separator| line.contains(*separator));
    let Some(separator) = separator else {
        let mut names: Vec<String> = Vec::new();
        for word in line.split_whitespace() {
            // A unit belongs to the name before it.
            match names.last_mut().filter(|_| word.starts_with('[')) {
                Some(name) => *name += word,
                None => names.push(word.to_owned()),
            }
        }
        return names.iter().map(|name| normal_column_name(name)).collect();
    };
    line.split(separator).map(|cell| normal_column_name(cell.trim().trim_matches('"'))).collect()
}

/// A name from a file, short and in a form that is safe to show.
pub(super) fn clip_name(name: &str) -> String {
    name.chars().take(MAX_NAME_CHARS).collect::<String>().escape_debug().to_string()
}

/// Whether a header is EuRoC's. Its sensor has z ahead and x up (`T_BS` in its sensor.yaml).
pub(super) fn is_euroc_header(header: &str) -> bool {
    header.to_ascii_lowercase().contains(EUROC_POSITION)
}

impl PoseColumns {
    /// Finds the columns by their names; `None` without a time or picture, or without x and y.
    pub(super) fn from_names(names: &[String]) -> Option<Self> {
        let find = |name: &str| names.iter().position(|other| other == name);
        let any = |names: &[&str]| names.iter().find_map(|name| find(name));
        let time = || {
            let bare = any(&["time", "timestamp", "t", "stamp"]).map(|column| KeyColumn::Time { column, unit: None });
            let with_unit = ["s", "ms", "us", "ns"].into_iter().find_map(|unit| {
                let names = ["time", "timestamp", "t", "stamp"].map(|name| format!("{name}_{unit}"));
                let column = names.iter().find_map(|name| find(name))?;
                Some(KeyColumn::Time { column, unit: Some(unit) })
            });
            with_unit.or(bare)
        };
        let frame = any(&FRAME_NAMES);
        let key = any(&["image", "file", "filename", "picture", "name"]).map(KeyColumn::Picture).or_else(time);
        let key = key.or(frame.map(KeyColumn::Frame))?;
        let metric = |axis: &str| any(&[&format!("{axis}_m"), &format!("t{axis}_m")]);
        let axis = |axis: &str| {
            let spellings = ["{}", "t{}", "p{}", "pos_{}", "pos{}", "p_{}", "t_{}", "position_{}"];
            metric(axis).or_else(|| spellings.iter().find_map(|spelling| find(&spelling.replace("{}", axis))))
        };
        Some(Self {
            key,
            position: [axis("x")?, axis("y")?, axis("z").or_else(|| axis("x"))?],
            facing: FacingColumns::from_columns(&find),
            frame,
            names_unit: metric("x").is_some(),
        })
    }

    /// The columns among these names that are not read, for the user; `None` if all are.
    pub(super) fn describe_unread(&self, names: &[String]) -> Option<String> {
        let key = match self.key {
            KeyColumn::Time { column, .. } | KeyColumn::Picture(column) | KeyColumn::Frame(column) => column,
        };
        let facing = match self.facing {
            FacingColumns::Nowhere => Vec::new(),
            FacingColumns::Quaternion(columns) => columns.to_vec(),
            FacingColumns::Yaw { column, .. } | FacingColumns::Heading { column, .. } => vec![column],
        };
        let read: Vec<usize> = [key].into_iter().chain(self.position).chain(facing).chain(self.frame).collect();
        let unread = names.iter().enumerate().filter(|(at, name)| !read.contains(at) && !name.is_empty());
        let unread: Vec<String> = unread.map(|(_, name)| clip_name(name)).collect();
        let first = unread.get(..unread.len().min(MAX_NAMED_COLUMNS)).unwrap_or_default().join(", ");
        let more = match unread.len().saturating_sub(MAX_NAMED_COLUMNS) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let are = match unread.len() {
            0 => return None,
            1 => format!("the column {first} is not read"),
            _ => format!("the columns {first}{more} are not read"),
        };
        let without_facing = match self.facing {
            FacingColumns::Nowhere => {
                "; no column gives the direction of the camera, so it counts as looking along the path (qx, qy, qz, qw, yaw_rad or heading_deg would)"
            }
            _ => "",
        };
        Some(are + without_facing)
    }

    /// Whether its names give the order of a quaternion.
    pub(super) const fn has_quaternion(&self) -> bool {
        matches!(self.facing, FacingColumns::Quaternion(_))
    }

    /// Whether a yaw has its unit in the column's name.
    pub(super) const fn names_angle_unit(&self) -> bool {
        !matches!(self.facing, FacingColumns::Yaw { name: None, .. })
    }

    /// The name of the column with an angle, if it names its unit.
    pub(super) const fn angle_name(&self) -> Option<&'static str> {
        match self.facing {
            FacingColumns::Yaw { name, .. } => name,
            FacingColumns::Heading { name, .. } => Some(name),
            FacingColumns::Nowhere | FacingColumns::Quaternion(_) => None,
        }
    }

    /// The pose of a row, whose cells `cell` gives. `at` is the number of its line.
    pub(super) fn read_row<'a>(
        &self,
        at: usize,
        cell: &dyn Fn(usize) -> Result<&'a str, String>,
    ) -> Result<PoseRow, String> {
        self.read_cells(at, cell).map_err(|reason| format!("line {at}: {reason}"))
    }

    fn read_cells<'a>(&self, at: usize, cell: &dyn Fn(usize) -> Result<&'a str, String>) -> Result<PoseRow, String> {
        let value = |column: usize| parse_number(cell(column)?);
        let key = match self.key {
            KeyColumn::Time { column, unit } => PoseKey::Time(seconds_in_unit(value(column)?, unit)),
            KeyColumn::Picture(column) => PoseKey::Picture(cell(column)?.to_owned()),
            KeyColumn::Frame(column) => {
                let number = value(column)?;
                PoseKey::Number(whole_number(number).ok_or_else(|| format!("{number} is not the number of a picture"))?)
            }
        };
        let [x, y, z] = self.position;
        // A robot on a plane has no z.
        let height_m = if z == x { 0.0 } else { value(z)? };
        let position = DVec3::new(value(x)?, value(y)?, height_m);
        let facing = match self.facing {
            FacingColumns::Nowhere => PoseFacing::Unknown,
            FacingColumns::Quaternion([x, y, z, w]) => {
                PoseFacing::Quaternion([value(x)?, value(y)?, value(z)?, value(w)?])
            }
            FacingColumns::Yaw { column, name } => {
                PoseFacing::Yaw(value(column)? * name.map_or(1.0, rad_per_named_unit))
            }
            FacingColumns::Heading { column, name } => PoseFacing::Heading(value(column)? * rad_per_named_unit(name)),
        };
        Ok(PoseRow { at, key, position, facing })
    }

    /// The number in the column that counts pictures, beside a time; `None` if there is none.
    pub(super) fn read_frame<'a>(&self, cell: &dyn Fn(usize) -> Result<&'a str, String>) -> Option<usize> {
        whole_number(parse_number(cell(self.frame?).ok()?).ok()?)
    }
}

/// Radians per unit of a column with its unit at the end of its name.
fn rad_per_named_unit(name: &str) -> f64 {
    if name.ends_with("_deg") { 1_f64.to_radians() } else { 1.0 }
}

impl FacingColumns {
    fn from_columns(find: &dyn Fn(&str) -> Option<usize>) -> Self {
        let quaternion = || {
            let spellings = ["q{}", "q_{}", "quat_{}", "rot_{}", "rot{}", "orientation_{}", "rotation_{}"];
            spellings.iter().find_map(|spelling| {
                let part = |part: &str| find(&spelling.replace("{}", part));
                Some(Self::Quaternion([part("x")?, part("y")?, part("z")?, part("w")?]))
            })
        };
        let angle = |names: [&'static str; 2]| names.into_iter().find_map(|name| Some((find(name)?, name)));
        let yaw = || {
            let named = angle(["yaw_rad", "yaw_deg"]).map(|(column, name)| (column, Some(name)));
            let found = named.or_else(|| find("yaw").or_else(|| find("theta")).map(|column| (column, None)));
            found.map(|(column, name)| Self::Yaw { column, name })
        };
        let heading = || angle(["heading_rad", "heading_deg"]).map(|(column, name)| Self::Heading { column, name });
        quaternion().or_else(heading).or_else(yaw).unwrap_or(Self::Nowhere)
    }
}
