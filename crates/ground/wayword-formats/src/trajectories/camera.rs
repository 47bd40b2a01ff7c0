//! A camera of an agent: its intrinsics, and for each walk its poses, the pictures it takes and the goals that they show.

use super::{PictureKind, PictureSet, pictures::take_picture_set};
use crate::{DatasetItem, FormatError, input};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::path::Path;
use wayword_core::{DMat4, DVec3};

/// The value of `format` of a line.
const PICTURES_FORMAT: &str = "wayword-pictures/1";
/// Numbers of a pose are rounded to that part of 1.
const POSE_PARTS: f64 = 1e9;
/// Most pictures of one walk; a line with more is refused.
const MAX_PICTURES: usize = 25_000;

/// A pinhole camera on an agent. Pixel coordinates are continuous, x to the right and y down, from the top left corner of the picture:
/// the centre of the first pixel is (0.5, 0.5).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraIntrinsics {
    /// Its height over the agent's place on the navmesh, metres.
    pub height_m: f64,
    /// Its angle over the horizon, degrees: negative looks down.
    pub pitch_deg: f64,
    /// Width of its pictures, pixels.
    pub width_px: u32,
    /// Height of its pictures, pixels.
    pub height_px: u32,
    /// Focal length, pixels: the same in both directions.
    pub focal_px: f64,
    /// The principal point, pixels: the middle of the picture.
    pub centre_px: [f64; 2],
}

impl CameraIntrinsics {
    /// Its name, by height and pitch as InternNav's folders have it: `125cm_30deg` looks down by 30 degrees.
    #[must_use]
    pub fn name(&self) -> String {
        // No "-0".
        format!("{:.0}cm_{:.0}deg", 100.0 * self.height_m, 0.0 - self.pitch_deg)
    }

    /// The pixel (column and row) that shows a point of the camera's frame (x right, y down, z ahead, metres); `None` if it is not in the
    /// picture.
    #[must_use]
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "both are within the picture")]
    pub fn pixel_of(&self, point: DVec3) -> Option<[u32; 2]> {
        if point.z <= 0.0 {
            return None;
        }
        let [u, v] = [(point.x, self.centre_px[0]), (point.y, self.centre_px[1])]
            .map(|(off, centre)| centre + self.focal_px * off / point.z);
        let is_shown = u >= 0.0 && v >= 0.0 && u < f64::from(self.width_px) && v < f64::from(self.height_px);
        is_shown.then_some([u as u32, v as u32])
    }

    /// The ray through the centre of a pixel in the camera's frame, with length 1 ahead: times a depth it is a point.
    #[must_use]
    pub fn ray_through(&self, [u, v]: [u32; 2]) -> DVec3 {
        let [x, y] = [(u, self.centre_px[0]), (v, self.centre_px[1])]
            .map(|(pixel, centre)| (f64::from(pixel) + 0.5 - centre) / self.focal_px);
        DVec3::new(x, y, 1.0)
    }
}

/// What a camera sees along a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraWalk {
    /// The walk.
    pub trajectory_id: String,
    /// Its pose before each action, in Habitat's world (y up, metres): it takes points of the camera's frame (x right, y down, z ahead).
    pub world_from_camera: Vec<DMat4>,
    /// The pictures before each action.
    pub rgb: PictureSet,
    /// The depths before each action, millimetres along the camera's axis; 0 where nothing is drawn or it is farther than 65.5 m.
    pub depth: PictureSet,
    /// For each action the farthest later position of the walk that the picture shows, at its place on the floor.
    pub pixel_goals: Vec<Option<PixelGoal>>,
}

impl CameraWalk {
    /// The pictures of a kind.
    #[must_use]
    pub fn pictures(&self, kind: PictureKind) -> &PictureSet {
        match kind {
            PictureKind::Rgb => &self.rgb,
            PictureKind::Depth => &self.depth,
        }
    }
}

/// A later position of a walk, as a picture shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelGoal {
    /// Column and row of its pixel, from 0.
    pub pixel: [u32; 2],
    /// The action before which the agent comes there.
    pub step: usize,
}

/// The line of a camera about a walk.
#[must_use]
pub fn camera_walk_line(walk: &CameraWalk) -> Value {
    let goals: Vec<_> = walk.pixel_goals.iter().map(|goal| goal.map(|goal| (goal.pixel, goal.step))).collect();
    let poses: Vec<_> = walk.world_from_camera.iter().map(|pose| rows_of(*pose)).collect();
    json!({
        "format": PICTURES_FORMAT,
        "trajectory_id": walk.trajectory_id,
        "rgb": walk.rgb,
        "depth": walk.depth,
        "world_from_camera": poses,
        "pixel_goals": goals,
    })
}

/// The rows of a pose, rounded.
fn rows_of(pose: DMat4) -> [[f64; 4]; 4] {
    // No -0, which would be written as such.
    pose.transpose().to_cols_array_2d().map(|row| row.map(|part| (part * POSE_PARTS).round() / POSE_PARTS + 0.0))
}

/// Reads a camera's `pictures.jsonl`.
///
/// # Errors
/// When the file cannot be read, or a line breaks a rule; the error names line and field.
pub fn read_camera_walks(file: &Path) -> Result<Vec<CameraWalk>, FormatError> {
    let mut walks = Vec::new();
    input::each_line(file, |mut item| {
        walks.push(take_camera_walk(&mut item)?);
        Ok(())
    })?;
    Ok(walks)
}

fn take_camera_walk(item: &mut DatasetItem<'_>) -> Result<CameraWalk, FormatError> {
    let format = item.take_field("format")?;
    if item.checked_text("format", &format)? != PICTURES_FORMAT {
        let problem = format!("expected {PICTURES_FORMAT:?}, found {format}");
        return Err(item.wrong_field("format", problem, "read it with the version of Wayword that wrote it"));
    }
    let id = item.take_field("trajectory_id")?;
    let trajectory_id = item.checked_name("trajectory_id", &id)?;
    item.set_id(&trajectory_id);
    let rgb = item.take_field("rgb")?;
    let rgb = take_picture_set(item, "rgb", rgb)?;
    let depth = item.take_field("depth")?;
    let depth = take_picture_set(item, "depth", depth)?;
    let poses = item.take_field("world_from_camera")?;
    item.checked_list("world_from_camera", &poses, MAX_PICTURES)?;
    let rows: Vec<[[f64; 4]; 4]> = item.parse_value("world_from_camera", poses)?;
    let world_from_camera = rows.iter().map(|rows| DMat4::from_cols_array_2d(rows).transpose()).collect::<Vec<_>>();
    let goals = item.take_field("pixel_goals")?;
    let goals: Vec<Option<([u32; 2], usize)>> = item.parse_value("pixel_goals", goals)?;
    if goals.len() != world_from_camera.len() || world_from_camera.iter().any(|pose| !pose.is_finite()) {
        let problem = format!("expected {} entries, one for each pose, found {}", world_from_camera.len(), goals.len());
        return Err(item.wrong_field("pixel_goals", problem, "write a goal or null for each action"));
    }
    let is_later = |(at, goal): &(usize, &Option<([u32; 2], usize)>)| {
        goal.is_none_or(|(_, step)| step > *at && step < world_from_camera.len())
    };
    if let Some((at, _)) = goals.iter().enumerate().find(|entry| !is_later(entry)) {
        let problem = "it is no later action of the walk";
        return Err(item.wrong_field(&format!("pixel_goals[{at}]"), problem, "count actions from 0"));
    }
    let pixel_goals = goals.into_iter().map(|goal| goal.map(|(pixel, step)| PixelGoal { pixel, step })).collect();
    Ok(CameraWalk { trajectory_id, world_from_camera, rgb, depth, pixel_goals })
}
