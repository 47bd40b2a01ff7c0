//! Any platform, with pictures that a [`FlawedEye`](super::scripts::FlawedEye) can read: their labels hang in a gallery.

use super::{Gallery, Scenery, Thing, barcode};
use sha2::{Digest, Sha256};
use std::sync::Arc;
use wayword_core::{
    Frame, Gaze, ObjectId, Path, PathRequest, Platform, PlatformError, SceneId, View, ViewpointGraph, Where,
};

/// A platform whose views show a number instead of the world.
pub struct Pictured<P> {
    platform: P,
    gallery: Gallery,
}

impl<P: Platform> Pictured<P> {
    /// Hangs what is looked at in the gallery.
    #[must_use]
    pub fn new(platform: P, gallery: Gallery) -> Self {
        Self { platform, gallery }
    }
}

impl<P: Platform> Platform for Pictured<P> {
    fn name(&self) -> &'static str {
        self.platform.name()
    }

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.platform.scenes()
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.platform.graph(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.platform.sample_path(scene, request, seed)
    }

    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        let view = self.platform.look(scene, from, gaze)?;
        let truth = view.ground_truth().cloned();
        let id = id(scene, from, gaze);
        if let Some(truth) = &truth {
            let third = |label: &wayword_core::Label| {
                let off_rad = view.pose.heading.turn_to(label.heading);
                match Where::at(off_rad, view.horizontal_fov_rad) {
                    Where::Left => 0,
                    Where::Middle => 1,
                    Where::Right => 2,
                }
            };
            let things = truth.labels.iter().map(|label| Thing {
                name: label.name.clone(),
                third: third(label),
                colour: label.colour.clone(),
            });
            self.gallery.hang(id, Scenery { room: truth.room.clone(), things: things.collect() });
        }
        Ok(View::new(view.pose, view.horizontal_fov_rad, Some(Arc::new(barcode::image(id))), truth))
    }

    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        self.platform.object_name(scene, near, object)
    }
}

/// The number of a view: equal looks have equal numbers.
fn id(scene: &SceneId, from: &Frame, gaze: Gaze) -> u64 {
    let mut hash = Sha256::new();
    hash.update(scene.as_str());
    for metres in from.pose.position.to_array() {
        hash.update(metres.to_bits().to_le_bytes());
    }
    for rad in [gaze.heading.rad(), gaze.horizontal_fov_rad] {
        hash.update(((rad * 1e6).round() as u64).to_le_bytes());
    }
    let bytes: [u8; 32] = hash.finalize().into();
    u64::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3], bytes[4], bytes[5], bytes[6], bytes[7]])
}
