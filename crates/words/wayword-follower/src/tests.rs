//! A follower on a small made-up building: a hall that runs north, with a room on either side of its end.

use crate::{
    FeatureWeights, Guide, GuideTrial, KnownBuilding, WalkFit, WalkPrior, WalkTree, best_walk,
    change::{StepChangeKind, rank_changes},
    online::{OnwardWeights, WalkerDecision, WalkerHop, WalkerSighting, WalkerThing, WalkingFollower},
    route::{GainThresholds, KnownWalk, UnfollowedReason, judge_route, judge_steps},
    swap::best_swap,
    walk_shares,
};
use wayword_core::{
    CheckKind, DVec3, Heading, ObjectId, ObjectLabel, ViewpointGraph, ViewpointId, ViewpointSurvey, graph::GraphError,
    survey,
};

/// Viewpoints: name, east and north (metres), room.
const PLACES: [(&str, f64, f64, &str); 8] = [
    ("start", 0.0, 0.0, "hallway"),
    ("middle", 0.0, 2.5, "hallway"),
    ("end", 0.0, 5.0, "hallway"),
    ("west", -2.5, 5.0, "bedroom"),
    ("far west", -5.0, 5.0, "bedroom"),
    ("east", 2.5, 5.0, "kitchen"),
    ("far east", 5.0, 5.0, "kitchen"),
    ("south", 0.0, -2.5, "bathroom"),
];
const WAYS: [(usize, usize); 7] = [(0, 1), (1, 2), (2, 3), (3, 4), (2, 5), (5, 6), (0, 7)];

fn id(at: usize) -> ViewpointId {
    ViewpointId::new(PLACES[at].0.replace(' ', "-")).unwrap()
}

fn label(name: &str, east: f64, north: f64, eye: DVec3) -> ObjectLabel {
    let position = DVec3::new(east, north, 1.0);
    ObjectLabel {
        object: ObjectId::new(name).unwrap(),
        name: name.to_owned(),
        heading: Heading::towards(eye, position).unwrap_or(Heading::NORTH),
        elevation_rad: 0.0,
        box_px: None,
        distance_m: None,
        position: Some(position),
        colour: None,
        room: None,
    }
}

pub(crate) fn surveyed() -> ViewpointSurvey {
    surveyed_at(None)
}

/// The survey with this distance for each label, metres.
pub(crate) fn surveyed_at(distance_m: Option<f64>) -> ViewpointSurvey {
    let mut graph = ViewpointGraph::default();
    for (at, (_, east, north, _)) in PLACES.iter().enumerate() {
        graph.add_viewpoint(id(at), DVec3::new(*east, *north, 1.5), Some(1)).unwrap();
    }
    for (a, b) in WAYS {
        graph.join_viewpoints(&id(a), &id(b)).unwrap();
    }
    let known = |name: &ViewpointId, eye: DVec3| {
        let at = (0..PLACES.len()).find(|at| id(*at) == *name).unwrap();
        let things = match at {
            1 => vec![label("plant", 0.8, 2.5, eye)],
            4 => vec![label("bed", -5.5, 5.5, eye)],
            6 => vec![label("oven", 5.5, 5.5, eye)],
            _ => Vec::new(),
        };
        let things = things.into_iter().map(|label| ObjectLabel { distance_m, ..label }).collect();
        Ok::<_, GraphError>(survey::ViewpointKnowledge { room: Some(PLACES[at].3.to_owned()), things: Some(things) })
    };
    ViewpointSurvey::from_graph(&graph, known).unwrap()
}

/// The end of the walk that a text means, from the start looking north.
fn end_of(text: &str, weights: &FeatureWeights) -> &'static str {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(text);
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    let fit = WalkFit::new(&GuideTrial::new(&guide, &building), &tree, weights);
    PLACES[tree.end_viewpoint(best_walk(&fit, &tree).unwrap())].0
}

const TO_KITCHEN: &str = "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.";
const TO_BEDROOM: &str = "Walk down the hallway and turn left. Walk into the bedroom and wait by the bed.";

#[test]
fn the_best_walk_ends_at_the_place_in_the_text() {
    for weights in [FeatureWeights::fitted(), &FeatureWeights::by_hand()] {
        assert_eq!(end_of(TO_KITCHEN, weights), "far east");
        assert_eq!(end_of(TO_BEDROOM, weights), "far west");
    }
    assert_eq!(end_of("Turn around and go into the bathroom.", FeatureWeights::fitted()), "south");
}

#[test]
fn shares_add_up_to_one() {
    let building = KnownBuilding::from_survey(&surveyed());
    let guide = Guide::read_text(TO_KITCHEN);
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(8));
    let fit = WalkFit::new(&GuideTrial::new(&guide, &building), &tree, FeatureWeights::fitted());
    let shares = walk_shares(&fit, &tree);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
    assert!(shares[0].abs() < f64::EPSILON, "the start alone is no walk");
}

#[test]
fn changing_a_wrong_turn_gains_most() {
    let building = KnownBuilding::from_survey(&surveyed());
    let walk = [0, 1, 2, 5, 6];
    let gain = |text: &str| {
        let changes = rank_changes(&Guide::read_text(text), &building, &walk, 0.0, FeatureWeights::fitted());
        let turn = changes.into_iter().find(|change| change.kind == StepChangeKind::Turn).unwrap();
        (turn.gain, text[turn.span[0]..turn.span[1]].to_owned())
    };
    let (right, _) = gain(TO_KITCHEN);
    let wrong = TO_KITCHEN.replace("right", "left");
    let (gained, words) = gain(&wrong);
    assert!(right < 0.0 && gained > 2.0, "{right} {gained}");
    assert!("turn left".ends_with(&words), "{words:?}");
}

#[test]
fn swapping_misplaced_places_gains() {
    let building = KnownBuilding::from_survey(&surveyed());
    let walk = [0, 1, 2, 5, 6];
    let known = KnownWalk { building: &building, walk: &walk, heading_rad: 0.0 };
    let orders = |text: &str| {
        let guide = Guide::read_text(text);
        let swap = best_swap(&guide, &building, &walk, 0.0, FeatureWeights::fitted()).unwrap();
        let judged = judge_steps(&guide, known, FeatureWeights::fitted(), GainThresholds::default());
        (swap, judged.wrong.into_iter().filter(|finding| finding.check == CheckKind::Order).count())
    };
    let (right, fails) = orders("Walk past the plant, turn right and stop at the oven.");
    assert!(right.gain < 0.0 && fails == 0, "{right:?}");
    let text = "Walk past the oven, turn right and stop at the plant.";
    let (wrong, fails) = orders(text);
    assert_eq!(wrong.names, ["oven", "plant"]);
    assert_eq!(wrong.spans.map(|[from, to]| &text[from..to]), ["oven", "plant"]);
    assert_eq!(fails, 1, "{wrong:?}");
    let lacking = Guide::read_text("Walk past the piano and stop at the oven.");
    assert_eq!(best_swap(&lacking, &building, &walk, 0.0, FeatureWeights::fitted()), None, "the building has no piano");
}

#[test]
fn a_text_of_another_walk_leads_elsewhere() {
    let building = KnownBuilding::from_survey(&surveyed());
    let known = KnownWalk { building: &building, walk: &[0, 1, 2, 5, 6], heading_rad: 0.0 };
    let route = |text: &str| {
        judge_route(
            &Guide::read_text(text),
            known,
            Some(WalkPrior::Shortest(8)),
            FeatureWeights::fitted(),
            GainThresholds::default(),
        )
    };
    let own = route(TO_KITCHEN).unwrap();
    assert_eq!(own.ends, [6]);
    assert!(own.share > 0.5, "{}", own.share);
    let other = route(TO_BEDROOM).unwrap();
    assert!(other.share < 0.01 && other.other > 0.5, "{} {}", other.share, other.other);
    assert_eq!(other.finding.check, CheckKind::Route);
    assert!(route("Go.").unwrap().ends.len() > 1, "a text that says nothing may end anywhere");
}

#[test]
fn texts_with_too_few_or_too_many_steps_are_not_followed() {
    let building = KnownBuilding::from_survey(&surveyed());
    // Up and down the hall: more hops than one step leads.
    let walk: Vec<usize> = [0, 1, 2, 1].into_iter().cycle().take(12).collect();
    let known = KnownWalk { building: &building, walk: &walk, heading_rad: 0.0 };
    let told = |text: &str| {
        let (guide, weights, thresholds) =
            (Guide::read_text(text), FeatureWeights::fitted(), GainThresholds::default());
        let route = judge_route(&guide, known, Some(WalkPrior::Shortest(8)), weights, thresholds);
        (route, judge_steps(&guide, known, weights, thresholds))
    };
    let (few, of_few) = told("Walk to the kitchen.");
    assert_eq!(few, Err(UnfollowedReason::TooFewSteps));
    assert_eq!(of_few.wrong, []);
    let (many, of_many) = told(&"Turn left. ".repeat(100));
    assert_eq!(many, Err(UnfollowedReason::TooManySteps));
    assert_eq!((of_many.wrong.len(), of_many.turn_gain), (0, None), "nothing is said of its turns");
}

#[test]
fn walks_of_two_pieces_pass_no_viewpoint_twice() {
    let building = KnownBuilding::from_survey(&surveyed());
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::TwoPieces(6));
    for walk in 0..tree.len() {
        let mut viewpoints = tree.viewpoints(walk);
        assert_eq!(tree.find_walk(&viewpoints), Some(walk));
        let count = viewpoints.len();
        viewpoints.sort_unstable();
        viewpoints.dedup();
        assert_eq!(viewpoints.len(), count);
    }
}

/// What a body sees at a viewpoint.
fn sight(survey: &ViewpointSurvey, here: usize, heading: Heading) -> WalkerSighting {
    let all = survey.viewpoints();
    let hop = |to: &usize| WalkerHop::between(all[here].position, all[*to].position, heading);
    let hops: Vec<WalkerHop> = all[here].neighbours.iter().map(hop).collect();
    WalkerSighting {
        room: all[here].known.room.clone(),
        things: all[here]
            .known
            .things
            .iter()
            .flatten()
            .filter_map(|label| WalkerThing::from_label(label, &hops, heading))
            .collect(),
        hops,
    }
}

#[test]
fn a_walker_gets_there_without_a_map() {
    let survey = surveyed();
    for (text, goal) in [(TO_KITCHEN, "kitchen"), (TO_BEDROOM, "bedroom")] {
        let guide = Guide::read_text(text);
        let mut reader = WalkingFollower::new(&guide, OnwardWeights::fitted());
        let (mut here, mut heading) = (0, Heading::NORTH);
        for _ in 0..40 {
            let WalkerDecision::Go(hop) = reader.decide_next(&sight(&survey, here, heading)) else { break };
            let to = survey.viewpoints()[here].neighbours[hop];
            heading = Heading::towards(survey.viewpoints()[here].position, survey.viewpoints()[to].position).unwrap();
            here = to;
        }
        assert_eq!(PLACES[here].3, goal, "{text}");
    }
}

#[test]
fn a_walker_without_a_way_out_stops() {
    let guide = Guide::read_text("Walk on.");
    let mut reader = WalkingFollower::new(&guide, OnwardWeights::fitted());
    assert_eq!(reader.decide_next(&WalkerSighting::default()), WalkerDecision::Stop);
}

#[test]
fn an_empty_text_has_no_step() {
    assert!(Guide::read_text("").is_empty() && Guide::read_text(" . ! ").is_empty());
    assert_eq!(Guide::read_text("Turn left, then turn right.").len(), 2);
}
