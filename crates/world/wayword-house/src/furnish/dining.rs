//! The dining room: a table with chairs under a chandelier.

use super::super::{
    catalogue::FurnitureKind as K,
    rect::{RectCm, WallSide},
};
use super::placing::{RoomFurnisher, WallPreference};

pub(super) fn furnish_dining_room(room: &mut RoomFurnisher<'_>) {
    let (x, y) = room.inner.centre();
    let along_x = room.inner.width() >= room.inner.depth();
    room.hang_from_ceiling(K::Chandelier);
    for length in [180, 150, 120] {
        let (w, d) = if along_x { (length, 90) } else { (90, length) };
        let footprint = RectCm::new(x - w / 2, y - d / 2, x + w / 2, y + d / 2);
        let wall = if along_x { WallSide::North } else { WallSide::West };
        if let Some(table) = room.place_at_if_free(K::DiningTable, footprint, wall, false) {
            room.apply_finish(table);
            room.place_on_top(table, K::Vase, 0, 0);
            add_chairs(room, footprint, along_x, length);
            break;
        }
    }
    let walls = room.quiet_walls();
    if let Some(sideboard) = room.stand_at_walls(K::Sideboard, &walls, WallPreference::Middle, 45) {
        room.apply_finish(sideboard);
        room.place_on_top(sideboard, K::TableLamp, 45, 0);
        room.hang_over(sideboard, K::Painting, 50);
    }
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    room.stand_anywhere(K::Bookshelf, WallPreference::Ends, 50);
    if room.dice.chance(30) {
        room.stand_anywhere(K::GrandfatherClock, WallPreference::Ends, 60);
    }
    room.hang_curtains();
}

/// Chairs on the long sides, and at the heads where there is room.
fn add_chairs(room: &mut RoomFurnisher<'_>, table: RectCm, along_x: bool, length: i32) {
    let colour = K::Chair.draw_colour(&mut room.dice);
    let shifts: &[i32] = if length >= 150 { &[-42, 42] } else { &[0] };
    let (long, heads) = if along_x {
        ([WallSide::North, WallSide::South], [WallSide::West, WallSide::East])
    } else {
        ([WallSide::West, WallSide::East], [WallSide::North, WallSide::South])
    };
    let sides = long.iter().flat_map(|wall| shifts.iter().map(|shift| (*wall, *shift)));
    for (back, shift) in sides.chain(heads.map(|wall| (wall, 0))) {
        let middle = table.edge_at(back).middle();
        let (dx, dy) = back.inward();
        // Pushed under the table by a third of its depth.
        let (x, y) = (middle.0 - dx * 10, middle.1 - dy * 10);
        let (x, y) = if back.along_x() { (x + shift, y) } else { (x, y + shift) };
        let (w, d) = if back.along_x() { (44, 48) } else { (48, 44) };
        let footprint = RectCm::new(x - w / 2, y - d / 2, x + w / 2, y + d / 2);
        if let Some(chair) = room.place_under_if_free(K::Chair, footprint, back, &table) {
            room.set_colour(chair, colour);
        }
    }
}
