//! Asks a child for a random path, if it offers to choose paths itself, and checks the path.

use super::{
    child_keeper::ChildKeeper,
    labels::{plausible_heading, plausible_level, plausible_position},
};
use serde::Deserialize;
use serde_json::json;
use wayword_core::{
    ObjectId, Path, PathMotion, PathRequest, Platform, PlatformError, SceneId, ViewpointGraph, ViewpointId,
    path::PathStop,
};
use wayword_world::{episode_path, graph_walk};

/// Most stops of a path.
const MAX_STOPS: usize = 1000;
/// Tolerance of a path's length, for rounding, metres.
const SLACK_M: f64 = 1e-3;

/// The answer to `sample_path`; `path` is missing if the child found none.
#[derive(Deserialize)]
struct SamplePathAnswer {
    path: Option<ChildPath>,
}

/// A path in the child's words.
#[derive(Deserialize)]
struct ChildPath {
    stops: Vec<ChildStop>,
    #[serde(default)]
    heading_rad: Option<f64>,
    #[serde(default)]
    target: Option<ObjectId>,
}

/// A stop: a viewpoint of the graph, or any position.
#[derive(Deserialize)]
struct ChildStop {
    #[serde(default)]
    viewpoint: Option<ViewpointId>,
    #[serde(default)]
    position: Option<[f64; 3]>,
    #[serde(default)]
    level: Option<u32>,
}

/// Asks the child for a path, and checks it against the request. `platform` is the child's platform, for the target's
/// name.
pub(crate) fn ask_random_path(
    keeper: &ChildKeeper,
    platform: &dyn Platform,
    scene: &SceneId,
    request: &PathRequest,
    seed: u64,
) -> Result<Path, PlatformError> {
    let asked = json!({
        "scene": scene,
        "hops": [request.hops.start(), request.hops.end()],
        "length_m": [request.length_m.start(), request.length_m.end()],
        // Some languages cannot represent whole numbers beyond 2^53.
        "seed": wayword_core::seed::derive_seed(seed, &["process path", scene.as_str()]) >> 11,
    });
    let SamplePathAnswer { path } = keeper.ask_and_read("sample_path", &asked)?;
    let Some(walk) = path else {
        return Err(PlatformError::NoSuchPath {
            scene: scene.clone(),
            request: graph_walk::describe_path_request(request),
            hint: "widen --hops or --metres",
        });
    };
    let misfit = |reason: String| keeper.misfit_error("sample_path", reason);
    if !(2..=MAX_STOPS).contains(&walk.stops.len()) {
        return Err(misfit(format!("`stops` has length {}, expected 2 to {MAX_STOPS}", walk.stops.len())));
    }
    let on_graph = walk.stops.iter().any(|stop| stop.viewpoint.is_some());
    let graph = if on_graph { Some(platform.graph_for_scene(scene)?) } else { None };
    let stops: Result<Vec<PathStop>, String> =
        walk.stops.into_iter().map(|given| given.into_stop(graph.as_deref())).collect();
    let heading = walk.heading_rad.map(plausible_heading).transpose().map_err(misfit)?;
    let frames = Path::frames_along(stops.map_err(misfit)?, heading);
    let mut path =
        Path { id: format!("{scene}_{seed}"), scene: scene.clone(), frames, motion: PathMotion::Known, target: None };
    check_fit(&path, request).map_err(misfit)?;
    if let (Some(object), Some(last)) = (&walk.target, path.frames.last()) {
        let target = episode_path::target_for_object(platform, scene, last, object)?;
        path.target = Some(target.ok_or_else(|| {
            let reason = format!("`target` {:?} is not known: no label and no `object_name` has it", object.as_str());
            misfit(format!("{reason}; send the id of an object of the scene, or leave `target` out"))
        })?);
    }
    Ok(path)
}

impl ChildStop {
    fn into_stop(self, graph: Option<&ViewpointGraph>) -> Result<PathStop, String> {
        match (self.viewpoint, self.position, graph) {
            (Some(id), _, Some(graph)) => {
                let position = graph.position_of(&id).ok_or_else(|| format!("viewpoint {id} is not in the graph"))?;
                let level = graph.level_of(&id);
                Ok(PathStop { position, viewpoint: Some(id), level })
            }
            (_, Some(position), _) => Ok(PathStop {
                position: plausible_position(position)?,
                viewpoint: None,
                level: plausible_level(self.level)?,
            }),
            _ => Err("a stop must have a `viewpoint` or a `position`".into()),
        }
    }
}

/// Checks a path against the request: its length, and its hops if all its stops are viewpoints.
fn check_fit(path: &Path, request: &PathRequest) -> Result<(), String> {
    let Some(length_m) = path.length_m() else { return Err("a path of unknown length".into()) };
    let hops = path.frames.len() - 1;
    let (least, most) = (request.length_m.start() - SLACK_M, request.length_m.end() + SLACK_M);
    let on_graph = path.frames.iter().all(|frame| frame.viewpoint.is_some());
    if !(least..=most).contains(&length_m) || (on_graph && !request.hops.contains(&hops)) {
        return Err(format!(
            "a path with hops: {hops}, metres: {length_m:.3}; expected {}",
            graph_walk::describe_path_request(request)
        ));
    }
    Ok(())
}
