//! Random walks: the shortest way between two random places of the largest island, with frames along it.

use super::home::Home;
use crate::ground::stops_along;
use rand::Rng;
use wayword_core::{DVec3, Motion, Path, PathRequest, PlatformError, SceneId, rng};
use wayword_platforms::matterport::sample::target;

/// So many pairs of places are tried.
const TRIES: usize = 400;
/// Ends at which nothing is visible that are passed over before one is accepted.
const MAX_BARE_ENDS: usize = 12;

/// A walk whose length keeps to `request`. Hops play no part: a walk over open ground has none.
pub(super) fn path(home: &Home, request: &PathRequest, seed: u64, interval_m: f64) -> Result<Path, PlatformError> {
    let scene: &SceneId = &home.id;
    let mut rng = rng(seed, &["habitat path", scene.as_str()]);
    let mut bare = None;
    let mut bare_ends = 0;
    for _ in 0..TRIES {
        let Some((from, to)) = ends(home, &mut rng) else { break };
        if from.distance(to) > *request.length_m.end() {
            continue;
        }
        let Ok(way) = home.ground.geodesic(from, to) else { continue };
        let frames = Path::frames_along(stops_along(&home.ground, &way, interval_m), None);
        let mut path =
            Path { id: format!("{scene}_{seed}"), scene: scene.clone(), frames, motion: Motion::Known, target: None };
        let Some(last) = path.frames.last().filter(|_| request.allows_length_of(&path)) else { continue };
        if home.semantics.is_none() {
            return Ok(path);
        }
        path.target = target(&home.labels_around(last.pose.position)?, &mut rng);
        if path.target.is_some() {
            return Ok(path);
        }
        bare_ends += 1;
        bare.get_or_insert(path);
        if bare_ends > MAX_BARE_ENDS {
            break;
        }
    }
    bare.ok_or_else(|| PlatformError::NoSuchPath { scene: scene.clone(), request: refused(home, request) })
}

/// What was asked for, beside the ground that there is: a scene in other units, or one that lies on its side, has next to none.
fn refused(home: &Home, request: &PathRequest) -> String {
    let length_m = &request.length_m;
    let largest_m2 = home.ground.islands_m2().next().unwrap_or_default();
    format!(
        "{} to {} metres on its {largest_m2:.1} m2 of ground (a scene is read as metres with z up; where that is wrong, a \
         stage_config.json beside it says units_to_meters, up and front)",
        length_m.start(),
        length_m.end()
    )
}

fn ends(home: &Home, rng: &mut impl Rng) -> Option<(DVec3, DVec3)> {
    Some((home.ground.random_place(0, rng)?.place, home.ground.random_place(0, rng)?.place))
}
