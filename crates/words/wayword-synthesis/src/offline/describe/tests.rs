//! A made-up building: two bedrooms side by side, each with a bed, and a hallway before them.

use super::{BuildingListing, describe_target};
use wayword_core::{
    DVec3, Frame, Heading, ObjectDescription, ObjectDistinction, ObjectId, ObjectLabel, ObjectRelation, PathTarget,
    Pose, ViewpointGraph, ViewpointId, ViewpointSurvey, graph::GraphError, survey::ViewpointKnowledge,
};

/// A viewpoint: its name, where it is, its room, and the things that are seen there (id, name, where they are).
type Spot<'a> = (&'a str, DVec3, &'a str, &'a [(&'a str, &'a str, DVec3)]);

fn id(name: &str) -> ViewpointId {
    ViewpointId::new(name).unwrap()
}

fn survey(spots: &[Spot<'_>], joined: &[(&str, &str)], has_positions: bool) -> ViewpointSurvey {
    let mut graph = ViewpointGraph::default();
    for (name, eye, ..) in spots {
        graph.add_viewpoint(id(name), *eye, Some(if eye.z < 3.0 { 1 } else { 2 })).unwrap();
    }
    for (a, b) in joined {
        graph.join_viewpoints(&id(a), &id(b)).unwrap();
    }
    let known = |place: &ViewpointId, eye: DVec3| {
        let (.., room, things) = spots.iter().find(|spot| id(spot.0) == *place).unwrap();
        let label = |(object, name, position): &(&str, &str, DVec3)| ObjectLabel {
            object: ObjectId::new(*object).unwrap(),
            name: (*name).to_owned(),
            heading: Heading::towards(eye, *position).unwrap(),
            elevation_rad: libm::atan2(position.z - eye.z, position.truncate().distance(eye.truncate())),
            box_px: None,
            distance_m: None,
            position: has_positions.then_some(*position),
            colour: None,
            room: None,
        };
        let things = Some(things.iter().map(label).collect());
        Ok::<_, GraphError>(ViewpointKnowledge { room: Some((*room).to_owned()), things })
    };
    ViewpointSurvey::from_graph(&graph, known).unwrap()
}

const LEFT: DVec3 = DVec3::new(-1.0, 3.0, 1.0);
const RIGHT: DVec3 = DVec3::new(1.0, 3.0, 1.0);

fn described(target: &str, spots: &[Spot<'_>], joined: &[(&str, &str)], has_positions: bool) -> PathTarget {
    let survey = survey(spots, joined, has_positions);
    let (place, eye, _, things) = spots[0];
    let frame = Frame { pose: Pose::looking_level(eye, Heading::NORTH), viewpoint: Some(id(place)), level: Some(1) };
    let name = things.iter().find(|thing| thing.0 == target).unwrap().1.to_owned();
    let mut target = PathTarget {
        object: ObjectId::new(target).unwrap(),
        name,
        told_by: Vec::new(),
        has_namesake: false,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    };
    describe_target(&mut target, &[frame], &BuildingListing::from_survey(&survey));
    target
}

const EYE: DVec3 = DVec3::new(0.0, 0.0, 1.5);
const FAR: DVec3 = DVec3::new(20.0, 0.0, 1.5);

#[test]
fn the_only_one_needs_no_more_than_its_name() {
    let lamp = described("1", &[("a", EYE, "bedroom", &[("1", "lamp", LEFT)])], &[], true);
    assert_eq!(lamp.descriptions.first(), Some(&ObjectDescription { by: vec![], leaves: 1 }));
    assert!(!lamp.has_namesake && lamp.told_by.is_empty());
}

#[test]
fn a_neighbour_or_a_row_distinguishes_one_of_two() {
    let sofa = ("3", "sofa", LEFT + DVec3::new(0.0, 0.6, 0.0));
    let things = [("1", "lamp", LEFT), ("2", "lamp", RIGHT), sofa];
    let lamp = described("1", &[("a", EYE, "bedroom", &things)], &[], true);
    assert!(lamp.has_namesake && lamp.descriptions.iter().all(ObjectDescription::fits_one_object), "{lamp:?}");
    let says = |by: &ObjectDistinction| lamp.descriptions.iter().any(|description| description.by == [by.clone()]);
    assert!(says(&ObjectDistinction::NextTo { neighbour: "sofa".into() }));
    assert!(says(&ObjectDistinction::InRow { place: 1, of: 2, from: wayword_core::Side::Left }));
    assert!(!lamp.descriptions.iter().any(|description| description.by.is_empty()));
}

#[test]
fn describe_leaves_out_unclear_properties() {
    // Both lamps are about as near to the sofa, and about as far to the left.
    let things = [("1", "lamp", LEFT), ("2", "lamp", LEFT + DVec3::new(0.1, 0.0, 0.0)), ("3", "sofa", RIGHT)];
    let lamp = described("1", &[("a", EYE, "bedroom", &things)], &[], true);
    assert!(lamp.told_by.is_empty(), "{lamp:?}");
    assert!(lamp.descriptions.iter().all(|description| description.leaves == 2), "{lamp:?}");
}

#[test]
fn names_that_mean_the_same_are_rivals() {
    let things = [("1", "picture", LEFT), ("2", "painting", RIGHT)];
    let picture = described("1", &[("a", EYE, "bedroom", &things)], &[], true);
    assert!(picture.has_namesake && picture.descriptions.iter().all(|description| !description.by.is_empty()));
}

#[test]
fn the_room_is_identified_by_its_neighbours() {
    let other = [("2", "lamp", FAR + DVec3::X)];
    let spots: [Spot<'_>; 3] = [
        ("a", EYE, "bedroom", &[("1", "lamp", LEFT)]),
        ("b", FAR, "bedroom", &other),
        ("c", EYE - DVec3::Y * 3.0, "bathroom", &[]),
    ];
    let lamp = described("1", &spots, &[("a", "c")], true);
    let by_bathroom = ObjectDistinction::RoomBy { room: "bathroom".into() };
    assert!(
        lamp.descriptions
            .iter()
            .any(|description| description.by == [by_bathroom.clone()] && description.fits_one_object())
    );
}

#[test]
fn without_positions_things_are_found_where_rays_meet() {
    let sofa = ("3", "sofa", LEFT + DVec3::new(0.0, 0.6, 0.0));
    let things = [("1", "lamp", LEFT), ("2", "lamp", RIGHT), sofa];
    let spots: [Spot<'_>; 2] = [("a", EYE, "bedroom", &things), ("b", EYE + DVec3::X * 3.0, "bedroom", &things)];
    let lamp = described("1", &spots, &[("a", "b")], false);
    let next_to = ObjectDistinction::NextTo { neighbour: "sofa".into() };
    assert!(lamp.descriptions.iter().any(|description| description.by == [next_to.clone()]), "{lamp:?}");
}

#[test]
fn the_one_on_the_left_is_the_outermost_of_several() {
    let (near, far) = (DVec3::new(-2.0, 2.0, 1.0), DVec3::new(-3.0, 0.5, 1.0));
    let says_side = |target: &str| {
        let pillows = [("1", "pillow", near), ("2", "pillow", far)];
        let other = [("3", "pillow", FAR + DVec3::X)];
        // No other property differs between the beds: the other bedroom is the same.
        let spots: [Spot<'_>; 2] = [("a", EYE, "bedroom", &pillows), ("b", FAR, "bedroom", &other)];
        let pillow = described(target, &spots, &[], true);
        let is_side = |by: &ObjectDistinction| matches!(by, ObjectDistinction::OnSide { .. });
        pillow
            .descriptions
            .iter()
            .any(|description| !description.fits_one_object() && description.by.iter().any(is_side))
            || pillow.told_by.iter().any(is_side)
    };
    assert!(!says_side("1"), "the other one is farther to the left");
}

#[test]
fn unlisted_rivals_at_the_end_count_for_sides() {
    // The second chair is in the room, but only listed where the first is not seen.
    let (one, other) = (DVec3::new(-2.0, 1.0, 1.0), DVec3::new(-4.0, 1.0, 1.0));
    let (here, there) = ([("1", "chair", one)], [("2", "chair", other)]);
    let spots: [Spot<'_>; 2] = [("a", EYE, "kitchen", &here), ("b", EYE - DVec3::X * 4.0, "kitchen", &there)];
    let chair = described("1", &spots, &[("a", "b")], true);
    let is_side = |by: &ObjectDistinction| matches!(by, ObjectDistinction::OnSide { .. });
    assert!(!chair.descriptions.iter().any(|description| description.by.iter().any(is_side)), "{chair:?}");
}

#[test]
fn describe_mentions_no_thing_twice() {
    let shelf = ("3", "shelf", LEFT + DVec3::Z * 0.6);
    let things = [("1", "lamp", LEFT), ("2", "lamp", RIGHT), shelf];
    let lamp = described("1", &[("a", EYE, "bedroom", &things)], &[], true);
    for description in &lamp.descriptions {
        let names: Vec<&str> = description.by.iter().flat_map(ObjectDistinction::named_things).collect();
        assert!(names.len() < 2 || names[0] != names[1], "{description:?}");
    }
    assert!(
        lamp.descriptions
            .iter()
            .any(|description| description.by.iter().any(|by| by.named_things().next() == Some("shelf")))
    );
}

#[test]
fn the_storey_is_told_where_rooms_of_the_kind_lie_on_several() {
    let level = |above: &str| {
        let spots: [Spot<'_>; 2] =
            [("a", EYE, "bedroom", &[("1", "lamp", LEFT)]), ("b", EYE + DVec3::Z * 3.0, above, &[])];
        let lamp = described("1", &spots, &[], true);
        lamp.descriptions.iter().all(|description| description.by.contains(&ObjectDistinction::Level { level: 1 }))
    };
    assert!(level("bedroom") && !level("kitchen"));
}

/// The single properties of a target that describe it in some way.
fn properties(target: &PathTarget) -> impl Iterator<Item = &ObjectDistinction> {
    target.told_by.iter().chain(target.descriptions.iter().flat_map(|description| &description.by))
}

#[test]
fn the_closest_is_told_only_where_there_are_several() {
    let sofa = ("3", "sofa", LEFT + DVec3::new(0.0, 0.9, 0.0));
    let other = [("2", "lamp", FAR + DVec3::X)];
    let alone: [Spot<'_>; 2] = [("a", EYE, "bedroom", &[("1", "lamp", LEFT), sofa]), ("b", FAR, "bedroom", &other)];
    let lamp = described("1", &alone, &[], true);
    assert!(properties(&lamp).all(|by| !matches!(by, ObjectDistinction::NextTo { .. })), "{lamp:?}");
}

#[test]
fn a_lamp_on_a_desk_is_not_near_it_and_what_hangs_above_is_not_beside() {
    let things = [
        ("1", "lamp", LEFT),
        ("2", "lamp", RIGHT),
        ("3", "desk", LEFT - DVec3::Z * 0.4),
        ("4", "picture", LEFT + DVec3::new(0.6, 0.3, 1.2)),
    ];
    let lamp = described("1", &[("a", EYE, "office", &things)], &[], true);
    let of_object = || properties(&lamp).filter(|by| !by.is_about_room());
    let to_desk: Vec<_> = of_object().filter(|by| by.named_things().any(|name| name == "desk")).collect();
    let is_on = |by: &&ObjectDistinction| matches!(by, ObjectDistinction::Related { relation: ObjectRelation::On, .. });
    assert!(!to_desk.is_empty() && to_desk.iter().all(is_on), "{to_desk:?}");
    assert!(of_object().all(|by| by.named_things().all(|name| name != "picture")), "{lamp:?}");
}

#[test]
fn what_lies_in_front_of_a_thing_is_on_no_side_of_it() {
    let plant = |at: DVec3| is_left_of_sofa(&[("a", EYE, "bedroom", &[("1", "plant", at), SOFA])]);
    assert!(plant(DVec3::new(-1.2, 3.0, 0.0)) && !plant(DVec3::new(-0.5, 1.9, 0.0)));
}

const SOFA: (&str, &str, DVec3) = ("2", "sofa", DVec3::new(0.0, 3.0, 0.4));

fn is_left_of_sofa(spots: &[Spot<'_>]) -> bool {
    let thing = described("1", spots, &[], true);
    properties(&thing).any(|by| matches!(by, ObjectDistinction::Related { relation: ObjectRelation::LeftOf, .. }))
}

#[test]
fn a_side_of_a_thing_holds_from_wherever_both_are_seen() {
    let things = [("1", "plant", DVec3::new(-1.2, 3.0, 0.0)), SOFA];
    let behind = EYE + DVec3::Y * 6.0;
    assert!(is_left_of_sofa(&[("a", EYE, "bedroom", &things)]));
    assert!(!is_left_of_sofa(&[("a", EYE, "bedroom", &things), ("b", behind, "bedroom", &things)]));
}

#[test]
fn what_may_stand_on_a_rug_is_on_no_side_of_it() {
    let things = [("1", "sofa", LEFT), ("2", "rug", LEFT + DVec3::new(0.9, 0.0, -0.9)), ("3", "tv stand", RIGHT)];
    let names = |target: &str, name: &str| {
        let target = described(target, &[("a", EYE, "bedroom", &things)], &[], true);
        properties(&target).any(|by| by.named_things().any(|named| named == name))
    };
    assert!(!names("1", "rug") && !names("2", "sofa"));
}

#[test]
fn a_room_is_told_only_by_what_another_of_its_kind_lacks() {
    let with = |there: &[(&str, &str, DVec3)]| {
        let here = [("1", "lamp", LEFT), ("2", "bed", RIGHT)];
        let lamp = described("1", &[("a", EYE, "bedroom", &here), ("b", FAR, "bedroom", there)], &[], true);
        properties(&lamp).any(|by| matches!(by, ObjectDistinction::RoomWith { .. }))
    };
    assert!(with(&[("3", "lamp", FAR + DVec3::X)]));
    assert!(!with(&[("3", "lamp", FAR + DVec3::X), ("4", "bed", FAR - DVec3::X)]));
}

#[test]
fn a_frame_beside_the_viewpoints_is_told_from_the_rest_of_its_building() {
    let other = [("2", "lamp", FAR + DVec3::X)];
    let survey = survey(&[("a", EYE, "bedroom", &[("1", "lamp", LEFT)]), ("b", FAR, "bedroom", &other)], &[], true);
    let aside =
        Frame { pose: Pose::looking_level(EYE + DVec3::X * 0.5, Heading::NORTH), viewpoint: None, level: Some(1) };
    let known = survey.viewpoints()[0].known.things.clone().unwrap();
    let told = |listing: BuildingListing| {
        let mut target = PathTarget {
            object: ObjectId::new("1").unwrap(),
            name: "lamp".into(),
            told_by: Vec::new(),
            has_namesake: false,
            descriptions: Vec::new(),
            hangs: false,
            storeys: 0,
        };
        describe_target(
            &mut target,
            std::slice::from_ref(&aside),
            &listing.with_frame(&aside, Some("bedroom"), known.iter()),
        );
        target.descriptions[0].leaves
    };
    assert_eq!((told(BuildingListing::from_survey(&survey)), told(BuildingListing::default())), (2, 1));
}
