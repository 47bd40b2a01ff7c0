//! The settings of an export of trajectories. They are stored in the folder: a repeated command continues only if they are the same.
//! Cameras are not among them, because more of them can be added to a folder.

use crate::export::steps_args::AskedSteps;
use serde::{Deserialize, Serialize};
use wayword_formats::trajectories::CameraIntrinsics;
use wayword_habitat::walk::AgentGait;
use wayword_run::{error::CommandError, own_format::OwnFormat};

/// The allowed lengths of the sides of pictures, pixels.
const PICTURE_SIDE_RANGE_PX: std::ops::RangeInclusive<u32> = 16..=4096;

/// Most walks in a shard, because the pictures of a shard are in memory before it is written. More are refused.
const MAX_SHARD_WALKS: usize = 500;

/// The agent's gait, the size of pictures, and the way in which they are stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StepExportSettings {
    pub(super) forward_m: f64,
    pub(super) turn_deg: f64,
    /// How far a step may end off the walk, metres.
    pub(super) tolerance_m: f64,
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    /// Horizontal field of view of the pictures, degrees.
    pub(super) fov_deg: f64,
    /// Quality of the JPEG files, percent.
    pub(super) jpeg_quality: u8,
    /// Walks in a shard; no shards where it is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) shard: Option<usize>,
}

impl OwnFormat for StepExportSettings {
    const NAME: &str = "wayword-steps/2";
}

impl StepExportSettings {
    /// The settings from the flags; defaults are VLN-CE's gait, and pictures as its agents see them.
    pub(super) fn from_flags(asked: &AskedSteps) -> Result<Self, CommandError> {
        let gait = AgentGait::default();
        let [width_px, height_px] = asked.size_px.as_deref().map_or(Ok([224, 224]), parse_size)?;
        let steps = Self {
            forward_m: asked.forward_m.unwrap_or(gait.forward_m()),
            turn_deg: asked.turn_deg.unwrap_or(gait.turn_deg()),
            tolerance_m: asked.tolerance_m.unwrap_or(0.25),
            width_px,
            height_px,
            fov_deg: asked.fov_deg.unwrap_or(90.0),
            jpeg_quality: 90,
            shard: asked.shard,
        };
        steps.check_ranges()?;
        Ok(steps)
    }

    fn check_ranges(&self) -> Result<(), CommandError> {
        self.gait()?;
        expect_within("--tolerance-m", self.tolerance_m, 0.05, 2.0)?;
        expect_within("--fov-deg", self.fov_deg, 10.0, 140.0)?;
        if let Some(shard) = self.shard.filter(|shard| !(1..=MAX_SHARD_WALKS).contains(shard)) {
            let hint = format!("give the number of walks in a shard, from 1 to {MAX_SHARD_WALKS}, as in --shard 100");
            return Err(CommandError::usage(format!("--shard {shard}"), hint));
        }
        Ok(())
    }

    /// The length of the agent's step and the angle of its turn.
    pub(super) fn gait(&self) -> Result<AgentGait, CommandError> {
        AgentGait::new(self.forward_m, self.turn_deg)
            .map_err(|error| CommandError::usage(error.to_string(), "see --forward-m and --turn-deg"))
    }

    /// Refuses another gait than the words of a layout mean: length of a step, metres, and angle of a turn, degrees.
    pub(super) fn expect_gait(&self, meant: Option<[f64; 2]>) -> Result<(), CommandError> {
        let Some([forward_m, turn_deg]) = meant else { return Ok(()) };
        if self.forward_m == forward_m && self.turn_deg == turn_deg {
            return Ok(());
        }
        let problem = format!(
            "the words of this layout mean steps of {forward_m} m and turns of {turn_deg} degrees, and the steps have {} m and {} degrees",
            self.forward_m, self.turn_deg
        );
        Err(CommandError::usage(
            problem,
            "leave --forward-m and --turn-deg out, and give another --steps if you gave one",
        ))
    }

    /// The camera of a height and a pitch.
    fn camera(&self, height_m: f64, pitch_deg: f64) -> CameraIntrinsics {
        let [width, height] = [self.width_px, self.height_px].map(f64::from);
        CameraIntrinsics {
            height_m,
            pitch_deg,
            width_px: self.width_px,
            height_px: self.height_px,
            focal_px: 0.5 * width / libm::tan(0.5 * self.fov_deg.to_radians()),
            centre_px: [0.5 * width, 0.5 * height],
        }
    }

    /// The cameras that the user asked for with `--camera`, or else these: heights in metres and pitches in degrees.
    pub(super) fn cameras(&self, asked: &[String], usual: &[[f64; 2]]) -> Result<Vec<CameraIntrinsics>, CommandError> {
        let stances = if asked.is_empty() {
            usual.to_vec()
        } else {
            asked.iter().map(|typed| parse_stance(typed)).collect::<Result<Vec<_>, _>>()?
        };
        let mut cameras: Vec<CameraIntrinsics> = Vec::new();
        for [height_m, pitch_deg] in stances {
            let camera = self.camera(height_m, pitch_deg);
            if cameras.iter().all(|known| known.name() != camera.name()) {
                cameras.push(camera);
            }
        }
        Ok(cameras)
    }
}

impl AskedSteps {
    /// The flags, with the settings of a folder where they leave something open.
    pub(super) fn with_defaults_from(&self, before: Option<&StepExportSettings>) -> Self {
        let Some(before) = before else { return self.clone() };
        let size_px = format!("{}x{}", before.width_px, before.height_px);
        Self {
            forward_m: self.forward_m.or(Some(before.forward_m)),
            turn_deg: self.turn_deg.or(Some(before.turn_deg)),
            tolerance_m: self.tolerance_m.or(Some(before.tolerance_m)),
            size_px: self.size_px.clone().or(Some(size_px)),
            fov_deg: self.fov_deg.or(Some(before.fov_deg)),
            shard: self.shard.or(before.shard),
            ..self.clone()
        }
    }
}

fn expect_within(flag: &str, value: f64, low: f64, high: f64) -> Result<(), CommandError> {
    let fits = (low..=high).contains(&value);
    let wrong = || CommandError::usage(format!("{flag} {value}"), format!("give a number from {low} to {high}"));
    if fits { Ok(()) } else { Err(wrong()) }
}

/// Reads `1.25,-30`: height in metres, pitch in degrees. They are rounded to whole centimetres and degrees, which name the camera.
fn parse_stance(typed: &str) -> Result<[f64; 2], CommandError> {
    let numbers = typed.split_once(',').and_then(|(height, pitch)| Some([height.parse().ok()?, pitch.parse().ok()?]));
    let Some([height_m, pitch_deg]): Option<[f64; 2]> = numbers else {
        let hint = "give height in metres and pitch in degrees: --camera 1.25,-30 looks down by 30 degrees";
        return Err(CommandError::usage(format!("--camera {typed}"), hint));
    };
    expect_within("--camera: height", height_m, 0.1, 2.2)?;
    expect_within("--camera: pitch", pitch_deg, -60.0, 0.0)?;
    Ok([(100.0 * height_m).round() / 100.0, pitch_deg.round() + 0.0])
}

fn parse_size(typed: &str) -> Result<[u32; 2], CommandError> {
    let sides = typed.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.filter(|sides| sides.iter().all(|side| PICTURE_SIDE_RANGE_PX.contains(side))).ok_or_else(|| {
        CommandError::usage(
            format!("--size-px {typed}"),
            "give width and height in pixels, each from 16 to 4096: 224x224",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(change: impl FnOnce(&mut AskedSteps)) -> Result<StepExportSettings, CommandError> {
        let mut asked = AskedSteps::default();
        change(&mut asked);
        StepExportSettings::from_flags(&asked)
    }

    #[test]
    fn without_flags_steps_are_vln_ces() {
        let steps = of(|_| ()).unwrap();
        assert_eq!((steps.forward_m, steps.turn_deg, steps.width_px, steps.fov_deg), (0.25, 15.0, 224, 90.0));
        assert_eq!(of(|asked| asked.size_px = Some("640x480".into())).unwrap().height_px, 480);
    }

    #[test]
    fn cameras_are_named_by_height_and_pitch_and_occur_once() {
        let steps = of(|_| ()).unwrap();
        let names = |asked: &[&str]| {
            let asked: Vec<String> = asked.iter().map(|&typed| typed.to_owned()).collect();
            steps
                .cameras(&asked, &[[1.25, 0.0]])
                .map(|cameras| cameras.iter().map(CameraIntrinsics::name).collect::<Vec<_>>())
        };
        assert_eq!(names(&[]).unwrap(), ["125cm_0deg"]);
        assert_eq!(names(&["0.6,-30", "1.25,0", "0.6,-30.2"]).unwrap(), ["60cm_30deg", "125cm_0deg"]);
        for (typed, told) in [("1.25", "--camera 1.25"), ("9,0", "--camera: height 9"), ("1,20", "--camera: pitch 20")]
        {
            assert!(names(&[typed]).unwrap_err().to_string().contains(told));
        }
    }

    #[test]
    fn a_quarter_view_has_a_focal_length_of_half_its_width() {
        let camera = of(|_| ()).unwrap().camera(1.25, -30.0);
        assert!((camera.focal_px - 112.0).abs() < 1e-9 && camera.centre_px == [112.0, 112.0]);
    }

    #[test]
    fn flags_that_make_no_sense_are_refused_by_name() {
        let told = |change: fn(&mut AskedSteps)| of(change).unwrap_err().to_string();
        assert!(told(|asked| asked.turn_deg = Some(50.0)).contains("a turn of 50 degrees"));
        assert!(told(|asked| asked.forward_m = Some(0.0)).contains("a step of 0 m"));
        assert!(told(|asked| asked.tolerance_m = Some(f64::NAN)).contains("--tolerance-m NaN"));
        assert!(told(|asked| asked.fov_deg = Some(180.0)).contains("--fov-deg 180"));
        assert!(told(|asked| asked.size_px = Some("9x9".into())).contains("--size-px 9x9"));
        assert!(told(|asked| asked.shard = Some(0)).contains("--shard 0"));
    }
}
