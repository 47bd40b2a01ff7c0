//! Refuses changes that would have no effect, or cannot be made, on the platform and with the observer of a run, and explains why.

use super::{Change, DoseKind, WholeChange};

/// Mean distance between viewpoints of Matterport3D, metres (Chang et al., "Matterport3D", 2017).
const VIEWPOINT_SPACING_M: f64 = 2.25;
/// Distance between the frames that are chosen from a recording, metres.
const RECORDED_FRAME_SPACING_M: f64 = 1.0;

/// Who names the things in a view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum SightSource {
    /// The platform's labels.
    Labels,
    /// A scripted eye. Its recall is a fixed function of the dose.
    Eye,
    /// A model that gets the pictures.
    Pictures,
}

/// The run for which a change is requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChangeSetting<'a> {
    /// The platform's name.
    pub platform: &'a str,
    /// Who names the things in its views.
    pub sees: SightSource,
    /// Whether the frames of the platform's paths have poses.
    pub has_poses: bool,
    /// Whether the platform can render a view from any pose, and is not limited to existing pictures.
    pub can_render: bool,
    /// Whether the platform has views only from the viewpoints of a graph, but in all directions from each.
    pub is_graph_bound: bool,
}

impl Change {
    /// Why the change cannot be used for this run, in one sentence; `None` if it can.
    #[must_use]
    pub fn refusal_reason(&self, setting: &ChangeSetting<'_>) -> Option<String> {
        let why = match self {
            Self::Platform(spec) => OtherPlatform::from_spec(spec).refusal_reason(setting),
            Self::Whole(whole) => whole.refusal_reason(setting),
            Self::By(dose, value) => dose.refusal_reason(*value, setting),
        };
        why.map(|why| format!("{self} means nothing here: {why}"))
    }
}

/// Another platform as a change names it: `NAME[:DATA][@ADDRESS]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OtherPlatform<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its folder or file of data, behind `:`.
    pub data: Option<&'a str>,
    /// Its address, behind `@`, if it is already running.
    pub address: Option<&'a str>,
}

impl<'a> OtherPlatform<'a> {
    /// Splits the text behind `platform=`.
    #[must_use]
    pub fn from_spec(spec: &'a str) -> Self {
        let (rest, at) = spec.split_once('@').map_or((spec, None), |(rest, at)| (rest, Some(at)));
        let (name, data) = rest.split_once(':').map_or((rest, None), |(name, data)| (name, Some(data)));
        Self { name, data, address: at }
    }

    fn refusal_reason(&self, setting: &ChangeSetting<'_>) -> Option<String> {
        let Self { name, data, address: at } = *self;
        let is_house = setting.platform == "house";
        Some(match name {
            _ if !setting.has_poses => {
                "the frames have no poses, so nobody knows where they are on another platform".to_owned()
            }
            _ if name == setting.platform && data.is_none() && at.is_none() => "the run was made there".to_owned(),
            "recording" if setting.sees == SightSource::Labels => {
                "a recording has no labels; a scripted eye (--eye) or a model has to see".to_owned()
            }
            "recording" if data.is_some() => "the run's own paths are filmed; leave out the data".to_owned(),
            "recording" if !setting.can_render => "the platform has no pictures along the paths to film".to_owned(),
            "habitat" if data.is_none() && !is_house => {
                "only generated houses are saved for it; name the data of the same scenes, as in habitat:DIR".to_owned()
            }
            "process" | "matterport" if data.is_none() => {
                format!("name its data, with the same scenes and the same axes, as in {name}:PATH")
            }
            "house" => "its homes are generated, and none of them is this scene".to_owned(),
            _ => return None,
        })
    }
}

impl WholeChange {
    fn refusal_reason(self, setting: &ChangeSetting<'_>) -> Option<String> {
        match self {
            Self::Mirror | Self::Turn | Self::Reverse if !setting.has_poses => Some(no_poses_reason("directions", setting)),
            Self::Reverse if setting.is_recorded() => {
                Some(format!("platform {} has no pictures of the way back", setting.platform))
            }
            Self::Remove | Self::Add | Self::Material if setting.sees == SightSource::Pictures => Some(
                "it changes what is listed and not the pictures, which are what the model sees; use labels or the scripted eye"
                    .to_owned(),
            ),
            _ => None,
        }
    }
}

impl DoseKind {
    fn refusal_reason(self, value: f64, setting: &ChangeSetting<'_>) -> Option<String> {
        match self {
            Self::CameraHeight | Self::FieldOfView | Self::Pitch | Self::Roll => (!setting.can_render).then(|| {
                format!(
                    "the pictures of platform {} were taken before, by a camera that is as it was",
                    setting.platform
                )
            }),
            Self::Exposure | Self::ColourTemperature | Self::Blur | Self::Noise | Self::JpegQuality => (setting.sees
                == SightSource::Labels)
                .then(|| "it changes the pictures, and labels are not read from pictures".to_owned()),
            Self::DroppedFrames => None,
            Self::FrameSpacing if !setting.has_poses => Some(no_poses_reason("distances", setting)),
            Self::FrameSpacing => setting.spacing_refusal(value),
            Self::HeadingNoise | Self::StartHeading if !setting.has_poses => Some(no_poses_reason("headings", setting)),
            Self::StartHeading if setting.is_recorded() => {
                Some(format!("platform {} has no pictures of other directions", setting.platform))
            }
            Self::HeadingNoise | Self::StartHeading => None,
        }
    }
}

impl ChangeSetting<'_> {
    /// Whether the platform's pictures were taken one by one along a path, as in a recording.
    fn is_recorded(&self) -> bool {
        !self.can_render && !self.is_graph_bound
    }

    /// Why frames cannot be so close together; `None` if they can.
    fn spacing_refusal(&self, spacing_m: f64) -> Option<String> {
        let (own_m, from) = match (self.is_graph_bound, self.can_render) {
            (true, _) => (VIEWPOINT_SPACING_M, "viewpoints"),
            (false, false) => (RECORDED_FRAME_SPACING_M, "frames that were recorded"),
            (false, true) => return None,
        };
        (spacing_m < own_m).then(|| {
            format!(
                "platform {} has views only from {from}, about {own_m} m apart, so that frames can be left out but not put between",
                self.platform
            )
        })
    }
}

/// The reason for a refusal on a platform without poses: a quantity, such as headings, is not known there.
fn no_poses_reason(quantity: &str, setting: &ChangeSetting<'_>) -> String {
    format!("the frames of platform {} have no poses, so that no {quantity} of the path are known", setting.platform)
}
