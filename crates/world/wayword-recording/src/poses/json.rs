//! Reads poses from JSON: Wayword's own list of poses, or NeRF's `transforms.json`.

use super::rows::{Facing, Of, Row, Rows, seconds};
use crate::axes::{Axes, Body};
use serde::Deserialize;
use wayword_core::DVec3;

/// The content of either file.
#[derive(Deserialize)]
#[serde(untagged)]
enum PoseFile {
    Transforms { frames: Vec<Framed> },
    Poses { poses: Vec<Posed> },
    List(Vec<Posed>),
}

/// A frame of `transforms.json`.
#[derive(Deserialize)]
struct Framed {
    file_path: String,
    /// world_from_camera, row by row.
    transform_matrix: Vec<[f64; 4]>,
}

/// A pose of Wayword's own format.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Posed {
    #[serde(default)]
    time_s: Option<f64>,
    #[serde(default)]
    image: Option<String>,
    position: [f64; 3],
    /// x, y, z, w.
    #[serde(default)]
    orientation: Option<[f64; 4]>,
    #[serde(default)]
    yaw_rad: Option<f64>,
    #[serde(default)]
    heading_deg: Option<f64>,
}

const EXPECTED: &str = "expected `transforms.json`, or a list of {\"image\" or \"time_s\", \"position\": [x, y, z]} \
                        with \"orientation\": [x, y, z, w], \"yaw_rad\" or \"heading_deg\"";

/// Reads the rows of a JSON file.
pub(super) fn read(text: &str) -> Result<Rows, String> {
    // The error of an untagged enum does not name the fault, so invalid JSON is reported first.
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    match PoseFile::deserialize(value).map_err(|_| EXPECTED.to_owned())? {
        PoseFile::Transforms { frames } => {
            let rows = frames.into_iter().enumerate().map(|(at, framed)| framed.row().ok_or((at, "frame")));
            rows_of(Axes::of(Body::OpenGl), rows)
        }
        PoseFile::Poses { poses } | PoseFile::List(poses) => {
            let rows = poses.into_iter().enumerate().map(|(at, posed)| posed.row().ok_or((at, "pose")));
            rows_of(Axes::of(Body::Robot), rows)
        }
    }
}

fn rows_of(usual: Axes, rows: impl Iterator<Item = Result<Row, (usize, &'static str)>>) -> Result<Rows, String> {
    let rows = rows.collect::<Result<_, _>>().map_err(|(at, what)| format!("{what} {at}: {EXPECTED}"))?;
    Ok(Rows { usual, knows_above: true, rows })
}

impl Framed {
    fn row(self) -> Option<Row> {
        let [a, b, c, ..] = *self.transform_matrix.as_slice() else { return None };
        let column = |at: usize| DVec3::new(a[at], b[at], c[at]);
        Some(Row {
            of: Of::Picture(self.file_path),
            position: column(3),
            facing: Facing::Columns([column(0), column(1), column(2)]),
        })
    }
}

impl Posed {
    fn row(self) -> Option<Row> {
        let of = match (self.image, self.time_s) {
            (Some(image), _) => Of::Picture(image),
            (None, Some(time_s)) => Of::Time(seconds(time_s, Some("s"))),
            (None, None) => return None,
        };
        let facing = match (self.orientation, self.heading_deg, self.yaw_rad) {
            (Some(quaternion), ..) => Facing::Quaternion(quaternion),
            (_, Some(deg), _) => Facing::Heading(deg.to_radians()),
            (.., Some(rad)) => Facing::Yaw(rad),
            _ => Facing::Unknown,
        };
        Some(Row { of, position: DVec3::from_array(self.position), facing })
    }
}
