//! How well a viewpoint graph stands for the ground: what a study or a comparison in which somebody walks over it can measure.

use super::{DistanceAtlas, SceneDistances};
use rand::Rng;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use wayword_core::{Frame, Heading, Platform, PlatformError, Pose, SceneId, ViewpointGraph, ViewpointId, seeded_rng};

/// Under 3 m from the goal a walk has arrived (R2R, `tasks/R2R/eval.py`), metres.
const ARRIVED_M: f64 = 3.0;
/// Two viewpoints nearer than this over the ground are close: a person goes from one to the other in a step or two. Metres.
const CLOSE_M: f64 = 1.2;
/// A way is shown in whole metres, and a shorter one than this as 0 m. Metres.
const ZERO_WAY_M: f64 = 0.5;
/// Random walks for each route.
const WALKS_PER_ROUTE: usize = 100;
/// Viewpoints of each scene for which distances to the goal are compared, for each route.
const COMPARED_PER_ROUTE: usize = 20;

/// A route over the viewpoint graph of a scene, from start to goal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GraphRoute {
    /// The scene.
    pub scene: SceneId,
    /// Its viewpoints.
    pub viewpoints: Vec<ViewpointId>,
}

/// What the viewpoint graph of some routes is worth. Distances over the ground are known for generated houses and Habitat's
/// scenes; elsewhere the counts that need them are 0.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct WalkSurvey {
    /// Steps of the routes.
    pub route_steps: usize,
    /// Those that are edges of the graph.
    pub edge_steps: usize,
    /// Viewpoints less than 3 m over the ground from the goal of a route, the goal itself left out.
    pub near_goal: usize,
    /// Those that count as success, by their distance over the graph.
    pub near_goal_arrived: usize,
    /// Random walks: from the start of each route, as many steps as it has.
    pub random_walks: usize,
    /// Those that arrive: what a walker reaches who reads nothing.
    pub random_arrived: usize,
    /// Ratio of the distance over the graph to the distance over the ground, to the goals: median.
    pub detour_median: Option<f64>,
    /// The same: 95th percentile.
    pub detour_p95: Option<f64>,
    /// Edges of the graphs.
    pub edges: usize,
    /// Those under half a metre.
    pub zero_edges: usize,
    /// Pairs of viewpoints less than 1.2 m from each other over the ground.
    pub close_pairs: usize,
    /// Those without an edge.
    pub close_unjoined: usize,
}

/// Surveys the graphs of some routes. Equal input gives equal figures.
///
/// # Errors
/// When a scene cannot be read.
pub fn survey_walks(platform: &dyn Platform, routes: &[GraphRoute], seed: u64) -> Result<WalkSurvey, PlatformError> {
    let atlas = DistanceAtlas::new(platform);
    let mut survey = WalkSurvey::default();
    let mut detours: Vec<f64> = Vec::new();
    let mut scenes: BTreeSet<&SceneId> = BTreeSet::new();
    for (number, route) in routes.iter().enumerate() {
        let scene = SurveyedGround {
            platform,
            scene: &route.scene,
            graph: &*platform.graph_for_scene(&route.scene)?,
            distances: &*atlas.scene_distances(&route.scene)?,
        };
        if scenes.insert(&route.scene) {
            scene.count_edges(&mut survey)?;
        }
        scene.count_steps(route, &mut survey);
        scene.walk_at_random(route, &mut survey, &mut seeded_rng(seed, &["random walk", &number.to_string()]));
        if let Some(goal) = route.viewpoints.last() {
            let mut rng = seeded_rng(seed, &["detours", &number.to_string()]);
            scene.measure_around_goal(goal, &mut survey, &mut detours, &mut rng)?;
        }
    }
    detours.sort_by(f64::total_cmp);
    let quantile = |share: f64| {
        let last = detours.len().checked_sub(1)?;
        detours.get((share * last as f64).round() as usize).copied()
    };
    (survey.detour_median, survey.detour_p95) = (quantile(0.5), quantile(0.95));
    Ok(survey)
}

/// The scene of a route.
struct SurveyedGround<'a> {
    platform: &'a dyn Platform,
    scene: &'a SceneId,
    graph: &'a ViewpointGraph,
    distances: &'a SceneDistances,
}

impl SurveyedGround<'_> {
    /// Distance over the ground between two viewpoints, metres; `None` where it is not known, or there is no way.
    fn ground_m(&self, a: &ViewpointId, b: &ViewpointId) -> Result<Option<f64>, PlatformError> {
        let frame = |id: &ViewpointId| {
            let pose = Pose::looking_level(self.graph.position_of(id)?, Heading::NORTH);
            Some(Frame { pose, viewpoint: Some(id.clone()), level: self.graph.level_of(id) })
        };
        let Some((a, b)) = frame(a).zip(frame(b)) else { return Ok(None) };
        Ok(self.platform.ground().ground_route(self.scene, &a, &b)?.map(|route| route.length_m))
    }

    /// Straight distance between two viewpoints, metres.
    fn straight_m(&self, a: &ViewpointId, b: &ViewpointId) -> f64 {
        let ends = self.graph.position_of(a).zip(self.graph.position_of(b));
        ends.map_or(f64::INFINITY, |(a, b)| a.distance(b))
    }

    fn count_edges(&self, survey: &mut WalkSurvey) -> Result<(), PlatformError> {
        let lengths: Vec<f64> = self.graph.edges().map(|(_, _, length_m)| length_m).collect();
        survey.edges += lengths.len();
        survey.zero_edges += lengths.iter().filter(|length_m| **length_m < ZERO_WAY_M).count();
        let ids: Vec<&ViewpointId> = self.graph.viewpoints().collect();
        for (at, a) in ids.iter().enumerate() {
            for b in ids[at + 1..].iter().filter(|b| self.straight_m(a, b) < CLOSE_M) {
                if self.ground_m(a, b)?.is_some_and(|ground_m| ground_m < CLOSE_M) {
                    survey.close_pairs += 1;
                    survey.close_unjoined += usize::from(!self.distances.has_edge(a, b));
                }
            }
        }
        Ok(())
    }

    fn count_steps(&self, route: &GraphRoute, survey: &mut WalkSurvey) {
        let steps = || route.viewpoints.windows(2);
        survey.route_steps += steps().count();
        survey.edge_steps += steps().filter(|step| self.distances.has_edge(&step[0], &step[1])).count();
    }

    fn walk_at_random(&self, route: &GraphRoute, survey: &mut WalkSurvey, rng: &mut impl Rng) {
        let (Some(start), Some(goal)) = (route.viewpoints.first(), route.viewpoints.last()) else { return };
        for _ in 0..WALKS_PER_ROUTE {
            let mut here = start.clone();
            for _ in 1..route.viewpoints.len() {
                let neighbours = self.graph.neighbours_of(&here);
                if !neighbours.is_empty() {
                    here = neighbours[rng.random_range(0..neighbours.len())].clone();
                }
            }
            let off_m = self.distances.metres_between(&here, goal);
            survey.random_walks += 1;
            survey.random_arrived += usize::from(off_m.is_some_and(|off_m| off_m < ARRIVED_M));
        }
    }

    fn measure_around_goal(
        &self,
        goal: &ViewpointId,
        survey: &mut WalkSurvey,
        detours: &mut Vec<f64>,
        rng: &mut impl Rng,
    ) -> Result<(), PlatformError> {
        let others: Vec<&ViewpointId> = self.graph.viewpoints().filter(|other| *other != goal).collect();
        for other in others.iter().filter(|other| self.straight_m(other, goal) < ARRIVED_M) {
            if self.ground_m(other, goal)?.is_some_and(|ground_m| ground_m < ARRIVED_M) {
                let graph_m = self.distances.metres_between(other, goal);
                survey.near_goal += 1;
                survey.near_goal_arrived += usize::from(graph_m.is_some_and(|graph_m| graph_m < ARRIVED_M));
            }
        }
        for _ in 0..COMPARED_PER_ROUTE.min(others.len()) {
            let other = others[rng.random_range(0..others.len())];
            let both = self.distances.metres_between(other, goal).zip(self.ground_m(other, goal)?);
            detours.extend(both.filter(|(_, ground_m)| *ground_m > 0.0).map(|(graph_m, ground_m)| graph_m / ground_m));
        }
        Ok(())
    }
}
