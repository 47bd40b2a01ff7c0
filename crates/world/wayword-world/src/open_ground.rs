//! Draws random paths through scenes with open ground: there one can walk anywhere, so a path has a length but no hops.

use wayword_core::{DVec3, Frame, Path, PathMotion, PathRequest, PathTarget, PlatformError, SceneId, path::PathStop};

/// How many pairs of places are tried before the search gives up.
const MAX_PAIRS_TRIED: usize = 400;
/// How many ends without a visible target are skipped before one is accepted.
const MAX_BARE_ENDS: usize = 12;

/// A scene with open ground. It makes the random choices of a path: its ends, its stops and its target.
pub trait OpenGroundScene {
    /// Two random places for the ends of a path; `None` if the scene has no ground.
    fn random_ends(&mut self) -> Option<(DVec3, DVec3)>;

    /// The places of frames along the shortest way between two places; `None` if no way joins them.
    ///
    /// # Errors
    /// When the platform cannot answer.
    fn stops_between(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<PathStop>>, PlatformError>;

    /// A target for a path with these frames; `None` if no suitable object is visible from the last one.
    ///
    /// # Errors
    /// When the platform cannot give a view.
    fn target_at(&mut self, frames: &[Frame]) -> Result<Option<PathTarget>, PlatformError>;

    /// Whether the objects of the scene are known at all. Without them, the search for a target is useless.
    fn knows_objects(&self) -> bool {
        true
    }
}

/// Draws a path of a length that `request` allows; `None` if none is found.
///
/// Random pairs of places are tried in turn, and the first path with a target is taken. After a dozen paths of the right
/// length without a target, the first of them is taken as it is.
///
/// # Errors
/// When the platform cannot answer.
pub fn sample_open_path(
    world: &mut dyn OpenGroundScene,
    scene: &SceneId,
    request: &PathRequest,
    seed: u64,
) -> Result<Option<Path>, PlatformError> {
    // The first path without a target. It is used if no better one is found.
    let mut bare = None;
    let mut bare_ends = 0;
    for _ in 0..MAX_PAIRS_TRIED {
        let Some((from, to)) = world.random_ends() else { break };
        if from == to || from.distance(to) > *request.length_m.end() {
            continue;
        }
        let Some(stops) = world.stops_between(from, to)? else { continue };
        let frames = Path::frames_along(stops, None);
        let mut path = Path {
            id: format!("{scene}_{seed}"),
            scene: scene.clone(),
            frames,
            motion: PathMotion::Known,
            target: None,
        };
        if path.frames.is_empty() || !request.allows_length_of(&path) {
            continue;
        }
        if world.knows_objects() {
            path.target = world.target_at(&path.frames)?;
        }
        if path.target.is_some() || !world.knows_objects() {
            return Ok(Some(path));
        }
        bare_ends += 1;
        bare.get_or_insert(path);
        if bare_ends > MAX_BARE_ENDS {
            break;
        }
    }
    Ok(bare)
}

/// The error for a request that no path was found for.
#[must_use]
pub fn no_such_walk(scene: &SceneId, request: &PathRequest) -> PlatformError {
    let request = format!("{} to {} metres", request.length_m.start(), request.length_m.end());
    PlatformError::NoSuchPath { scene: scene.clone(), request, hint: "widen --metres" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::ObjectId;

    /// A scene on a line: each pair of ends lies one metre farther apart than the pair before. A path has a target if `seen`
    /// is true for its end in metres. No way leads to the place at 3 metres.
    struct Line {
        tried: usize,
        seen: fn(usize) -> bool,
        knows: bool,
    }

    impl OpenGroundScene for Line {
        fn random_ends(&mut self) -> Option<(DVec3, DVec3)> {
            self.tried += 1;
            Some((DVec3::ZERO, DVec3::X * self.tried as f64))
        }

        fn stops_between(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<PathStop>>, PlatformError> {
            let stop = |position| PathStop { position, viewpoint: None, level: None };
            Ok((to.x != 3.0).then(|| vec![stop(from), stop(to)]))
        }

        fn target_at(&mut self, frames: &[Frame]) -> Result<Option<PathTarget>, PlatformError> {
            let object = ObjectId::new("1").unwrap();
            let target = PathTarget {
                object,
                name: "chair".into(),
                told_by: Vec::new(),
                has_namesake: false,
                descriptions: Vec::new(),
                hangs: false,
                storeys: 0,
            };
            Ok((self.seen)(frames.last().unwrap().pose.position.x as usize).then_some(target))
        }

        fn knows_objects(&self) -> bool {
            self.knows
        }
    }

    fn walked(seen: fn(usize) -> bool, knows: bool, length_m: std::ops::RangeInclusive<f64>) -> Option<(f64, bool)> {
        let request = PathRequest { length_m, ..PathRequest::default() };
        let path =
            sample_open_path(&mut Line { tried: 0, seen, knows }, &SceneId::new("s").unwrap(), &request, 7).unwrap()?;
        Some((path.length_m().unwrap(), path.target.is_some()))
    }

    #[test]
    fn sample_open_path_takes_the_first_path_of_the_length_with_a_target() {
        assert_eq!(walked(|_| true, true, 2.0..=9.0), Some((2.0, true)));
        assert_eq!(walked(|at| at > 4, true, 2.0..=9.0), Some((5.0, true)));
        assert_eq!(walked(|_| true, true, 3.0..=9.0), Some((4.0, true)), "no way is three metres long");
    }

    #[test]
    fn sample_open_path_takes_the_first_path_if_no_target_is_visible() {
        assert_eq!(walked(|_| false, true, 2.0..=90.0), Some((2.0, false)));
        assert_eq!(walked(|at| at > 60, true, 2.0..=90.0), Some((2.0, false)), "the search must end");
        assert_eq!(walked(|at| at > 4, false, 2.0..=9.0), Some((2.0, false)), "the objects are not known");
    }

    #[test]
    fn sample_open_path_finds_no_path_if_none_has_the_length() {
        assert_eq!(walked(|_| true, true, 3.0..=3.0), None);
    }
}
