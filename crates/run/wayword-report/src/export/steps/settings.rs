//! The settings of an export of trajectories. They are stored in the folder: a repeated command continues only if they are the same.

use crate::export::steps_args::AskedSteps;
use serde::{Deserialize, Serialize};
use wayword_habitat::walk::AgentGait;
use wayword_run::{error::CommandError, own_format::OwnFormat};

/// The allowed lengths of the sides of pictures, pixels.
const PICTURE_SIDE_RANGE_PX: std::ops::RangeInclusive<u32> = 16..=4096;

/// Most walks in a shard, because the pictures of a shard are in memory before it is written. More are refused.
const MAX_SHARD_WALKS: usize = 500;

/// The agent's gait and camera, and the way in which pictures are stored.
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
    /// Height of the camera over the floor, metres.
    pub(super) eye_m: f64,
    /// Quality of the JPEG files, percent.
    pub(super) jpeg_quality: u8,
    /// Walks in a shard; no shards where it is missing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) shard: Option<usize>,
    /// SHA-256 of the texts, their walks and their splits.
    pub(super) texts: String,
}

impl OwnFormat for StepExportSettings {
    const NAME: &str = "wayword-steps/1";
}

impl StepExportSettings {
    /// The settings from the flags; defaults are VLN-CE's gait, and pictures as its agents see them.
    pub(super) fn from_flags(asked: &AskedSteps, texts: String) -> Result<Self, CommandError> {
        let gait = AgentGait::default();
        let [width_px, height_px] = asked.size_px.as_deref().map_or(Ok([224, 224]), parse_size)?;
        let steps = Self {
            forward_m: asked.forward_m.unwrap_or(gait.forward_m()),
            turn_deg: asked.turn_deg.unwrap_or(gait.turn_deg()),
            tolerance_m: asked.tolerance_m.unwrap_or(0.25),
            width_px,
            height_px,
            fov_deg: asked.fov_deg.unwrap_or(90.0),
            eye_m: asked.eye_m.unwrap_or(wayword_habitat::axes::EYE_M),
            jpeg_quality: 90,
            shard: asked.shard,
            texts,
        };
        steps.check_ranges()?;
        Ok(steps)
    }

    fn check_ranges(&self) -> Result<(), CommandError> {
        self.gait()?;
        let within = |flag: &str, value: f64, low: f64, high: f64| {
            let fits = (low..=high).contains(&value);
            let wrong =
                || CommandError::usage(format!("{flag} {value}"), format!("give a number from {low} to {high}"));
            if fits { Ok(()) } else { Err(wrong()) }
        };
        within("--tolerance-m", self.tolerance_m, 0.05, 2.0)?;
        within("--fov-deg", self.fov_deg, 10.0, 140.0)?;
        within("--eye-m", self.eye_m, 0.1, 2.2)?;
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
        StepExportSettings::from_flags(&asked, String::new())
    }

    #[test]
    fn without_flags_steps_are_vln_ces() {
        let steps = of(|_| ()).unwrap();
        assert_eq!((steps.forward_m, steps.turn_deg, steps.width_px, steps.fov_deg), (0.25, 15.0, 224, 90.0));
        assert_eq!(of(|asked| asked.size_px = Some("640x480".into())).unwrap().height_px, 480);
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
