//! Turns a list of viewpoints, and perhaps a target object, into a [`Path`] through a scene.

use wayword_core::{
    Frame, Heading, ObjectId, ObjectLabel, Path, PathMotion, PathTarget, Platform, PlatformError, SceneId, ViewGaze,
    ViewpointId,
};

/// A path over a viewpoint graph: a frame at each of `viewpoints`, the first one looking along `heading`, with `object` as its
/// target.
///
/// The platform provides the target's name; if it has none, the path has no target. `told_by` is left empty.
///
/// # Errors
/// When the scene or a viewpoint is unknown, two viewpoints in a row have no edge, or data cannot be read.
pub fn path_over_viewpoints(
    platform: &dyn Platform,
    id: impl Into<String>,
    scene: &SceneId,
    viewpoints: &[ViewpointId],
    heading: Option<Heading>,
    object: Option<&ObjectId>,
) -> Result<Path, PlatformError> {
    let graph = platform.graph_for_scene(scene)?;
    let frames = graph
        .path_frames(viewpoints, heading)
        .map_err(|source| PlatformError::Graph { scene: scene.clone(), source })?;
    let target = match (object, frames.last()) {
        (Some(object), Some(last)) => target_for_object(platform, scene, last, object)?,
        _ => None,
    };
    Ok(Path { id: id.into(), scene: scene.clone(), frames, motion: PathMotion::Known, target })
}

/// The labels of all four views around a frame, in the order ahead, right, behind, left.
///
/// # Errors
/// When the platform cannot give a view from the frame.
pub fn labels_around(
    platform: &dyn Platform,
    scene: &SceneId,
    frame: &Frame,
) -> Result<Vec<ObjectLabel>, PlatformError> {
    let mut labels = Vec::new();
    for gaze in ViewGaze::around_heading(frame.pose.heading) {
        let view = platform.look_without_picture(scene, frame, gaze)?;
        labels.extend(view.ground_truth().into_iter().flat_map(|truth| truth.labels.iter().cloned()));
    }
    Ok(labels)
}

/// The target of an episode: `object` with its name, as seen from the last frame. `None` if the platform has no name
/// for it.
///
/// # Errors
/// When the platform cannot give the name, or a view from the frame.
pub fn target_for_object(
    platform: &dyn Platform,
    scene: &SceneId,
    last: &Frame,
    object: &ObjectId,
) -> Result<Option<PathTarget>, PlatformError> {
    let Some(name) = platform.catalogue().object_name(scene, last, object)? else {
        return Ok(None);
    };
    let around = labels_around(platform, scene, last)?;
    let has_namesake = around.iter().any(|label| label.object != *object && label.name == name);
    Ok(Some(PathTarget {
        object: object.clone(),
        name,
        told_by: Vec::new(),
        has_namesake,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    }))
}
