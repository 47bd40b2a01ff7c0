//! A scene at a glance: all its viewpoints with their rooms, objects and neighbours.

use crate::{DVec3, ObjectId, ObjectLabel, ViewpointGraph, ViewpointId, graph::GraphError};
use std::collections::BTreeMap;

/// All viewpoints of a scene, the edges between them, and what each one shows.
#[derive(Debug, Clone, Default)]
pub struct ViewpointSurvey {
    viewpoints: Vec<SurveyedViewpoint>,
    index: BTreeMap<ViewpointId, usize>,
    objects: Vec<PlacedObject>,
}

/// An object that a platform lists in a scene, whether or not a viewpoint shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedObject {
    /// Its id in the scene.
    pub object: ObjectId,
    /// Its name in plain words.
    pub name: String,
    /// Its centre, metres, world frame.
    pub position: DVec3,
}

/// One viewpoint with what the platform knows of it.
#[derive(Debug, Clone)]
pub struct SurveyedViewpoint {
    /// Its name.
    pub id: ViewpointId,
    /// The eye's position, metres, world frame.
    pub position: DVec3,
    /// How high the floor is there, metres, world frame, where the platform knows it.
    pub floor_m: Option<f64>,
    /// The storey, the lowest being 1.
    pub level: Option<u32>,
    /// Its neighbours, as indices into [`ViewpointSurvey::viewpoints`].
    pub neighbours: Vec<usize>,
    /// The room and the objects that the platform knows there.
    pub known: ViewpointKnowledge,
}

/// The room and the objects that a platform reports for a viewpoint.
#[derive(Debug, Clone, Default)]
pub struct ViewpointKnowledge {
    /// The room ("living room"), where it has a name.
    pub room: Option<String>,
    /// The objects that are seen all around; `None` where the platform does not list them.
    pub things: Option<Vec<ObjectLabel>>,
}

impl ViewpointSurvey {
    /// Surveys a graph; `known` reports the room and the objects at a viewpoint.
    ///
    /// # Errors
    /// When `known` fails, or an edge of the graph leads nowhere.
    pub fn from_graph<E: From<GraphError>>(
        graph: &ViewpointGraph,
        mut known: impl FnMut(&ViewpointId, DVec3) -> Result<ViewpointKnowledge, E>,
    ) -> Result<Self, E> {
        let ids: Vec<&ViewpointId> = graph.viewpoints().collect();
        let index: BTreeMap<ViewpointId, usize> = ids.iter().enumerate().map(|(at, id)| ((*id).clone(), at)).collect();
        let surveyed = |id: &&ViewpointId| {
            let position = graph.position_of(id).ok_or_else(|| GraphError::Unknown((*id).clone()))?;
            let neighbours = graph.neighbours_of(id).into_iter().filter_map(|to| index.get(to).copied()).collect();
            let known = known(id, position)?;
            Ok(SurveyedViewpoint {
                id: (*id).clone(),
                position,
                level: graph.level_of(id),
                floor_m: graph.floor_m(id),
                neighbours,
                known,
            })
        };
        let viewpoints = ids.iter().map(surveyed).collect::<Result<_, E>>()?;
        Ok(Self { viewpoints, index, objects: Vec::new() })
    }

    /// The survey with all objects that the platform lists in the scene, also those that no viewpoint shows.
    #[must_use]
    pub fn with_objects(self, objects: Vec<PlacedObject>) -> Self {
        Self { objects, ..self }
    }

    /// All objects that the platform lists in the scene; empty where it knows no more than its viewpoints show.
    #[must_use]
    pub fn objects(&self) -> &[PlacedObject] {
        &self.objects
    }

    /// All viewpoints, in the order of the graph.
    #[must_use]
    pub fn viewpoints(&self) -> &[SurveyedViewpoint] {
        &self.viewpoints
    }

    /// The index of a viewpoint in [`Self::viewpoints`].
    #[must_use]
    pub fn viewpoint_index(&self, id: &ViewpointId) -> Option<usize> {
        self.index.get(id).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_places_in_the_survey() {
        let id = |name: &str| ViewpointId::new(name).unwrap();
        let mut graph = ViewpointGraph::default();
        for (name, x) in [("c", 0.0), ("a", 1.0), ("b", 2.0)] {
            graph.add_viewpoint(id(name), DVec3::new(x, 0.0, 1.5), Some(1)).unwrap();
        }
        graph.join_viewpoints(&id("c"), &id("a")).unwrap();
        graph.join_viewpoints(&id("a"), &id("b")).unwrap();
        let room =
            |id: &ViewpointId, _| Ok::<_, GraphError>(ViewpointKnowledge { room: Some(id.to_string()), things: None });
        let survey = ViewpointSurvey::from_graph(&graph, room).unwrap();
        let a = &survey.viewpoints()[survey.viewpoint_index(&id("a")).unwrap()];
        let names: Vec<_> = a.neighbours.iter().map(|at| survey.viewpoints()[*at].id.as_str()).collect();
        assert_eq!(names, ["b", "c"]);
        assert_eq!(a.known.room.as_deref(), Some("a"));
        assert_eq!(survey.viewpoint_index(&id("d")), None);
    }
}
