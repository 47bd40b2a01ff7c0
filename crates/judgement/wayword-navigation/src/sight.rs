//! Makes the input of agents at a node: for an agent that walks by phrases, how well they fit four views and which neighbours lie
//! in each view; for an agent that reads, see `sighting`. Agents learn about a scene only through this file.

mod sighting;

pub use sighting::ThingSource;

use crate::error::WalkError;
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    DVec3, Frame, Heading, ObjectId, PhraseGrounder, Platform, Pose, SceneId, View, ViewGaze, ViewpointGraph,
    ViewpointId,
};

/// An agent's access to one scene: a platform that gives views, and a grounder that scores how well phrases fit them.
///
/// The four views look north, east, south and west, so that a node looks the same wherever the agent comes from. Views and
/// scores are cached, so that all agents that walk by one instruction share them.
pub struct AgentView<'a> {
    platform: &'a dyn Platform,
    grounder: &'a dyn PhraseGrounder,
    scene: SceneId,
    graph: Arc<ViewpointGraph>,
    /// Whether the views need pictures; without them the platform draws none.
    needs_pictures: bool,
    /// Cache of the views around each node.
    around: Mutex<BTreeMap<ViewpointId, Arc<NodeViews>>>,
    /// Cache of the grounder's scores, by node and phrases.
    scores: Mutex<BTreeMap<(ViewpointId, Vec<String>), ViewScores>>,
}

/// How well phrases fit each of the four views of a node: for each view, one score per phrase.
type ViewScores = Arc<[Vec<f32>; 4]>;

/// The four views around a node.
struct NodeViews {
    /// North, east, south, west.
    views: [View; 4],
    /// Neighbours in each view, nearest first.
    onward: [Vec<ViewpointId>; 4],
}

/// The input at a node for an agent that walks by phrases.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeSight {
    /// North, east, south, west.
    pub views: [SightView; 4],
}

/// One view at a node, as an agent gets it.
#[derive(Debug, Clone, PartialEq)]
pub struct SightView {
    /// How well each phrase fits, in the order in which they were given.
    pub scores: Vec<f32>,
    /// The neighbours in it, nearest first.
    pub onward: Vec<ViewpointId>,
}

impl<'a> AgentView<'a> {
    /// Opens a scene for agents. If the grounder needs no pictures, the platform draws none.
    ///
    /// # Errors
    /// When the platform cannot give the scene's graph.
    pub fn new(
        platform: &'a dyn Platform,
        grounder: &'a dyn PhraseGrounder,
        needs_pictures: bool,
        scene: &SceneId,
    ) -> Result<Self, WalkError> {
        Ok(Self {
            platform,
            grounder,
            scene: scene.clone(),
            graph: platform.graph_for_scene(scene)?,
            needs_pictures,
            around: Mutex::default(),
            scores: Mutex::default(),
        })
    }

    /// The four views of a node, with the scores of the phrases.
    ///
    /// # Errors
    /// When the platform gives no view, or the grounder fails.
    pub fn look_from(&self, viewpoint: &ViewpointId, phrases: &[String]) -> Result<NodeSight, WalkError> {
        let around = self.cached_views(viewpoint)?;
        let scores = self.phrase_scores(viewpoint, &around, phrases)?;
        let seen = |view: usize| SightView { scores: scores[view].clone(), onward: around.onward[view].clone() };
        Ok(NodeSight { views: std::array::from_fn(seen) })
    }

    /// The object around a node that a phrase fits best, where the grounder can name one.
    ///
    /// # Errors
    /// When the platform gives no view, or the grounder fails.
    pub fn point_at_object(&self, viewpoint: &ViewpointId, phrase: &str) -> Result<Option<ObjectId>, WalkError> {
        let around = self.cached_views(viewpoint)?;
        Ok(self.grounder.point_to_object(&around.views.each_ref(), phrase)?)
    }

    /// The four views of a node, from north clockwise. They are not cached, because the pictures of many walks would fill the
    /// memory.
    ///
    /// # Errors
    /// When the platform gives no view.
    pub(crate) fn views_around(&self, viewpoint: &ViewpointId) -> Result<[View; 4], WalkError> {
        Ok(self.look_around(viewpoint)?.views)
    }

    /// Where a node is, metres, world frame.
    pub(crate) fn node_position(&self, viewpoint: &ViewpointId) -> DVec3 {
        self.graph.position_of(viewpoint).unwrap_or_default()
    }

    /// The direction from one node to another; `None` if one is straight above the other.
    pub(crate) fn heading_to(&self, from: &ViewpointId, to: &ViewpointId) -> Option<Heading> {
        heading_to(&self.graph, from, to)
    }

    fn cached_views(&self, viewpoint: &ViewpointId) -> Result<Arc<NodeViews>, WalkError> {
        if let Some(around) = self.around.lock().unwrap_or_else(PoisonError::into_inner).get(viewpoint) {
            return Ok(Arc::clone(around));
        }
        let around = Arc::new(self.look_around(viewpoint)?);
        let mut all = self.around.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(all.entry(viewpoint.clone()).or_insert(around)))
    }

    fn look_around(&self, viewpoint: &ViewpointId) -> Result<NodeViews, WalkError> {
        let frame = frame_at(&self.graph, &self.scene, viewpoint)?;
        let look = |gaze: ViewGaze| match self.needs_pictures {
            true => self.platform.look_from(&self.scene, &frame, gaze),
            false => self.platform.look_without_picture(&self.scene, &frame, gaze),
        };
        let [north, east, south, west] = ViewGaze::compass_views();
        let views = [look(north)?, look(east)?, look(south)?, look(west)?];
        Ok(NodeViews {
            views,
            onward: ViewGaze::compass_views().map(|gaze| neighbours_in_view(&self.graph, viewpoint, gaze)),
        })
    }

    fn phrase_scores(
        &self,
        viewpoint: &ViewpointId,
        around: &NodeViews,
        phrases: &[String],
    ) -> Result<ViewScores, WalkError> {
        let key = (viewpoint.clone(), phrases.to_vec());
        if let Some(scores) = self.scores.lock().unwrap_or_else(PoisonError::into_inner).get(&key) {
            return Ok(Arc::clone(scores));
        }
        let phrases: Vec<&str> = phrases.iter().map(String::as_str).collect();
        let results = self.grounder.score_phrases(&around.views.each_ref(), &phrases);
        let by_view = results.into_iter().collect::<Result<Vec<_>, _>>()?;
        let is_usable =
            by_view.iter().all(|scores| scores.len() == phrases.len() && scores.iter().all(|score| score.is_finite()));
        let scores = <[Vec<f32>; 4]>::try_from(by_view).ok().filter(|_| is_usable);
        let scores = Arc::new(scores.ok_or_else(|| WalkError::Unusable { grounder: self.grounder.name().to_owned() })?);
        self.scores.lock().unwrap_or_else(PoisonError::into_inner).insert(key, Arc::clone(&scores));
        Ok(scores)
    }
}

/// A frame at a node, looking north.
pub(crate) fn frame_at(graph: &ViewpointGraph, scene: &SceneId, viewpoint: &ViewpointId) -> Result<Frame, WalkError> {
    let unknown = || WalkError::Unknown { scene: scene.clone(), viewpoint: viewpoint.clone() };
    let position = graph.position_of(viewpoint).ok_or_else(unknown)?;
    let pose = Pose::looking_level(position, Heading::NORTH);
    Ok(Frame { pose, viewpoint: Some(viewpoint.clone()), level: graph.level_of(viewpoint) })
}

/// The direction from one node to another; `None` if one is straight above the other.
pub(crate) fn heading_to(graph: &ViewpointGraph, from: &ViewpointId, to: &ViewpointId) -> Option<Heading> {
    Heading::towards(graph.position_of(from)?, graph.position_of(to)?)
}

/// The neighbours that lie in a view, nearest first. A neighbour straight above or below counts as north, because every
/// neighbour must be in one of the views.
fn neighbours_in_view(graph: &ViewpointGraph, from: &ViewpointId, gaze: ViewGaze) -> Vec<ViewpointId> {
    let position = |id: &ViewpointId| graph.position_of(id).unwrap_or_default();
    let here = position(from);
    let lies_in = |to: &&ViewpointId| gaze.holds_heading(heading_to(graph, from, to).unwrap_or(Heading::NORTH));
    let mut in_view: Vec<&ViewpointId> = graph.neighbours_of(from).into_iter().filter(lies_in).collect();
    in_view.sort_by(|a, b| here.distance(position(a)).total_cmp(&here.distance(position(b))));
    in_view.into_iter().cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Cross, id, scene};
    use std::sync::atomic::Ordering;
    use wayword_core::ModelError;

    /// Gives the same scores to every view.
    struct Says(Vec<f32>);

    impl PhraseGrounder for Says {
        fn name(&self) -> &str {
            "says"
        }

        fn score_phrases(&self, views: &[&View], _: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
            views.iter().map(|_| Ok(self.0.clone())).collect()
        }
    }

    fn told(grounder: &Says, phrases: usize) -> Result<NodeSight, WalkError> {
        let world = Cross::new(&[]);
        AgentView::new(&world, grounder, false, &scene())?.look_from(&id("middle"), &vec!["a sink".to_owned(); phrases])
    }

    #[test]
    fn each_neighbour_lies_in_the_view_towards_it() {
        let seen = told(&Says(vec![0.5]), 1).unwrap();
        let names = seen.views.map(|view| view.onward.iter().map(|to| to.as_str().to_owned()).collect::<Vec<_>>());
        assert_eq!(names, [["n1"], ["e1"], ["s1"], ["w1"]]);
    }

    #[test]
    fn a_node_is_looked_at_and_scored_once() {
        let (world, grounder) = (Cross::new(&[]), Says(vec![0.5]));
        let agent_view = AgentView::new(&world, &grounder, false, &scene()).unwrap();
        let phrases = ["a sink".to_owned()];
        assert_eq!(
            agent_view.look_from(&id("n1"), &phrases).unwrap(),
            agent_view.look_from(&id("n1"), &phrases).unwrap()
        );
        assert_eq!(world.looks.load(Ordering::Relaxed), 4);
    }

    #[test]
    fn scores_that_cannot_be_compared_are_refused() {
        for scores in [vec![], vec![f32::NAN, 0.0], vec![0.0; 3]] {
            let error = told(&Says(scores), 2).unwrap_err();
            assert!(matches!(error, WalkError::Unusable { .. }) && !error.ends_run(), "{error}");
        }
        let world = Cross::new(&[]);
        let nowhere = AgentView::new(&world, &Says(vec![]), false, &scene()).unwrap().look_from(&id("attic"), &[]);
        assert!(matches!(nowhere, Err(WalkError::Unknown { .. })));
    }
}
