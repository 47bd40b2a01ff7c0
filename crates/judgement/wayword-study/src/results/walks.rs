//! Computes the metrics of the participants' walks.

use super::given::trajectory;
use crate::{Data, Move, Route};
use std::collections::BTreeMap;
use wayword_core::{SceneId, ViewpointId};
use wayword_metrics::{Demand, Distances, Score, score};

/// Scores walks; the distances of a scene are computed once.
pub(super) struct Walks<'a> {
    data: &'a Data,
    scenes: BTreeMap<&'a SceneId, Result<Distances, String>>,
}

impl<'a> Walks<'a> {
    pub(super) fn new(data: &'a Data) -> Self {
        Self { data, scenes: BTreeMap::new() }
    }

    /// The metrics of a walk along a route.
    ///
    /// # Errors
    /// The reason why they cannot be computed.
    pub(super) fn score(&mut self, route: u32, moves: &[Move]) -> Result<Score, String> {
        let route = self.route(route)?;
        let start = route.viewpoints.first().ok_or("its route has no viewpoints")?;
        let demand = Demand { reference: route.viewpoints.clone(), object: None, visible_from: None };
        let walk = trajectory(start, moves);
        score(self.distances(&route.scene)?, &demand, &walk)
            .map_err(|problems| problems.first().map_or_else(String::new, ToString::to_string))
    }

    /// How far a viewpoint is from the goal of a route along the graph, metres.
    pub(super) fn metres_to_goal(&mut self, route: u32, from: &ViewpointId) -> Option<f64> {
        let route = self.route(route).ok()?;
        let goal = route.viewpoints.last()?;
        self.distances(&route.scene).ok()?.metres(from, goal)
    }

    fn route(&self, route: u32) -> Result<&'a Route, String> {
        self.data.routes.get(route as usize).ok_or_else(|| format!("the study has no route {route}"))
    }

    fn distances(&mut self, scene: &'a SceneId) -> Result<&Distances, String> {
        let data = self.data;
        let made = self.scenes.entry(scene).or_insert_with(|| {
            let ground = data.scenes.iter().find(|other| other.scene == *scene);
            let graph = ground.ok_or("the study has no such scene")?.graph().map_err(|error| error.to_string())?;
            Ok(Distances::new(&graph))
        });
        made.as_ref().map_err(Clone::clone)
    }
}
