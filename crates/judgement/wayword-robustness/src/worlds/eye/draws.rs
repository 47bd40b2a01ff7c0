//! The random draws of a scripted eye for a label.

use crate::draws::draw_uniform;
use wayword_core::{ObjectLabel, SceneId, ViewpointId};

/// Names that the eye gives to things by mistake.
const WRONG_NAMES: [&str; 12] =
    ["chair", "table", "lamp", "bed", "sofa", "cabinet", "bookshelf", "plant", "mirror", "picture", "rug", "stool"];

/// The values on which the draws for one view depend. The viewpoint is used only for labels without a known distance.
pub(super) struct EyeDraws<'a> {
    pub(super) seed: u64,
    pub(super) scene: &'a SceneId,
    pub(super) viewpoint: Option<&'a ViewpointId>,
}

impl EyeDraws<'_> {
    /// A number in [0, 1) for a label and a purpose. It is the same in all views with the same object at the same distance.
    pub(super) fn draw_for_label(&self, purpose: &str, label: &ObjectLabel) -> f64 {
        let away = self.distance_key(label);
        draw_uniform(self.seed, &["scripted eye", purpose, self.scene.as_str(), label.object.as_str(), &away])
    }

    /// Draws a name that differs from the label's.
    pub(super) fn wrong_name(&self, label: &ObjectLabel) -> &'static str {
        let others: Vec<&str> = WRONG_NAMES.into_iter().filter(|name| *name != label.name).collect();
        let at = self.draw_for_label("wrong name", label) * others.len() as f64;
        others.get(at as usize).copied().unwrap_or(WRONG_NAMES[0])
    }

    /// The horizontal distance of the thing, rounded to a centimetre. It distinguishes the frames from each other.
    fn distance_key(&self, label: &ObjectLabel) -> String {
        let viewpoint = || self.viewpoint.map_or("", ViewpointId::as_str).to_owned();
        label
            .distance_m
            .map_or_else(viewpoint, |distance_m| format!("{:.2}", distance_m * libm::cos(label.elevation_rad)))
    }
}
