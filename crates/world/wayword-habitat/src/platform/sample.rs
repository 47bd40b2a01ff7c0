//! Random paths: the shortest way between two random places of the island that paths stay on, with frames along it.

use super::{scene::HabitatScene, walkable::WalkableGround};
use crate::{axes::EYE_M, ground::stops_along};
use rand::Rng;
use wayword_core::{DVec3, Frame, Heading, Path, PathRequest, PathTarget, PlatformError, path::PathStop, seeded_rng};
use wayword_world::{
    graph_walk::{self, choose_target},
    open_ground::{OpenGroundScene, sample_open_path},
};

/// A random path with a length within `request`: over the ground, or along the graph if that comes from a file.
pub(super) fn sample_path(
    home: &HabitatScene,
    request: &PathRequest,
    seed: u64,
    interval_m: f64,
) -> Result<Path, PlatformError> {
    match &home.walkable {
        Some(walkable) => sample_ground_path(home, walkable, request, seed, interval_m),
        None => graph_walk::sample_graph_path(&home.id, &home.graph, request, seed, |viewpoint| {
            home.labels_around(home.graph.position_of(viewpoint).unwrap_or_default(), Heading::NORTH)
        }),
    }
}

/// A random path over the ground.
fn sample_ground_path(
    home: &HabitatScene,
    walkable: &WalkableGround,
    request: &PathRequest,
    seed: u64,
    interval_m: f64,
) -> Result<Path, PlatformError> {
    let dice = seeded_rng(seed, &["habitat path", home.id.as_str()]);
    let found = sample_open_path(&mut GroundWalker { home, walkable, dice, interval_m }, &home.id, request, seed)?;
    found.ok_or_else(|| PlatformError::NoSuchPath {
        scene: home.id.clone(),
        request: describe_request(walkable, request),
        hint: "widen --metres",
    })
}

/// Walks over the ground of a scene.
struct GroundWalker<'a, R> {
    home: &'a HabitatScene,
    walkable: &'a WalkableGround,
    dice: R,
    interval_m: f64,
}

impl<R: Rng> OpenGroundScene for GroundWalker<'_, R> {
    fn random_ends(&mut self) -> Option<(DVec3, DVec3)> {
        let ground = &self.walkable.ground;
        let mut place = || Some(ground.random_place(ground.main(), &mut self.dice)?.place);
        Some((place()?, place()?))
    }

    fn stops_between(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<PathStop>>, PlatformError> {
        let ground = &self.walkable.ground;
        let Ok(way) = ground.geodesic(from, to) else { return Ok(None) };
        let stops = stops_along(ground, &way, self.interval_m);
        // Habitat's agent is 1.5 m high, so its ground includes places where a person cannot stand upright.
        let upright = |stop: &PathStop| self.walkable.has_headroom(stop.position - DVec3::Z * EYE_M);
        Ok(stops.iter().all(upright).then_some(stops))
    }

    fn target_at(&mut self, frames: &[Frame]) -> Result<Option<PathTarget>, PlatformError> {
        let Some(last) = frames.last() else { return Ok(None) };
        Ok(choose_target(&self.home.labels_around(last.pose.position, Heading::NORTH)?, &mut self.dice))
    }

    fn knows_objects(&self) -> bool {
        self.home.semantics.is_some()
    }
}

/// The request in words, with the area of the ground: almost none is a sign of wrong units, or of a scene that lies on
/// its side.
fn describe_request(walkable: &WalkableGround, request: &PathRequest) -> String {
    let length_m = &request.length_m;
    let ground_m2 = walkable.ground.islands_m2().nth(walkable.ground.main()).unwrap_or_default();
    format!(
        "{} to {} metres on its {ground_m2:.1} m2 of ground (if it has more, its unit or its axes are read \
         wrong: a stage_config.json beside it must give units_to_meters, up and front)",
        length_m.start(),
        length_m.end()
    )
}
