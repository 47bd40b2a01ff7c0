//! Computes the metrics of the participants' walks.

use crate::{ParticipantMove, StudyData, StudyRoute};
use std::collections::BTreeMap;
use wayword_core::{SceneId, ViewpointId};
use wayword_metrics::{AgentTrajectory, EpisodeDemand, SceneDistances, TrajectoryScore, score_trajectory};

/// Scores walks; the distances of a scene are computed once.
pub(super) struct WalkScorer<'a> {
    data: &'a StudyData,
    scenes: BTreeMap<&'a SceneId, Result<SceneDistances, String>>,
}

impl<'a> WalkScorer<'a> {
    pub(super) fn new(data: &'a StudyData) -> Self {
        Self { data, scenes: BTreeMap::new() }
    }

    /// The metrics of a walk along a route.
    ///
    /// # Errors
    /// The reason why they cannot be computed.
    pub(super) fn score_walk(&mut self, route: u32, moves: &[ParticipantMove]) -> Result<TrajectoryScore, String> {
        let route = self.find_route(route)?;
        let start = route.viewpoints.first().ok_or("its route has no viewpoints")?;
        let demand = EpisodeDemand { reference: route.viewpoints.clone(), object: None, visible_from: None };
        let walk = walked_trajectory(start, moves);
        score_trajectory(self.scene_distances(&route.scene)?, &demand, &walk)
            .map_err(|problems| problems.first().map_or_else(String::new, ToString::to_string))
    }

    /// How far a viewpoint is from the goal of a route along the graph, metres.
    pub(super) fn metres_to_goal(&mut self, route: u32, from: &ViewpointId) -> Option<f64> {
        let route = self.find_route(route).ok()?;
        let goal = route.viewpoints.last()?;
        self.scene_distances(&route.scene).ok()?.metres_between(from, goal)
    }

    fn find_route(&self, route: u32) -> Result<&'a StudyRoute, String> {
        self.data.routes.get(route as usize).ok_or_else(|| format!("the study has no route {route}"))
    }

    /// The distances between the viewpoints of a scene. They are computed at the first call.
    fn scene_distances(&mut self, scene: &'a SceneId) -> Result<&SceneDistances, String> {
        let data = self.data;
        let distances = self.scenes.entry(scene).or_insert_with(|| {
            let ground = data.scenes.iter().find(|other| other.scene == *scene);
            let graph = ground.ok_or("the study has no such scene")?.to_graph().map_err(|error| error.to_string())?;
            Ok(SceneDistances::new(&graph))
        });
        distances.as_ref().map_err(Clone::clone)
    }
}

/// A walk as the metrics take it: its viewpoints, the start included.
fn walked_trajectory(start: &ViewpointId, moves: &[ParticipantMove]) -> AgentTrajectory {
    let viewpoints = std::iter::once(start).chain(moves.iter().map(|step| &step.viewpoint)).cloned().collect();
    AgentTrajectory { viewpoints, object: None }
}
