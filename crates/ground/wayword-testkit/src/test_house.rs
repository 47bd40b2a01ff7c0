//! The floor plan of the made-up building: rooms, viewpoints, edges and objects. Coordinates are metres; x points east, y north,
//! z up. All other files of this crate derive from these tables.

use glam::DVec3;

/// The name of the building as a Matterport3D scan.
pub const SCAN: &str = "madeUpHouse";

/// Height of the camera above the floor, metres.
pub(crate) const CAMERA_HEIGHT_M: f64 = 1.5;
/// Height of the upper storey's floor above the lower one's, metres.
const UPPER_FLOOR_M: f64 = 2.9;

/// A room: a box on one storey.
pub(crate) struct TestHouseRoom {
    /// Matterport3D's letter for the kind of room, as `k` for a kitchen.
    pub(crate) letter: char,
    /// The storey: 0 is the lower one, 1 the upper.
    pub(crate) level: usize,
    /// The coordinates of its west, south, east and north walls.
    pub(crate) sides_m: [f64; 4],
}

/// A viewpoint.
pub(crate) struct TestHouseViewpoint {
    /// The index of its room in [`ROOMS`].
    pub(crate) room: usize,
    x_m: f64,
    y_m: f64,
    /// The height of the ground under it; on the stairs, of the step.
    floor_m: f64,
}

/// An object: a box along the axes.
pub(crate) struct TestHouseObject {
    /// Its name as an annotator writes it: `#` is a space.
    pub(crate) name: &'static str,
    /// The index of its room in [`ROOMS`].
    pub(crate) room: usize,
    /// Its centre; z is counted from the floor of its storey.
    at_m: [f64; 3],
    /// Half of its size along the axes.
    pub(crate) half_m: [f64; 3],
}

const fn make_room(letter: char, level: usize, sides_m: [f64; 4]) -> TestHouseRoom {
    TestHouseRoom { letter, level, sides_m }
}

const fn make_viewpoint(room: usize, x_m: f64, y_m: f64, floor_m: f64) -> TestHouseViewpoint {
    TestHouseViewpoint { room, x_m, y_m, floor_m }
}

const fn make_object(room: usize, name: &'static str, at_m: [f64; 3], half_m: [f64; 3]) -> TestHouseObject {
    TestHouseObject { name, room, at_m, half_m }
}

/// All rooms. Their indices are their numbers in the files.
pub(crate) const ROOMS: &[TestHouseRoom] = &[
    make_room('e', 0, [0.0, 0.0, 4.0, 3.0]),
    make_room('h', 0, [4.0, 0.0, 8.0, 3.0]),
    make_room('l', 0, [0.0, 3.0, 6.0, 9.0]),
    make_room('k', 0, [6.0, 3.0, 11.0, 9.0]),
    make_room('s', 0, [8.0, 0.0, 11.0, 3.0]),
    make_room('h', 1, [4.0, 0.0, 11.0, 3.0]),
    make_room('b', 1, [0.0, 3.0, 6.0, 9.0]),
    make_room('a', 1, [6.0, 3.0, 11.0, 9.0]),
    make_room('o', 1, [0.0, 0.0, 4.0, 3.0]),
];

/// All viewpoints, by index. Numbers 6 and 7 are on the stairs.
pub(crate) const VIEWPOINTS: &[TestHouseViewpoint] = &[
    make_viewpoint(0, 2.0, 1.5, 0.0),
    make_viewpoint(1, 6.0, 1.5, 0.0),
    make_viewpoint(2, 2.0, 4.5, 0.0),
    make_viewpoint(2, 3.0, 7.5, 0.0),
    make_viewpoint(3, 8.0, 4.5, 0.0),
    make_viewpoint(3, 8.5, 7.5, 0.0),
    make_viewpoint(4, 8.6, 1.5, 0.3),
    make_viewpoint(4, 10.2, 1.5, 1.4),
    make_viewpoint(5, 8.5, 1.5, UPPER_FLOOR_M),
    make_viewpoint(5, 5.5, 1.5, UPPER_FLOOR_M),
    make_viewpoint(6, 3.5, 4.5, UPPER_FLOOR_M),
    make_viewpoint(6, 3.0, 7.5, UPPER_FLOOR_M),
    make_viewpoint(7, 8.5, 5.0, UPPER_FLOOR_M),
    make_viewpoint(8, 2.0, 1.5, UPPER_FLOOR_M),
];

/// Pairs of viewpoints between which one can walk straight.
const EDGES: &[(usize, usize)] = &[
    (0, 1),
    (0, 2),
    (1, 2),
    (2, 3),
    (1, 4),
    (4, 5),
    (1, 6),
    (6, 7),
    (7, 8),
    (8, 9),
    (9, 10),
    (10, 11),
    (8, 12),
    (9, 13),
];

/// All objects. Their indices are their numbers in the files.
pub(crate) const OBJECTS: &[TestHouseObject] = &[
    make_object(0, "coat#rack", [0.6, 0.8, 0.9], [0.2, 0.2, 0.9]),
    make_object(0, "bench", [3.2, 0.4, 0.25], [0.5, 0.2, 0.25]),
    make_object(0, "umbrella#stand", [1.0, 2.6, 0.3], [0.15, 0.15, 0.3]),
    make_object(0, "mirror", [2.6, 2.9, 1.5], [0.3, 0.05, 0.4]),
    make_object(1, "picture", [5.5, 2.9, 1.6], [0.3, 0.03, 0.25]),
    make_object(1, "picture", [6.6, 2.9, 1.6], [0.3, 0.03, 0.25]),
    make_object(1, "console#table", [5.8, 0.3, 0.45], [0.5, 0.2, 0.45]),
    make_object(2, "couch", [1.2, 5.9, 0.4], [0.9, 0.4, 0.4]),
    make_object(2, "coffee#table", [2.6, 6.3, 0.25], [0.5, 0.3, 0.25]),
    make_object(2, "lamp", [0.7, 4.0, 0.9], [0.15, 0.15, 0.5]),
    make_object(2, "lamp", [4.6, 8.3, 0.9], [0.15, 0.15, 0.5]),
    make_object(2, "cushion", [1.0, 5.5, 0.7], [0.2, 0.15, 0.2]),
    make_object(2, "cushion", [1.5, 5.9, 0.7], [0.2, 0.15, 0.2]),
    make_object(2, "tv", [3.0, 8.9, 1.1], [0.6, 0.05, 0.35]),
    make_object(2, "plant", [4.5, 6.6, 0.6], [0.25, 0.25, 0.6]),
    make_object(3, "refrigerator", [10.2, 8.4, 0.9], [0.35, 0.35, 0.9]),
    make_object(3, "sink", [9.3, 3.6, 0.9], [0.3, 0.25, 0.15]),
    make_object(3, "stove", [7.0, 8.6, 0.5], [0.3, 0.3, 0.5]),
    make_object(3, "dining#table", [8.3, 6.2, 0.4], [0.7, 0.5, 0.4]),
    make_object(3, "chair", [7.5, 6.2, 0.45], [0.22, 0.22, 0.45]),
    make_object(3, "chair", [9.1, 6.2, 0.45], [0.22, 0.22, 0.45]),
    make_object(3, "microwave", [6.5, 4.2, 1.2], [0.25, 0.2, 0.15]),
    make_object(4, "picture", [10.0, 2.9, 2.2], [0.3, 0.03, 0.25]),
    make_object(5, "plant", [5.0, 0.5, 0.5], [0.25, 0.25, 0.5]),
    make_object(5, "picture", [5.8, 2.9, 1.6], [0.3, 0.03, 0.25]),
    make_object(5, "vase", [8.0, 0.4, 0.9], [0.12, 0.12, 0.2]),
    make_object(6, "bed", [2.4, 5.6, 0.35], [1.0, 0.8, 0.35]),
    make_object(6, "pillow", [2.0, 5.3, 0.75], [0.3, 0.2, 0.1]),
    make_object(6, "pillow", [2.2, 5.9, 0.75], [0.3, 0.2, 0.1]),
    make_object(6, "nightstand", [1.8, 6.9, 0.3], [0.25, 0.2, 0.3]),
    make_object(6, "nightstand", [2.2, 8.6, 0.3], [0.25, 0.2, 0.3]),
    make_object(6, "dresser", [4.7, 7.8, 0.5], [0.25, 0.6, 0.5]),
    make_object(6, "window", [3.0, 8.95, 1.4], [0.7, 0.05, 0.6]),
    make_object(7, "toilet", [7.2, 4.0, 0.4], [0.2, 0.3, 0.4]),
    make_object(7, "mirror", [10.2, 5.0, 1.5], [0.05, 0.5, 0.4]),
    make_object(7, "towel", [8.0, 6.6, 1.3], [0.25, 0.05, 0.3]),
    make_object(7, "towel", [9.0, 6.6, 1.3], [0.25, 0.05, 0.3]),
    make_object(7, "sink", [9.6, 4.2, 0.9], [0.25, 0.25, 0.15]),
    make_object(8, "desk", [1.0, 2.4, 0.4], [0.6, 0.35, 0.4]),
    make_object(8, "office#chair", [1.4, 1.6, 0.5], [0.3, 0.3, 0.5]),
    make_object(8, "printer", [3.2, 2.5, 0.9], [0.2, 0.2, 0.15]),
    make_object(8, "bookshelf", [3.3, 0.5, 1.0], [0.5, 0.15, 1.0]),
];

/// The name of a viewpoint: 32 hexadecimal digits, as in Matterport3D. The index after the last is the viewpoint that
/// is not included.
#[must_use]
pub fn viewpoint_id(index: usize) -> String {
    let mixed = (index as u128 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835);
    format!("{mixed:032x}")
}

/// Where the camera of a viewpoint is.
pub(crate) fn camera_position(viewpoint: &TestHouseViewpoint) -> DVec3 {
    DVec3::new(viewpoint.x_m, viewpoint.y_m, viewpoint.floor_m + CAMERA_HEIGHT_M)
}

/// Height of a storey's floor, metres.
pub(crate) fn floor_m(level: usize) -> f64 {
    if level == 0 { 0.0 } else { UPPER_FLOOR_M }
}

/// The centre of an object.
pub(crate) fn object_centre(object: &TestHouseObject) -> DVec3 {
    DVec3::from_array(object.at_m) + DVec3::Z * floor_m(ROOMS[object.room].level)
}

/// Whether one can walk straight between two viewpoints.
pub(crate) fn are_joined(a: usize, b: usize) -> bool {
    EDGES.contains(&(a, b)) || EDGES.contains(&(b, a))
}
