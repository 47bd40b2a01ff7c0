//! A building that is mirrored, turned, moved, renamed or larger than the walks, and the shares of its walks.

use std::collections::BTreeMap;
use wayword_core::{
    DVec3, Heading, ObjectId, ObjectLabel, ViewpointGraph, ViewpointId, ViewpointSurvey, graph::GraphError, survey,
};
use wayword_follower::{
    FeatureWeights, Guide, GuideTrial, KnownBuilding, WalkFit, WalkPrior, WalkTree, best_walk,
    change::{StepChangeKind, rank_changes},
    route::{KnownWalk, goal_probability},
    walk_shares,
};

/// A viewpoint: name, east and north (metres), room, and a thing with its offset.
type Place = (&'static str, [f64; 2], &'static str, Option<(&'static str, [f64; 2])>);

/// Odd places, so that no angle lies on the border of two classes.
const PLACES: [Place; 9] = [
    ("a", [0.0, 0.0], "hallway", None),
    ("b", [0.11, 2.41], "hallway", Some(("plant", [0.83, 0.37]))),
    ("c", [0.23, 5.13], "hallway", None),
    ("d", [-2.37, 5.57], "bedroom", None),
    ("e", [-4.91, 5.03], "bedroom", Some(("bed", [-0.57, 0.61]))),
    ("f", [2.61, 5.71], "kitchen", None),
    ("g", [5.17, 6.07], "kitchen", Some(("oven", [0.47, -0.83]))),
    ("h", [0.31, -2.73], "bathroom", None),
    ("i", [0.43, 8.29], "office", Some(("lamp", [0.71, 0.53]))),
];
const WAYS: [(usize, usize); 8] = [(0, 1), (1, 2), (2, 3), (3, 4), (2, 5), (5, 6), (0, 7), (2, 8)];

const TEXTS: [&str; 5] = [
    "Walk down the hallway and turn right. Walk into the kitchen and wait by the oven.",
    "Walk down the hallway past the plant on your right and turn left. Walk into the bedroom and stop at the bed.",
    "Turn left into the bedroom.",
    "Go straight. Make a slight right turn, then walk to the lamp on the left.",
    "Go to the kitchen and clean the oven.",
];

/// A change of the world: where a place goes, and what a viewpoint is called.
struct World<'a> {
    places: Vec<Place>,
    position: &'a dyn Fn([f64; 2]) -> [f64; 2],
    name: &'a dyn Fn(&str) -> String,
    heading_rad: f64,
}

impl World<'_> {
    fn building(&self) -> (KnownBuilding, BTreeMap<String, usize>) {
        let id = |place: &Place| ViewpointId::new((self.name)(place.0)).unwrap();
        let at = |[east, north]: [f64; 2], up: f64| DVec3::new(east, north, up);
        let mut graph = ViewpointGraph::default();
        for place in &self.places {
            graph.add_viewpoint(id(place), at((self.position)(place.1), 1.5), Some(1)).unwrap();
        }
        for (a, b) in WAYS {
            graph.join_viewpoints(&id(&self.places[a]), &id(&self.places[b])).unwrap();
        }
        let known = |name: &ViewpointId, eye: DVec3| {
            let place = self.places.iter().find(|place| id(place) == *name).unwrap();
            let thing = place.3.map(|(thing, off)| {
                let there = (self.position)([place.1[0] + off[0], place.1[1] + off[1]]);
                let position = at(there, 1.0);
                ObjectLabel {
                    object: ObjectId::new(thing).unwrap(),
                    name: thing.to_owned(),
                    heading: Heading::towards(eye, position).unwrap(),
                    elevation_rad: 0.0,
                    box_px: None,
                    distance_m: None,
                    position: Some(position),
                    colour: None,
                    room: None,
                }
            });
            let things = Some(thing.into_iter().collect());
            Ok::<_, GraphError>(survey::ViewpointKnowledge { room: Some(place.2.to_owned()), things })
        };
        let survey = ViewpointSurvey::from_graph(&graph, known).unwrap();
        let number = |place: &Place| (place.0.to_owned(), survey.viewpoint_index(&id(place)).unwrap());
        (KnownBuilding::from_survey(&survey), self.places.iter().map(number).collect())
    }

    /// The share of each walk, by the first names of its viewpoints, and the best walk.
    fn shares(&self, text: &str, weights: &FeatureWeights) -> (BTreeMap<String, f64>, String) {
        let (building, numbers) = self.building();
        let guide = Guide::read_text(text);
        let tree = WalkTree::from_prior(&building, numbers["a"], self.heading_rad, WalkPrior::TwoPieces(8));
        let fit = WalkFit::new(&GuideTrial::new(&guide, &building), &tree, weights);
        let name = |at: &usize| numbers.iter().find(|(_, number)| *number == at).map_or("?", |(name, _)| name);
        let walk = |walk: usize| tree.viewpoints(walk).iter().map(name).collect::<String>();
        let shares = walk_shares(&fit, &tree).into_iter().enumerate().map(|(at, share)| (walk(at), share)).collect();
        (shares, walk(best_walk(&fit, &tree).unwrap()))
    }
}

fn plain() -> World<'static> {
    World { places: PLACES.to_vec(), position: &|at| at, name: &str::to_owned, heading_rad: 0.05 }
}

fn mirrored_text(text: &str) -> String {
    text.replace("left", "LEFT").replace("right", "left").replace("LEFT", "right")
}

fn assert_alike(a: &BTreeMap<String, f64>, b: &BTreeMap<String, f64>, text: &str) {
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (walk, share) in a {
        assert!((share - b[walk]).abs() < 1e-9, "{text} {walk}: {share} {}", b[walk]);
    }
}

/// Both sets of weights.
fn both_weights() -> [FeatureWeights; 2] {
    [FeatureWeights::fitted().clone(), FeatureWeights::by_hand()]
}

#[test]
fn walk_shares_add_up_to_one_and_lie_between_zero_and_one() {
    for (text, weights) in TEXTS.iter().flat_map(|text| both_weights().map(|weights| (text, weights))) {
        let (shares, best) = plain().shares(text, &weights);
        assert!((shares.values().sum::<f64>() - 1.0).abs() < 1e-9);
        assert!(shares.values().all(|share| (0.0..=1.0).contains(share)));
        assert!(shares["a"] == 0.0 && shares.values().all(|share| *share <= shares[&best]));
        // The building is a tree, so there is one walk to each viewpoint.
        assert_eq!(shares.len(), PLACES.len());
    }
}

#[test]
fn walk_shares_of_a_mirrored_building_belong_to_the_mirrored_text() {
    for (text, weights) in TEXTS.iter().flat_map(|text| both_weights().map(|weights| (text, weights))) {
        let mirror = |[east, north]: [f64; 2]| [-east, north];
        let mirrored = World { position: &mirror, heading_rad: -0.05, ..plain() };
        let (shares, best) = plain().shares(text, &weights);
        let (others, other) = mirrored.shares(&mirrored_text(text), &weights);
        assert_alike(&shares, &others, text);
        assert_eq!(best, other);
    }
    // The mirror matters: the same text leads elsewhere in the mirrored building.
    let mirrored = World { position: &|[east, north]| [-east, north], heading_rad: -0.05, ..plain() };
    let text = "Walk down the hallway, turn right and walk on.";
    let weights = FeatureWeights::fitted();
    let (here, there) = (plain().shares(text, weights).0, mirrored.shares(text, weights).0);
    assert!(here["abcf"] > 2.0 * there["abcf"] && 2.0 * here["abcd"] < there["abcd"], "{here:?} {there:?}");
}

#[test]
fn walk_shares_do_not_depend_on_where_a_building_is_and_how_it_is_turned() {
    let rad = 0.77f64;
    let turned = |[east, north]: [f64; 2]| {
        [east * rad.cos() + north * rad.sin() + 31.0, north * rad.cos() - east * rad.sin() - 17.0]
    };
    let world = World { position: &turned, heading_rad: 0.05 + rad, ..plain() };
    for (text, weights) in TEXTS.iter().flat_map(|text| both_weights().map(|weights| (text, weights))) {
        assert_alike(&plain().shares(text, &weights).0, &world.shares(text, &weights).0, text);
    }
}

#[test]
fn walk_shares_do_not_depend_on_names_of_viewpoints() {
    // The names are in the opposite order.
    let renamed = |name: &str| format!("v{}", u32::from(b'z') - u32::from(name.as_bytes()[0]));
    let world = World { name: &renamed, ..plain() };
    for (text, weights) in TEXTS.iter().flat_map(|text| both_weights().map(|weights| (text, weights))) {
        assert_alike(&plain().shares(text, &weights).0, &world.shares(text, &weights).0, text);
    }
}

#[test]
fn walk_shares_do_not_depend_on_a_place_that_no_way_leads_to() {
    let mut world = plain();
    world.places.push(("j", [60.0, 60.0], "garage", Some(("car", [1.0, 1.0]))));
    for (text, weights) in TEXTS.iter().flat_map(|text| both_weights().map(|weights| (text, weights))) {
        assert_alike(&plain().shares(text, &weights).0, &world.shares(text, &weights).0, text);
    }
}

#[test]
fn rank_changes_finds_the_wrong_side_in_either_mirror() {
    let mirror = |[east, north]: [f64; 2]| [-east, north];
    for (side, wrong, position) in
        [("right", "left", (&|at| at) as &dyn Fn([f64; 2]) -> [f64; 2]), ("left", "right", &mirror)]
    {
        let (building, numbers) = World { position, heading_rad: 0.0, ..plain() }.building();
        let walk = ["a", "b", "c", "f", "g"].map(|name| numbers[name]);
        let gain = |side: &str| {
            let text = format!("Walk down the hallway and turn {side}. Walk into the kitchen and wait by the oven.");
            let changes = rank_changes(&Guide::read_text(&text), &building, &walk, 0.0, FeatureWeights::fitted());
            changes.into_iter().find(|change| change.kind == StepChangeKind::Turn).unwrap().gain
        };
        assert!(gain(wrong) > 2.0 && (gain(side) + gain(wrong)).abs() < 1e-9, "the change back loses what it gained");
    }
}

#[test]
fn leads_there_is_likelier_for_the_place_in_the_text() {
    let (building, numbers) = plain().building();
    let walks = [vec!["a", "b", "c", "f", "g"], vec!["a", "b", "c", "d", "e"], vec!["a", "h"]];
    for (text, meant) in [(TEXTS[0], 0), (TEXTS[1], 1)] {
        let leads: Vec<f64> = walks
            .iter()
            .map(|walk| {
                let walk: Vec<usize> = walk.iter().map(|name| numbers[*name]).collect();
                let known = KnownWalk { building: &building, walk: &walk, heading_rad: 0.05 };
                goal_probability(&Guide::read_text(text), known, Some(WalkPrior::Shortest(8)), FeatureWeights::fitted())
                    .unwrap()
            })
            .collect();
        assert!(leads[meant] > 0.9 && leads.iter().sum::<f64>() < 1.0 + 1e-9, "{text}: {leads:?}");
    }
}
