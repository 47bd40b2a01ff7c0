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
        has_witnesses: false,
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
        has_witnesses: false,
        beyond: EndSurroundings::default(),
    };
    let memory = WalkMemory::from_path(&evidence, &path);
    assert_eq!(memory.things.len(), 1);
    assert_eq!((memory.things[0].position, memory.things[0].passed, memory.bends.len()), (None, None, 0));
    assert_eq!(memory.side_at(&memory.things[0], 1), None);
}

/// The memory of a walk along these points in one room, with the things of each frame.
fn memory_of(stops: &[(f64, f64, f64)], things: Vec<Vec<SeenThing>>) -> WalkMemory {
    let frames = things.into_iter().map(|things| frame("den", things)).collect();
    let (evidence, path) = walked(stops, frames);
    WalkMemory::from_path(&evidence, &path)
}

fn at_distance(name: &str, deg: f64, distance_m: f64) -> SeenThing {
    SeenThing { distance_m: Some(distance_m), ..thing(name, None, deg) }
}

#[test]
fn frame_count_room_at_and_stay_at_follow_the_frames() {
    let frames = vec![frame("", vec![]), frame("den", vec![]), frame("den", vec![]), frame("hallway", vec![])];
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    assert_eq!(memory.frame_count(), 4);
    let rooms: Vec<_> = (0..5).map(|at| memory.room_at(at)).collect();
    assert_eq!(rooms, [None, Some("den"), Some("den"), Some("hallway"), None]);
    assert_eq!(memory.stay_at(2).map(|stay| (stay.entered, stay.left)), Some((1, 2)));
}

#[test]
fn a_stay_goes_on_over_frames_without_a_room_and_under_another_name() {
    let stays = |rooms: [&str; 4]| {
        let (evidence, _) = walked(&NORTH, rooms.map(|room| frame(room, vec![])).into());
        let stays = stays_and_bends::find_stays(&evidence);
        stays.into_iter().map(|stay| (stay.room, stay.entered, stay.left)).collect::<Vec<_>>()
    };
    let stay = |room: &str, entered, left| (room.to_owned(), entered, left);
    assert_eq!(stays(["hall", "", "corridor", "den"]), [stay("hall", 0, 2), stay("den", 3, 3)]);
    assert_eq!(stays(["den", "hall", "den", "den"]), [stay("den", 0, 0), stay("hall", 1, 1), stay("den", 2, 3)]);
    assert_eq!(stays(["", "", "", ""]), []);
}

#[test]
fn distance_and_side_are_taken_from_the_place_of_a_thing() {
    let memory = memory_of(&NORTH, vec![vec![placed("sofa", "1", 3.0, 4.0)], vec![], vec![], vec![]]);
    let sofa = &memory.things[0];
    let distances: Vec<_> = (0..4).map(|at| memory.distance_m(sofa, at).unwrap()).collect();
    assert_eq!((distances[0], distances[2]), (5.0, 3.0));
    assert_eq!((memory.side_at(sofa, 0), memory.side_at(sofa, 2)), (Some(Side::Ahead), Some(Side::Right)));
    assert_eq!(memory.side_at(sofa, 9), None);
    assert_eq!(memory.seen_from(0).count(), 1);
    assert_eq!(memory.seen_from(1).count(), 0);
    // Height does not count, but another storey is not near, and nothing of it is passed.
    let at_height = |z: f64| {
        let lamp = SeenThing { position: Some(DVec3::new(3.0, 4.0, z)), ..thing("lamp", Some("2"), 0.0) };
        memory_of(&NORTH, vec![vec![lamp], vec![], vec![], vec![]])
    };
    assert_eq!(at_height(1.0).distance_m(&at_height(1.0).things[0], 0), Some(5.0));
    assert!(at_height(9.0).distance_m(&at_height(9.0).things[0], 0).unwrap() > 10.0);
    assert!(at_height(1.0).things[0].passed.is_some() && at_height(9.0).things[0].passed.is_none());
}

#[test]
fn distance_and_side_without_a_place_are_those_of_the_glimpse() {
    let memory = memory_of(&NORTH, vec![vec![], vec![thing("sofa", None, -90.0)], vec![], vec![]]);
    let sofa = &memory.things[0];
    assert_eq!((sofa.position, memory.distance_m(sofa, 1)), (None, None));
    assert_eq!((memory.side_at(sofa, 1), memory.side_at(sofa, 2)), (Some(Side::Left), None));
    assert_eq!((sofa.first_seen(), sofa.last_seen()), (1, 1));
    assert!(sofa.glimpse_from(1).is_some() && sofa.glimpse_from(0).is_none());
    // The motion is unknown: a distance may be measured all the same.
    let (mut evidence, path) = walked(&NORTH[..1], vec![frame("den", vec![at_distance("sofa", 0.0, 2.5)])]);
    evidence.motion = PathMotion::Unknown;
    let memory = WalkMemory::from_path(&evidence, &Path { motion: PathMotion::Unknown, ..path });
    assert_eq!(memory.distance_m(&memory.things[0], 0), Some(2.5));
    assert_eq!(memory.distance_m(&memory.things[0], 1), None);
}

#[test]
fn a_thing_is_passed_at_the_nearest_frame_and_on_its_side() {
    let passed = |x: f64, y: f64| {
        let memory = memory_of(&NORTH, vec![vec![placed("sofa", "1", x, y)], vec![], vec![], vec![]]);
        memory.things[0].passed.map(|passed| (passed.frame, passed.side, passed.along_m))
    };
    assert_eq!(passed(1.0, 0.9), Some((0, Side::Right, 0.9)));
    assert_eq!(passed(1.0, 1.0), Some((0, Side::Right, 1.0)));
    assert_eq!(passed(1.0, 1.1), Some((1, Side::Right, 1.1)));
    assert_eq!(passed(-1.0, 4.5), Some((2, Side::Left, 4.5)));
    // Up to 0.3 metres before the beginning and behind the end.
    assert_eq!(passed(1.0, -0.3).map(|(frame, ..)| frame), Some(0));
    assert_eq!(passed(1.0, -0.31), None);
    assert_eq!(passed(1.0, 6.25).map(|(frame, ..)| frame), Some(3));
    assert_eq!(passed(1.0, 6.31), None);
    // Not in the way, and not farther off than four metres.
    assert_eq!((passed(0.15, 1.0).is_some(), passed(0.14, 1.0)), (true, None));
    assert_eq!((passed(-4.0, 1.0).is_some(), passed(-4.01, 1.0)), (true, None));
}

#[test]
fn a_thing_is_passed_on_the_hop_that_comes_nearest() {
    let corner = [(0.0, 0.0, 0.0), (0.0, 4.0, 0.0), (4.0, 4.0, 0.0)];
    let passed = |x: f64, y: f64| {
        let memory = memory_of(&corner, vec![vec![placed("sofa", "1", x, y)], vec![], vec![]]);
        memory.things[0].passed.map(|passed| (passed.frame, passed.side, passed.along_m))
    };
    assert_eq!(
        passed(1.0, 2.5),
        Some((1, Side::Right, 2.5)),
        "the first hop is a metre off, the second one and a half"
    );
    assert_eq!(passed(2.5, 3.0), Some((2, Side::Right, 6.5)));
    assert_eq!(passed(3.0, 5.0), Some((2, Side::Left, 7.0)));
    // A hop on the spot passes nothing.
    let still = memory_of(&[(0.0, 0.0, 0.0), (0.0, 0.0, 0.0)], vec![vec![placed("sofa", "1", 1.0, 0.0)], vec![]]);
    assert_eq!(still.things[0].passed, None);
}

#[test]
fn a_thing_without_a_place_is_passed_from_ahead_to_the_side() {
    let passed = |before: Option<f64>, now: Option<f64>| {
        let seen = |deg: Option<f64>| SeenThing { turn_rad: deg.map(f64::to_radians), ..thing("sofa", Some("1"), 0.0) };
        // Without poses, directions give no place.
        let frames = vec![frame("den", vec![seen(before)]), frame("den", vec![seen(now)])];
        let (evidence, path) = walked(&NORTH[..2], frames);
        let path = Path { motion: PathMotion::Unknown, ..path };
        let memory = WalkMemory::from_path(&evidence, &path);
        memory.things[0].passed.map(|passed| (passed.frame, passed.side, passed.along_m))
    };
    assert_eq!(passed(Some(10.0), Some(90.0)), Some((1, Side::Right, 1.0)));
    assert_eq!(passed(Some(-10.0), Some(-90.0)), Some((1, Side::Left, 1.0)));
    assert_eq!(passed(Some(59.0), Some(61.0)), Some((1, Side::Right, 1.0)));
    for (before, now) in [(61.0, 90.0), (10.0, 59.0), (10.0, 136.0), (10.0, -136.0), (-61.0, -90.0)] {
        assert_eq!(passed(Some(before), Some(now)), None, "{before} {now}");
    }
    assert_eq!(passed(Some(10.0), Some(134.0)), Some((1, Side::Right, 1.0)));
    assert_eq!((passed(None, Some(90.0)), passed(Some(10.0), None)), (None, None));
}

#[test]
fn sightings_without_ids_are_joined_by_their_places() {
    let count =
        |first: SeenThing, second: SeenThing| memory_of(&NORTH[..2], vec![vec![first], vec![second]]).things.len();
    let at = |x: f64, y: f64| SeenThing { position: Some(DVec3::new(x, y, 0.0)), ..thing("sofa", None, 0.0) };
    assert_eq!((count(at(1.0, 3.0), at(1.0, 3.8)), count(at(1.0, 3.0), at(1.0, 3.81))), (1, 2));
    // Measured from the second frame, which is two metres farther on.
    let ahead = |distance_m: f64| at_distance("sofa", 0.0, distance_m);
    assert_eq!((count(ahead(6.0), ahead(5.5)), count(ahead(6.0), ahead(5.6))), (1, 2));
    assert_eq!((count(ahead(6.0), ahead(2.5)), count(ahead(6.0), ahead(2.4))), (1, 2));
    // Another name or another colour is another thing.
    assert_eq!(count(at(1.0, 3.0), SeenThing { name: "lamp".into(), ..at(1.0, 3.0) }), 2);
    let coloured = |colour: &str| SeenThing { colour: Some(colour.into()), ..at(1.0, 3.0) };
    assert_eq!((count(coloured("red"), coloured("green")), count(coloured("red"), at(1.0, 3.0))), (2, 1));
    // A thing with an id is never joined with one without.
    assert_eq!(count(placed("sofa", "1", 1.0, 3.0), at(1.0, 3.0)), 2);
    assert_eq!(count(placed("sofa", "1", 1.0, 3.0), placed("sofa", "1", 9.0, 9.0)), 1);
    assert_eq!(count(placed("sofa", "1", 1.0, 3.0), placed("sofa", "2", 1.0, 3.0)), 2);
}

#[test]
fn sightings_without_ids_are_joined_where_their_directions_can_meet() {
    let count = |first: f64, second: f64| {
        memory_of(&NORTH[..2], vec![vec![thing("sofa", None, first)], vec![thing("sofa", None, second)]]).things.len()
    };
    assert_eq!(count(30.0, 60.0), 1);
    assert_eq!(count(-30.0, -60.0), 1);
    // They cross behind the eyes, or on different sides.
    assert_eq!(count(60.0, 30.0), 2);
    assert_eq!(count(30.0, -60.0), 2);
    // Nearly parallel, in one direction and in opposite ones.
    assert_eq!((count(0.0, 5.0), count(0.0, 175.0)), (1, 2));
    // They cross at 7.9 metres from the first eye, and at 8.1.
    assert_eq!((count(33.0, 43.0), count(35.0, 45.0)), (1, 2));
}

#[test]
fn sightings_without_directions_are_joined_in_consecutive_frames_alone() {
    let plain = || vec![SeenThing { name: "sofa".into(), ..SeenThing::default() }];
    assert_eq!(memory_of(&NORTH[..3], vec![plain(), plain(), plain()]).things.len(), 1);
    assert_eq!(memory_of(&NORTH[..3], vec![plain(), vec![], plain()]).things.len(), 2);
    let two = memory_of(&NORTH[..1], vec![[plain(), plain()].concat()]);
    assert_eq!(two.things.len(), 2, "two of one frame are two things");
    let nameless = memory_of(&NORTH[..1], vec![vec![SeenThing::default()]]);
    assert!(nameless.things.is_empty());
}

#[test]
fn the_place_of_a_thing_is_listed_measured_or_crossed() {
    let place = |first: SeenThing, second: SeenThing| {
        let id = |thing: SeenThing| SeenThing { object: Some(ObjectId::new("1").unwrap()), ..thing };
        memory_of(&NORTH[..2], vec![vec![id(first)], vec![id(second)]]).things[0].position
    };
    let near = |at: Option<DVec3>, x: f64, y: f64| at.is_some_and(|at| at.distance(DVec3::new(x, y, 0.0)) < 1e-9);
    assert!(near(place(placed("sofa", "1", 5.0, 5.0), at_distance("sofa", 0.0, 2.0)), 5.0, 5.0));
    assert!(near(place(at_distance("sofa", 90.0, 2.0), at_distance("sofa", 90.0, 1.0)), 1.0, 2.0), "the nearer one");
    assert!(near(place(at_distance("sofa", 90.0, 1.0), at_distance("sofa", 90.0, 2.0)), 1.0, 0.0));
    assert!(near(place(thing("sofa", None, 45.0), thing("sofa", None, 90.0)), 2.0, 2.0));
    assert!(near(place(thing("sofa", None, -45.0), thing("sofa", None, -90.0)), -2.0, 2.0));
    assert_eq!(place(thing("sofa", None, 45.0), thing("sofa", None, 30.0)), None, "they cross behind");
    assert_eq!(place(thing("sofa", None, 35.0), thing("sofa", None, 45.0)), None, "they cross too far off");
    assert_eq!(place(thing("sofa", None, 0.0), thing("sofa", None, 5.0)), None, "they hardly cross");
    let glimpses = memory_of(&NORTH[..2], vec![vec![placed("sofa", "1", 3.0, 0.0)], vec![]]).things.remove(0).glimpses;
    assert_eq!(glimpses[0].distance_m, Some(3.0));
}

#[test]
fn a_colour_is_kept_only_if_no_glimpse_has_another() {
    let colour = |first: Option<&str>, second: Option<&str>| {
        let sofa =
            |colour: Option<&str>| SeenThing { colour: colour.map(str::to_owned), ..thing("sofa", Some("1"), 0.0) };
        memory_of(&NORTH[..2], vec![vec![sofa(first)], vec![sofa(second)]]).things.remove(0).colour
    };
    assert_eq!(colour(Some("red"), Some("red")).as_deref(), Some("red"));
    assert_eq!(colour(None, Some("red")).as_deref(), Some("red"));
    assert_eq!(colour(Some("red"), Some("green")), None);
}

#[test]
fn ordinals_count_the_same_stay_the_same_side_and_the_same_name() {
    let things = vec![
        placed("door", "a", 1.0, 1.0),
        placed("gate", "b", 1.0, 2.0),
        placed("door", "c", 1.0, 5.5),
        placed("door", "d", 0.0, 3.0),
        placed("door", "e", 1.0, 2.5),
    ];
    let rooms = ["hallway", "hallway", "hallway", "den"];
    let mut frames: Vec<FrameEvidence> = rooms.map(|room| frame(room, vec![])).into();
    frames[0].things = things;
    let (evidence, path) = walked(&NORTH, frames.clone());
    let memory = WalkMemory::from_path(&evidence, &path);
    let all: Vec<_> = memory.things.iter().map(|thing| memory.ordinal_among_alike(thing)).collect();
    // The door straight ahead is not passed, so the doors cannot be counted.
    assert_eq!(all, [None, Some((1, 1)), None, None, None]);
    frames[0].things.remove(3);
    let (evidence, path) = walked(&NORTH, frames);
    let memory = WalkMemory::from_path(&evidence, &path);
    let all: Vec<_> = memory.things.iter().map(|thing| memory.ordinal_among_alike(thing)).collect();
    assert_eq!(all, [Some((1, 2)), Some((1, 1)), Some((1, 1)), Some((2, 2))], "the third door is in the den");
}

#[test]
fn bends_begin_and_end_at_their_limits() {
    let step = |deg: f64, distance_m: f64| wayword_core::PathMove {
        turn_rad: crate::tests::exact_rad(deg),
        distance_m,
        rise_m: 0.0,
    };
    let bends = |turns: &[(f64, f64)]| {
        let moves: Vec<_> = turns.iter().map(|(deg, distance_m)| step(*deg, *distance_m)).collect();
        let of = stays_and_bends::find_bends(&moves);
        of.iter().map(|bend| (bend.first, bend.last, bend.turn_rad.to_degrees().round())).collect::<Vec<_>>()
    };
    // A turn is worth a word from 30 degrees on.
    assert_eq!((bends(&[(30.0, 1.0)]), bends(&[(29.5, 1.0)])), (vec![(0, 0, 30.0)], vec![]));
    assert_eq!(bends(&[(-30.0, 1.0)]), [(0, 0, -30.0)]);
    // Small turns are one bend from 60 degrees on, and each has at least 10.
    assert_eq!(bends(&[(0.0, 1.0), (29.0, 1.0), (29.0, 1.0)]), []);
    assert_eq!(bends(&[(0.0, 1.0), (29.0, 1.0), (29.0, 1.0), (9.0, 1.0)]), []);
    assert_eq!(bends(&[(0.0, 1.0), (29.0, 1.0), (29.0, 1.0), (11.0, 1.0)]), [(1, 3, 69.0)]);
    assert_eq!(bends(&[(0.0, 1.0), (-29.0, 1.0), (-29.0, 1.0), (-11.0, 1.0)]), [(1, 3, -69.0)]);
    // The opening turn is a turn of its own.
    assert_eq!(bends(&[(35.0, 1.0), (35.0, 1.0)]), [(0, 0, 35.0), (1, 1, 35.0)]);
    assert_eq!(bends(&[(0.0, 1.0), (35.0, 1.0), (35.0, 1.0)]), [(1, 2, 70.0)]);
    // No more than three moves, no more than one full turn, and no more than 135 degrees are one bend.
    assert_eq!(bends(&[(0.0, 1.0), (26.0, 1.0), (25.0, 1.0), (25.0, 1.0), (20.0, 1.0)]), [(1, 3, 76.0)]);
    assert_eq!(bends(&[(0.0, 1.0), (60.0, 1.0), (60.0, 1.0)]), [(1, 1, 60.0), (2, 2, 60.0)]);
    assert_eq!(bends(&[(0.0, 1.0), (54.0, 1.0), (60.0, 1.0)]), [(1, 2, 114.0)]);
    assert_eq!(bends(&[(0.0, 1.0), (50.0, 1.0), (90.0, 1.0)]), [(1, 1, 50.0), (2, 2, 90.0)]);
}

#[test]
fn a_winding_way_has_small_opposite_turns_close_together() {
    let step = |deg: f64, distance_m: f64| wayword_core::PathMove {
        turn_rad: crate::tests::exact_rad(deg),
        distance_m,
        rise_m: 0.0,
    };
    let count = |turns: &[(f64, f64)]| {
        let moves: Vec<_> = turns.iter().map(|(deg, distance_m)| step(*deg, *distance_m)).collect();
        stays_and_bends::find_bends(&moves).len()
    };
    assert_eq!(count(&[(0.0, 1.0), (35.0, 2.4), (-35.0, 1.0)]), 0);
    assert_eq!(count(&[(0.0, 1.0), (35.0, 2.5), (-35.0, 1.0)]), 2, "two and a half metres lie between them");
    assert_eq!(count(&[(0.0, 1.0), (35.0, 1.3), (0.0, 1.3), (-35.0, 1.0)]), 2);
    assert_eq!(count(&[(0.0, 1.0), (39.0, 1.0), (-39.0, 1.0)]), 0);
    assert_eq!(count(&[(0.0, 1.0), (39.0, 1.0), (-41.0, 1.0)]), 2);
    assert_eq!(count(&[(35.0, 1.0), (-35.0, 1.0)]), 2, "the opening turn is no part of a winding way");
    // The nearest two go first.
    assert_eq!(count(&[(0.0, 1.0), (35.0, 2.0), (-35.0, 1.0), (35.0, 1.0)]), 1);
    let moves: Vec<_> =
        [(0.0, 1.0), (35.0, 2.0), (-35.0, 1.0), (35.0, 1.0)].iter().map(|(a, b)| step(*a, *b)).collect();
    assert_eq!(stays_and_bends::find_bends(&moves)[0].first, 1);
}

#[test]
fn a_bend_has_a_side_and_may_be_slight() {
    let bend = |deg: f64| WalkBend { first: 0, last: 0, turn_rad: crate::tests::exact_rad(deg) };
    let sides: Vec<_> = [150.0, 149.0, -149.0, -150.0, 40.0, -40.0].iter().map(|deg| bend(*deg).side()).collect();
    assert_eq!(sides, [Side::Behind, Side::Right, Side::Left, Side::Behind, Side::Right, Side::Left]);
    let slight: Vec<_> = [54.0, 55.0, -54.0, -55.0].iter().map(|deg| bend(*deg).is_slight()).collect();
    assert_eq!(slight, [true, false, true, false]);
}

#[test]
fn flights_in_two_directions_or_far_apart_are_two() {
    let flights = |stops: &[(f64, f64, f64)], levels: &[u32]| {
        let (mut evidence, path) = walked(stops, vec![frame("", vec![]); stops.len()]);
        for (frame, level) in evidence.frames.iter_mut().zip(levels) {
            frame.level = Some(*level);
        }
        WalkMemory::from_path(&evidence, &path).flights
    };
    let flight = |climb, from, to, to_level| StairFlight { climb, from, to, to_level };
    use ClimbDirection::{Down, Up};
    let up_and_down = [(0.0, 0.0, 0.0), (0.0, 1.0, 1.0), (0.0, 2.0, 0.0)];
    assert_eq!(flights(&up_and_down, &[1, 2, 1]), [flight(Up, 0, 1, Some(2)), flight(Down, 1, 2, Some(1))]);
    // A landing of 2.5 metres joins two flights, and a longer way does not.
    let landing = |y: f64| [(0.0, 0.0, 0.0), (0.0, 1.0, 1.0), (0.0, 1.0 + y, 1.0), (0.0, 2.0 + y, 2.0)];
    assert_eq!(flights(&landing(2.5), &[]), [flight(Up, 0, 3, None)]);
    assert_eq!(flights(&landing(2.6), &[]), [flight(Up, 0, 1, None), flight(Up, 2, 3, None)]);
    // The storey is that behind the last flight that has one.
    assert_eq!(flights(&landing(1.0), &[1, 2, 2, 3]), [flight(Up, 0, 3, Some(3))]);
    assert_eq!(flights(&landing(1.0), &[1, 2, 2, 2]), [flight(Up, 0, 3, Some(2))]);
    assert_eq!(flights(&[(0.0, 0.0, 0.0), (0.0, 1.0, 1.0)], &[1, 1]), [flight(Up, 0, 1, None)]);
    assert_eq!(flights(&[(0.0, 0.0, 0.0), (0.0, 1.0, 0.4)], &[1, 1]), []);
}

#[test]
fn an_opening_has_a_door_by_its_rooms_or_by_a_near_door() {
    let opening = |first: (&str, Vec<SeenThing>), second: (&str, Vec<SeenThing>)| {
        let (evidence, path) = walked(&NORTH[..2], vec![frame(first.0, first.1), frame(second.0, second.1)]);
        let openings = WalkMemory::from_path(&evidence, &path).openings;
        (frames_at_doors(&evidence), openings)
    };
    let (doors, openings) = opening(("hallway", vec![]), ("bedroom", vec![]));
    let wanted = RoomOpening { before: 0, behind: 1, from: "hallway".into(), to: "bedroom".into(), has_door: true };
    assert_eq!((doors, openings), (vec![0, 1], vec![wanted]));
    let open = |things: Vec<SeenThing>, more: Vec<SeenThing>| opening(("kitchen", things), ("dining room", more)).0;
    assert!(open(vec![], vec![]).is_empty());
    for far_m in [1.0, 2.5] {
        assert_eq!(open(vec![at_distance("door", 0.0, far_m)], vec![]), [0, 1], "{far_m}");
        assert_eq!(open(vec![], vec![at_distance("door", 0.0, far_m)]), [0, 1], "{far_m}");
    }
    assert!(open(vec![at_distance("door", 0.0, 2.6)], vec![]).is_empty());
    assert!(open(vec![at_distance("sofa", 0.0, 1.0)], vec![]).is_empty());
    assert_eq!(open(vec![thing("door", None, 0.0)], vec![]), [0, 1], "its distance is not known");
    assert_eq!(opening(("kitchen", vec![]), ("kitchen", vec![])), (vec![], vec![]));
}

#[test]
fn a_turn_just_before_its_door_comes_before_the_room() {
    // North along a hallway, and west through a door just beside the corner at frame 2.
    let stops = [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 2.0, 0.0), (-1.0, 2.0, 0.0), (-2.0, 2.0, 0.0)];
    let openings = |door: (f64, f64)| {
        let seen = |room: &str| frame(room, vec![placed("door", "1", door.0, door.1)]);
        let rooms = ["hallway", "hallway", "bedroom", "bedroom", "bedroom"].map(seen);
        let (evidence, path) = walked(&stops, rooms.to_vec());
        let memory = WalkMemory::from_path(&evidence, &path);
        (memory.openings[0].before, memory.openings[0].behind, memory.stays[1].entered)
    };
    assert_eq!(openings((-0.3, 2.2)), (2, 3, 3), "the hop behind the corner leads through the door");
    assert_eq!(openings((0.2, 1.7)), (1, 2, 2), "the hop before the corner does");
}

#[test]
fn the_nearest_hops_are_those_that_come_nearest_within_the_walk() {
    let (evidence, path) = walked(&NORTH, vec![frame("den", vec![]); 4]);
    let memory = WalkMemory::from_path(&evidence, &path);
    let near = |x: f64, y: f64| {
        let seen = RememberedThing {
            name: "door".into(),
            object: None,
            colour: None,
            position: Some(DVec3::new(x, y, 0.0)),
            room: None,
            glimpses: Vec::new(),
            passed: None,
            ..RememberedThing::default()
        };
        memory.nearest_hops(&seen).map(|(hops, near_m)| (hops, (near_m * 100.0).round()))
    };
    assert_eq!(near(0.4, 3.0), Some((vec![1], 40.0)));
    assert_eq!(near(0.5, 4.0), Some((vec![1, 2], 50.0)), "at a corner there are two");
    assert_eq!(near(0.0, 9.0), None, "it lies behind the end");
    assert_eq!(near(0.0, -1.0), None, "it lies before the start");
}

#[test]
fn a_door_leads_into_a_walled_room_and_not_from_one_outside_to_another() {
    for (from, to, wanted) in [
        ("hallway", "bedroom", true),
        ("bedroom", "hallway", true),
        ("kitchen", "living room", false),
        ("bedroom", "master bedroom", false),
        ("bedroom", "bathroom", true),
        ("hallway", "porch", true),
        ("balcony", "garden", false),
        ("outdoor area", "kitchen", true),
        ("zorble", "hallway", false),
        ("office", "zorble", true),
    ] {
        assert_eq!(leads_through_a_door(from, to), wanted, "{from} to {to}");
    }
}

/// The memory of a walk that bends a little in a door and turns left behind it, with this thing in the door.
fn bent_in_a_door(name: &str) -> WalkMemory {
    let stops = [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-0.42, 1.91, 0.0), (-1.33, 1.48, 0.0), (-2.24, 1.06, 0.0)];
    let in_door = placed(name, "1", -0.21, 1.45);
    memory_of(&stops, vec![vec![in_door.clone()], vec![in_door], vec![], vec![], vec![]])
}

#[test]
fn a_turn_behind_a_door_is_a_bend_of_its_own() {
    let spans = |memory: &WalkMemory| -> Vec<(usize, usize)> {
        memory.bends.iter().map(|bend| (bend.first, bend.last)).collect()
    };
    assert_eq!(spans(&bent_in_a_door("lamp")), [(1, 2)]);
    assert_eq!(spans(&bent_in_a_door("door")), [(2, 2)]);
}

#[test]
fn of_two_doors_ahead_the_walk_takes_the_one_to_which_it_bends() {
    let stops = [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 2.0, 0.0), (-0.42, 2.91, 0.0), (-0.42, 3.91, 0.0)];
    let taken = placed("doorway", "1", -0.21, 2.45);
    let with = |others: &[SeenThing]| {
        let seen: Vec<SeenThing> = others.iter().cloned().chain([taken.clone()]).collect();
        memory_of(&stops, vec![vec![], vec![], seen, vec![], vec![]])
    };
    let ahead = placed("door", "2", 0.6, 4.5);
    let behind = placed("door", "3", 0.6, -4.5);
    assert_eq!(with(std::slice::from_ref(&ahead)).side_among_doors(2), Some(Side::Left));
    assert_eq!(with(&[behind]).side_among_doors(2), None);
    assert_eq!(with(&[ahead]).side_among_doors(1), None);
}

#[test]
fn the_doors_on_a_side_are_counted_from_where_the_walker_sees_them_ahead() {
    let stops = [(0.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 4.0, 0.0), (0.0, 6.0, 0.0), (-2.0, 6.5, 0.0)];
    let doors: Vec<SeenThing> = [(-1.0, 1.0), (-1.0, 3.0), (1.0, 3.0), (-1.0, 6.3)]
        .into_iter()
        .enumerate()
        .map(|(at, (x, y))| placed("door", &at.to_string(), x, y))
        .collect();
    let ahead = |frame: usize| doors.iter().skip(frame).cloned().collect();
    let memory = memory_of(&stops, vec![ahead(0), ahead(1), ahead(3), ahead(3), vec![]]);
    assert_eq!(memory.door_number(Side::Left, 0, 3), Some(3));
    assert_eq!(memory.door_number(Side::Left, 1, 3), Some(2));
    assert_eq!(memory.door_number(Side::Left, 2, 3), Some(1));
}
