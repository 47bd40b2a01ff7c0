//! Tests with made-up rooms: which room an eye sees, for floors and things at given places.

mod houses;

use super::*;
use wayword_core::ObjectId;

/// A thing of a room with a level rectangle at a height: x from, x to, y from, y to.
fn thing(number: usize, raw: &str, room: u32, [x0, x1, y0, y1]: [f64; 4], height_m: f64) -> SemanticThing {
    let mut thing =
        SemanticThing { room: Some(room), ..SemanticThing::new(ObjectId::new(number.to_string()).unwrap(), raw) };
    thing.include_place(DVec3::new(x0, y0, height_m));
    thing.include_place(DVec3::new(x1, y1, height_m));
    thing
}

fn rooms(given: &[(&str, u32, [f64; 4], f64)]) -> NumberedRooms {
    let numbered = given.iter().enumerate();
    let things: Vec<SemanticThing> =
        numbered.map(|(at, (raw, room, area, z))| thing(at, raw, *room, *area, *z)).collect();
    let mut shell = Vec::new();
    for (at, (_, _, [x0, x1, y0, y1], z)) in given.iter().enumerate().filter(|(at, _)| things[*at].part.is_some()) {
        let corner = |x: f64, y: f64| DVec3::new(x, y, *z).as_vec3();
        let [a, b, c, d] = [corner(*x0, *y0), corner(*x1, *y0), corner(*x1, *y1), corner(*x0, *y1)];
        shell.extend([([a, b, c], at as u32), ([a, c, d], at as u32)]);
    }
    NumberedRooms::from_things(&things, shell)
}

fn name_seen(rooms: &NumberedRooms, x: f64, y: f64, turn_rad: f64) -> Option<&'static str> {
    rooms.room_in_view(DVec3::new(x, y, 1.5), Heading::new(turn_rad).unwrap())
}

const EAST: f64 = std::f64::consts::FRAC_PI_2;
const WEST: f64 = 3.0 * EAST;

/// A bedroom west of a bathroom, with a wall of 12 cm between them. The sill of the doorway belongs to the bedroom.
fn two_rooms() -> Vec<(&'static str, u32, [f64; 4], f64)> {
    vec![
        ("floor", 1, [0.0, 3.94, 0.0, 4.0], 0.0),
        ("floor", 1, [3.94, 4.06, 1.5, 2.5], 0.0),
        ("floor", 2, [4.06, 7.0, 0.0, 4.0], 0.0),
        ("bed", 1, [1.0, 3.0, 3.0, 4.0], 0.5),
        ("toilet#seat", 2, [6.0, 6.5, 3.0, 3.5], 0.4),
    ]
}

#[test]
fn the_floor_decides_in_which_room_an_eye_is() {
    let rooms = rooms(&two_rooms());
    assert_eq!(name_seen(&rooms, 1.0, 1.0, EAST), Some("bedroom"));
    assert_eq!(name_seen(&rooms, 6.0, 1.0, EAST), Some("bathroom"));
    // Above another storey's ceiling and far outside, the room is not known.
    assert_eq!(rooms.room_in_view(DVec3::new(1.0, 1.0, 4.5), Heading::NORTH), None);
    assert_eq!(name_seen(&rooms, 20.0, 1.0, EAST), None);
}

#[test]
fn in_an_opening_the_room_ahead_is_seen_and_never_one_behind_a_wall() {
    let rooms = rooms(&two_rooms());
    for x in [3.85, 4.0, 4.15] {
        assert_eq!(name_seen(&rooms, x, 2.0, EAST), Some("bathroom"), "{x}");
        assert_eq!(name_seen(&rooms, x, 2.0, WEST), Some("bedroom"), "{x}");
    }
    // An eye that looks along the wall sees neither.
    assert_eq!(name_seen(&rooms, 4.0, 2.0, 0.0), None);
    assert_eq!(name_seen(&rooms, 3.5, 2.0, 0.0), Some("bedroom"));
    assert_eq!(name_seen(&rooms, 3.5, 2.0, EAST), Some("bedroom"));
    assert_eq!(name_seen(&rooms, 3.85, 0.5, EAST), Some("bedroom"));
}

#[test]
fn a_hole_in_the_floor_and_a_missing_floor_are_bridged() {
    let hole = rooms(&[("floor", 1, [0.0, 1.0, 0.0, 4.0], 0.0), ("bed", 1, [0.0, 1.0, 0.0, 1.0], 0.5)]);
    assert_eq!(name_seen(&hole, 1.2, 2.0, EAST), Some("bedroom"));
    assert_eq!(name_seen(&hole, 2.2, 2.0, EAST), None);
    let roofed = rooms(&[("ceiling", 1, [0.0, 4.0, 0.0, 4.0], 2.6), ("bed", 1, [0.0, 1.0, 0.0, 1.0], 0.5)]);
    assert_eq!(name_seen(&roofed, 2.0, 2.0, EAST), Some("bedroom"));
}

#[test]
fn stairs_are_stairs_unless_their_room_has_a_name() {
    let stairs = ("stairs", 1, [0.0, 1.0, 0.0, 4.0], 0.3);
    assert_eq!(name_seen(&rooms(&[stairs]), 0.5, 2.0, EAST), Some("stairs"));
    let roof = ("ceiling", 1, [0.0, 4.0, 0.0, 4.0], 2.6);
    let within =
        [stairs, roof, ("couch", 1, [3.0, 4.0, 0.0, 1.0], 0.5), ("coffee table", 1, [3.0, 4.0, 1.5, 2.0], 0.4)];
    assert_eq!(name_seen(&rooms(&within), 0.5, 2.0, EAST), Some("living room"));
}

/// A floor of 8 x 1.3 m with three rooms north of it, to which doors lead.
fn hall(roof: &'static str, third: &'static str) -> Vec<(&'static str, u32, [f64; 4], f64)> {
    let mut all = vec![("floor", 0, [0.0, 8.0, 0.0, 1.3], 0.0), (roof, 0, [0.0, 8.0, 0.0, 1.3], 2.6)];
    all.push(("picture", 0, [1.0, 2.0, 0.0, 0.0], 1.5));
    for (number, name) in [(1, "bed"), (2, "desk"), (3, third)] {
        let x = f64::from(number) * 2.0;
        all.push(("floor", number, [x, x + 1.88, 1.42, 5.0], 0.0));
        all.push(("floor", number, [x + 0.5, x + 1.4, 1.3, 1.42], 0.0));
        all.push((name, number, [x, x + 1.0, 4.0, 5.0], 0.5));
    }
    all
}

#[test]
fn a_hallway_is_long_and_leads_to_rooms() {
    assert_eq!(name_seen(&rooms(&hall("ceiling", "toilet")), 1.0, 0.6, EAST), Some("hallway"));
    // A balcony has no ceiling, or no bathroom at its side.
    assert_eq!(name_seen(&rooms(&hall("awning", "toilet")), 1.0, 0.6, EAST), None);
    assert_eq!(name_seen(&rooms(&hall("ceiling", "chair")), 1.0, 0.6, EAST), None);
    let mut two_doors = hall("ceiling", "toilet");
    two_doors.remove(4);
    assert_eq!(name_seen(&rooms(&two_doors), 1.0, 0.6, EAST), None);
    // A thing in it suggests another room.
    let mut doubtful = hall("ceiling", "toilet");
    doubtful.push(("couch", 0, [0.0, 1.0, 0.0, 0.5], 0.5));
    assert_eq!(name_seen(&rooms(&doubtful), 1.0, 0.6, EAST), None);
    // No walls: the room goes on.
    let mut open = hall("ceiling", "toilet");
    open.push(("floor", 2, [0.0, 8.0, -2.0, 0.0], 0.0));
    assert_eq!(name_seen(&rooms(&open), 1.0, 0.6, EAST), None);
}
