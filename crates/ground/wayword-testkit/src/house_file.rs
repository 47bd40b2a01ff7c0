//! Writes Matterport3D's `.house` file: levels, regions, panoramas, objects and their categories, a line each. Fields that our
//! reader does not use are zero.

use crate::test_house::{self, OBJECTS, ROOMS, SCAN, VIEWPOINTS, viewpoint_id};

/// Height of a room, metres.
const ROOM_M: f64 = 2.5;
/// Five fields that our reader does not use.
const ZEROS: &str = "0 0 0 0 0";

/// The contents of the building's `.house` file.
pub(crate) fn house_file_text() -> String {
    let mut lines = vec!["ASCII 1.1".to_owned()];
    let (panoramas, objects, regions) = (VIEWPOINTS.len(), OBJECTS.len(), ROOMS.len());
    lines.push(format!(
        "H {SCAN} - 0 {panoramas} 0 0 0 {objects} {objects} {regions} 0 2 {ZEROS} 0 0 0 11 9 5.4 {ZEROS}"
    ));
    for level in 0..2 {
        let floor_m = test_house::floor_m(level);
        let rooms = ROOMS.iter().filter(|room| room.level == level).count();
        lines.push(format!("L {level} {rooms} - 5.5 4.5 {floor_m} 0 0 {floor_m} 11 9 {} {ZEROS}", floor_m + ROOM_M));
    }
    for (index, room) in ROOMS.iter().enumerate() {
        let ([west, south, east, north], floor_m) = (room.sides_m, test_house::floor_m(room.level));
        let (x, y, top_m) = ((west + east) / 2.0, (south + north) / 2.0, floor_m + ROOM_M);
        let place = format!("{x} {y} {floor_m} {west} {south} {floor_m} {east} {north} {top_m} {ROOM_M}");
        lines.push(format!("R {index} {} 0 0 {} {place} 0 0 0 0", room.level, room.letter));
    }
    for (index, viewpoint) in VIEWPOINTS.iter().enumerate() {
        let eye = test_house::camera_position(viewpoint);
        let place = format!("{} {} {}", eye.x, eye.y, eye.z);
        lines.push(format!("P {} {index} {} 0 {place} {ZEROS}", viewpoint_id(index), viewpoint.room));
    }
    for (index, object) in OBJECTS.iter().enumerate() {
        let (centre, [a, b, c]) = (test_house::object_centre(object), object.half_m);
        let place = format!("{} {} {} 1 0 0 0 1 0 {a} {b} {c}", centre.x, centre.y, centre.z);
        lines.push(format!("O {index} {} {index} {place} 0 0 0 {ZEROS}", object.room));
        lines.push(format!("C {index} {index} {} 0 misc {ZEROS}", object.name));
    }
    lines.join("\n") + "\n"
}
