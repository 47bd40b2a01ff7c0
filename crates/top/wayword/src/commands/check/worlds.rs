//! The world that each text is held against.

use super::walks::{Text, Walk};
use crate::{cli::AskedWorld, error::Error};
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_checks::{Building, Source, Surroundings, World};
use wayword_core::{Platform, SceneId};
use wayword_world::survey;

/// Where a scene's building is kept once it is surveyed.
type Slot = Arc<Mutex<Option<Arc<Building>>>>;

/// What open worlds know of each scene. A scene is surveyed once, when the first text needs it.
#[derive(Default)]
pub(super) struct Buildings {
    by_scene: Mutex<BTreeMap<SceneId, Slot>>,
}

impl Buildings {
    /// What is listed around a path; `None` where the platform lists nothing beyond its frames.
    pub(super) fn around(&self, platform: &dyn Platform, walk: &Walk) -> Result<Option<Surroundings>, Error> {
        let scene = &walk.path.scene;
        let cell =
            Arc::clone(self.by_scene.lock().unwrap_or_else(PoisonError::into_inner).entry(scene.clone()).or_default());
        let mut building = cell.lock().unwrap_or_else(PoisonError::into_inner);
        let building = match &*building {
            Some(known) => Arc::clone(known),
            None => Arc::clone(building.insert(Arc::new(Building::of(&survey(platform, scene)?)))),
        };
        Ok(Surroundings::of(&building, &walk.path))
    }
}

/// The world of a text: the one that was asked for, or else closed for a record whose provenance and evidence match
/// what is at hand, and open for everything else.
pub(super) fn world_of(text: &Text, asked: AskedWorld, platform: &str, source: Source) -> World {
    match (asked, &text.made) {
        (AskedWorld::Open, _) | (AskedWorld::Auto, None) => World::Open,
        (AskedWorld::Closed, _) => World::Closed,
        (AskedWorld::Auto, Some((made_on, provenance))) => World::of_record(provenance, made_on, platform, source),
    }
}
