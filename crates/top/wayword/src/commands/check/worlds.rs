//! The world that each text is held against.

use super::walks::Text;
use crate::{cli::AskedWorld, error::Error};
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_checks::{Building, Source, World};
use wayword_core::{Platform, SceneId, Survey};
use wayword_world::survey;

/// Where what is known of a scene is kept once it is surveyed.
type Slot = Arc<Mutex<Option<Arc<KnownScene>>>>;

/// What is known of each scene beyond the frames of a path. A scene is surveyed once, when the first text needs it.
#[derive(Default)]
pub(super) struct Scenes {
    by_name: Mutex<BTreeMap<SceneId, Slot>>,
}

/// A scene that was surveyed.
pub(super) struct KnownScene {
    /// Its viewpoints.
    pub(super) survey: Survey,
    /// What is listed in it, for the checks.
    pub(super) listed: Arc<Building>,
    /// The same for the follower.
    pub(super) followed: wayword_follower::Building,
}

impl Scenes {
    /// A scene. It has no viewpoints where the platform has no graph.
    pub(super) fn get(&self, platform: &dyn Platform, scene: &SceneId) -> Result<Arc<KnownScene>, Error> {
        let cell =
            Arc::clone(self.by_name.lock().unwrap_or_else(PoisonError::into_inner).entry(scene.clone()).or_default());
        let mut known = cell.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = &*known {
            return Ok(Arc::clone(known));
        }
        let survey = survey(platform, scene)?;
        let listed = Arc::new(Building::of(&survey));
        let followed = wayword_follower::Building::of(&survey);
        Ok(Arc::clone(known.insert(Arc::new(KnownScene { survey, listed, followed }))))
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
