use super::super::{
    generate_house,
    model::{DoorLeaf, House, RoomKind},
};
use super::*;
use proptest::prelude::*;

/// The place of some walkable cell in a room.
fn a_place_in(house: &House, ground: &HouseGround, room: usize) -> Option<DVec3> {
    let outline = house.rooms[room].outline;
    let base_m = f64::from(house.rooms[room].base_cm()) / 100.0;
    let within = |place: &DVec3| outline.holds_m(place.x, place.y) && (place.z - base_m).abs() < 0.1;
    ground.free_cells().map(|cell| ground.middle_of_cell(cell)).find(within)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    #[test]
    fn every_room_can_be_walked_to(seed: u64) {
        let house = generate_house(seed);
        let ground = HouseGround::for_house(&house);
        let places: Vec<_> = (0..house.rooms.len()).map(|room| a_place_in(&house, &ground, room)).collect();
        for (room, place) in places.iter().enumerate() {
            prop_assert!(place.is_some(), "no walkable cell in {:?}", house.rooms[room]);
            let way = ground.shortest_route(places[0].unwrap(), place.unwrap());
            prop_assert!(way.is_ok(), "{:?}: {way:?}", house.rooms[room]);
        }
    }

    #[test]
    fn ways_are_walkable_and_no_shorter_than_straight(seed: u64, a in 0usize..8, b in 0usize..8) {
        let house = generate_house(seed);
        let ground = HouseGround::for_house(&house);
        let count = house.rooms.len();
        let (from, to) = (a_place_in(&house, &ground, a % count).unwrap(), a_place_in(&house, &ground, b % count).unwrap());
        let way = ground.shortest_route(from, to).unwrap();
        let back = ground.shortest_route(to, from).unwrap();
        prop_assert!(way.length_m + 1e-6 >= from.distance(to));
        prop_assert!((way.length_m - back.length_m).abs() <= 0.05 * way.length_m + 0.2, "{} {}", way.length_m, back.length_m);
        for pair in way.places.windows(2) {
            prop_assert!(pair[0].distance(pair[1]) < 0.08, "a jump in {pair:?}");
            prop_assert!(ground.is_walkable(pair[1]));
        }
    }
}

/// Two empty rooms of 4 x 4 m side by side, with a doorway of one metre at the northern end of the wall between.
fn two_rooms() -> House {
    let mut house = generate_house(1);
    house.storeys = 1;
    house.stairs = None;
    house.furniture.clear();
    house.windows.clear();
    house.rooms.truncate(2);
    (house.rooms[0].outline, house.rooms[1].outline) = (RectCm::new(0, 0, 400, 400), RectCm::new(400, 0, 800, 400));
    (house.rooms[0].floor, house.rooms[1].floor) = (0, 0);
    house.rooms[0].kind = RoomKind::Bedroom;
    house.openings.truncate(1);
    let opening = &mut house.openings[0];
    (opening.room, opening.beyond, opening.base_cm, opening.leaf) = (0, Some(1), 0, DoorLeaf::None);
    opening.span = super::super::rect::SpanCm { along_x: false, at: 400, from: 280, to: 380 };
    house
}

#[test]
fn the_way_round_a_wall_is_taut() {
    let ground = HouseGround::for_house(&two_rooms());
    let (from, to) = (DVec3::new(3.0, 1.0, 0.0), DVec3::new(5.0, 1.0, 0.0));
    let way = ground.shortest_route(from, to).unwrap();
    // The way passes the passage's two southern corners, at y = 3.00 and x = 3.74 and 4.26.
    let exact_m = 2.0 * (0.74_f64 * 0.74 + 4.0).sqrt() + 0.52;
    assert!(way.length_m >= exact_m - 0.05 && way.length_m < exact_m * 1.03, "{} against {exact_m}", way.length_m);
    assert!(matches!(ground.shortest_route(from, DVec3::new(4.0, 1.0, 0.0)), Err(GroundRouteError::NotWalkable(_))));
}

#[test]
fn ground_leaves_out_floor_that_cannot_be_reached() {
    let mut house = two_rooms();
    house.openings.clear();
    house.rooms[1].outline.x1 = 600;
    let ground = HouseGround::for_house(&house);
    assert!(ground.is_walkable(DVec3::new(3.0, 1.0, 0.0)));
    assert!(!ground.is_walkable(DVec3::new(5.0, 1.0, 0.0)));
}

#[test]
fn the_way_up_climbs_a_storey_without_a_step() {
    let house = (0..20).map(generate_house).find(|house| house.storeys == 2).unwrap();
    let ground = HouseGround::for_house(&house);
    let upstairs = house.rooms.iter().position(|room| room.floor == 1).unwrap();
    let (from, to) = (a_place_in(&house, &ground, 0).unwrap(), a_place_in(&house, &ground, upstairs).unwrap());
    let way = ground.shortest_route(from, to).unwrap();
    assert!((way.places.last().unwrap().z - 3.0).abs() < 0.05 && way.places[0].z.abs() < 0.05);
    assert!(way.places.windows(2).all(|pair| (pair[1].z - pair[0].z).abs() < 0.06));
}

/// Two blocked cells that touch at a corner leave no gap between them.
#[test]
fn no_way_leads_between_two_things_that_touch_at_a_corner() {
    let house = generate_house(1_451_638_221_406_018_528);
    let ground = HouseGround::for_house(&house);
    let [from, to] = [0, 2].map(|room| a_place_in(&house, &ground, room).unwrap());
    let [way, back] = [(from, to), (to, from)].map(|(from, to)| ground.shortest_route(from, to).unwrap().length_m);
    assert!((way - back).abs() < 0.2, "{way} {back}");
}
