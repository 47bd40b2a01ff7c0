//! Tests of evidence: what is denied, where things are around a path, and what labels and captions become.

use super::*;
use crate::tests::{frame, walk};
use std::sync::Arc;
use wayword_core::{
    Caption, CaptionedView, FormOutcome, FrameObservation, Heading, ObjectLabel, ObjectSighting, PlacedObject, Pose,
    SceneId, View, ViewGaze, ViewThird, ViewpointGraph, ViewpointId, ViewpointSurvey, WitnessAnswer, graph::GraphError,
    path::PathStop, survey::ViewpointKnowledge, view::GroundTruth,
};
use wayword_language::lexicon::ThingClass;

fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn id(name: &str) -> ViewpointId {
    ViewpointId::new(name).unwrap()
}

/// A label of an object that is named after its id.
fn label(name: &str, object: &str, position: Option<[f64; 3]>) -> ObjectLabel {
    ObjectLabel {
        object: ObjectId::new(object).unwrap(),
        name: name.into(),
        heading: Heading::new(90_f64.to_radians()).unwrap(),
        elevation_rad: 0.0,
        box_px: None,
        distance_m: None,
        position: position.map(|[x, y, z]| DVec3::new(x, y, z)),
        colour: None,
        room: None,
    }
}

/// A viewpoint of a made-up building: its name, its place, its room (empty where it has none) and its labels.
type MadeUpViewpoint<'a> = (&'a str, [f64; 3], &'a str, Vec<ObjectLabel>);

fn survey(viewpoints: &[MadeUpViewpoint<'_>], edges: &[(&str, &str)], objects: Vec<PlacedObject>) -> ViewpointSurvey {
    let mut graph = ViewpointGraph::default();
    for (name, [x, y, z], ..) in viewpoints {
        graph.add_viewpoint(id(name), DVec3::new(*x, *y, *z), Some(1)).unwrap();
    }
    for (from, to) in edges {
        graph.join_viewpoints(&id(from), &id(to)).unwrap();
    }
    let known = |viewpoint: &ViewpointId, _| {
        let (_, _, room, things) = viewpoints.iter().find(|(name, ..)| *name == viewpoint.as_str()).unwrap();
        let room = Some((*room).to_owned()).filter(|room| !room.is_empty());
        Ok::<_, GraphError>(ViewpointKnowledge { room, things: Some(things.clone()) })
    };
    ViewpointSurvey::from_graph(&graph, known).unwrap().with_objects(objects)
}

fn placed(name: &str, [x, y, z]: [f64; 3]) -> PlacedObject {
    PlacedObject {
        object: ObjectId::new(name.replace(' ', "-")).unwrap(),
        name: name.into(),
        position: DVec3::new(x, y, z),
    }
}

/// A path through viewpoints, or through positions of no viewpoint.
fn path_through(stops: &[([f64; 3], Option<&str>)]) -> Path {
    let stop = |([x, y, z], name): &([f64; 3], Option<&str>)| PathStop {
        position: DVec3::new(*x, *y, *z),
        viewpoint: name.map(id),
        level: Some(1),
    };
    Path {
        id: "p".into(),
        scene: SceneId::new("s").unwrap(),
        frames: Path::frames_along(stops.iter().map(stop).collect(), None),
        motion: PathMotion::Known,
        target: None,
    }
}

const A: [f64; 3] = [0.0, 0.0, 1.5];
const B: [f64; 3] = [0.0, 2.0, 1.5];
const C: [f64; 3] = [0.0, 4.0, 1.5];
const D: [f64; 3] = [0.0, 10.0, 1.5];

/// Four viewpoints in a row; the path goes through the first three of them.
fn house(objects: Vec<PlacedObject>) -> BuildingInventory {
    let viewpoints = [
        ("a", A, "hall", vec![]),
        ("b", B, "hall", vec![]),
        ("c", C, "kitchen", vec![]),
        ("d", D, "bedroom", vec![label("bed", "bed-1", Some([1.0, 10.0, 1.0]))]),
    ];
    BuildingInventory::from_survey(&survey(&viewpoints, &[("a", "b"), ("b", "c"), ("c", "d")], objects))
}

fn around(building: BuildingInventory) -> PathSurroundings {
    let path = path_through(&[(A, Some("a")), (B, Some("b")), (C, Some("c"))]);
    PathSurroundings::around_path(&Arc::new(building), &path).unwrap()
}

#[test]
fn thing_distance_is_from_the_nearest_point_of_the_path_and_from_its_end() {
    let distance = |at: [f64; 3]| {
        let distance = around(house(vec![placed("sofa", at)])).thing_distance("couch");
        (distance.path_m, distance.end_m)
    };
    for (at, path_m, end_m) in [
        ([3.0, 1.0, 1.5], 3.0, 18_f64.sqrt()),
        ([-3.0, 1.0, 1.5], 3.0, 18_f64.sqrt()),
        ([0.0, -3.0, 1.5], 3.0, 7.0),
        ([0.0, 6.0, 1.5], 2.0, 2.0),
        ([4.0, 4.0, 1.5], 4.0, 4.0),
        // Up to 1.9 metres of height cost nothing, and each metre more counts three times.
        ([0.0, 3.0, 3.4], 0.0, 1.0),
        ([0.0, 3.0, -0.4], 0.0, 1.0),
        ([0.0, 4.0, 4.4], 3.0, 3.0),
        ([0.0, 4.0, -1.4], 3.0, 3.0),
        ([4.0, 4.0, 4.4], 5.0, 5.0),
    ] {
        let (path_found_m, end_found_m) = distance(at);
        assert!(is_near(path_found_m, path_m) && is_near(end_found_m, end_m), "{at:?}: {path_found_m} {end_found_m}");
    }
}

#[test]
fn thing_distance_takes_the_nearest_of_several_in_each_respect() {
    let around = around(house(vec![placed("sofa", [1.0, 0.0, 1.5]), placed("couch", [0.0, 7.0, 1.5])]));
    let sofa = around.thing_distance("sofa");
    assert!(is_near(sofa.path_m, 1.0) && is_near(sofa.end_m, 3.0), "{sofa:?}");
    assert_eq!(around.thing_distance("piano"), ListedDistance::NOWHERE);
    assert!(around.thing_distance("piano").path_m.is_infinite());
    assert_eq!(around.count_things("sofa"), 2);
    assert_eq!((around.count_things("bed"), around.count_things("piano")), (1, 0));
}

#[test]
fn nearer_of_takes_the_lesser_in_each_respect() {
    let a = ListedDistance { path_m: 1.0, end_m: 9.0, path_hops: 4, end_hops: 2 };
    let b = ListedDistance { path_m: 5.0, end_m: 6.0, path_hops: 3, end_hops: 7 };
    let both = ListedDistance { path_m: 1.0, end_m: 6.0, path_hops: 3, end_hops: 2 };
    assert_eq!((a.nearer_of(b), b.nearer_of(a)), (both, both));
    assert_eq!(a.nearer_of(ListedDistance::NOWHERE), a);
}

#[test]
fn hops_are_counted_from_the_path_and_from_its_end() {
    let around = around(house(vec![placed("sofa", [0.5, 0.0, 1.5]), placed("piano", [0.0, 99.0, 1.5])]));
    let hops = |name: &str| {
        let distance = around.thing_distance(name);
        (distance.path_hops, distance.end_hops)
    };
    assert_eq!(hops("bed"), (1, 1));
    assert_eq!(hops("sofa"), (0, 2));
    assert_eq!(hops("piano"), (usize::MAX, usize::MAX), "no viewpoint is next to it");
    let room = |name: &str| (around.room_distance(name).path_hops, around.room_distance(name).end_hops);
    assert_eq!((room("bedroom"), room("hallway"), room("kitchen")), ((1, 1), (0, 1), (0, 0)));
    assert_eq!(room("garage"), (usize::MAX, usize::MAX));
}

#[test]
fn room_distance_is_to_the_nearest_viewpoint_of_the_room() {
    let around = around(house(vec![]));
    let room = |name: &str| (around.room_distance(name).path_m, around.room_distance(name).end_m);
    assert!(is_near(room("bedroom").0, 6.0) && is_near(room("bedroom").1, 6.0));
    assert!(is_near(room("corridor").0, 0.0) && is_near(room("corridor").1, 2.0));
    assert_eq!(around.room_distance("garage"), ListedDistance::NOWHERE);
    assert_eq!(around.near_rooms().iter().map(String::as_str).collect::<Vec<_>>(), ["hallway", "kitchen"]);
    assert_eq!(around.room_spots("bedroom", 6.0), [DVec3::from_array(D)]);
    assert!(around.room_spots("bedroom", 5.9).is_empty());
    assert!(around.knows_rooms());
}

#[test]
fn a_room_is_near_up_to_three_metres() {
    for (far_m, near) in [(3.0, true), (3.1, false)] {
        let viewpoints = [("a", A, "hallway", vec![]), ("b", [far_m, 0.0, 1.5], "office", vec![])];
        let building = BuildingInventory::from_survey(&survey(&viewpoints, &[("a", "b")], vec![]));
        let path = path_through(&[(A, Some("a"))]);
        let around = PathSurroundings::around_path(&Arc::new(building), &path).unwrap();
        assert_eq!(around.near_rooms().contains("office"), near, "{far_m}");
    }
}

#[test]
fn a_gap_is_a_viewpoint_without_a_room_near_the_path() {
    for (far_m, gap) in [(0.0, true), (3.0, true), (3.1, false)] {
        let viewpoints = [("a", A, "hallway", vec![]), ("b", [far_m, 0.0, 1.5], "", vec![])];
        let building = BuildingInventory::from_survey(&survey(&viewpoints, &[("a", "b")], vec![]));
        let path = path_through(&[(A, Some("a"))]);
        assert_eq!(PathSurroundings::around_path(&Arc::new(building), &path).unwrap().has_gap(), gap, "{far_m}");
    }
    assert!(!around(house(vec![])).has_gap());
}

#[test]
fn thing_spots_are_the_things_within_a_distance() {
    let around = around(house(vec![placed("sofa", [3.0, 1.0, 1.5]), placed("couch", [5.0, 1.0, 1.5])]));
    assert_eq!(around.thing_spots("sofa", 3.0), [DVec3::new(3.0, 1.0, 1.5)]);
    assert!(around.thing_spots("sofa", 2.9).is_empty());
    assert_eq!(around.thing_spots("sofa", 5.0).len(), 2);
    assert!(around.thing_spots("bed", 5.0).is_empty());
    assert_eq!(around.eyes(), [A, B, C].map(DVec3::from_array));
}

#[test]
fn listed_objects_are_counted_near_the_path_and_near_its_end() {
    let objects = vec![
        placed("sofa", [3.0, 0.0, 1.5]),
        placed("lamp", [0.0, 7.0, 1.5]),
        placed("rug", [0.0, 7.1, 1.5]),
        placed("clock", [3.1, 0.0, 1.5]),
    ];
    let around = around(house(objects));
    assert!(is_near(around.objects_per_frame(), 2.0 / 3.0), "{}", around.objects_per_frame());
    assert_eq!((around.objects_at_end(), around.listing_viewpoints()), (1, 1));
    let kin = |class, at_end| around.has_kin(class, at_end);
    assert!(kin(ThingClass::Seat, false) && !kin(ThingClass::Seat, true));
    assert!(kin(ThingClass::Light, false) && kin(ThingClass::Light, true));
    assert!(!kin(ThingClass::Floor, false) && !kin(ThingClass::Bed, false) && !kin(ThingClass::Bed, true));
}

#[test]
fn names_agree_where_one_is_the_kind_of_the_other() {
    let count = |listed: &str, name: &str| around(house(vec![placed(listed, A)])).count_things(name);
    for (listed, name, wanted) in [
        ("dining chair", "chair", 1),
        ("chair", "dining chair", 1),
        ("dining chair", "armchair", 0),
        ("sofa chair", "sofa", 1),
        ("sofa chair", "chair", 1),
        ("table lamp", "table", 0),
        ("table lamp", "lamp", 1),
        ("zorble stand", "zorble stand", 1),
    ] {
        assert_eq!(count(listed, name), wanted, "{listed} for {name}");
    }
}

#[test]
fn a_thing_is_at_home_in_the_room_of_the_viewpoints_next_to_it() {
    let homes = |at: [f64; 3]| {
        let around = around(house(vec![placed("oven", at)]));
        around.passes_home_of("oven")
    };
    assert!(homes([0.0, 4.0, 1.5]), "it is in the kitchen, which the path enters");
    assert!(homes([4.0, 4.0, 1.5]), "four metres are still beside it");
    assert!(!homes([4.1, 4.0, 1.5]));
    assert!(!homes([0.0, 10.0, 1.5]), "the bedroom is not near the path");
    assert!(!around(house(vec![])).passes_home_of("oven"));
    assert!(!around(house(vec![])).passes_home_of("bed"));
}

#[test]
fn an_object_that_several_viewpoints_list_is_one_object() {
    let sofa = || label("sofa", "sofa-1", Some([1.0, 1.0, 1.0]));
    let viewpoints = [("a", A, "hall", vec![sofa()]), ("b", B, "den", vec![sofa(), label("sofa", "sofa-2", None)])];
    let objects = vec![placed("sofa-1", [9.0, 9.0, 9.0])];
    let renamed = objects.into_iter().map(|object| PlacedObject { name: "sofa".into(), ..object }).collect();
    let building = BuildingInventory::from_survey(&survey(&viewpoints, &[("a", "b")], renamed));
    let path = path_through(&[(A, Some("a")), (B, Some("b"))]);
    let around = PathSurroundings::around_path(&Arc::new(building), &path).unwrap();
    assert_eq!((around.count_things("sofa"), around.listing_viewpoints()), (2, 2));
    assert!(around.passes_home_of("sofa"));
    // The one without a position is taken to be at the eye.
    assert_eq!(around.thing_spots("sofa", 0.0), [DVec3::from_array(B)]);
}

#[test]
fn an_object_without_a_position_lies_along_its_direction() {
    let spot = |distance_m: Option<f64>, heading_deg: f64, elevation_deg: f64| {
        let seen = ObjectLabel {
            distance_m,
            heading: Heading::new(heading_deg.to_radians()).unwrap(),
            elevation_rad: elevation_deg.to_radians(),
            ..label("sofa", "sofa-1", None)
        };
        let building = BuildingInventory::from_survey(&survey(&[("a", A, "", vec![seen])], &[], vec![]));
        let around = PathSurroundings::around_path(&Arc::new(building), &path_through(&[(A, Some("a"))])).unwrap();
        around.thing_spots("sofa", 99.0)[0]
    };
    let near = |a: DVec3, b: [f64; 3]| a.distance(DVec3::from_array(b)) < 1e-9;
    assert!(near(spot(Some(2.0), 90.0, 0.0), [2.0, 0.0, 1.5]));
    assert!(near(spot(Some(2.0), 0.0, 60.0), [0.0, 1.0, 1.5]), "only the floor counts");
    assert!(near(spot(None, 90.0, 0.0), A));
}

#[test]
fn around_path_needs_known_poses_and_a_building_that_lists_something() {
    let path = path_through(&[(A, Some("a")), (B, Some("b"))]);
    let none =
        |building: BuildingInventory, path: &Path| PathSurroundings::around_path(&Arc::new(building), path).is_none();
    assert!(!none(house(vec![]), &path));
    assert!(none(house(vec![]), &Path { motion: PathMotion::Unknown, ..path.clone() }));
    assert!(none(house(vec![]), &Path { frames: vec![], ..path.clone() }));
    let blank = survey(&[("a", A, "", vec![]), ("b", B, "", vec![])], &[("a", "b")], vec![]);
    assert!(BuildingInventory::from_survey(&blank).is_blank() && none(BuildingInventory::from_survey(&blank), &path));
    let one_room = survey(&[("a", A, "hall", vec![])], &[], vec![]);
    assert!(!BuildingInventory::from_survey(&one_room).is_blank());
    let one_thing = BuildingInventory::from_survey(&survey(&[("a", A, "", vec![])], &[], vec![placed("sofa", A)]));
    assert!(!one_thing.is_blank());
    let around = PathSurroundings::around_path(&Arc::new(one_thing), &path_through(&[(A, Some("a"))])).unwrap();
    assert!(!around.knows_rooms());
}

#[test]
fn a_frame_without_a_viewpoint_counts_as_the_nearest_one() {
    let path = path_through(&[([0.0, 0.3, 1.5], None), ([0.0, 3.0, 1.5], None), ([0.0, 9.0, 1.5], None)]);
    let around = PathSurroundings::around_path(&Arc::new(house(vec![])), &path).unwrap();
    assert_eq!((around.thing_distance("bed").path_hops, around.thing_distance("bed").end_hops), (0, 0));
    assert_eq!(around.room_distance("kitchen").end_hops, 1);
    assert!(around.floors_m().is_empty());
}

#[test]
fn floors_are_known_only_if_each_frame_has_one() {
    let floors = |of: &[&str]| {
        let mut graph = ViewpointGraph::default();
        for (name, at) in [("a", A), ("b", B)] {
            graph.add_viewpoint(id(name), DVec3::from_array(at), Some(1)).unwrap();
        }
        for name in of {
            graph.set_floor(&id(name), 0.25).unwrap();
        }
        graph.join_viewpoints(&id("a"), &id("b")).unwrap();
        let known =
            |_: &ViewpointId, _| Ok::<_, GraphError>(ViewpointKnowledge { room: Some("hall".into()), things: None });
        let building = BuildingInventory::from_survey(&ViewpointSurvey::from_graph(&graph, known).unwrap());
        let path = path_through(&[(A, Some("a")), (B, Some("b"))]);
        PathSurroundings::around_path(&Arc::new(building), &path).unwrap().floors_m().to_vec()
    };
    assert_eq!(floors(&["a", "b"]), [0.25, 0.25]);
    assert!(floors(&["a"]).is_empty());
}

#[test]
fn beyond_end_has_the_rooms_next_to_the_last_one_and_the_things_in_it() {
    let at = |name: &str, y: f64| label(name, name, Some([0.0, y, 1.0]));
    let viewpoints = [
        ("a", A, "hallway", vec![at("rug", 0.0)]),
        ("b", B, "kitchen", vec![at("stove", 2.0)]),
        ("c", C, "kitchen", vec![at("sink", 4.0)]),
        ("d", D, "pantry", vec![at("shelf", 10.0)]),
        ("e", [9.0, 9.0, 1.5], "kitchen", vec![at("oven", 9.0)]),
    ];
    let edges = [("a", "b"), ("b", "c"), ("c", "d"), ("d", "e")];
    let building = BuildingInventory::from_survey(&survey(&viewpoints, &edges, vec![]));
    let beyond = building.beyond_end(&path_through(&[(A, Some("a")), (B, Some("b"))]));
    assert_eq!(beyond.rooms, ["hallway", "pantry"]);
    assert_eq!(beyond.things, ["sink", "stove"], "the oven is in another kitchen");
    assert_eq!(building.beyond_end(&path_through(&[(A, None)])), EndSurroundings::default());
    assert_eq!(building.beyond_end(&path_through(&[])), EndSurroundings::default());
}

fn seen(name: &str) -> SeenThing {
    SeenThing { name: name.into(), ..SeenThing::default() }
}

fn two_frames(source: EvidenceSource) -> Evidence {
    let frames = vec![frame("hallway", Some(&["rug"]), 2), frame("kitchen", Some(&["stove"]), 2)];
    Evidence { source, ..walk(frames, &[(0.0, 0.0)]) }
}

#[test]
fn labels_deny_a_thing_unless_a_frame_is_unknown_or_guesses_it() {
    let labels = two_frames(EvidenceSource::Labels);
    assert!(labels.denies_thing("piano") && labels.is_named_nowhere("piano"));
    assert!(!labels.denies_thing("door") && !labels.denies_thing("wall"), "labels leave them out");
    let mut doors = labels.clone();
    doors.frames[0].things.push(seen("garage door"));
    assert!(doors.denies_thing("gate"), "these labels have doors");
    let mut unknown = labels.clone();
    unknown.frames[1].knows_things = false;
    assert!(!unknown.denies_thing("piano") && !unknown.is_named_nowhere("piano"));
    let mut guessed = labels;
    guessed.frames[1].perhaps.things.push(seen("piano"));
    assert!(!guessed.denies_thing("piano") && guessed.may_show("piano") && !guessed.may_show("clock"));
    assert!(!two_frames(EvidenceSource::Nothing).denies_thing("piano"));
}

#[test]
fn captions_deny_a_thing_that_a_witness_denied_or_that_stands_out() {
    let mut captions = two_frames(EvidenceSource::Captions);
    assert!(!captions.denies_thing("sofa") && captions.is_named_nowhere("sofa"));
    for frame in &mut captions.frames {
        frame.lists_things = true;
    }
    // A sofa is too large to be missing in two lists; a clock is not.
    assert!(captions.denies_thing("sofa") && !captions.denies_thing("clock"));
    captions.frames[0].denied.push("clock".into());
    assert!(captions.denies_thing("clock") && !captions.denies_thing("lamp"));
    captions.frames[0].lists_things = false;
    assert!(!captions.denies_thing("sofa") && captions.denies_thing("clock"));
    assert!(!stands_out("chair") && stands_out("sofa") && !stands_out("zorble"));
}

#[test]
fn denying_a_kind_denies_its_members_and_not_the_other_way() {
    assert!(denies_name("chair", "dining chair") && denies_name("chairs", "chair"));
    assert!(!denies_name("dining chair", "chair") && !denies_name("chair", "sofa"));
    assert!(denies_name("zorble", "zorbles"));
}

#[test]
fn labels_deny_a_thing_at_the_end_alone() {
    let labels = two_frames(EvidenceSource::Labels);
    assert!(labels.denies_thing_at_end("rug") && labels.denies_thing_at_end("piano"));
    assert!(!labels.denies_thing_at_end("door"));
    let mut unknown = labels.clone();
    unknown.frames[0].knows_things = false;
    assert!(unknown.denies_thing_at_end("rug"), "only the last frame has to be known");
    unknown.frames[1].knows_things = false;
    assert!(!unknown.denies_thing_at_end("rug"));
    let mut guessed = labels;
    guessed.frames[1].perhaps.things.push(seen("carpet"));
    assert!(!guessed.denies_thing_at_end("rug"));
    assert!(!walk(Vec::new(), &[]).denies_thing_at_end("rug"));
}

#[test]
fn captions_deny_a_thing_at_the_end_by_a_list_or_a_word() {
    let captions = two_frames(EvidenceSource::Captions);
    assert!(!captions.denies_thing_at_end("rug"));
    let mut listed = captions.clone();
    listed.frames[1].lists_things = true;
    assert!(listed.denies_thing_at_end("rug") && !listed.denies_thing_at_end("zorble"));
    let mut denied = captions;
    denied.frames[1].denied.push("rug".into());
    assert!(denied.denies_thing_at_end("rug") && !denied.denies_thing_at_end("lamp"));
}

#[test]
fn rooms_are_denied_where_each_frame_has_one() {
    let labels = two_frames(EvidenceSource::Labels);
    assert!(labels.denies_room("garage"));
    let mut unknown = labels.clone();
    unknown.frames[0].rooms.clear();
    assert!(!unknown.denies_room("garage"));
    let mut guessed = labels.clone();
    guessed.frames[0].perhaps.rooms.push("garage".into());
    assert!(!guessed.denies_room("garage") && guessed.denies_room("gym"));
    assert!(!two_frames(EvidenceSource::Nothing).denies_room("garage"));
    // Storeys: a basement is denied above the lowest storey, and an attic never.
    assert!(labels.denies_room("basement") && labels.denies_room("cellar") && !labels.denies_room("attic"));
    for level in [None, Some(1)] {
        let mut low = labels.clone();
        low.frames[0].level = level;
        assert!(!low.denies_room("basement"), "{level:?}");
    }
}

#[test]
fn frames_are_found_by_what_they_show() {
    let mut labels = two_frames(EvidenceSource::Labels);
    labels.frames[1].knows_things = false;
    assert_eq!((labels.frames_with_thing("carpet"), labels.frames_with_thing("piano")), (vec![0], vec![]));
    assert_eq!((labels.frames_in_room("corridor"), labels.frames_in_room("kitchen")), (vec![0], vec![1]));
    assert_eq!((labels.frames_without_things(), labels.frames_without_room()), (vec![1], vec![]));
    labels.frames[0].rooms.clear();
    assert_eq!(labels.frames_without_room(), [0]);
    assert_eq!(labels.final_things().iter().map(|thing| thing.name.as_str()).collect::<Vec<_>>(), ["stove"]);
    assert!(walk(Vec::new(), &[]).final_things().is_empty());
}

#[test]
fn climbs_are_found_at_the_foot_of_each_flight() {
    let frames = || vec![FrameEvidence::default(); 6];
    let rises = |rises: [f64; 5]| walk(frames(), &rises.map(|rise_m| (0.0, rise_m)));
    let path = rises([0.0, 0.3, 0.3, 0.0, -0.6]);
    assert_eq!(path.frames_with_climb(ClimbDirection::Up), [1]);
    assert_eq!(path.frames_with_climb(ClimbDirection::Down), [4]);
    assert_eq!(path.frames_on_stairs(), [1, 2, 3, 4, 5]);
    assert!(path.has_steps(ClimbDirection::Up) && path.has_steps(ClimbDirection::Down));
    let flat = rises([0.0, 0.09, -0.09, 0.0, 0.0]);
    assert!(!flat.has_steps(ClimbDirection::Up) && !flat.has_steps(ClimbDirection::Down));
    assert!(flat.frames_on_stairs().is_empty());
    let step = rises([0.1, 0.0, 0.0, 0.0, 0.0]);
    assert!(step.has_steps(ClimbDirection::Up) && !step.has_steps(ClimbDirection::Down));
    assert!(rises([0.0, 0.0, -0.1, 0.0, 0.0]).has_steps(ClimbDirection::Down));
}

#[test]
fn sources_have_names_and_some_leave_things_out() {
    use EvidenceSource::{Captions, Detector, Labels, Nothing};
    assert_eq!(
        [Labels, Captions, Detector, Nothing].map(EvidenceSource::name),
        ["labels", "captions", "detector", "nothing"]
    );
    assert_eq!([Labels, Captions, Detector, Nothing].map(EvidenceSource::leaves_out), [false, true, true, false]);
}

#[test]
fn evidence_of_a_path_alone_has_its_moves_and_storeys() {
    let path = path_through(&[(A, None), (B, None), ([2.0, 2.0, 1.5], None)]);
    let evidence = Evidence::for_path_alone(&path);
    assert_eq!((evidence.frames.len(), evidence.moves.len()), (3, 2));
    assert!(is_near(evidence.moves[1].turn_rad, std::f64::consts::FRAC_PI_2));
    assert_eq!((evidence.source, evidence.frames[2].level), (EvidenceSource::Nothing, Some(1)));
    let video = Evidence::for_path_alone(&Path { motion: PathMotion::Unknown, ..path });
    assert_eq!((video.moves.len(), video.frames[2].level), (0, None));
}

fn view(truth: Option<GroundTruth>) -> View {
    View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), 1.5, None, truth)
}

#[test]
fn labels_become_things_with_directions_distances_and_places() {
    let path = path_through(&[(A, None), ([2.0, 0.0, 1.5], None)]);
    // The walker looks east, and so do the labels.
    let placed = ObjectLabel { colour: Some("red".into()), ..label("sofa", "1", Some([3.0, 0.0, 1.5])) };
    let far = ObjectLabel { distance_m: Some(2.0), heading: Heading::NORTH, ..label("lamp", "2", None) };
    let high = ObjectLabel { distance_m: Some(2.0), elevation_rad: 30_f64.to_radians(), ..label("clock", "3", None) };
    let truth = GroundTruth { labels: vec![placed, far, high], lists_objects: true, room: Some("den".into()) };
    let bare = GroundTruth { labels: vec![label("rug", "4", None)], lists_objects: false, room: Some("den".into()) };
    let panoramas =
        vec![vec![view(Some(truth.clone())), view(Some(truth.clone()))], vec![view(Some(bare)), view(None)]];
    let evidence = Evidence::from_labels(&path, &panoramas).unwrap();
    let first = &evidence.frames[0];
    assert_eq!((first.rooms.clone(), first.knows_things, first.things.len()), (vec!["den".to_owned()], true, 6));
    assert_eq!((evidence.source, evidence.frames[1].knows_things), (EvidenceSource::Labels, false));
    let [sofa, lamp, clock] = &first.things[..3] else { panic!("three labels a view") };
    assert_eq!((sofa.name.as_str(), sofa.colour.as_deref()), ("sofa", Some("red")));
    assert_eq!(sofa.object, Some(ObjectId::new("1").unwrap()));
    assert!(is_near(sofa.turn_rad.unwrap(), 0.0) && is_near(sofa.distance_m.unwrap(), 3.0));
    assert!(is_near(lamp.turn_rad.unwrap(), -std::f64::consts::FRAC_PI_2) && lamp.distance_m == Some(2.0));
    assert!(lamp.position.unwrap().distance(DVec3::new(0.0, 2.0, 1.5)) < 1e-9);
    assert!(clock.position.unwrap().distance(DVec3::new(3_f64.sqrt(), 0.0, 2.5)) < 1e-9);
    let rug = &evidence.frames[1].things[0];
    assert_eq!((rug.distance_m, rug.position), (None, None));
    assert!(Evidence::from_labels(&path, &[vec![view(None)], vec![]]).is_none());
    let one = Evidence::from_labels(&path, &[vec![], vec![view(Some(truth))]]).unwrap();
    assert!(!one.frames[0].knows_things && one.frames[1].knows_things);
}

fn sighting(name: &str, witness: WitnessAnswer) -> ObjectSighting {
    ObjectSighting::new(name, witness, "test")
}

fn caption(room: Option<&str>, sightings: Vec<ObjectSighting>) -> Caption {
    Caption { room: room.map(str::to_owned), sightings, is_structured: true, ..Caption::default() }
}

/// Evidence from captions of views in these directions from the heading, one list for each frame.
fn captioned(frames: Vec<Vec<(f64, Caption)>>) -> Option<Evidence> {
    let path =
        path_through(&frames.iter().enumerate().map(|(at, _)| ([0.0, at as f64, 1.5], None)).collect::<Vec<_>>());
    let looks = |looks: Vec<(f64, Caption)>| FrameObservation {
        looks: looks
            .into_iter()
            .map(|(deg, caption)| CaptionedView {
                gaze: ViewGaze::quarter_view(Heading::NORTH.turned_by(deg.to_radians())),
                caption,
            })
            .collect(),
        ..FrameObservation::default()
    };
    let seen: Vec<FrameObservation> = frames.into_iter().map(looks).collect();
    Evidence::from_captions(&path, &seen)
}

#[test]
fn captions_without_rooms_and_objects_are_no_evidence() {
    use WitnessAnswer::{Denied, Seen, Unsure};
    assert!(captioned(vec![vec![(0.0, caption(None, vec![]))]]).is_none());
    for witness in [Seen, Unsure, Denied] {
        assert!(captioned(vec![vec![(0.0, caption(None, vec![sighting("sofa", witness)]))]]).is_some(), "{witness:?}");
    }
    assert!(captioned(vec![vec![(0.0, caption(Some("den"), vec![]))]]).is_some());
    let path = path_through(&[(A, None)]);
    assert!(Evidence::from_detector(&path, &[FrameObservation::default()]).is_none());
    let look = CaptionedView {
        gaze: ViewGaze::quarter_view(Heading::NORTH),
        caption: caption(None, vec![sighting("sofa", Denied)]),
    };
    let found =
        Evidence::from_detector(&path, &[FrameObservation { looks: vec![look], ..Default::default() }]).unwrap();
    assert_eq!((found.source, found.is_denied("sofa")), (EvidenceSource::Detector, true));
}

#[test]
fn captions_know_the_things_of_a_frame_if_each_view_was_looked_at() {
    use WitnessAnswer::Seen;
    let sofa = || caption(None, vec![sighting("sofa", Seen)]);
    let frame = |looks: Vec<(f64, Caption)>| captioned(vec![looks]).unwrap().frames.remove(0);
    let one = frame(vec![(0.0, sofa()), (90.0, caption(Some("den"), vec![]))]);
    assert!(one.knows_things && one.lists_things);
    let silent = frame(vec![(0.0, sofa()), (90.0, caption(None, vec![]))]);
    assert!(!silent.knows_things && !silent.lists_things);
    let words = frame(vec![(0.0, sofa()), (90.0, Caption { is_structured: false, ..sofa() })]);
    assert!(words.knows_things && !words.lists_things);
    let broken = frame(vec![(0.0, Caption { form: Some(FormOutcome::Broken), ..sofa() })]);
    let mended = frame(vec![(0.0, Caption { form: Some(FormOutcome::Mended), ..sofa() })]);
    assert!(!broken.lists_things && mended.lists_things);
    let none = captioned(vec![vec![(0.0, sofa())], vec![]]).unwrap().frames.remove(1);
    assert!(!none.knows_things && !none.lists_things);
}

#[test]
fn captions_give_directions_from_the_place_in_a_view() {
    use WitnessAnswer::{Seen, Unsure};
    let at = |place: ViewThird| ObjectSighting { place: Some(place), ..sighting("sofa", Seen) };
    let turn_deg = |deg: f64, place: ViewThird| {
        let evidence = captioned(vec![vec![(deg, caption(None, vec![at(place)]))]]).unwrap();
        evidence.frames[0].things[0].turn_rad.unwrap().to_degrees().round()
    };
    assert_eq!((turn_deg(0.0, ViewThird::Middle), turn_deg(90.0, ViewThird::Middle)), (0.0, 90.0));
    assert_eq!(turn_deg(90.0, ViewThird::Left) - 90.0, turn_deg(0.0, ViewThird::Left));
    assert!(turn_deg(0.0, ViewThird::Left) < 0.0 && turn_deg(0.0, ViewThird::Right) > 0.0);
    let plain =
        captioned(vec![vec![(0.0, caption(None, vec![sighting("sofa", Seen), sighting("rug", Unsure)]))]]).unwrap();
    assert_eq!(plain.frames[0].things[0].turn_rad, None);
    assert_eq!(plain.frames[0].perhaps.things[0].name, "rug");
}

#[test]
fn rooms_of_captions_are_listed_once_and_guesses_apart() {
    let first = Caption { perhaps_rooms: vec!["gym".into()], ..caption(Some("den"), vec![]) };
    let way = wayword_core::WayOut { name: "door".into(), place: None, leads_to: Some("kitchen".into()) };
    let second = Caption { ways: vec![way], ..caption(Some("den"), vec![]) };
    let evidence = captioned(vec![vec![(0.0, first), (90.0, second), (180.0, caption(Some("bar"), vec![]))]]).unwrap();
    assert_eq!(evidence.frames[0].rooms, ["den", "bar"]);
    assert_eq!(evidence.frames[0].perhaps.rooms, ["gym", "kitchen"]);
}

#[test]
fn a_denial_falls_where_another_view_of_the_frame_shows_the_thing() {
    use WitnessAnswer::{Denied, Seen, Unsure};
    let denied = |other: Vec<ObjectSighting>| {
        let looks = vec![(0.0, caption(None, vec![sighting("sofa", Denied)])), (90.0, caption(None, other))];
        captioned(vec![looks]).unwrap().frames[0].denied.clone()
    };
    assert_eq!(denied(vec![sighting("lamp", Seen)]), ["sofa"]);
    assert!(denied(vec![sighting("couch", Seen)]).is_empty());
    assert!(denied(vec![sighting("couch", Unsure)]).is_empty());
}

#[test]
fn a_thing_that_was_doubted_as_often_as_seen_is_only_perhaps_there() {
    use WitnessAnswer::{Seen, Unsure};
    let sofa = |witness| vec![(0.0, caption(None, vec![sighting("sofa", witness), sighting("rug", Seen)]))];
    let counts = |witnesses: &[WitnessAnswer]| {
        let evidence = captioned(witnesses.iter().map(|witness| sofa(*witness)).collect()).unwrap();
        let sure = evidence.frames_with_thing("sofa").len();
        let perhaps = evidence.frames.iter().filter(|frame| frame.may_show("sofa")).count();
        assert_eq!(evidence.frames_with_thing("rug").len(), witnesses.len());
        (sure, perhaps)
    };
    assert_eq!(counts(&[Seen, Seen]), (2, 0));
    assert_eq!(counts(&[Seen, Unsure]), (0, 2));
    assert_eq!(counts(&[Seen, Seen, Unsure]), (2, 1));
    assert_eq!(counts(&[Unsure, Unsure, Seen]), (0, 3));
}
