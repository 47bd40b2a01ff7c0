//! Tests of the memory of a walk: things, rooms, bends, flights and openings.

use super::*;
use crate::{EndSurroundings, EvidenceSource, FrameEvidence, SeenThing};
use wayword_core::{ClimbDirection, Frame, ObjectId, PathMotion, Pose, SceneId};

/// A path along points over the floor, with the evidence of its frames: its room, and its things.
fn walked(stops: &[(f64, f64, f64)], frames: Vec<FrameEvidence>) -> (Evidence, Path) {
    let stop = |at: &(f64, f64, f64)| wayword_core::path::PathStop {
        position: DVec3::new(at.0, at.1, at.2),
        viewpoint: None,
        level: None,
    };
    let frames_along = Path::frames_along(stops.iter().map(stop).collect(), None);
    let path = Path {
        id: "p".into(),
        scene: SceneId::new("s").unwrap(),
        frames: frames_along,
        motion: PathMotion::Known,
        target: None,
    };
    let evidence = Evidence {
        frames,
        moves: path.moves(),
        motion: path.motion,
        source: EvidenceSource::Labels,
        beyond: EndSurroundings::default(),
    };
    (evidence, path)
}

fn frame(room: &str, things: Vec<SeenThing>) -> FrameEvidence {
    let rooms = if room.is_empty() { Vec::new() } else { vec![room.to_owned()] };
    FrameEvidence { rooms, things, knows_things: true, ..FrameEvidence::default() }
}

fn thing(name: &str, id: Option<&str>, deg: f64) -> SeenThing {
    SeenThing {
        name: name.into(),
        object: id.map(|id| ObjectId::new(id).unwrap()),
        turn_rad: Some(deg.to_radians()),
        ..SeenThing::default()
    }
}

fn placed(name: &str, id: &str, x: f64, y: f64) -> SeenThing {
    SeenThing { position: Some(DVec3::new(x, y, 0.0)), ..thing(name, Some(id), 0.0) }
}

const NORTH: [(f64, f64, f64); 4] = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 4.0, 0.0), (0.0, 6.0, 0.0)];

#[test]
fn a_thing_that_several_frames_show_is_one_thing() {
    let frames = vec![
        frame("den", vec![thing("sofa", Some("1"), 20.0), thing("sofa", Some("2"), -20.0)]),
        frame("den", vec![thing("sofa", Some("1"), 60.0)]),
        frame("den", Vec::new()),
        frame("den", Vec::new()),
    ];
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    assert_eq!(memory.things.len(), 2);
    let sofa = &memory.things[0];
    assert_eq!((sofa.first_seen(), sofa.last_seen()), (0, 1));
    // Its two directions cross at about a metre and a quarter to the right, behind the second frame.
    let at = sofa.position.unwrap();
    assert!(at.x > 0.8 && at.y > 2.2 && at.y < 3.6, "{at}");
    assert_eq!(sofa.passed.map(|passed| passed.side), Some(Side::Right));
    assert!(memory.distance_m(sofa, 0).unwrap() > memory.distance_m(sofa, 1).unwrap());
    assert_eq!(memory.things[1].position, None, "one direction gives no place");
}

#[test]
fn one_direction_with_a_distance_gives_a_place() {
    let chair = SeenThing { distance_m: Some(2.0), ..thing("chair", None, 45.0) };
    let frames = vec![frame("den", vec![chair]), frame("den", vec![]), frame("den", vec![]), frame("den", vec![])];
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    let at = memory.things[0].position.unwrap();
    assert!((at.x - 2f64.sqrt()).abs() < 1e-9 && (at.y - 2f64.sqrt()).abs() < 1e-9, "{at}");
    assert!((memory.distance_m(&memory.things[0], 0).unwrap() - 2.0).abs() < 1e-9);
    assert_eq!(memory.things[0].passed.map(|passed| passed.side), Some(Side::Right));
}

#[test]
fn things_in_one_direction_at_other_distances_are_two() {
    let chair = |far_m| SeenThing { distance_m: Some(far_m), ..thing("chair", None, 0.0) };
    let things = |first_m, second_m| {
        let frames = vec![frame("den", vec![chair(first_m)]), frame("den", vec![chair(second_m)])];
        let (evidence, path) = walked(&NORTH[..2], frames);
        WalkMemory::from_path(&evidence, &path).things.len()
    };
    assert_eq!((things(6.0, 5.5), things(2.0, 8.0)), (1, 2));
}

#[test]
fn captions_without_ids_name_one_thing_where_colour_and_directions_allow_it() {
    let coloured =
        |name: &str, colour: &str, deg: f64| SeenThing { colour: Some(colour.into()), ..thing(name, None, deg) };
    let frames = vec![
        frame("den", vec![coloured("sofa", "green", 10.0)]),
        frame("den", vec![coloured("couch", "green", 25.0), coloured("sofa", "red", 25.0)]),
        frame("den", vec![thing("sofa", None, -90.0)]),
        frame("den", Vec::new()),
    ];
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    let told: Vec<(&str, Option<&str>, usize)> =
        memory.things.iter().map(|thing| (&*thing.name, thing.colour.as_deref(), thing.glimpses.len())).collect();
    assert_eq!(told, [("sofa", Some("green"), 2), ("sofa", Some("red"), 1), ("sofa", None, 1)]);
}

#[test]
fn doors_on_one_side_are_counted_along_the_way() {
    let doors = vec![placed("door", "a", 1.0, 1.0), placed("door", "b", -1.0, 2.0), placed("door", "c", 1.0, 3.0)];
    let frames =
        vec![frame("hallway", doors), frame("hallway", vec![]), frame("hallway", vec![]), frame("den", vec![])];
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    let ordinals: Vec<_> = memory.things.iter().map(|thing| memory.ordinal_among_alike(thing)).collect();
    assert_eq!(ordinals, [Some((1, 2)), Some((1, 1)), Some((2, 2))]);
    assert_eq!(memory.things[1].passed.map(|passed| (passed.frame, passed.side)), Some((1, Side::Left)));
}

#[test]
fn rooms_come_in_order_and_openings_between_them() {
    let frames = vec![frame("bedroom", vec![]), frame("bedroom", vec![]), frame("", vec![]), frame("hallway", vec![])];
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    let stays: Vec<_> = memory.stays.iter().map(|stay| (&*stay.room, stay.entered, stay.left)).collect();
    assert_eq!(stays, [("bedroom", 0, 1), ("hallway", 3, 3)]);
    assert!(memory.openings.is_empty(), "between them is a frame of which nothing is known");
    let frames = ["kitchen", "dining room", "hallway", "bathroom"].map(|room| frame(room, vec![]));
    let (evidence, path) = walked(&NORTH, frames.into());
    let doors: Vec<bool> =
        WalkMemory::from_path(&evidence, &path).openings.iter().map(|opening| opening.has_door).collect();
    assert_eq!(doors, [false, false, true]);
}

#[test]
fn small_turns_to_one_side_are_one_bend_and_a_winding_way_has_none() {
    let step = |deg: f64| wayword_core::PathMove { turn_rad: deg.to_radians(), distance_m: 1.0, rise_m: 0.0 };
    let bends = |turns: &[f64]| -> Vec<(usize, usize, f64)> {
        let moves: Vec<_> = turns.iter().map(|deg| step(*deg)).collect();
        let told = stays_and_bends::find_bends(&moves);
        told.iter().map(|bend| (bend.first, bend.last, bend.turn_rad.to_degrees().round())).collect()
    };
    assert_eq!(bends(&[0.0, 25.0, 28.0, 22.0, 0.0]), [(1, 3, 75.0)]);
    assert_eq!(bends(&[0.0, -90.0, -90.0]), [(1, 1, -90.0), (2, 2, -90.0)]);
    assert_eq!(bends(&[0.0, 35.0, -38.0, 0.0]), []);
    assert_eq!(bends(&[170.0, 0.0, 29.0]), [(0, 0, 170.0)]);
    assert_eq!(bends(&[0.0, 35.0, -45.0, 0.0]).len(), 2, "a turn of 45 degrees is told");
    for turns in [vec![0.0, 35.0, -38.0, 35.0], vec![0.0, 20.0, 50.0, 45.0, 20.0], vec![0.0, 30.0, 80.0, 20.0]] {
        let back: Vec<f64> = std::iter::once(0.0).chain(turns[1..].iter().rev().map(|deg| -deg)).collect();
        let (there, back) = (bends(&turns), bends(&back));
        let mirrored: Vec<f64> = back.iter().rev().map(|(_, _, deg)| -deg).collect();
        assert_eq!(there.iter().map(|(_, _, deg)| *deg).collect::<Vec<f64>>(), mirrored, "the way back of {turns:?}");
    }
    let around = WalkBend { first: 0, last: 0, turn_rad: 170_f64.to_radians() };
    assert_eq!((around.side(), around.is_slight()), (Side::Behind, false));
}

#[test]
fn a_flight_is_one_however_many_hops_it_takes() {
    let stops = [(0.0, 0.0, 0.0), (0.0, 1.0, 0.9), (0.0, 2.0, 1.8), (0.0, 4.0, 1.8)];
    let (mut evidence, path) = walked(&stops, vec![frame("", vec![]); 4]);
    for (at, frame) in evidence.frames.iter_mut().enumerate() {
        frame.level = Some(if at < 2 { 1 } else { 2 });
    }
    let flights = WalkMemory::from_path(&evidence, &path).flights;
    assert_eq!(flights, [StairFlight { climb: ClimbDirection::Up, from: 0, to: 2, to_level: Some(2) }]);
}

#[test]
fn flights_that_a_landing_joins_are_one() {
    let up = |x: f64, y: f64, z: f64| (x, y, z);
    let stops = [up(0.0, 0.0, 0.0), up(0.0, 2.0, 1.4), up(1.0, 2.0, 1.4), up(1.0, 0.0, 2.8), up(4.0, 0.0, 2.8)];
    let (evidence, path) = walked(&stops, vec![frame("", vec![]); 5]);
    let flights = WalkMemory::from_path(&evidence, &path).flights;
    assert_eq!(flights, [StairFlight { climb: ClimbDirection::Up, from: 0, to: 3, to_level: None }]);
    let (evidence, path) = walked(
        &[up(0.0, 0.0, 0.0), up(0.0, 2.0, 1.4), up(4.0, 2.0, 1.4), up(4.0, 0.0, 2.8)],
        vec![frame("", vec![]); 4],
    );
    assert_eq!(WalkMemory::from_path(&evidence, &path).flights.len(), 2, "a hallway lies between them");
}

#[test]
fn memory_of_an_unknown_motion_has_only_the_order() {
    let frames = vec![frame("den", vec![thing("sofa", None, 20.0)]); 3];
    let path = Path {
        id: "p".into(),
        scene: SceneId::new("s").unwrap(),
        frames: vec![Frame { pose: Pose::looking_level(DVec3::ZERO, Heading::NORTH), viewpoint: None, level: None }; 3],
        motion: PathMotion::Unknown,
        target: None,
    };
    let evidence = Evidence {
        frames,
        moves: Vec::new(),
        motion: PathMotion::Unknown,
        source: EvidenceSource::Captions,
        beyond: EndSurroundings::default(),
    };
    let memory = WalkMemory::from_path(&evidence, &path);
    assert_eq!(memory.things.len(), 1);
    assert_eq!((memory.things[0].position, memory.things[0].passed, memory.bends.len()), (None, None, 0));
    assert_eq!(memory.side_at(&memory.things[0], 1), None);
}
