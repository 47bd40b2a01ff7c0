use super::{policy::*, *};
use crate::sight::{NodeSight, SightView};
use proptest::prelude::*;
use wayword_core::{DVec3, ViewpointGraph, seeded_rng};

fn id(n: usize) -> ViewpointId {
    ViewpointId::new(format!("v{n}")).unwrap()
}

/// Four views; each with its scores (phrases, then the activity) and its neighbours.
fn sight(views: [(&[f32], &[usize]); 4]) -> NodeSight {
    NodeSight {
        views: views.map(|(scores, onward)| SightView {
            scores: scores.to_vec(),
            onward: onward.iter().map(|n| id(*n)).collect(),
        }),
    }
}

fn parameters() -> PhraseWalkParameters {
    PhraseWalkParameters {
        phrase_threshold: 0.5,
        stop_threshold: 0.5,
        stop_with_phrases_left: 0,
        max_hops: 10,
        shun_visited: false,
        back: None,
    }
}

fn onward(view: usize, to: usize) -> PhraseDecision {
    PhraseDecision::Onward { view, to: id(to) }
}

#[test]
fn the_best_view_leads_to_its_nearest_neighbour() {
    let parameters = parameters();
    let mut policy = PhrasePolicy::new(&parameters, 1);
    let seen = sight([(&[0.1, 0.0], &[1]), (&[0.4, 0.0], &[2, 3]), (&[0.2, 0.0], &[4]), (&[0.3, 0.0], &[])]);
    assert_eq!(policy.decide(&id(0), Heading::NORTH, &seen), onward(1, 2));
}

#[test]
fn a_view_without_neighbours_gives_way_to_the_next_best() {
    let parameters = parameters();
    let mut policy = PhrasePolicy::new(&parameters, 1);
    let seen = sight([(&[0.4, 0.0], &[]), (&[0.1, 0.0], &[1]), (&[0.2, 0.0], &[2]), (&[0.0, 0.0], &[3])]);
    assert_eq!(policy.decide(&id(0), Heading::NORTH, &seen), onward(2, 2));
    let nowhere = sight([(&[0.4, 0.0], &[]), (&[0.1, 0.0], &[]), (&[0.2, 0.0], &[]), (&[0.0, 0.0], &[])]);
    assert_eq!(policy.decide(&id(0), Heading::NORTH, &nowhere), PhraseDecision::DeadEnd);
}

#[test]
fn of_equal_views_the_one_straight_ahead_is_taken() {
    let parameters = parameters();
    let equal: (&[f32], &[usize]) = (&[0.2, 0.0], &[7]);
    for view in 0..4 {
        let heading = wayword_core::CompassPoint::ALL[view].to_heading().turned_by(0.3);
        let mut policy = PhrasePolicy::new(&parameters, 1);
        assert_eq!(policy.decide(&id(0), heading, &sight([equal; 4])), onward(view, 7));
    }
}

#[test]
fn a_phrase_that_fits_gives_way_to_the_next() {
    let parameters = parameters();
    let mut policy = PhrasePolicy::new(&parameters, 2);
    // The first phrase fits east, the second west.
    let seen =
        sight([(&[0.0, 0.0, 0.0], &[1]), (&[0.6, 0.0, 0.0], &[2]), (&[0.0, 0.0, 0.0], &[3]), (&[0.0, 0.4, 0.0], &[4])]);
    assert_eq!((policy.current_phrase(), policy.decide(&id(0), Heading::NORTH, &seen)), (0, onward(1, 2)));
    assert_eq!((policy.current_phrase(), policy.decide(&id(0), Heading::NORTH, &seen)), (1, onward(3, 4)));
    assert_eq!(policy.current_phrase(), 1, "a phrase that fits too little stays the current one");
}

#[test]
fn the_activity_ends_the_walk_when_few_phrases_are_left() {
    let seen = sight([(&[0.0, 0.9], &[1]), (&[0.0, 0.0], &[2]), (&[0.0, 0.0], &[3]), (&[0.0, 0.0], &[4])]);
    let patient = parameters();
    assert_ne!(PhrasePolicy::new(&patient, 1).decide(&id(0), Heading::NORTH, &seen), PhraseDecision::Stop);
    let eager = PhraseWalkParameters { stop_with_phrases_left: 1, ..patient };
    assert_eq!(PhrasePolicy::new(&eager, 1).decide(&id(0), Heading::NORTH, &seen), PhraseDecision::Stop);
}

#[test]
fn visited_neighbours_are_shunned_while_there_are_others() {
    let shy = PhraseWalkParameters { shun_visited: true, ..parameters() };
    let mut policy = PhrasePolicy::new(&shy, 1);
    let from_0 = sight([(&[0.4, 0.0], &[1]), (&[0.0, 0.0], &[]), (&[0.0, 0.0], &[2]), (&[0.0, 0.0], &[])]);
    let from_1 = sight([(&[0.0, 0.0], &[3]), (&[0.0, 0.0], &[]), (&[0.4, 0.0], &[0]), (&[0.0, 0.0], &[])]);
    let dead_end = sight([(&[0.0, 0.0], &[]), (&[0.0, 0.0], &[]), (&[0.4, 0.0], &[1]), (&[0.0, 0.0], &[])]);
    assert_eq!(policy.decide(&id(0), Heading::NORTH, &from_0), onward(0, 1));
    assert_eq!(policy.decide(&id(1), Heading::NORTH, &from_1), onward(0, 3), "not back to where it came from");
    assert_eq!(policy.decide(&id(3), Heading::NORTH, &dead_end), onward(2, 1), "unless there is no other way");
}

#[test]
fn low_scores_in_a_row_lead_back() {
    let back = BacktrackParameters { window: 2, threshold: 0.3, nodes: 2 };
    let parameters = PhraseWalkParameters { back: Some(back), shun_visited: true, ..parameters() };
    let mut policy = PhrasePolicy::new(&parameters, 1);
    let seen = |fit: f32| {
        let scores = [fit, 0.0];
        sight([(&scores, &[1, 2, 3, 4]), (&[0.0, 0.0], &[]), (&[0.0, 0.0], &[]), (&[0.0, 0.0], &[])])
    };
    assert_eq!(policy.decide(&id(0), Heading::NORTH, &seen(0.4)), onward(0, 1));
    assert_eq!(policy.decide(&id(1), Heading::NORTH, &seen(0.4)), onward(0, 2), "high enough");
    assert_eq!(policy.decide(&id(2), Heading::NORTH, &seen(0.1)), PhraseDecision::Back(vec![id(1), id(0)]));
    assert_eq!(policy.decide(&id(0), Heading::NORTH, &seen(0.1)), onward(0, 3), "the scores count anew, another way");
}

fn line() -> ViewpointGraph {
    let mut graph = ViewpointGraph::default();
    for n in 0..5 {
        graph.add_viewpoint(id(n), DVec3::new(0.0, 2.0 * n as f64, 0.0), Some(1)).unwrap();
    }
    for n in 0..4 {
        graph.join_viewpoints(&id(n), &id(n + 1)).unwrap();
    }
    graph
}

fn start(heading_rad: f64) -> AgentStart {
    let scene = SceneId::new("s").unwrap();
    AgentStart { scene, viewpoint: id(1), heading: Heading::new(heading_rad).unwrap() }
}

fn stood(walked: &AgentWalk) -> Vec<&str> {
    walked.steps.iter().map(|step| step.viewpoint.as_str()).collect()
}

#[test]
fn straight_goes_on_until_no_neighbour_lies_ahead() {
    assert_eq!(stood(&walk_straight(&line(), &start(0.2), 10)), ["v1", "v2", "v3", "v4"]);
    assert_eq!(stood(&walk_straight(&line(), &start(0.2), 2)), ["v1", "v2", "v3"]);
    assert_eq!(stood(&walk_straight(&line(), &start(std::f64::consts::PI), 10)), ["v1", "v0"]);
    assert_eq!(stood(&walk_straight(&line(), &start(1.5), 10)), ["v1"], "nothing lies to the east");
}

#[test]
fn the_oracle_takes_the_shortest_way_and_stays_where_there_is_none() {
    assert_eq!(stood(&walk_shortest_path(&line(), &start(0.0), &id(4)).unwrap()), ["v1", "v2", "v3", "v4"]);
    let mut apart = line();
    apart.add_viewpoint(id(9), DVec3::new(50.0, 0.0, 0.0), None).unwrap();
    assert_eq!(stood(&walk_shortest_path(&apart, &start(0.0), &id(9)).unwrap()), ["v1"]);
    assert!(walk_shortest_path(&line(), &start(0.0), &id(77)).is_err());
}

proptest! {
    #[test]
    fn random_walks_keep_to_edges_and_to_their_length(hops in 0usize..20, seed in 0u64..1000) {
        let graph = line();
        let walked = walk_randomly(&graph, &start(0.0), hops, &mut seeded_rng(seed, &["test"]));
        prop_assert_eq!(walked.steps.len(), hops + 1);
        for pair in walked.steps.windows(2) {
            prop_assert!(graph.neighbours_of(&pair[0].viewpoint).contains(&&pair[1].viewpoint));
        }
        let again = walk_randomly(&graph, &start(0.0), hops, &mut seeded_rng(seed, &["test"]));
        prop_assert_eq!(walked, again);
    }

    /// For any scores, an agent goes to a neighbour, goes back over visited nodes, or stays.
    #[test]
    fn an_agent_never_leaves_the_graph(
        scores in prop::collection::vec(0.0f32..1.0, 12),
        window in 1usize..4,
        nodes in 0usize..4,
        shun_visited: bool,
    ) {
        let back = BacktrackParameters { window, threshold: 0.5, nodes };
        let parameters = PhraseWalkParameters { back: Some(back), shun_visited, ..parameters() };
        let mut policy = PhrasePolicy::new(&parameters, 2);
        let graph = line();
        let (mut here, mut stood) = (id(2), vec![id(2)]);
        for round in 0..30 {
            let view = |at: usize| SightView {
                scores: (0..3).map(|of| scores[(at + 5 * of + round) % scores.len()] * 0.49).collect(),
                onward: if at == 0 { graph.neighbours_of(&here).into_iter().cloned().collect() } else { Vec::new() },
            };
            match policy.decide(&here, Heading::NORTH, &NodeSight { views: std::array::from_fn(view) }) {
                PhraseDecision::Onward { to, .. } => {
                    prop_assert!(graph.neighbours_of(&here).contains(&&to));
                    here = to;
                }
                PhraseDecision::Back(over) => {
                    prop_assert_eq!(over.len(), nodes);
                    for to in over {
                        prop_assert!(graph.neighbours_of(&here).contains(&&to) && stood.contains(&to));
                        here = to;
                    }
                }
                PhraseDecision::Stop | PhraseDecision::DeadEnd => prop_assert!(false, "nothing here ends the walk"),
            }
            stood.push(here.clone());
        }
    }
}
