use super::*;
use crate::{
    features::{WalkStretch, stretch_features, tables},
    learn::FitPlan,
    made_buildings::random_weights,
    online::{OnwardLearner, ThingDirection, WalkerHop, WalkerThing},
};
use std::f64::consts::{FRAC_PI_2, PI};
use wayword_core::{DVec3, Heading, ObjectId, ObjectLabel};

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() < tolerance
}

fn hop(turn_rad: f64, length_m: f64) -> WalkerHop {
    WalkerHop { turn_rad, elevation_rad: 0.0, length_m }
}

fn sight(hops: &[WalkerHop], room: &str, things: &[(&str, usize)]) -> WalkerSighting {
    let thing =
        |(name, hop): &(&str, usize)| WalkerThing { name: (*name).into(), place: ThingDirection::Towards(*hop) };
    let things = things.iter().map(thing).collect();
    WalkerSighting { hops: hops.to_vec(), room: Some(room.to_owned()), things }
}

/// Weights without any pattern.
fn random_onward(seed: u64) -> OnwardWeights {
    let mut weights =
        OnwardWeights { done: random_weights(seed), going: random_weights(seed + 100), ..OnwardWeights::by_hand() };
    weights.left = std::array::from_fn(|at| 0.3 - 0.1 * at as f64);
    weights.away = [0.2, -0.1].map(|by| std::array::from_fn(|at| by * at as f64));
    weights
}

#[test]
fn between_measures_a_hop_from_the_walker_s_heading() {
    let east = Heading::towards(DVec3::ZERO, DVec3::new(1.0, 0.0, 0.0)).unwrap();
    let hop = WalkerHop::between(DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 4.0, 4.0), east);
    assert!(near(hop.turn_rad, -FRAC_PI_2, 1e-9) && near(hop.length_m, 5.0, 1e-9));
    assert!(near(hop.elevation_rad, (4.0f64 / 3.0).atan(), 1e-9));
    let up = WalkerHop::between(DVec3::ZERO, DVec3::new(0.0, 0.0, -2.0), east);
    assert!(up.turn_rad == 0.0 && near(up.elevation_rad, -FRAC_PI_2, 1e-9));
}

#[test]
fn nearest_hop_has_the_smallest_angle_to_a_direction() {
    let hops = [hop(0.0, 1.0), hop(1.0, 1.0), hop(-2.5, 1.0)];
    let nearest =
        |rad: f64| WalkerHop::nearest_hop(&hops, Heading::NORTH.turned_by(0.5), Heading::NORTH.turned_by(0.5 + rad));
    assert_eq!([0.1, 0.4, 0.6, -1.0, -1.5, 3.0].map(nearest), [Some(0), Some(0), Some(1), Some(0), Some(2), Some(2)]);
    assert_eq!(WalkerHop::nearest_hop(&[], Heading::NORTH, Heading::NORTH), None);
}

#[test]
fn walker_map_puts_a_thing_with_a_distance_where_it_is_seen() {
    let mut map = WalkerMap::new();
    map.note_sighting(&sight(&[hop(FRAC_PI_2, 2.0)], "hall", &[]));
    map.go_to(1);
    let lamp = hop(-FRAC_PI_2, 1.2);
    let thing = WalkerThing { name: "lamp".into(), place: ThingDirection::At(lamp) };
    map.note_sighting(&WalkerSighting { things: vec![thing], ..sight(&[hop(PI, 2.0)], "hall", &[]) });
    assert!(map.building.things[0].position.distance(DVec3::new(2.0, 1.2, 0.0)) < 1e-9);
}

#[test]
fn from_label_takes_the_direction_from_the_body_and_the_nearest_hop_without_a_distance() {
    let label = |distance_m: Option<f64>| ObjectLabel {
        object: ObjectId::new("7").unwrap(),
        name: "lamp".into(),
        heading: Heading::NORTH.turned_by(1.5),
        elevation_rad: 0.2,
        box_px: None,
        distance_m,
        position: None,
        room: None,
        colour: None,
    };
    let (hops, east) = ([hop(0.0, 1.0), hop(PI, 1.0)], Heading::NORTH.turned_by(1.0));
    let place = |label: &ObjectLabel, hops: &[WalkerHop]| WalkerThing::from_label(label, hops, east).map(|it| it.place);
    let Some(ThingDirection::At(seen)) = place(&label(Some(2.5)), &hops) else { panic!("the label has a distance") };
    assert!(near(seen.turn_rad, 0.5, 1e-9) && (seen.elevation_rad, seen.length_m) == (0.2, 2.5));
    assert_eq!(place(&label(None), &hops), Some(ThingDirection::Towards(0)));
    assert_eq!(place(&label(None), &[]), None);
}

#[test]
fn walker_map_places_hops_and_things_in_the_frame_of_the_start() {
    let mut map = WalkerMap::new();
    let up = WalkerHop { turn_rad: FRAC_PI_2, elevation_rad: 0.5, length_m: 2.0 };
    map.note_sighting(&sight(&[hop(0.0, 2.0), up, hop(PI, 1.0)], "attic", &[("Sofa", 0), ("lamp", 2), ("oven", 9)]));
    let position = |map: &WalkerMap, at: usize| map.building.viewpoints[at].position;
    assert!(position(&map, 1).distance(DVec3::new(0.0, 2.0, 0.0)) < 1e-9);
    assert!(position(&map, 2).distance(DVec3::new(2.0 * 0.5f64.cos(), 0.0, 2.0 * 0.5f64.sin())) < 1e-9);
    assert!(position(&map, 3).distance(DVec3::new(0.0, -1.0, 0.0)) < 1e-9);
    assert_eq!(map.ways[0], [1, 2, 3]);
    assert_eq!(map.building.viewpoints[0].neighbours, [1, 2, 3]);
    assert_eq!(map.building.viewpoints[2].neighbours, [0]);
    assert_eq!(map.building.viewpoints[0].climbs, [true, false]);
    let things: Vec<_> =
        map.building.things.iter().map(|thing| (&*thing.name, thing.position, &*thing.seen_from)).collect();
    assert_eq!(things.len(), 2, "a thing in no hop's direction has no place");
    assert!(things[0].0 == "sofa" && things[0].1.distance(DVec3::new(0.0, 1.5, 0.0)) < 1e-9 && things[0].2 == [0]);
    assert!(things[1].0 == "lamp" && things[1].1.distance(DVec3::new(0.0, -1.0, 0.0)) < 1e-9);
    let known: Vec<_> = map.building.viewpoints.iter().map(|at| (at.is_known, at.room.as_deref())).collect();
    assert_eq!(known, [(true, Some("attic")), (false, None), (false, None), (false, None)]);

    // To the right: from there, back and on.
    map.go_to(2);
    assert!(map.here == 2 && near(map.heading_rad, FRAC_PI_2, 1e-9));
    let back = WalkerHop { turn_rad: PI, elevation_rad: -0.5, length_m: 2.0 };
    map.note_sighting(&sight(&[back, hop(-FRAC_PI_2, 3.0)], "kitchen", &[]));
    assert_eq!(map.ways[2], [0, 4]);
    assert!(position(&map, 4).distance(position(&map, 2) + DVec3::new(0.0, 3.0, 0.0)) < 1e-9);
    assert_eq!((map.building.len(), map.building.viewpoints[2].neighbours.clone()), (5, vec![0, 4]));
    assert_eq!(map.building.viewpoints[0].neighbours, [1, 2, 3], "no way is added twice");
}

#[test]
fn walker_map_knows_a_place_again_and_tells_two_at_one_place_apart() {
    let mut map = WalkerMap::new();
    let first = sight(&[hop(0.0, 2.0), hop(PI, 0.0)], "attic", &[("sofa", 0)]);
    map.note_sighting(&first);
    assert_eq!((map.building.len(), &*map.ways[0]), (2, &[1, 0][..]));
    assert_eq!(map.building.viewpoints[0].neighbours, [1], "no way leads from a place to itself");
    map.note_sighting(&first);
    assert_eq!((map.building.len(), map.here, map.building.things.len()), (2, 0, 1));
    // A little off is the same place.
    map.note_sighting(&sight(&[hop(0.0, 2.04), hop(PI, 0.04)], "attic", &[]));
    assert_eq!((map.building.len(), map.here), (2, 0));
    map.note_sighting(&sight(&[hop(0.0, 2.0), hop(FRAC_PI_2, 3.0)], "kitchen", &[]));
    assert_eq!((map.building.len(), map.here, &*map.ways[2]), (4, 2, &[1, 3][..]));
    assert_eq!(map.building.viewpoints[0].room.as_deref(), Some("attic"));
    assert_eq!(map.building.viewpoints[2].room.as_deref(), Some("kitchen"));
    map.here = 0;
    map.note_sighting(&sight(&[hop(0.0, 2.0)], "attic", &[]));
    assert_eq!(map.here, 4, "another number of ways is another viewpoint");
}

#[test]
fn walker_map_takes_near_ends_of_two_hops_for_one_viewpoint() {
    let mut map = WalkerMap::new();
    map.note_sighting(&sight(&[hop(0.0, 2.0), hop(0.0, 2.04), hop(0.0, 2.06)], "attic", &[]));
    assert_eq!((map.building.len(), &*map.ways[0]), (3, &[1, 1, 2][..]));
}

/// A walker that stands one hop from its start, before a fork.
fn at_a_fork<'a>(guide: &'a Guide, weights: &'a OnwardWeights) -> WalkingFollower<'a> {
    let mut walker = WalkingFollower::new(guide, weights);
    walker.look_around(&sight(&[hop(0.1, 2.0), hop(2.0, 1.7)], "hallway", &[("plant", 0)]));
    walker.take_hop(0);
    walker.look_around(&sight(
        &[hop(PI, 2.0), hop(1.5, 2.3), hop(-1.4, 2.6), hop(0.3, 1.9)],
        "hallway",
        &[("oven", 1)],
    ));
    walker
}

const TEXT: &str = "Walk past the plant and turn right. Walk into the kitchen and wait by the oven.";

#[test]
fn onward_fit_is_the_sum_over_steps_in_progress_and_their_begins() {
    let guide = Guide::read_text(TEXT);
    let weights = random_onward(3);
    let walker = at_a_fork(&guide, &weights);
    let building = &walker.map.building;
    let trial = GuideTrial::new_partial(&guide, building);
    let tree = WalkTree::from_prior(building, 0, 0.0, WalkPrior::Shortest(10));
    let fit = WalkFit::new(&trial, &tree, &weights.done);
    let onward = OnwardFit::new(&trial, &tree, &fit, &weights);
    let mut count = 0;
    for node in 0..tree.len() {
        let mut sum = 0.0;
        if !building.viewpoints[tree.end_viewpoint(node)].is_known {
            let back: Vec<usize> = tree.nodes_back(node).collect();
            for (hops, step) in (1..back.len()).flat_map(|hops| (0..guide.len()).map(move |step| (hops, step))) {
                let mut found = Vec::new();
                stretch_features(&trial, step, &WalkStretch::to_node(&tree, node, hops), &mut found);
                let left = weights.left[guide.len() - 1 - step];
                sum += (fit.sum_after(step, back[hops]) + weights.going.sum_weights(&found) + left).exp();
            }
            count += 1;
        }
        assert!(near(onward.score(node).exp(), sum, 1e-9 * (1.0 + sum)), "{node}");
    }
    assert_eq!((count, tree.len()), (4, 6));
}

#[test]
fn learn_decision_is_the_derivative_of_the_loss_by_every_weight() {
    let guide = Guide::read_text(TEXT);
    let weights = random_onward(5);
    // Back at the start, on to the right, on through another hop, and to stop here.
    for way in [vec![0, 1], vec![1], vec![2, 5], vec![]] {
        let loss = |values: &[f64]| {
            let weights = OnwardWeights::from_values(values);
            let mut slope = OnwardSlope::default();
            at_a_fork(&guide, &weights).learn_decision(way.iter().copied(), &mut slope);
            slope.loss
        };
        let mut slope = OnwardSlope::default();
        at_a_fork(&guide, &weights).learn_decision(way.iter().copied(), &mut slope);
        assert!(slope.loss > 0.0 && slope.decisions == 1);
        let slope = [&slope.done[..], &slope.going, &slope.left, slope.away.as_flattened()].concat();
        let values = weights.values();
        assert_eq!(slope.len(), values.len());
        let mut count = 0;
        for at in (0..slope.len()).filter(|at| slope[*at] != 0.0 || at % 997 == 0 || *at >= 2 * tables::COUNT) {
            let at_offset = |off: f64| {
                let mut values = values.clone();
                values[at] += off;
                loss(&values)
            };
            let expected = (at_offset(1e-4) - at_offset(-1e-4)) / 2e-4;
            assert!(near(slope[at], expected, 1e-4), "{way:?} weight {at}: {} {expected}", slope[at]);
            count += usize::from(expected.abs() > 1e-3);
        }
        assert!(count > 60, "{count}");
    }
}

#[test]
fn learn_decision_goes_to_the_last_known_viewpoint_of_the_way() {
    let guide = Guide::read_text(TEXT);
    let weights = random_onward(6);
    let walker = at_a_fork(&guide, &weights);
    let loss = |way: &[usize]| {
        let mut slope = OnwardSlope::default();
        walker.learn_decision(way.iter().copied(), &mut slope);
        (slope.loss, slope.decisions)
    };
    assert_eq!(loss(&[1]), loss(&[1, 7]), "what comes after an unknown viewpoint does not matter");
    assert_ne!(loss(&[1]), loss(&[2]));
    assert_eq!(loss(&[9]), (0.0, 0), "there is no such way");
    assert_eq!(loss(&[0]), (0.0, 0), "no walk ends at its start");
    // The shares of all decisions add up to one.
    let whole: f64 = [&[][..], &[1], &[2], &[3], &[0, 1]].iter().map(|way| (-loss(way).0).exp()).sum();
    assert!(near(whole, 1.0, 1e-9), "{whole}");
}

#[test]
fn onward_weights_survive_their_list() {
    let weights = random_onward(1);
    let values = weights.values();
    assert_eq!(values.len(), 2 * tables::COUNT + 8 + 16);
    assert_eq!(OnwardWeights::from_values(&values), weights);
    assert_eq!((values[2 * tables::COUNT], values[2 * tables::COUNT + 9]), (0.3, 0.2));
    assert_ne!(*OnwardWeights::fitted(), OnwardWeights::by_hand());
}

#[test]
fn onward_slope_adds_up() {
    let mut a = OnwardSlope::default();
    let mut b = OnwardSlope::default();
    for (slope, value) in [(&mut a, 1.0), (&mut b, 0.25)] {
        slope.done[3] = value;
        slope.going[4] = 2.0 * value;
        slope.left[5] = 3.0 * value;
        slope.away[1][6] = 4.0 * value;
        slope.loss = 5.0 * value;
    }
    (a.decisions, b.decisions) = (2, 3);
    let sum = a.plus(&b);
    assert_eq!((sum.done[3], sum.going[4], sum.left[5], sum.away[1][6]), (1.25, 2.5, 3.75, 5.0));
    assert_eq!((sum.loss, sum.decisions), (6.25, 5));
}

#[test]
fn onward_learner_lowers_the_loss() {
    let guide = Guide::read_text(TEXT);
    let start = random_onward(8);
    let slope = |weights: &OnwardWeights| {
        let mut slope = OnwardSlope::default();
        at_a_fork(&guide, weights).learn_decision([2], &mut slope);
        slope
    };
    let mut learner = OnwardLearner::new(FitPlan { rounds: 4, ..FitPlan::default() }, &start);
    assert_eq!(learner.current_weights(), start);
    let mut last = slope(&start).loss;
    for round in 0..4 {
        learner.step_down(round, &slope(&learner.current_weights()));
        let now = slope(&learner.current_weights()).loss;
        assert!(now < last, "{now} {last}");
        last = now;
    }
    let weights = learner.current_weights();
    assert_eq!(learner.finish(), weights);
}

#[test]
fn take_hop_ignores_a_hop_that_is_not_there() {
    let guide = Guide::read_text(TEXT);
    let weights = random_onward(8);
    let mut walker = WalkingFollower::new(&guide, &weights);
    walker.look_around(&sight(&[hop(0.1, 2.0)], "hallway", &[]));
    walker.take_hop(3);
    assert!(walker.map.building.len() == 2 && walker.map.here == 0);
    walker.take_hop(0);
    assert!(walker.map.here == 1);
}

#[test]
fn decide_next_stops_after_60_hops() {
    let guide = Guide::read_text("Walk on. Walk on. Walk on.");
    // Stopping costs so much that the walker always goes on.
    let mut weights = OnwardWeights::by_hand();
    weights.away[0] = [-1e4; 8];
    let mut walker = WalkingFollower::new(&guide, &weights);
    let mut hops = 0;
    let mut seen = sight(&[hop(0.0, 2.0)], "hallway", &[]);
    while let WalkerDecision::Go(_) = walker.decide_next(&seen) {
        hops += 1;
        seen = sight(&[hop(PI, 2.0), hop(0.3, 2.0)], "hallway", &[]);
        assert!(hops <= 60);
    }
    assert_eq!(hops, 60);
    let empty = Guide::read_text("");
    let mut walker = WalkingFollower::new(&empty, &weights);
    assert_eq!(walker.decide_next(&sight(&[hop(0.0, 2.0)], "hallway", &[])), WalkerDecision::Stop);
}

#[test]
fn decide_next_takes_the_way_behind_which_most_of_the_probability_lies() {
    let guide = Guide::read_text(TEXT);
    let mut decisions = std::collections::BTreeSet::new();
    for seed in 0..16 {
        let weights = random_onward(seed);
        let mut walker = at_a_fork(&guide, &weights);
        // The probability of each decision, from its loss, less 0.3 for each hop to its end.
        let share = |way: &[usize], hops: f64| {
            let mut slope = OnwardSlope::default();
            walker.learn_decision(way.iter().copied(), &mut slope);
            (-slope.loss - 0.3 * hops).exp()
        };
        let shares = [
            (None, share(&[], 0.0)),
            (Some(0), share(&[0, 1], 2.0)),
            (Some(1), share(&[1], 1.0)),
            (Some(2), share(&[2], 1.0)),
            (Some(3), share(&[3], 1.0)),
        ];
        let best = shares.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0;
        let seen = sight(&[hop(PI, 2.0), hop(1.5, 2.3), hop(-1.4, 2.6), hop(0.3, 1.9)], "hallway", &[]);
        let decision = walker.decide_next(&seen);
        assert_eq!(decision, best.map_or(WalkerDecision::Stop, WalkerDecision::Go));
        decisions.insert(best);
    }
    assert!(decisions.len() > 2, "{decisions:?}");
}
