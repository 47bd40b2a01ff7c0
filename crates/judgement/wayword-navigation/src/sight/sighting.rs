//! Makes the input at a node for an agent that reads: the ways out relative to its body, the room, and through which way each
//! thing lies. The agent gets nothing else, and in particular no information about other nodes.
//!
//! Rooms and labelled things are ground truth, not perception. With [`ThingSource::Scores`] the things are those that the grounder
//! finds in the views; the room still comes from the labels.

use super::AgentView;
use crate::{directions::named_places, error::WalkError, grounders::labels_of};
use wayword_core::{CompassPoint, GroundTruth, Heading, View, ViewpointId};
use wayword_follower::{
    counts_as_seen,
    online::{ThingDirection, WalkerHop, WalkerSighting, WalkerThing},
};

/// The source of the things that an agent is given at a node.
#[derive(Debug, Clone, PartialEq)]
pub enum ThingSource {
    /// From the platform's labels.
    Labels,
    /// From the grounder's scores.
    Scores {
        /// The names to look for.
        names: Vec<String>,
        /// A name with at least this score in a view counts as a thing there.
        threshold: f32,
    },
}

impl ThingSource {
    /// The things that an instruction names, by the grounder's scores.
    #[must_use]
    pub fn named_in(text: &str, threshold: f32) -> Self {
        let names = named_places(text).into_iter().filter(|place| !place.is_room).map(|place| place.name).collect();
        Self::Scores { names, threshold }
    }
}

/// The input for an agent at a node, and the node that each way leads to. The agent gets only the sighting.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NodeSurroundings {
    pub(crate) sighting: WalkerSighting,
    /// In the order of the sighting's hops.
    pub(crate) ways: Vec<ViewpointId>,
}

impl AgentView<'_> {
    /// The surroundings of a node for an agent that looks along `heading`.
    ///
    /// # Errors
    /// When the platform gives no view, labels are asked for and there are none, or the grounder fails.
    pub(crate) fn surroundings_at(
        &self,
        here: &ViewpointId,
        heading: Heading,
        things: &ThingSource,
    ) -> Result<NodeSurroundings, WalkError> {
        let around = self.cached_views(here)?;
        let (ways, hops) = self.ways_from(here, heading);
        let nearest = |direction: Heading| WalkerHop::nearest_hop(&hops, heading, direction);
        let mut found: Vec<WalkerThing> = Vec::new();
        match things {
            ThingSource::Labels => {
                for view in &around.views {
                    let labels = labels_of(view, self.grounder.name())?.0;
                    let thing = |label| WalkerThing::from_label(label, &hops, heading);
                    found.extend(labels.iter().filter(|label| counts_as_seen(label)).filter_map(thing));
                }
            }
            ThingSource::Scores { names, .. } if names.is_empty() => {}
            ThingSource::Scores { names, threshold } => {
                let scores = self.phrase_scores(here, &around, names)?;
                for (view, compass) in CompassPoint::ALL.into_iter().enumerate() {
                    // The first way in the view is the nearest node there.
                    let first = around.onward[view].first().and_then(|to| ways.iter().position(|way| way == to));
                    let Some(hop) = first.or_else(|| nearest(compass.to_heading())) else { continue };
                    let passes = names.iter().zip(&scores[view]).filter(|(_, score)| **score >= *threshold);
                    let place = ThingDirection::Towards(hop);
                    found.extend(passes.map(|(name, _)| WalkerThing { name: name.clone(), place }));
                }
            }
        }
        Ok(NodeSurroundings {
            sighting: WalkerSighting { hops, room: around.views.iter().find_map(view_room), things: found },
            ways,
        })
    }

    /// All labels around a node, and its room; `None` where there are no labels.
    ///
    /// # Errors
    /// When the platform gives no view.
    pub(crate) fn labels_around(&self, here: &ViewpointId) -> Result<Option<GroundTruth>, WalkError> {
        let around = self.cached_views(here)?;
        let all: Option<Vec<&GroundTruth>> = around.views.iter().map(View::ground_truth).collect();
        Ok(all.map(|all| GroundTruth {
            labels: all.iter().flat_map(|truth| &truth.labels).cloned().collect(),
            lists_objects: all.iter().all(|truth| truth.lists_objects),
            room: around.views.iter().find_map(view_room),
        }))
    }

    /// The ways out of a node, for an agent that looks along `heading`: the node that each leads to, and the hop.
    pub(crate) fn ways_from(&self, here: &ViewpointId, heading: Heading) -> (Vec<ViewpointId>, Vec<WalkerHop>) {
        let ways: Vec<ViewpointId> = self.graph.neighbours_of(here).into_iter().cloned().collect();
        let hops = ways
            .iter()
            .map(|to| WalkerHop::between(self.node_position(here), self.node_position(to), heading))
            .collect();
        (ways, hops)
    }
}

fn view_room(view: &View) -> Option<String> {
    view.ground_truth()?.room.clone()
}
