//! Makes the changed world of an arm: an altered platform, or a changed path through the same one.

use super::arm::RobustnessArm;
use wayword_core::{Path, Platform};
use wayword_robustness::{
    Change, DoseKind, WholeChange,
    paths::{self, ChangedPath},
    worlds::{
        AlteredPlatform, CameraHeight, CameraTilt, FieldOfView, HeadingNoise, PictureChange, QuarterTurn, TiltError,
        WorldAlteration, WorldMirror,
    },
};

/// A world with a path through it.
pub(super) struct ChangedWorld<'a> {
    pub(super) platform: Box<dyn Platform + 'a>,
    pub(super) path: Path,
    /// For each frame of the path, the index of the corresponding frame of the run's path.
    pub(super) base_frame_of: Vec<usize>,
}

/// The height of the eye above the floor on the platforms' paths, metres.
const EYE_M: f64 = 1.5;

/// The world of an arm for a path; the reason as an error if it cannot be made.
pub(super) fn world_for_arm<'a>(
    arm: &RobustnessArm,
    platform: &'a dyn Platform,
    path: &Path,
    seed: u64,
) -> Result<ChangedWorld<'a>, String> {
    let same_platform = |ChangedPath { path, base_frame_of }: ChangedPath| ChangedWorld {
        platform: Box::new(platform),
        path,
        base_frame_of,
    };
    let change = match arm {
        RobustnessArm::Changed(change) => change,
        RobustnessArm::Forward => return Ok(same_platform(paths::face_first_hop(path))),
        _ => return Err("the world is not changed".to_owned()),
    };
    Ok(match change {
        Change::Whole(WholeChange::Mirror) => altered_world(platform, WorldMirror, path),
        Change::Whole(WholeChange::Turn) => altered_world(platform, QuarterTurn, path),
        Change::Whole(WholeChange::Reverse) => same_platform(paths::reverse_path(path)),
        Change::By(DoseKind::CameraHeight, height_m) => {
            altered_world(platform, CameraHeight { height_m: *height_m, eye_m: EYE_M }, path)
        }
        Change::By(DoseKind::FieldOfView, deg) => altered_world(platform, FieldOfView { deg: *deg }, path),
        Change::By(DoseKind::HeadingNoise, deg) => altered_world(platform, HeadingNoise { deg: *deg, seed }, path),
        Change::By(DoseKind::FrameSpacing, spacing_m) => same_platform(paths::space_frames(path, *spacing_m)),
        Change::By(DoseKind::DroppedFrames, percent) => same_platform(paths::drop_frames(path, *percent, seed)),
        Change::By(DoseKind::StartHeading, deg) => same_platform(paths::turn_start_heading(path, *deg)),
        Change::By(DoseKind::Pitch, deg) => tilted_world(platform, path, CameraTilt::new(*deg, 0.0))?,
        Change::By(DoseKind::Roll, deg) => tilted_world(platform, path, CameraTilt::new(0.0, *deg))?,
        other => match pixel_change(other, seed) {
            Some(pixels) => altered_world(platform, pixels, path),
            None => return Err("the world is not changed".to_owned()),
        },
    })
}

fn tilted_world<'a>(
    platform: &'a dyn Platform,
    path: &Path,
    tilt: Result<CameraTilt, TiltError>,
) -> Result<ChangedWorld<'a>, String> {
    tilt.map(|tilt| altered_world(platform, tilt, path)).map_err(|error| error.to_string())
}

/// The change of pictures that a dose of blur, noise and the like means; `None` for other changes.
fn pixel_change(change: &Change, seed: u64) -> Option<PictureChange> {
    let Change::By(dose, value) = *change else { return None };
    Some(match dose {
        DoseKind::Exposure => PictureChange::Exposure { stops: value },
        DoseKind::ColourTemperature => PictureChange::ColourTemperature { kelvin: value },
        DoseKind::Blur => PictureChange::Blur { sigma_px: value },
        DoseKind::Noise => PictureChange::Noise { percent: value, seed },
        DoseKind::JpegQuality => PictureChange::Jpeg { quality_percent: value as u8 },
        _ => return None,
    })
}

fn altered_world<'a, A: WorldAlteration + 'a>(platform: &'a dyn Platform, alter: A, path: &Path) -> ChangedWorld<'a> {
    let path = alter.path_after(path.clone());
    ChangedWorld {
        base_frame_of: (0..path.frames.len()).collect(),
        path,
        platform: Box::new(AlteredPlatform::new(platform, alter)),
    }
}
