//! The office: a desk with a computer, books and files.

use super::super::{catalogue::FurnitureKind as K, rect::WallSide};
use super::{
    bedroom,
    placing::{RoomFurnisher, WallPreference},
};

pub(super) fn furnish_office(room: &mut RoomFurnisher<'_>) {
    bedroom::add_desk(room);
    let walls = room.shuffled_walls();
    let walls = room.walls_without_windows(&walls);
    for _ in 0..2 {
        if let Some(shelf) = room.stand_at_walls(K::Bookshelf, &walls, WallPreference::Ends, 50) {
            room.apply_finish(shelf);
        }
    }
    if let Some(cabinet) = room.stand_anywhere(K::FilingCabinet, WallPreference::Ends, 45) {
        room.place_on_top(cabinet, K::Globe, 0, 0);
    }
    if room.dice.chance(60) {
        room.stand_anywhere(K::Armchair, WallPreference::Ends, 30);
    }
    let size = K::Rug.size_cm(&mut room.dice);
    let centre = room.inner.centre();
    room.lay_flat(K::Rug, centre, [size[0] - 60, size[1] - 40, size[2]], WallSide::North);
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    room.hang_anywhere(K::Whiteboard, 110);
    room.hang_curtains();
}
