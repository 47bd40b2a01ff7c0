//! Random paths through scenes with open ground, where paths have a length but no hops.

use wayword_core::{DVec3, Frame, Motion, Path, PathRequest, PlatformError, SceneId, Target, path::Stop};

/// How many pairs of places are tried.
const TRIES: usize = 400;
/// How many ends without a visible target are skipped before one is accepted.
const MAX_BARE_ENDS: usize = 12;

/// A scene with open ground, and the random choices of a path through it.
pub trait Wander {
    /// Two random places; `None` where there is no ground.
    fn ends(&mut self) -> Option<(DVec3, DVec3)>;

    /// Where frames are taken along the shortest way from one to the other; `None` where there is none.
    ///
    /// # Errors
    /// When the platform cannot answer.
    fn stops(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<Stop>>, PlatformError>;

    /// A target for a path that ends at `last`.
    ///
    /// # Errors
    /// When the platform cannot give a view.
    fn target(&mut self, last: &Frame) -> Result<Option<Target>, PlatformError>;

    /// Whether the scene has known objects at all. Without them, looking for a target is useless.
    fn knows_objects(&self) -> bool {
        true
    }
}

/// A path whose length fits `request`, with a target where one is found; `None` where the program finds no such path.
///
/// # Errors
/// When the platform cannot answer.
pub fn wander(
    world: &mut dyn Wander,
    scene: &SceneId,
    request: &PathRequest,
    seed: u64,
) -> Result<Option<Path>, PlatformError> {
    let mut bare = None;
    let mut bare_ends = 0;
    for _ in 0..TRIES {
        let Some((from, to)) = world.ends() else { break };
        if from == to || from.distance(to) > *request.length_m.end() {
            continue;
        }
        let Some(stops) = world.stops(from, to)? else { continue };
        let frames = Path::frames_along(stops, None);
        let mut path =
            Path { id: format!("{scene}_{seed}"), scene: scene.clone(), frames, motion: Motion::Known, target: None };
        let Some(last) = path.frames.last().filter(|_| request.allows_length_of(&path)) else { continue };
        if world.knows_objects() {
            path.target = world.target(last)?;
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

/// The error that no path of the requested length was found.
#[must_use]
pub fn no_such_walk(scene: &SceneId, request: &PathRequest) -> PlatformError {
    let request = format!("{} to {} metres", request.length_m.start(), request.length_m.end());
    PlatformError::NoSuchPath { scene: scene.clone(), request, hint: "widen --metres" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::ObjectId;

    /// A scene on a line: each pair of ends lies one metre farther apart than the one before, and an object stands
    /// where `seen` says so.
    struct Line {
        tried: usize,
        seen: fn(usize) -> bool,
        knows: bool,
    }

    impl Wander for Line {
        fn ends(&mut self) -> Option<(DVec3, DVec3)> {
            self.tried += 1;
            Some((DVec3::ZERO, DVec3::X * self.tried as f64))
        }

        fn stops(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<Stop>>, PlatformError> {
            let stop = |position| Stop { position, viewpoint: None, level: None };
            Ok((to.x != 3.0).then(|| vec![stop(from), stop(to)]))
        }

        fn target(&mut self, last: &Frame) -> Result<Option<Target>, PlatformError> {
            let object = ObjectId::new("1").unwrap();
            let target = Target {
                object,
                name: "chair".into(),
                told_by: Vec::new(),
                has_namesake: false,
                descriptions: Vec::new(),
                hangs: false,
                storeys: 0,
            };
            Ok((self.seen)(last.pose.position.x as usize).then_some(target))
        }

        fn knows_objects(&self) -> bool {
            self.knows
        }
    }

    fn walked(seen: fn(usize) -> bool, knows: bool, length_m: std::ops::RangeInclusive<f64>) -> Option<(f64, bool)> {
        let request = PathRequest { length_m, ..PathRequest::default() };
        let path = wander(&mut Line { tried: 0, seen, knows }, &SceneId::new("s").unwrap(), &request, 7).unwrap()?;
        Some((path.length_m().unwrap(), path.target.is_some()))
    }

    #[test]
    fn the_first_walk_of_that_length_with_something_at_its_end_is_taken() {
        assert_eq!(walked(|_| true, true, 2.0..=9.0), Some((2.0, true)));
        assert_eq!(walked(|at| at > 4, true, 2.0..=9.0), Some((5.0, true)));
        assert_eq!(walked(|_| true, true, 3.0..=9.0), Some((4.0, true)), "no way is three metres long");
    }

    #[test]
    fn where_nothing_is_to_be_seen_the_first_walk_is_taken_without_a_target() {
        assert_eq!(walked(|_| false, true, 2.0..=90.0), Some((2.0, false)));
        assert_eq!(walked(|at| at > 60, true, 2.0..=90.0), Some((2.0, false)), "the search must end");
        assert_eq!(walked(|at| at > 4, false, 2.0..=9.0), Some((2.0, false)), "the objects are not known");
    }

    #[test]
    fn where_no_walk_is_of_that_length_there_is_none() {
        assert_eq!(walked(|_| true, true, 3.0..=3.0), None);
    }
}
