use super::*;
use crate::{
    building::KnownBuilding,
    made_buildings::{add_thing, make_building, make_corridor},
};

fn query(is_room: bool, name: &str) -> PlaceQuery {
    PlaceQuery { is_room, name: name.to_owned() }
}

/// Viewpoints to the east, at the given distances from the origin.
fn row(far_m: &[f64]) -> KnownBuilding {
    let places: Vec<_> = far_m.iter().map(|east| (*east, 0.0, 1.5, "attic")).collect();
    make_building(&places, &[])
}

#[test]
fn find_nearness_classes_the_distance_of_a_thing() {
    let mut building = row(&[1.2, 1.4, 12.0, 1.2, 2.9, 3.1, 4.9, 5.1, 7.9, 8.1]);
    add_thing(&mut building, "sofa", [0.0, 0.0, 1.0], &[0, 1, 2]);
    add_thing(&mut building, "bathtub", [3.0, 0.0, 1.0], &[4]);
    let near = building.find_nearness(&query(false, "sofa"));
    assert_eq!(near.class, [0, 1, 1, 2, 2, 3, 3, 4, 4, FAR_CLASS]);
    assert!(near.exists && near.nearest.iter().all(|at| *at == Some(DVec3::new(0.0, 0.0, 1.0))));
    let none = building.find_nearness(&query(false, "piano"));
    assert!(!none.exists && none.class == [FAR_CLASS; 10] && none.nearest.iter().all(Option::is_none));
    assert!(!building.find_nearness(&query(true, "sofa")).exists, "it is no room");
}

#[test]
fn find_nearness_takes_the_nearest_of_several_things() {
    let mut building = row(&[0.0, 10.0]);
    add_thing(&mut building, "sofa", [9.0, 0.0, 1.0], &[]);
    add_thing(&mut building, "couch", [1.0, 0.0, 1.0], &[]);
    let near = building.find_nearness(&query(false, "sofa"));
    assert_eq!(near.class, [2, 2]);
    assert_eq!(near.nearest.iter().flatten().map(|at| at.x).collect::<Vec<_>>(), [1.0, 9.0]);
}

#[test]
fn find_nearness_adds_6_m_for_a_thing_on_another_storey() {
    let class = |up: f64, seen: &[usize]| {
        let mut building = row(&[1.2]);
        add_thing(&mut building, "sofa", [0.0, 0.0, up], seen);
        building.find_nearness(&query(false, "sofa")).class[0]
    };
    // The eye is at 1.5 m: from 2.2 m below it to 1 m above it is the same storey.
    assert_eq!([-0.8, -0.6, 2.4, 2.6].map(|up| class(up, &[])), [4, 2, 2, 4]);
    assert_eq!([-0.8, 2.6].map(|up| class(up, &[0])), [0, 0], "it is seen");
}

#[test]
fn find_nearness_classes_the_distance_of_a_room() {
    let places = [
        (0.0, 0.0, 1.5, "kitchen"),
        (2.1, 0.0, 1.5, "attic"),
        (2.3, 0.0, 1.5, "attic"),
        (3.9, 0.0, 1.5, "attic"),
        (4.1, 0.0, 1.5, ""),
        (6.9, 0.0, 1.5, "attic"),
        (7.1, 0.0, 1.5, "attic"),
        (0.0, 0.0, 3.1, "attic"),
        (0.0, 0.0, 2.9, "attic"),
        (0.0, 0.0, -0.1, "attic"),
        (0.0, 0.0, 0.1, "attic"),
        (50.0, 0.0, 1.5, "dining room"),
    ];
    let building = make_building(&places, &[]);
    let near = building.find_nearness(&query(true, "kitchen"));
    // People take a dining room for a kitchen, so it counts as one, but not as well. 6 m more on another storey.
    assert_eq!(near.class, [0, 2, 3, 3, 4, 4, 5, 4, 2, 4, 2, 1]);
    assert_eq!(near.nearest[1], Some(DVec3::new(0.0, 0.0, 1.5)));
    assert!(near.exists);
    assert!(!building.find_nearness(&query(true, "garage")).exists);
}

#[test]
fn find_nearness_finds_stairs_where_a_way_climbs() {
    let mut building = make_corridor(&["attic", "attic", "stairs"]);
    building.viewpoints[0].climbs = [false, true];
    let near = building.find_nearness(&query(true, "stairs"));
    assert_eq!(near.class, [0, 2, 0]);
    let attic = building.find_nearness(&query(true, "bathroom"));
    assert_eq!((&attic.class, attic.exists), (&vec![FAR_CLASS; 3], false), "a climb is no bathroom");
    let flat = make_corridor(&["attic", "attic"]);
    let near = flat.find_nearness(&query(true, "stairs"));
    assert!(near.exists, "any building may have stairs");
    assert_eq!(near.class, [FAR_CLASS; 2]);
}

#[test]
fn find_nearness_does_not_know_distances_where_the_walker_was_not() {
    let mut building = row(&[1.2, 2.5, 4.0, 9.0]);
    add_thing(&mut building, "sofa", [0.0, 0.0, 1.0], &[0]);
    for at in [0, 1, 2] {
        building.viewpoints[at].is_known = false;
    }
    let near = building.find_nearness(&query(false, "sofa"));
    assert_eq!(near.class, [0, 2, UNKNOWN_CLASS, FAR_CLASS]);
    let mut rooms = make_corridor(&["kitchen", "dining room", "attic", "attic"]);
    rooms.viewpoints.iter_mut().skip(1).take(2).for_each(|at| at.is_known = false);
    let near = rooms.find_nearness(&query(true, "kitchen"));
    assert_eq!(near.class, [0, UNKNOWN_CLASS, UNKNOWN_CLASS, 4]);
}

#[test]
fn find_nearness_counts_how_many_known_viewpoints_are_near() {
    let commonness = |near: usize, far: usize, unknown: usize| {
        let mut building = row(&[vec![2.0; near], vec![20.0; far], vec![20.0; unknown]].concat());
        add_thing(&mut building, "sofa", [0.0, 0.0, 1.0], &[]);
        building.viewpoints.iter_mut().skip(near + far).for_each(|at| at.is_known = false);
        building.find_nearness(&query(false, "sofa")).commonness
    };
    assert_eq!([commonness(2, 24, 0), commonness(2, 23, 0), commonness(2, 7, 0), commonness(2, 6, 0)], [0, 1, 1, 2]);
    assert_eq!(commonness(2, 6, 20), 2, "unknown viewpoints do not count");
    assert_eq!(commonness(0, 5, 0), 0);
}
