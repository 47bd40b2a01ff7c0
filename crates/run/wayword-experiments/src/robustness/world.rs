//! Makes the changed world of an arm: an altered platform, or a changed path through the same one.

use super::arm::Arm;
use wayword_core::{Path, Platform};
use wayword_robustness::{
    Change, Dose, Whole,
    paths::{self, ChangedPath},
    worlds::{
        Alter, Altered, CameraHeight, FieldOfView, HeadingNoise, Mirror, PictureChange, QuarterTurn, Tilt, TiltError,
    },
};

/// A world with a path through it.
pub(super) struct World<'a> {
    pub(super) platform: Box<dyn Platform + 'a>,
    pub(super) path: Path,
    /// For each frame of the path, the index of the corresponding frame of the run's path.
    pub(super) base_frame_of: Vec<usize>,
}

/// The height of the eye above the floor on the platforms' paths, metres.
const EYE_M: f64 = 1.5;

/// The world of an arm for a path; the reason as an error if it cannot be made.
pub(super) fn of<'a>(arm: &Arm, platform: &'a dyn Platform, path: &Path, seed: u64) -> Result<World<'a>, String> {
    let walked =
        |ChangedPath { path, base_frame_of }: ChangedPath| World { platform: Box::new(platform), path, base_frame_of };
    let change = match arm {
        Arm::Changed(change) => change,
        Arm::Forward => return Ok(walked(paths::along(path))),
        _ => return Err("the world is not changed".to_owned()),
    };
    Ok(match change {
        Change::Whole(Whole::Mirror) => altered(platform, Mirror, path),
        Change::Whole(Whole::Turn) => altered(platform, QuarterTurn, path),
        Change::Whole(Whole::Reverse) => walked(paths::reversed(path)),
        Change::By(Dose::CameraHeight, height_m) => {
            altered(platform, CameraHeight { height_m: *height_m, eye_m: EYE_M }, path)
        }
        Change::By(Dose::FieldOfView, deg) => altered(platform, FieldOfView { deg: *deg }, path),
        Change::By(Dose::HeadingNoise, deg) => altered(platform, HeadingNoise { deg: *deg, seed }, path),
        Change::By(Dose::FrameSpacing, spacing_m) => walked(paths::spaced(path, *spacing_m)),
        Change::By(Dose::DroppedFrames, percent) => walked(paths::dropped(path, *percent, seed)),
        Change::By(Dose::StartHeading, deg) => walked(paths::start_heading(path, *deg)),
        Change::By(Dose::Pitch, deg) => tilted(platform, path, Tilt::new(*deg, 0.0))?,
        Change::By(Dose::Roll, deg) => tilted(platform, path, Tilt::new(0.0, *deg))?,
        other => match pixels(other, seed) {
            Some(pixels) => altered(platform, pixels, path),
            None => return Err("the world is not changed".to_owned()),
        },
    })
}

fn tilted<'a>(platform: &'a dyn Platform, path: &Path, tilt: Result<Tilt, TiltError>) -> Result<World<'a>, String> {
    tilt.map(|tilt| altered(platform, tilt, path)).map_err(|error| error.to_string())
}

/// The change of pictures that a dose of blur, noise and the like means; `None` for other changes.
fn pixels(change: &Change, seed: u64) -> Option<PictureChange> {
    let Change::By(dose, value) = *change else { return None };
    Some(match dose {
        Dose::Exposure => PictureChange::Exposure { stops: value },
        Dose::ColourTemperature => PictureChange::ColourTemperature { kelvin: value },
        Dose::Blur => PictureChange::Blur { sigma_px: value },
        Dose::Noise => PictureChange::Noise { percent: value, seed },
        Dose::JpegQuality => PictureChange::Jpeg { quality_percent: value as u8 },
        _ => return None,
    })
}

fn altered<'a, A: Alter + 'a>(platform: &'a dyn Platform, alter: A, path: &Path) -> World<'a> {
    let path = alter.path_after(path.clone());
    World { base_frame_of: (0..path.frames.len()).collect(), path, platform: Box::new(Altered::new(platform, alter)) }
}
