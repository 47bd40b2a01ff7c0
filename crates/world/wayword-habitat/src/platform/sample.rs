//! Random paths: the shortest way between two random places of the island that paths stay on, with frames along it.

use super::home::Home;
use crate::{axes::EYE_M, ground::stops_along};
use rand::Rng;
use wayword_core::{DVec3, Frame, Heading, Path, PathRequest, PlatformError, Target, path::Stop, rng};
use wayword_world::{
    graph_walk::target,
    wander::{Wander, wander},
};

/// A random path whose length is within `request`.
pub(super) fn path(home: &Home, request: &PathRequest, seed: u64, interval_m: f64) -> Result<Path, PlatformError> {
    let dice = rng(seed, &["habitat path", home.id.as_str()]);
    let found = wander(&mut Walker { home, dice, interval_m }, &home.id, request, seed)?;
    found.ok_or_else(|| PlatformError::NoSuchPath {
        scene: home.id.clone(),
        request: refused(home, request),
        hint: "widen --metres",
    })
}

/// Walks over the ground of a scene.
struct Walker<'a, R> {
    home: &'a Home,
    dice: R,
    interval_m: f64,
}

impl<R: Rng> Wander for Walker<'_, R> {
    fn ends(&mut self) -> Option<(DVec3, DVec3)> {
        let mut place = || Some(self.home.ground.random_place(self.home.ground.main(), &mut self.dice)?.place);
        Some((place()?, place()?))
    }

    fn stops(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<Stop>>, PlatformError> {
        let ground = &self.home.ground;
        let Ok(way) = ground.geodesic(from, to) else { return Ok(None) };
        let stops = stops_along(ground, &way, self.interval_m);
        // Habitat's agent is 1.5 m high, so its ground includes places where a person cannot stand upright.
        let upright = |stop: &Stop| self.home.is_headroom(stop.position - DVec3::Z * EYE_M);
        Ok(stops.iter().all(upright).then_some(stops))
    }

    fn target(&mut self, last: &Frame) -> Result<Option<Target>, PlatformError> {
        Ok(target(&self.home.labels_around(last.pose.position, Heading::NORTH)?, &mut self.dice))
    }

    fn knows_objects(&self) -> bool {
        self.home.semantics.is_some()
    }
}

/// The request in words, with the area of the ground: a scene in other units, or one that lies on its side, has almost
/// none.
fn refused(home: &Home, request: &PathRequest) -> String {
    let length_m = &request.length_m;
    let ground_m2 = home.ground.islands_m2().nth(home.ground.main()).unwrap_or_default();
    format!(
        "{} to {} metres on its {ground_m2:.1} m2 of ground (a scene is read as metres with z up; if that is wrong, a \
         stage_config.json beside it must give units_to_meters, up and front)",
        length_m.start(),
        length_m.end()
    )
}
