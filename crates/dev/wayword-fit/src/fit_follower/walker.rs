//! Teaches the follower that has no map and decides at each viewpoint, and scores its walks.

use super::texts::{Scene, Text, mean};
use rayon::prelude::*;
use wayword_core::Heading;
use wayword_follower::online::{Decision, Hop, OnwardSlope, OnwardWeights, Reader, Sighting};

/// Most hops of a walk in training.
const MOST_HOPS: usize = 16;
/// Most hops of a walk that is scored.
const MOST_WALKED: usize = 60;

/// The walker's viewpoint and heading.
struct Body<'a> {
    scene: &'a Scene,
    here: usize,
    heading: Heading,
}

impl<'a> Body<'a> {
    fn at_start(scene: &'a Scene, text: &Text) -> Self {
        let heading = Heading::new(text.heading_rad).unwrap_or(Heading::NORTH);
        Self { scene, here: text.walk[0], heading }
    }

    fn sight(&self) -> Sighting {
        let viewpoints = self.scene.survey.viewpoints();
        let here = &viewpoints[self.here];
        let hop = |to: &usize| Hop::between(here.position, viewpoints[*to].position, self.heading);
        let hops: Vec<Hop> = here.neighbours.iter().map(hop).collect();
        let labels = here.known.things.iter().flatten();
        let things = labels
            .filter_map(|label| Some((label.name.clone(), Hop::nearest(&hops, self.heading, label.heading)?)))
            .collect();
        Sighting { hops, room: here.known.room.clone(), things }
    }

    fn take(&mut self, hop: usize) {
        let viewpoints = self.scene.survey.viewpoints();
        let to = viewpoints[self.here].neighbours[hop];
        self.heading =
            Heading::towards(viewpoints[self.here].position, viewpoints[to].position).unwrap_or(self.heading);
        self.here = to;
    }

    /// The hops of the shortest way to the goal.
    fn way(&self, text: &Text) -> Vec<usize> {
        let viewpoints = self.scene.survey.viewpoints();
        let (mut here, mut way) = (self.here, Vec::new());
        while here != text.walk[text.walk.len() - 1] && way.len() < MOST_WALKED {
            let far_m = |hop: &usize| {
                let to = viewpoints[here].neighbours[*hop];
                text.to_goal_m[to] + self.scene.building.distance(here, to)
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
pub(super) fn teach(scene: &Scene, text: &Text, weights: &OnwardWeights, is_own: bool, slope: &mut OnwardSlope) {
    let mut reader = Reader::new(&text.guide, weights);
    let mut body = Body::at_start(scene, text);
    for _ in 0..MOST_HOPS {
        let seen = body.sight();
        reader.look(&seen);
        let way = body.way(text);
        let right = way.first().copied();
        reader.learn(way, slope);
        let own = if is_own { Some(reader.decide(&seen)) } else { None };
        match (own, right) {
            (Some(Decision::Go(hop)), _) => body.take(hop),
            (_, Some(hop)) => {
                reader.take(hop);
                body.take(hop);
            }
            (_, None) => return,
        }
    }
}

/// Success rate and SPL.
pub(super) fn score(scenes: &[Scene], texts: &[Text], weights: &OnwardWeights) -> String {
    mean(texts.par_iter().map(|text| {
        let scene = &scenes[text.scene];
        let mut reader = Reader::new(&text.guide, weights);
        let mut body = Body::at_start(scene, text);
        let mut walked = vec![body.here];
        while let Decision::Go(hop) = reader.decide(&body.sight()) {
            body.take(hop);
            walked.push(body.here);
            if walked.len() > MOST_WALKED {
                break;
            }
        }
        text.score(scene, &walked)
    }))
}
