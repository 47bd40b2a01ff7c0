//! Teaches the follower that has no map and decides at each viewpoint, and scores its walks.

use super::texts::{FollowerScene, WalkedText, mean_scores};
use rayon::prelude::*;
use wayword_core::Heading;
use wayword_follower::online::{
    OnwardSlope, OnwardWeights, WalkerDecision, WalkerHop, WalkerSighting, WalkerThing, WalkingFollower,
};

/// Hops of a walk in training at most; then the walk is cut off.
const MAX_TRAINING_HOPS: usize = 16;
/// Hops of a walk that is scored at most; then it counts as ending where it is.
const MAX_SCORED_HOPS: usize = 60;

/// The walker's viewpoint and heading.
struct WalkerBody<'a> {
    scene: &'a FollowerScene,
    /// The number of the viewpoint in the survey of the scene.
    here: usize,
    heading: Heading,
}

impl<'a> WalkerBody<'a> {
    /// At the first viewpoint of a text's walk, with the heading of its start.
    fn at_start(scene: &'a FollowerScene, text: &WalkedText) -> Self {
        let heading = Heading::new(text.heading_rad).unwrap_or(Heading::NORTH);
        Self { scene, here: text.walk[0], heading }
    }

    /// The hops from the walker's viewpoint, the room, and by which hop each thing lies.
    fn current_sighting(&self) -> WalkerSighting {
        let viewpoints = self.scene.survey.viewpoints();
        let here = &viewpoints[self.here];
        let hop = |to: &usize| WalkerHop::between(here.position, viewpoints[*to].position, self.heading);
        let hops: Vec<WalkerHop> = here.neighbours.iter().map(hop).collect();
        let labels = here.known.things.iter().flatten();
        let things = labels.filter_map(|label| WalkerThing::from_label(label, &hops, self.heading)).collect();
        WalkerSighting { hops, room: here.known.room.clone(), things }
    }

    /// Moves to the neighbour number `hop`, and turns in the direction of the move.
    fn take_hop(&mut self, hop: usize) {
        let viewpoints = self.scene.survey.viewpoints();
        let to = viewpoints[self.here].neighbours[hop];
        self.heading =
            Heading::towards(viewpoints[self.here].position, viewpoints[to].position).unwrap_or(self.heading);
        self.here = to;
    }

    /// The hops of the shortest way to the goal of a text, each as a number of a neighbour.
    fn shortest_way(&self, text: &WalkedText) -> Vec<usize> {
        let viewpoints = self.scene.survey.viewpoints();
        let (mut here, mut way) = (self.here, Vec::new());
        while here != text.walk[text.walk.len() - 1] && way.len() < MAX_SCORED_HOPS {
            let far_m = |hop: &usize| {
                let to = viewpoints[here].neighbours[*hop];
                text.to_goal_m[to] + self.scene.building.distance_m(here, to)
            };
            let Some(hop) = (0..viewpoints[here].neighbours.len()).min_by(|a, b| far_m(a).total_cmp(&far_m(b))) else {
                return way;
            };
            way.push(hop);
            here = viewpoints[here].neighbours[hop];
        }
        way
    }
}

/// Adds the slope for the right decision at each viewpoint of a walk. With `is_own` the walker goes by its own decisions, so that it also
/// learns to come back from errors; otherwise it keeps to the shortest way.
pub(super) fn teach_walker(
    scene: &FollowerScene,
    text: &WalkedText,
    weights: &OnwardWeights,
    is_own: bool,
    slope: &mut OnwardSlope,
) {
    let mut reader = WalkingFollower::new(&text.guide, weights);
    let mut body = WalkerBody::at_start(scene, text);
    for _ in 0..MAX_TRAINING_HOPS {
        let sighting = body.current_sighting();
        reader.look_around(&sighting);
        let way = body.shortest_way(text);
        let right_hop = way.first().copied();
        reader.learn_decision(way, slope);
        let own_decision = if is_own { Some(reader.decide_next(&sighting)) } else { None };
        match (own_decision, right_hop) {
            (Some(WalkerDecision::Go(hop)), _) => body.take_hop(hop),
            (_, Some(hop)) => {
                reader.take_hop(hop);
                body.take_hop(hop);
            }
            (_, None) => return,
        }
    }
}

/// Success rate and SPL (success weighted by path length) of the walks that the follower without a map takes.
pub(super) fn score_walker(scenes: &[FollowerScene], texts: &[WalkedText], weights: &OnwardWeights) -> String {
    mean_scores(texts.par_iter().map(|text| {
        let scene = &scenes[text.scene];
        let mut reader = WalkingFollower::new(&text.guide, weights);
        let mut body = WalkerBody::at_start(scene, text);
        let mut walked = vec![body.here];
        while let WalkerDecision::Go(hop) = reader.decide_next(&body.current_sighting()) {
            body.take_hop(hop);
            walked.push(body.here);
            if walked.len() > MAX_SCORED_HOPS {
                break;
            }
        }
        text.score_walk(scene, &walked)
    }))
}
