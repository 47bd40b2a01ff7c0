//! The world that each text is held against.

use super::walks::Text;
use crate::{cli::AskedWorld, error::Error};
use std::sync::Arc;
use wayword_checks::{Building, Source, World};
use wayword_core::{Platform, SceneId, Survey};
use wayword_world::survey;

/// A scene that was surveyed.
pub(super) struct KnownScene {
    /// Its viewpoints.
    pub(super) survey: Survey,
    /// What is listed in it, for the checks.
    pub(super) listed: Arc<Building>,
    /// The same for the follower.
    pub(super) followed: wayword_follower::Building,
}

impl KnownScene {
    /// Surveys a scene. It has no viewpoints where the platform has no graph.
    pub(super) fn of(platform: &dyn Platform, scene: &SceneId) -> Result<Self, Error> {
        let survey = survey(platform, scene)?;
        let listed = Arc::new(Building::of(&survey));
        let followed = wayword_follower::Building::of(&survey);
        Ok(Self { survey, listed, followed })
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
