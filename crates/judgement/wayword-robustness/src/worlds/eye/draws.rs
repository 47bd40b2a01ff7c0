//! What a scripted eye draws of a label.

use crate::draws::uniform;
use wayword_core::{Label, SceneId, ViewpointId};

/// The names by which things are called that they do not have.
const WRONG_NAMES: [&str; 12] =
    ["chair", "table", "lamp", "bed", "sofa", "cabinet", "bookshelf", "plant", "mirror", "picture", "rug", "stool"];

/// By what the numbers of one look are drawn. The name of the viewpoint counts where the distance of a label is not
/// known.
pub(super) struct Draws<'a> {
    pub(super) seed: u64,
    pub(super) scene: &'a SceneId,
    pub(super) viewpoint: Option<&'a ViewpointId>,
}

impl Draws<'_> {
    /// A label's number for one purpose, in [0, 1). It is the same wherever the label is the same thing at the same
    /// distance.
    pub(super) fn uniform(&self, purpose: &str, label: &Label) -> f64 {
        let away = self.away(label);
        uniform(self.seed, &["scripted eye", purpose, self.scene.as_str(), label.object.as_str(), &away])
    }

    /// Another name than the label's.
    pub(super) fn wrong_name(&self, label: &Label) -> &'static str {
        let others: Vec<&str> = WRONG_NAMES.into_iter().filter(|name| *name != label.name).collect();
        let at = self.uniform("wrong name", label) * others.len() as f64;
        others.get(at as usize).copied().unwrap_or(WRONG_NAMES[0])
    }

    /// How far away the thing is over the ground, to a centimetre: what tells the frames apart.
    fn away(&self, label: &Label) -> String {
        let viewpoint = || self.viewpoint.map_or("", ViewpointId::as_str).to_owned();
        label
            .distance_m
            .map_or_else(viewpoint, |distance_m| format!("{:.2}", distance_m * libm::cos(label.elevation_rad)))
    }
}
