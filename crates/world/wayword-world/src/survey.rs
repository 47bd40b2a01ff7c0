//! Collects the rooms and objects that a platform knows at all viewpoints of a scene.

use wayword_core::{
    DVec3, Frame, Heading, Platform, PlatformError, Pose, SceneId, ViewGaze, ViewpointId, ViewpointSurvey,
    survey::ViewpointKnowledge,
};

/// Surveys a scene by its graph and labels, without pictures. Where the platform has no graph, the survey is empty.
///
/// # Errors
/// When there is no such scene, or its data cannot be read.
pub fn survey_scene(platform: &dyn Platform, scene: &SceneId) -> Result<ViewpointSurvey, PlatformError> {
    let graph = platform.graph_for_scene(scene)?;
    let visit_viewpoint = |id: &ViewpointId, position: DVec3| {
        let pose = Pose::looking_level(position, Heading::NORTH);
        let frame = Frame { pose, viewpoint: Some(id.clone()), level: graph.level_of(id) };
        let mut known = ViewpointKnowledge { room: None, things: Some(Vec::new()) };
        for gaze in ViewGaze::compass_views() {
            let view = platform.look_without_picture(scene, &frame, gaze)?;
            let truth = view.ground_truth();
            known.room = known.room.or_else(|| truth.and_then(|truth| truth.room.clone()));
            known.things = match (known.things, truth.filter(|truth| truth.lists_objects)) {
                (Some(mut things), Some(truth)) => {
                    things.extend(truth.labels.iter().cloned());
                    Some(things)
                }
                _ => None,
            };
        }
        Ok::<_, SurveyError>(known)
    };
    let survey = ViewpointSurvey::from_graph(&graph, visit_viewpoint).map_err(|trouble| match trouble {
        SurveyError::Platform(error) => error,
        SurveyError::Graph(source) => PlatformError::Graph { scene: scene.clone(), source },
    })?;
    Ok(survey.with_objects(platform.catalogue().listed_objects(scene)?))
}

/// Why a survey failed: the two kinds of error that can occur while viewpoints are visited.
enum SurveyError {
    Platform(PlatformError),
    Graph(wayword_core::graph::GraphError),
}

impl From<PlatformError> for SurveyError {
    fn from(error: PlatformError) -> Self {
        Self::Platform(error)
    }
}

impl From<wayword_core::graph::GraphError> for SurveyError {
    fn from(error: wayword_core::graph::GraphError) -> Self {
        Self::Graph(error)
    }
}
