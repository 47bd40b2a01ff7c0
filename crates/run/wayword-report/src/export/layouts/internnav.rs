//! InternNav's layouts: VLN-CE walks with pixel goals, and VLN-N1 with poses, depths of its own scale and obstacles.

use super::{LayoutPack, PackedCounts, PackedWalk, walks_by_scene, write_files};
use crate::export::steps::encode_png16;
use image::codecs::png::CompressionType;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};
use wayword_core::{DMat4, DVec3};
use wayword_formats::{
    habitat::wayword_from_habitat,
    training::internnav::{
        InternNavCamera, InternNavEpisode, VLN_N1_DEPTH_PER_M, VlnN1Episode, internnav_picture, vln_n1_picture,
        write_internnav_scene, write_vln_n1_scene,
    },
    trajectories::{CameraIntrinsics, CameraWalk, DEPTH_PER_M, PictureKind, SubInstruction, TrajectoryInstruction},
};
use wayword_run::{
    error::CommandError,
    in_order::{core_count, in_order},
    interrupt,
    output::CommandOutput,
};

/// Depths of 16 bits.
type DepthPicture = image::ImageBuffer<image::Luma<u16>, Vec<u16>>;

/// The folder between the split's and the scenes': VLN-N1's groups of scenes.
const VLN_N1_GROUP: &str = "wayword";
/// The loader skips walks with fewer actions.
const MIN_ACTIONS: usize = 4;
/// The loader of VLN-N1 crashes on walks with fewer rows.
const MIN_ROWS: usize = 3;
/// What stands this high over the floor is in the way, metres.
const OBSTACLE_HEIGHTS_M: std::ops::Range<f64> = 0.15..1.2;
/// Places in the way are kept once for each square of this side, metres.
const OBSTACLE_GRID_M: f64 = 0.05;
/// Each so-manieth pixel of a depth picture, in each direction, is looked at for places in the way.
const OBSTACLE_PIXELS: u32 = 8;
/// Farthest depth at which a place in the way is kept, metres.
const OBSTACLE_REACH_M: f64 = 5.0;

pub(super) fn pack_internnav(pack: &LayoutPack<'_>, output: &CommandOutput) -> Result<PackedCounts, CommandError> {
    warn_of_replaced_words(pack, output);
    let mut counts = PackedCounts::default();
    for (scene, walks) in walks_by_scene(pack) {
        interrupt::check_interrupt()?;
        let mut episodes = Vec::new();
        for walk in walks {
            if walk.trajectory.actions.len() < MIN_ACTIONS {
                counts.left_out += 1;
                continue;
            }
            let index = episodes.len();
            for (number, camera) in pack.cameras.iter().map(CameraIntrinsics::name).enumerate() {
                for (kind, ending) in [(PictureKind::Rgb, "jpg"), (PictureKind::Depth, "png")] {
                    let name = |picture| internnav_picture(index, kind.name(), &camera, picture, ending);
                    let pictures = pack.read_pictures(walk, number, kind)?;
                    let place = |picture| [scene.into(), name(picture)].iter().collect();
                    pack.place_pictures(walk, (number, kind), &pictures, place)?;
                }
            }
            let seen = pack.cameras.iter().zip(&walk.seen);
            episodes.push(InternNavEpisode {
                index,
                texts: walk.texts.iter().map(|text| text.text.clone()).collect(),
                actions: walk.trajectory.actions.clone(),
                cameras: seen.map(|(camera, seen)| camera_columns(camera, seen)).collect(),
            });
        }
        if !episodes.is_empty() {
            write_internnav_scene(&pack.folder.join(scene), &episodes)?;
        }
        counts.entries += episodes.iter().map(|episode| episode.texts.len()).sum::<usize>();
    }
    Ok(counts)
}

/// Warns if the loader would not find pictures: it makes one path from another by replacing these words wherever they stand in it.
fn warn_of_replaced_words(pack: &LayoutPack<'_>, output: &CommandOutput) {
    const REPLACED: [&str; 3] = ["rgb", ".jpg", "_0deg"];
    let place = fs::canonicalize(&pack.folder).unwrap_or_else(|_| pack.folder.clone()).display().to_string();
    let scenes = pack.walks.iter().map(|walk| walk.trajectory.scene.as_str());
    let mut names = std::iter::once(place.as_str()).chain(scenes);
    if let Some(name) = names.find(|name| REPLACED.iter().any(|word| name.contains(word))) {
        output.say(format_args!(
            "InternNav's loader replaces \"rgb\", \".jpg\" and \"_0deg\" in the whole path of a picture, and {name} has one of them: give the \
             folder or the scene another name"
        ));
    }
}

fn camera_columns(camera: &CameraIntrinsics, seen: &CameraWalk) -> InternNavCamera {
    let goal = |(step, goal): (usize, &Option<wayword_formats::trajectories::PixelGoal>)| {
        goal.map(|goal| (goal.pixel, goal.step - step))
    };
    InternNavCamera {
        name: camera.name(),
        world_from_camera: seen.world_from_camera.iter().map(|pose| wayword_pose(*pose)).collect(),
        goals: seen.pixel_goals.iter().enumerate().map(goal).collect(),
    }
}

/// A pose in Wayword's world (z up) instead of Habitat's.
fn wayword_pose(habitat_from_camera: DMat4) -> DMat4 {
    let axis = |column: usize| {
        let column = habitat_from_camera.col(column);
        wayword_from_habitat(column.truncate()).extend(column.w)
    };
    DMat4::from_cols(axis(0), axis(1), axis(2), axis(3))
}

pub(super) fn pack_vln_n1(pack: &LayoutPack<'_>, output: &CommandOutput) -> Result<PackedCounts, CommandError> {
    let mut counts = PackedCounts::default();
    let bar = output.progress_bar(pack.walks.len(), "walks");
    for (scene, walks) in walks_by_scene(pack) {
        let folder = Path::new(VLN_N1_GROUP).join(scene);
        let (walks, short): (Vec<_>, Vec<_>) =
            walks.into_iter().partition(|walk| walk.trajectory.actions.len() >= MIN_ROWS);
        counts.left_out += short.len();
        if walks.is_empty() {
            continue;
        }
        let longest = walks.iter().map(|walk| walk.trajectory.actions.len()).max().unwrap_or_default();
        // Pictures are found by the order of their names.
        let digits = longest.saturating_sub(1).to_string().len().max(3);
        let (mut episodes, mut obstacles) = (Vec::new(), ObstacleMap::default());
        in_order(
            &walks,
            core_count(),
            |walk| rescaled_depths(pack, walk),
            |walk, rescaled| {
                interrupt::check_interrupt()?;
                let (depths, found) = rescaled?;
                obstacles.squares.extend(found.squares);
                let rgb = pack.read_pictures(walk, 0, PictureKind::Rgb)?;
                for text in &walk.texts {
                    let index = episodes.len();
                    let name =
                        |kind, number, ending: &str| folder.join(vln_n1_picture(index, kind, number, digits, ending));
                    pack.place_pictures(walk, (0, PictureKind::Rgb), &rgb, |number| name("rgb", number, "jpg"))?;
                    let places: Vec<PathBuf> =
                        (0..depths.len()).map(|number| pack.folder.join(name("depth", number, "png"))).collect();
                    write_files(&places, &depths)?;
                    episodes.push(vln_n1_episode(&pack.cameras[0], walk, text, index));
                }
                bar.inc(1);
                Ok::<bool, CommandError>(true)
            },
        )?;
        counts.entries += episodes.len();
        write_vln_n1_scene(&pack.folder.join(&folder), &episodes, &obstacles.places())?;
    }
    bar.finish_and_clear();
    Ok(counts)
}

fn vln_n1_episode(
    camera: &CameraIntrinsics,
    walk: &PackedWalk<'_>,
    text: &TrajectoryInstruction,
    index: usize,
) -> VlnN1Episode {
    VlnN1Episode {
        index,
        text: text.text.clone(),
        parts: part_pictures(&text.sub_instructions, walk.trajectory.actions.len()),
        world_from_camera: walk.seen[0].world_from_camera.iter().map(|pose| wayword_pose(*pose)).collect(),
        focal_px: camera.focal_px,
        centre_px: camera.centre_px,
        height_m: camera.height_m,
        pitch_rad: camera.pitch_deg.to_radians(),
    }
}

/// The parts of a text, each with its first and its last picture: it ends before the next begins.
fn part_pictures(parts: &[SubInstruction], count: usize) -> Vec<(String, [usize; 2])> {
    let starts = parts.iter().skip(1).map(|part| part.steps[0]).chain([count]);
    parts.iter().zip(starts).map(|(part, next)| (part.text.clone(), [part.steps[0], next.saturating_sub(1)])).collect()
}

/// Squares of the ground in which something is in the way.
#[derive(Default)]
struct ObstacleMap {
    squares: BTreeSet<[i64; 3]>,
}

impl ObstacleMap {
    /// Adds what a depth picture shows in the way.
    fn add_picture(&mut self, camera: &CameraIntrinsics, walk: &PackedWalk<'_>, step: usize, depth: &DepthPicture) {
        let floor_m = walk.trajectory.floor_position(step).unwrap_or_default().z;
        let world_from_camera = wayword_pose(walk.seen[0].world_from_camera[step]);
        for (u, v, pixel) in depth.enumerate_pixels() {
            let depth_m = f64::from(pixel.0[0]) / DEPTH_PER_M;
            let is_looked_at = u % OBSTACLE_PIXELS == 0 && v % OBSTACLE_PIXELS == 0;
            if !is_looked_at || depth_m <= 0.0 || depth_m > OBSTACLE_REACH_M {
                continue;
            }
            let place = world_from_camera.transform_point3(camera.ray_through([u, v]) * depth_m);
            if OBSTACLE_HEIGHTS_M.contains(&(place.z - floor_m)) {
                self.squares.insert((place / OBSTACLE_GRID_M).floor().to_array().map(|part| part as i64));
            }
        }
    }

    fn places(&self) -> Vec<DVec3> {
        let middle = |square: &[i64; 3]| DVec3::from_array(square.map(|part| (part as f64 + 0.5) * OBSTACLE_GRID_M));
        self.squares.iter().map(middle).collect()
    }
}

/// The depth pictures of a walk in VLN-N1's scale, and what they show in the way.
fn rescaled_depths(pack: &LayoutPack<'_>, walk: &PackedWalk<'_>) -> Result<(Vec<Vec<u8>>, ObstacleMap), CommandError> {
    let (mut rescaled, mut obstacles) = (Vec::new(), ObstacleMap::default());
    for (step, png) in pack.read_pictures(walk, 0, PictureKind::Depth)?.iter().enumerate() {
        let depth = image::load_from_memory(png)
            .map_err(|error| {
                let problem = format!("a depth picture of the steps cannot be read: {error}");
                CommandError::usage(problem, "make the steps again")
            })?
            .into_luma16();
        obstacles.add_picture(&pack.cameras[0], walk, step, &depth);
        let scale = VLN_N1_DEPTH_PER_M / DEPTH_PER_M;
        // What is too far for 16 bits is unknown.
        let scaled = |value: &u16| u16::try_from((f64::from(*value) * scale) as u32).unwrap_or(0);
        let pixels: Vec<u16> = depth.as_raw().iter().map(scaled).collect();
        rescaled.push(encode_png16(&pixels, [depth.width(), depth.height()], CompressionType::Fast)?);
    }
    Ok((rescaled, obstacles))
}
