//! Samples random paths through a live simulator's scene: the shortest way between two random viewpoints, with frames at
//! its corners and at equal distances between them.

use rand::Rng;
use wayword_core::{
    DVec3, Frame, ObjectLabel, Path, PathRequest, PathTarget, PlatformError, Pose, SceneId, ViewGaze, path::PathStop,
    seeded_rng,
};
use wayword_world::open_ground::{OpenGroundScene, no_such_walk, sample_open_path};

/// Height of the eye above the ground, metres.
pub(crate) const EYE_M: f64 = 1.5;
/// A corner gets no frame if it is nearer than this to the corner before it that has one, or to the end, metres.
const CROWDED_M: f64 = 0.4;
/// Largest distance of a target from the last frame, metres.
const TARGET_REACH_M: f64 = 4.0;

/// What sampling a path needs from a simulator.
pub(crate) trait WalkableScene {
    /// The corners of the shortest way between two eye positions, both ends included; `None` where there is no way.
    fn shortest_way(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<DVec3>>, PlatformError>;

    /// Labels of the objects that are visible from a pose within a gaze.
    fn labels_in_gaze(&mut self, pose: Pose, gaze: ViewGaze) -> Result<Vec<ObjectLabel>, PlatformError>;

    /// Everything visible around a pose.
    fn labels_around(&mut self, pose: Pose) -> Result<Vec<ObjectLabel>, PlatformError> {
        let views = ViewGaze::around_heading(pose.heading).map(|gaze| self.labels_in_gaze(pose, gaze));
        views.into_iter().collect::<Result<Vec<_>, _>>().map(|views| views.concat())
    }
}

/// A path between two of `eyes`, of a length that `request` allows. Frames are at corners and at most `interval_m` apart.
pub(crate) fn sample_live_path(
    world: &mut dyn WalkableScene,
    (scene, eyes): (&SceneId, &[DVec3]),
    request: &PathRequest,
    seed: u64,
    interval_m: f64,
) -> Result<Path, PlatformError> {
    let dice = seeded_rng(seed, &["live path", scene.as_str()]);
    let path = sample_open_path(&mut LivePathSampler { world, eyes, dice, interval_m }, scene, request, seed)?;
    path.ok_or_else(|| no_such_walk(scene, request))
}

/// Samples paths through a live simulator's scene.
struct LivePathSampler<'a, R> {
    world: &'a mut dyn WalkableScene,
    eyes: &'a [DVec3],
    dice: R,
    interval_m: f64,
}

impl<R: Rng> OpenGroundScene for LivePathSampler<'_, R> {
    fn random_ends(&mut self) -> Option<(DVec3, DVec3)> {
        let mut eye = || self.eyes[self.dice.random_range(0..self.eyes.len())];
        (!self.eyes.is_empty()).then(|| (eye(), eye()))
    }

    fn stops_between(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<PathStop>>, PlatformError> {
        Ok(self.world.shortest_way(from, to)?.map(|way| stops_along(&way, self.interval_m)))
    }

    fn target_at(&mut self, frames: &[Frame]) -> Result<Option<PathTarget>, PlatformError> {
        let Some(last) = frames.last() else { return Ok(None) };
        Ok(choose_target(&self.world.labels_around(last.pose)?, &mut self.dice))
    }
}

/// Where frames are taken: at both ends, at corners, and between them at equal distances of at most `interval_m`.
fn stops_along(way: &[DVec3], interval_m: f64) -> Vec<PathStop> {
    let interval_m = if interval_m.is_finite() { interval_m.max(0.1) } else { 1.0 };
    let Some((first, rest)) = way.split_first() else { return Vec::new() };
    let last = *way.last().unwrap_or(first);
    let mut marks = vec![*first];
    for corner in rest.iter().take(rest.len().saturating_sub(1)) {
        let before = marks.last().copied().unwrap_or(*first);
        if before.distance(*corner) >= CROWDED_M && corner.distance(last) >= CROWDED_M {
            marks.push(*corner);
        }
    }
    marks.push(last);
    let mut places = vec![*first];
    for leg in marks.windows(2) {
        let count = (leg[0].distance(leg[1]) / interval_m).ceil().max(1.0) as usize;
        places.extend((1..=count).map(|step| leg[0].lerp(leg[1], step as f64 / count as f64)));
    }
    places.dedup();
    places.into_iter().map(|position| PathStop { position, viewpoint: None, level: None }).collect()
}

/// A random object within reach that is the only visible one of its name.
fn choose_target(labels: &[ObjectLabel], dice: &mut impl Rng) -> Option<PathTarget> {
    let is_alone = |label: &&ObjectLabel| labels.iter().filter(|other| other.name == label.name).count() == 1;
    let in_reach = |label: &&ObjectLabel| label.distance_m.is_some_and(|distance_m| distance_m <= TARGET_REACH_M);
    let likely: Vec<&ObjectLabel> = labels.iter().filter(in_reach).filter(is_alone).collect();
    let chosen = (!likely.is_empty()).then(|| likely[dice.random_range(0..likely.len())])?;
    Some(PathTarget {
        object: chosen.object.clone(),
        name: chosen.name.clone(),
        told_by: Vec::new(),
        has_namesake: false,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    })
}

/// Refuses a frame at a position that is not finite or too far out.
pub(crate) fn check_frame(scene: &SceneId, frame: &Frame) -> Result<(), PlatformError> {
    let usable = frame.pose.position.is_finite() && frame.pose.position.abs().max_element() < 1e5;
    if usable { Ok(()) } else { Err(PlatformError::for_unknown_place(scene, frame)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn frames_are_evenly_spread_and_keep_the_ends(
            corners in prop::collection::vec((-9.0..9.0f64, -9.0..9.0f64), 2..7), interval_m in 0.2..3.0f64,
        ) {
            let way: Vec<DVec3> = corners.iter().map(|(x, y)| DVec3::new(*x, *y, EYE_M)).collect();
            let stops = stops_along(&way, interval_m);
            prop_assert_eq!(stops[0].position, way[0]);
            prop_assert_eq!(stops[stops.len() - 1].position, way[way.len() - 1]);
            for pair in stops.windows(2) {
                prop_assert!(pair[0].position.distance(pair[1].position) <= interval_m + 1e-9);
            }
        }
    }
}
