//! The office: a desk with a computer, books and files.

use super::super::{catalogue::FurnitureKind as K, rect::Wall};
use super::{
    bedroom,
    placing::{Along, Furnisher},
};

pub(super) fn furnish(room: &mut Furnisher<'_>) {
    bedroom::desk(room);
    let walls = room.shuffled_walls();
    let walls = room.windowless(&walls);
    for _ in 0..2 {
        if let Some(shelf) = room.stand(K::Bookshelf, &walls, Along::Ends, 50) {
            room.finish(shelf);
        }
    }
    if let Some(cabinet) = room.stand_anywhere(K::FilingCabinet, Along::Ends, 45) {
        room.on_top(cabinet, K::Globe, 0, 0);
    }
    if room.dice.chance(60) {
        room.stand_anywhere(K::Armchair, Along::Ends, 30);
    }
    let size = K::Rug.size_cm(&mut room.dice);
    let centre = room.inner.centre();
    room.lay(K::Rug, centre, [size[0] - 60, size[1] - 40, size[2]], Wall::North);
    room.stand_anywhere(K::Plant, Along::Ends, 0);
    room.hang(K::Whiteboard, 110);
    room.curtains();
}
