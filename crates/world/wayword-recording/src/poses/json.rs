//! Reads poses from JSON: Wayword's own list of poses, NeRF's `transforms.json`, or the `metadata` of Record3D (a phone's app).

use super::rows::{
    KnownConventions, PoseFacing, PoseKey, PoseRow, PoseRows, RowKind, pose_from_matrix, seconds_in_unit,
};
use crate::axes::{PoseAxes, PoseBody, WorldUpAxis};
use serde::Deserialize;
use wayword_core::DVec3;

/// The content of either file.
#[derive(Deserialize)]
#[serde(untagged)]
enum PoseFile {
    Transforms {
        frames: Vec<NerfFrame>,
    },
    Poses {
        poses: Vec<JsonPose>,
    },
    /// For each picture qx, qy, qz, qw, x, y, z of ARKit's camera.
    Record3D {
        poses: Vec<[f64; 7]>,
    },
    List(Vec<JsonPose>),
}

/// A frame of `transforms.json`.
#[derive(Deserialize)]
struct NerfFrame {
    file_path: String,
    /// world_from_camera, row by row.
    transform_matrix: Vec<[f64; 4]>,
}

/// A pose of Wayword's own format.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JsonPose {
    #[serde(default)]
    time_s: Option<f64>,
    #[serde(default)]
    image: Option<String>,
    position: [f64; 3],
    /// x, y, z, w, unless `quaternion` in recording.toml says otherwise.
    #[serde(default)]
    orientation: Option<[f64; 4]>,
    #[serde(default)]
    yaw_rad: Option<f64>,
    #[serde(default)]
    heading_deg: Option<f64>,
}

const EXPECTED_JSON: &str = "expected `transforms.json`, or a list of {\"image\" or \"time_s\", \"position\": [x, y, z]} \
                        with \"orientation\": [x, y, z, w], \"yaw_rad\" or \"heading_deg\"";

/// Reads the rows of a JSON file.
pub(super) fn read_json(text: &str) -> Result<PoseRows, String> {
    // The error of an untagged enum does not name the fault, so invalid JSON is reported first.
    let value: serde_json::Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    match PoseFile::deserialize(value).map_err(|_| EXPECTED_JSON.to_owned())? {
        PoseFile::Transforms { frames } => {
            let rows = frames.into_iter().enumerate().map(|(at, frame)| frame.into_row(at).ok_or((at, "frame")));
            collect_rows(PoseAxes::for_body(PoseBody::OpenGl), KnownConventions::BODY_ONLY, RowKind::Frame, rows)
        }
        PoseFile::Record3D { poses } => {
            let rows = poses.into_iter().enumerate().map(|(at, [qx, qy, qz, qw, x, y, z])| {
                let facing = PoseFacing::Quaternion([qx, qy, qz, qw]);
                Ok(PoseRow { at, key: PoseKey::Number(at), position: DVec3::new(x, y, z), facing })
            });
            let arkit = PoseAxes { world: WorldUpAxis::YUp, ..PoseAxes::for_body(PoseBody::OpenGl) };
            collect_rows(arkit, KnownConventions::ALL, RowKind::Pose, rows)
        }
        PoseFile::Poses { poses } | PoseFile::List(poses) => {
            let rows = poses.into_iter().enumerate().map(|(at, pose)| pose.into_row(at).ok_or((at, "pose")));
            let known = KnownConventions { angle_unit: true, ..KnownConventions::BODY_ONLY };
            collect_rows(PoseAxes::for_body(PoseBody::Robot), known, RowKind::Pose, rows)
        }
    }
}

/// Collects rows with the usual axes of their format. A row that is no pose is given as its number and its kind.
fn collect_rows(
    usual: PoseAxes,
    known: KnownConventions,
    kind: RowKind,
    rows: impl Iterator<Item = Result<PoseRow, (usize, &'static str)>>,
) -> Result<PoseRows, String> {
    let rows = rows.collect::<Result<_, _>>().map_err(|(at, what)| format!("{what} {at}: {EXPECTED_JSON}"))?;
    Ok(PoseRows { kind, ..PoseRows::new(usual, known, rows) })
}

impl NerfFrame {
    fn into_row(self, at: usize) -> Option<PoseRow> {
        let [[ax, ay, az, x], [bx, by, bz, y], [cx, cy, cz, z], ..] = *self.transform_matrix.as_slice() else {
            return None;
        };
        let (position, columns) = pose_from_matrix([ax, ay, az, x, bx, by, bz, y, cx, cy, cz, z]);
        Some(PoseRow { at, key: PoseKey::Picture(self.file_path), position, facing: PoseFacing::Columns(columns) })
    }
}

impl JsonPose {
    fn into_row(self, at: usize) -> Option<PoseRow> {
        let key = match (self.image, self.time_s) {
            (Some(image), _) => PoseKey::Picture(image),
            (None, Some(time_s)) => PoseKey::Time(seconds_in_unit(time_s, Some("s"))),
            (None, None) => return None,
        };
        let facing = match (self.orientation, self.heading_deg, self.yaw_rad) {
            (Some(quaternion), ..) => PoseFacing::Quaternion(quaternion),
            (_, Some(deg), _) => PoseFacing::Heading(deg.to_radians()),
            (.., Some(rad)) => PoseFacing::Yaw(rad),
            _ => PoseFacing::Unknown,
        };
        Some(PoseRow { at, key, position: DVec3::from_array(self.position), facing })
    }
}
