//! What a camera sees along a walk: pictures, depths, poses, and the goals that each picture shows.

use crate::walking::WalkingScenes;
use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};
use wayword_core::{DMat4, DVec3, Image};
use wayword_formats::{
    habitat::habitat_from_wayword,
    trajectories::{ActionTrajectory, CameraIntrinsics, DEPTH_PER_M, PictureKind, PixelGoal},
};
use wayword_render::{PinholeCamera, RenderedPicture};
use wayword_run::{error::CommandError, pictures::encode_jpeg};

/// A goal is seen if its pixel shows a place this near to it, metres, or nearer than the pixel is wide there. Rounding of the depth picture
/// stays below the rest to [`super::replay`]'s bound.
const SAME_PLACE_M: f64 = 0.098;
/// Positions nearer together than this are one, metres.
const SAME_POSITION_M: f64 = 1e-3;

/// What a camera sees along a walk.
pub(super) struct DrawnWalk {
    pub(super) rgb: Vec<Vec<u8>>,
    pub(super) depth: Vec<Vec<u8>>,
    pub(super) world_from_camera: Vec<DMat4>,
    pub(super) pixel_goals: Vec<Option<PixelGoal>>,
}

impl DrawnWalk {
    /// The pictures by kind.
    pub(super) fn kinds(&self) -> [(PictureKind, &[Vec<u8>]); 2] {
        [(PictureKind::Rgb, &self.rgb), (PictureKind::Depth, &self.depth)]
    }
}

/// Draws what a camera sees before each action of a walk.
pub(super) fn draw_walk(
    scenes: &WalkingScenes,
    camera: &CameraIntrinsics,
    jpeg_quality: u8,
    trajectory: &ActionTrajectory,
) -> Result<DrawnWalk, CommandError> {
    let count = trajectory.actions.len();
    let mut drawn = DrawnWalk {
        rgb: Vec::with_capacity(count),
        depth: Vec::with_capacity(count),
        world_from_camera: Vec::with_capacity(count),
        pixel_goals: Vec::with_capacity(count),
    };
    for step in 0..count {
        let pinhole = pinhole_at(camera, trajectory, step);
        let picture = scenes.render_camera(&trajectory.scene, &pinhole, true)?;
        drawn.pixel_goals.push(find_goal(camera, &pinhole, &picture, trajectory, step));
        drawn.world_from_camera.push(habitat_from_optical(&pinhole));
        drawn.depth.push(encode_depth(&picture)?);
        let image = Image::new(picture.width, picture.height, picture.rgb).map_err(|error| not_encoded(&error))?;
        drawn.rgb.push(encode_jpeg(&image, jpeg_quality).map_err(|error| not_encoded(&error))?);
    }
    Ok(drawn)
}

/// The camera as it stands before an action.
pub(super) fn pinhole_at(camera: &CameraIntrinsics, trajectory: &ActionTrajectory, step: usize) -> PinholeCamera {
    PinholeCamera {
        position: trajectory.positions[step] + DVec3::Z * camera.height_m,
        heading_rad: trajectory.headings[step].rad(),
        elevation_rad: camera.pitch_deg.to_radians(),
        vertical_fov_rad: 2.0 * libm::atan(0.5 * f64::from(camera.height_px) / camera.focal_px),
        width: camera.width_px,
        height: camera.height_px,
    }
}

/// The pose of a camera in Habitat's world; its own axes are x right, y down, z ahead.
fn habitat_from_optical(pinhole: &PinholeCamera) -> DMat4 {
    let world_from_camera = pinhole.world_from_camera();
    let [right, down, ahead] = [world_from_camera.x_axis, -world_from_camera.y_axis, -world_from_camera.z_axis];
    let [right, down, ahead, eye] = [right, down, ahead, pinhole.position].map(habitat_from_wayword);
    DMat4::from_cols(right.extend(0.0), down.extend(0.0), ahead.extend(0.0), eye.extend(1.0))
}

/// The farthest later position of the walk that the picture shows, at its place on the floor.
fn find_goal(
    camera: &CameraIntrinsics,
    pinhole: &PinholeCamera,
    picture: &RenderedPicture,
    trajectory: &ActionTrajectory,
    step: usize,
) -> Option<PixelGoal> {
    let is_same = |a: usize, b: usize| trajectory.positions[a].distance(trajectory.positions[b]) < SAME_POSITION_M;
    let later = (step + 1..trajectory.positions.len()).rev();
    // The agent turns on the spot; the first of these actions is when it comes there.
    let arrivals = later.filter(|later| !is_same(*later - 1, *later) && !is_same(step, *later));
    arrivals
        .filter_map(|later| Some((seen_pixel(camera, pinhole, picture, trajectory.floor_position(later)?)?, later)))
        .map(|(pixel, step)| PixelGoal { pixel, step })
        .next()
}

/// The pixel that shows a place on the floor; `None` if it is not in the picture, or something hides it.
fn seen_pixel(
    camera: &CameraIntrinsics,
    pinhole: &PinholeCamera,
    picture: &RenderedPicture,
    floor: DVec3,
) -> Option<[u32; 2]> {
    let world_from_camera = pinhole.world_from_camera();
    let offset = world_from_camera.transpose() * (floor - pinhole.position);
    let pixel = camera.pixel_of(DVec3::new(offset.x, -offset.y, -offset.z))?;
    let depth_m = f64::from(*picture.depth_m.get((pixel[1] * picture.width + pixel[0]) as usize)?);
    let ray = camera.ray_through(pixel);
    let seen = pinhole.position + world_from_camera * (DVec3::new(ray.x, -ray.y, -ray.z) * depth_m);
    let footprint_m = depth_m / camera.focal_px;
    (seen.distance(floor) <= SAME_PLACE_M.max(footprint_m)).then_some(pixel)
}

/// Depths as a PNG file of 16 bits.
fn encode_depth(picture: &RenderedPicture) -> Result<Vec<u8>, CommandError> {
    // The cast gives 0 for what is not a number; what lies too far or is background becomes 0 too.
    let millimetres = |depth_m: &f32| {
        let scaled = (depth_m * DEPTH_PER_M as f32).round();
        if scaled <= f32::from(u16::MAX) { scaled as u16 } else { 0 }
    };
    let pixels: Vec<u16> = picture.depth_m.iter().map(millimetres).collect();
    encode_png16(&pixels, [picture.width, picture.height], CompressionType::Default)
}

/// Writes a picture of 16 bits as a PNG file.
pub(in crate::export) fn encode_png16(
    pixels: &[u16],
    [width, height]: [u32; 2],
    compression: CompressionType,
) -> Result<Vec<u8>, CommandError> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_ne_bytes()).collect();
    let mut png = Vec::new();
    PngEncoder::new_with_quality(&mut png, compression, FilterType::Paeth)
        .write_image(&bytes, width, height, ExtendedColorType::L16)
        .map_err(|error| not_encoded(&error))?;
    Ok(png)
}

fn not_encoded(error: &dyn std::error::Error) -> CommandError {
    CommandError::usage(format!("a picture cannot be written: {error}"), "report this as a bug")
}
