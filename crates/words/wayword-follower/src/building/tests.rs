use super::*;
use crate::{
    made_buildings::{add_thing, make_building, make_corridor},
    tests::{surveyed, surveyed_at},
};
use std::f64::consts::{FRAC_PI_2, PI};

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn from_survey_takes_over_rooms_ways_things_and_storeys() {
    let building = KnownBuilding::from_survey(&surveyed());
    assert_eq!((building.len(), building.levels, building.is_empty()), (8, 1, false));
    assert!(building.viewpoints.iter().all(|viewpoint| viewpoint.is_known && viewpoint.level == Some(1)));
    assert_eq!(building.viewpoints[3].room.as_deref(), Some("bedroom"));
    let mut of_end = building.viewpoints[2].neighbours.clone();
    of_end.sort_unstable();
    assert_eq!(of_end, [1, 3, 5]);
    let things: Vec<_> = building.things.iter().map(|thing| (&*thing.name, &*thing.seen_from)).collect();
    assert_eq!(things, [("bed", &[4][..]), ("oven", &[6]), ("plant", &[1])]);
    assert_eq!(building.things[1].position, DVec3::new(5.5, 5.5, 1.0));
}

#[test]
fn from_survey_sees_things_within_three_metres_alone_and_keeps_the_others() {
    let seen_from = |distance_m: Option<f64>| {
        let building = KnownBuilding::from_survey(&surveyed_at(distance_m));
        building.things.iter().map(|thing| thing.seen_from.len()).collect::<Vec<_>>()
    };
    assert_eq!([seen_from(None), seen_from(Some(3.0)), seen_from(Some(3.1))], [[1; 3], [1; 3], [0; 3]]);
}

#[test]
fn along_path_joins_each_place_with_the_next_and_puts_things_in_their_direction() {
    let place = |north: f64, up: f64, things: &[(&str, Option<f64>)]| PathPlace {
        position: DVec3::new(0.0, north, up),
        room: Some("attic".to_owned()),
        level: None,
        things: things
            .iter()
            .map(|(name, rad)| PathThing { name: (*name).to_owned(), position: None, direction_rad: *rad })
            .collect(),
    };
    let path = vec![place(0.0, 0.0, &[("Sofa", Some(0.5))]), place(2.0, 0.0, &[]), place(4.0, 2.0, &[("lamp", None)])];
    let building = KnownBuilding::along_path(path);
    let neighbours: Vec<_> = building.viewpoints.iter().map(|viewpoint| &*viewpoint.neighbours).collect();
    assert_eq!(neighbours, [&[1][..], &[0, 2], &[1]]);
    assert_eq!(
        building.viewpoints.iter().map(|at| at.climbs).collect::<Vec<_>>(),
        [[false; 2], [true, false], [false, true]]
    );
    let sofa = &building.things[0];
    assert_eq!((&*sofa.name, &*sofa.seen_from), ("sofa", &[0][..]));
    assert!(near(sofa.position.x, 1.5 * 0.5f64.sin()) && near(sofa.position.y, 1.5 * 0.5f64.cos()));
    assert_eq!((building.things[1].position, &*building.things[1].seen_from), (DVec3::new(0.0, 4.0, 2.0), &[2][..]));
    assert_eq!(building.viewpoints[2].room.as_deref(), Some("attic"));
    assert!(KnownBuilding::along_path(Vec::new()).is_empty());
}

#[test]
fn find_stairs_takes_slopes_above_a_quarter() {
    let climbs = |rise_m: f64, flat_m: f64| {
        make_building(&[(0.0, 0.0, 0.0, ""), (0.0, flat_m, rise_m, "")], &[(0, 1)]).viewpoints[0].climbs
    };
    assert_eq!(climbs(0.6, 2.0), [true, false]);
    assert_eq!(climbs(-0.6, 2.0), [false, true]);
    assert_eq!([climbs(0.4, 2.0), climbs(-0.4, 2.0), climbs(0.0, 2.0)], [[false; 2]; 3]);
    assert_eq!(climbs(0.5, 2.0), [false; 2], "a slope of a quarter is none yet");
    // Two viewpoints at one place count as 0.3 m apart.
    assert_eq!([climbs(0.07, 0.0), climbs(0.08, 0.0)], [[false; 2], [true, false]]);
}

#[test]
fn find_nearness_is_computed_anew_after_a_change() {
    let mut building = make_corridor(&["attic", "attic"]);
    let query = PlaceQuery { is_room: false, name: "sofa".to_owned() };
    assert!(!building.find_nearness(&query).exists);
    add_thing(&mut building, "sofa", [0.0, 0.0, 1.0], &[0]);
    assert!(!building.find_nearness(&query).exists, "it is remembered");
    building.viewpoints[1].position.z += 2.0;
    building.forget_nearness();
    assert!(building.find_nearness(&query).exists);
    assert_eq!(building.viewpoints[0].climbs, [true, false]);
}

#[test]
fn distinguishing_name_prefers_the_room_and_then_the_most_striking_thing() {
    let mut building = make_corridor(&["attic", "kitchen", "attic", ""]);
    add_thing(&mut building, "lamp", [0.0, 0.0, 1.0], &[0]);
    add_thing(&mut building, "piano", [0.0, 0.0, 1.0], &[0, 1]);
    add_thing(&mut building, "sofa", [0.0, 0.0, 1.0], &[0, 2]);
    assert_eq!(building.distinguishing_name(0, &[1], &[]), Some("attic"));
    assert_eq!(building.distinguishing_name(0, &[], &[]), Some("attic"));
    assert_eq!(building.distinguishing_name(0, &[1, 2], &[]), Some("lamp"));
    assert_eq!(building.distinguishing_name(0, &[2], &[]), Some("piano"), "one notices a piano before a lamp");
    assert_eq!(building.distinguishing_name(2, &[0], &[]), None);
    assert_eq!(building.distinguishing_name(3, &[0], &[]), None);
    // A thing beside itself tells nothing.
    assert_eq!(building.distinguishing_name(0, &[2], &["piano"]), Some("lamp"));
    assert_eq!(building.distinguishing_name(0, &[2], &["table lamp", "grand piano"]), None);
    assert_eq!(building.distinguishing_name(0, &[1], &["attic"]), Some("sofa"));
}

#[test]
fn distance_m_is_measured_in_space() {
    let building = make_building(&[(0.0, 0.0, 0.0, ""), (2.0, 3.0, 6.0, "")], &[(0, 1)]);
    assert!(near(building.distance_m(0, 1), 7.0) && near(building.distance_m(1, 0), 7.0));
    assert!(near(building.distance_m(1, 1), 0.0));
}

#[test]
fn commonness_of_room_is_the_share_of_viewpoints_in_such_rooms() {
    let mut rooms = vec!["hallway"; 21];
    rooms[20] = "attic";
    // 1 of 21 is less than 5 %.
    assert_eq!(make_corridor(&rooms).commonness_of_room(20), 0);
    rooms.pop();
    rooms[0] = "attic";
    assert_eq!(make_corridor(&rooms).commonness_of_room(0), 1, "1 of 20");
    rooms[1] = "attic";
    assert_eq!(make_corridor(&rooms).commonness_of_room(0), 1, "2 of 20");
    rooms[2] = "attic";
    assert_eq!(make_corridor(&rooms).commonness_of_room(0), 2, "3 of 20");
}

#[test]
fn turns_from_are_relative_to_the_walker_and_leave_out_the_same_place() {
    let places =
        [(0.0, 0.0, 0.0, ""), (2.0, 0.0, 0.0, ""), (0.0, -2.0, 0.0, ""), (0.2, 0.0, 0.0, ""), (0.0, 0.0, 3.0, "")];
    let building = make_building(&places, &[(0, 1), (0, 2), (0, 3), (0, 4)]);
    let turns = building.turns_from(0, 0.5);
    assert_eq!(turns.len(), 2);
    assert!(near(turns[0], FRAC_PI_2 - 0.5) && near(turns[1], PI - 0.5));
    assert!(building.turns_from(4, 0.5).is_empty(), "straight down has no direction");
}

#[test]
fn offset_bearing_is_clockwise_from_north() {
    let bearing = |x: f64, y: f64| offset_bearing(DVec3::new(x, y, 5.0));
    assert!(near(bearing(0.0, 2.0).unwrap(), 0.0) && near(bearing(2.0, 0.0).unwrap(), FRAC_PI_2));
    assert!(near(bearing(-2.0, 0.0).unwrap(), -FRAC_PI_2) && near(bearing(0.0, -2.0).unwrap(), PI));
    assert_eq!(bearing(0.0, 0.0), None);
    assert_eq!(bearing(0.0, 1e-6), None);
}

#[test]
fn wrap_angle_lies_between_half_turns() {
    for (rad, wrapped) in [(0.5, 0.5), (-0.5, -0.5), (PI, PI), (-PI, PI), (4.0, 4.0 - 2.0 * PI), (7.0, 7.0 - 2.0 * PI)]
    {
        assert!(near(wrap_angle(rad), wrapped), "{rad}");
    }
}
