//! Texts that were made up here, on a cross of corridors.

use super::*;
use crate::{
    agents::{MapReader, MappedScene, WalkPrior},
    grounders::{GrounderScope, LexicalGrounder},
    testing::{Cross, id, scene},
};
use std::collections::BTreeSet;
use wayword_core::{
    Heading, ModelError, PhraseGrounder, Platform, View, ViewpointId, ViewpointSurvey, survey::ViewpointKnowledge,
};
use wayword_follower::online::{ThingDirection, WalkerThing};

const THINGS: [(&str, &str); 4] = [("n2", "plant"), ("e2", "sofa"), ("s2", "bed"), ("w2", "sink")];
const ROOMS: [(&str, &str); 3] = [("e2", "living room"), ("s2", "bedroom"), ("w2", "kitchen")];

fn cross() -> Cross {
    Cross::new(&THINGS).with_rooms(&ROOMS)
}

fn stood(walked: &AgentWalk) -> Vec<&str> {
    walked.steps.iter().map(|step| step.viewpoint.as_str()).collect()
}

fn walked(world: &Cross, text: &str) -> AgentWalk {
    let grounder = LexicalGrounder::new(GrounderScope::Views);
    let agent_view = AgentView::new(world, &grounder, false, &scene()).unwrap();
    walk_by_reading(&agent_view, &Cross::start(), text, &ThingSource::Labels).unwrap()
}

#[test]
fn it_turns_where_the_text_says_and_stops_there() {
    for (text, way) in [
        ("Turn right and walk to the sofa in the living room. Stop next to the sofa.", ["middle", "e1", "e2"]),
        ("Turn left and walk into the kitchen. Stop next to the sink.", ["middle", "w1", "w2"]),
        ("Walk straight ahead to the plant. Stop next to the plant.", ["middle", "n1", "n2"]),
    ] {
        let walked = walked(&cross(), text);
        assert_eq!((stood(&walked), walked.end), (way.to_vec(), WalkEnd::Stopped), "{text}");
        let told = walked.steps[2].told.as_ref().unwrap();
        assert_eq!((told.ways, told.things), (1, 1));
    }
}

/// The text does not mention in which direction the bed is, and it is not where the agent looks first.
#[test]
fn it_comes_back_from_a_dead_end() {
    let text = "Walk into the bedroom. Stop at the bed in the bedroom.";
    let walked = walked(&cross(), text);
    let stood = stood(&walked);
    assert_eq!(stood.last(), Some(&"s2"), "{stood:?}");
    assert!(stood.len() > 3 && walked.steps.iter().any(|step| step.choice == StepChoice::Back), "{stood:?}");
}

/// The agent is given the ways out of its node, the room and the things there, and no information about nodes that it did not
/// visit.
#[test]
fn reader_gets_only_the_surroundings_of_its_node() {
    let world = cross();
    let grounder = LexicalGrounder::new(GrounderScope::Views);
    let agent_view = AgentView::new(&world, &grounder, false, &scene()).unwrap();
    let guide = Guide::read_text("Turn right and walk to the sofa in the living room. Stop next to the sofa.");
    let mut reader = WalkingFollower::new(&guide, OnwardWeights::fitted());
    let mut given: Vec<WalkerSighting> = Vec::new();
    let walked = walk_by_decisions(&agent_view, &Cross::start(), &ThingSource::Labels, |seen| {
        given.push(seen.clone());
        reader.decide_next(seen)
    });
    let walked = walked.unwrap();
    assert_eq!(given.len(), walked.steps.len());
    let graph = world.graph_for_scene(&scene()).unwrap();
    for (seen, step) in given.iter().zip(&walked.steps) {
        let node = step.viewpoint.as_str();
        assert_eq!(seen.hops.len(), graph.neighbours_of(&step.viewpoint).len(), "{node}");
        assert!(seen.hops.iter().all(|hop| (hop.length_m - 2.0).abs() < 1e-9 && hop.elevation_rad == 0.0));
        let room = ROOMS.iter().find(|(at, _)| *at == node).map(|(_, room)| *room);
        assert_eq!(seen.room.as_deref(), room, "{node}");
        let things: Vec<&str> = THINGS.iter().filter(|(at, _)| *at == node).map(|(_, name)| *name).collect();
        assert_eq!(seen.things.iter().map(|thing| thing.name.as_str()).collect::<Vec<_>>(), things, "{node}");
    }
    let stood: BTreeSet<ViewpointId> = walked.steps.iter().map(|step| step.viewpoint.clone()).collect();
    assert_eq!(world.looked_from(), stood, "nobody looked from elsewhere");
}

#[test]
fn ways_are_given_relative_to_the_heading() {
    let (world, grounder) = (cross(), LexicalGrounder::new(GrounderScope::Views));
    let agent_view = AgentView::new(&world, &grounder, false, &scene()).unwrap();
    let turns = |heading_deg: f64| {
        let heading = Heading::new(heading_deg.to_radians()).unwrap();
        let told = agent_view.surroundings_at(&id("middle"), heading, &ThingSource::Labels).unwrap();
        let mut turns: Vec<(String, i32)> = told
            .ways
            .iter()
            .zip(&told.sighting.hops)
            .map(|(way, hop)| (way.to_string(), hop.turn_rad.to_degrees().round() as i32))
            .collect();
        turns.sort();
        turns
    };
    let named =
        |turns: [i32; 4]| ["e1", "n1", "s1", "w1"].map(str::to_owned).into_iter().zip(turns).collect::<Vec<_>>();
    assert_eq!(turns(0.0), named([90, 0, 180, -90]));
    assert_eq!(turns(90.0), named([0, -90, 90, 180]));
}

/// Finds a phrase in the west alone.
struct West;

impl PhraseGrounder for West {
    fn name(&self) -> &'static str {
        "west"
    }

    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let score = |at: usize, phrase: &&str| if at == 3 && *phrase == "sink" { 0.5 } else { 0.1 };
        (0..views.len()).map(|at| Ok(phrases.iter().map(|phrase| score(at, phrase)).collect())).collect()
    }
}

#[test]
fn things_by_scores_are_the_names_above_the_threshold() {
    let world = cross();
    let agent_view = AgentView::new(&world, &West, false, &scene()).unwrap();
    let told = |threshold: f32| {
        let things = ThingSource::named_in("Walk past the sofa in the kitchen to the sink", threshold);
        let told = agent_view.surroundings_at(&id("middle"), Heading::NORTH, &things).unwrap();
        let way = |thing: &WalkerThing| match thing.place {
            ThingDirection::Towards(hop) => told.ways[hop].to_string(),
            ThingDirection::At(_) => panic!("scores tell no distance"),
        };
        told.sighting.things.iter().map(|thing| (thing.name.clone(), way(thing))).collect::<Vec<_>>()
    };
    assert_eq!(told(0.3), [("sink".to_owned(), "w1".to_owned())]);
    assert_eq!(told(0.6), []);
    assert_eq!(told(0.05).len(), 2 * 4, "the sofa and the sink in four views; a room is no thing");
    let nowhere = walk_by_reading(&agent_view, &Cross::start(), "", &ThingSource::named_in("", 0.3)).unwrap();
    assert_eq!(stood(&nowhere), ["middle"]);
}

#[test]
fn missing_labels_are_an_error() {
    let (world, grounder) = (Cross::blind(), LexicalGrounder::new(GrounderScope::Views));
    let agent_view = AgentView::new(&world, &grounder, false, &scene()).unwrap();
    let error = walk_by_reading(&agent_view, &Cross::start(), "Turn left.", &ThingSource::Labels).unwrap_err();
    assert!(error.to_string().contains("needs labels"), "{error}");
}

fn surveyed(world: &Cross) -> MappedScene {
    let known = |at: &ViewpointId, _| {
        let room = ROOMS.iter().find(|(name, _)| *name == at.as_str()).map(|(_, room)| (*room).to_owned());
        Ok::<_, wayword_core::graph::GraphError>(ViewpointKnowledge { room, things: Some(world.labels(at)) })
    };
    MappedScene::from_survey(&ViewpointSurvey::from_graph(&world.graph_for_scene(&scene()).unwrap(), known).unwrap())
}

#[test]
fn map_reader_takes_the_shortest_walk() {
    let world = cross();
    let (graph, known, start) = (world.graph_for_scene(&scene()).unwrap(), surveyed(&world), Cross::start());
    for prior in [WalkPrior::Shortest(8), WalkPrior::TwoPieces(8)] {
        let reader = MapReader::new(&graph, &known, &start, prior).unwrap();
        let walked = reader.best_walk("Walk into the bedroom. Stop at the bed in the bedroom.");
        assert_eq!(stood(&walked), ["middle", "s1", "s2"], "{prior:?}");
        let left = reader.best_walk("Turn left and walk into the kitchen. Stop next to the sink.");
        assert_eq!(stood(&left), ["middle", "w1", "w2"], "{prior:?}");
    }
    let near = MapReader::new(&graph, &known, &start, WalkPrior::Shortest(1)).unwrap();
    assert_eq!(near.best_walk("Walk into the bedroom.").steps.len(), 2, "nothing farther is thought of");
    let lost = AgentStart { viewpoint: id("attic"), ..start.clone() };
    assert!(matches!(MapReader::new(&graph, &known, &lost, WalkPrior::Shortest(8)), Err(WalkError::Unknown { .. })));
}

#[test]
fn an_empty_text_gives_the_same_walk_each_time() {
    let world = cross();
    let (graph, start) = (world.graph_for_scene(&scene()).unwrap(), Cross::start());
    let walk = || {
        let known = surveyed(&world);
        let reader = MapReader::new(&graph, &known, &start, WalkPrior::Shortest(8)).unwrap();
        stood(&reader.best_walk("")).into_iter().map(str::to_owned).collect::<Vec<_>>()
    };
    let first = walk();
    assert!(first.len() > 1, "it goes where its weights alone lead: {first:?}");
    assert!((0..5).all(|_| walk() == first));
    let online = walked(&world, "");
    assert_eq!(stood(&online), ["middle"], "who knows no map stays");
}

#[test]
fn readers_bound_their_work_on_a_huge_text() {
    let world = cross();
    let (graph, known, start) = (world.graph_for_scene(&scene()).unwrap(), surveyed(&world), Cross::start());
    let reader = MapReader::new(&graph, &known, &start, WalkPrior::TwoPieces(8)).unwrap();
    let long = "Turn left. ".repeat(100_000);
    assert!(!reader.best_walk(&long).steps.is_empty());
    assert!(!walked(&world, &long).steps.is_empty());
}
