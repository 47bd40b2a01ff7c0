//! The small rooms: hallway, laundry, entryway, closet, garage.

use super::super::{
    catalogue::FurnitureKind as K,
    rect::{RectCm, WallSide},
};
use super::placing::{RoomFurnisher, WallPreference};

pub(super) fn furnish_hallway(room: &mut RoomFurnisher<'_>) {
    let inner = room.inner;
    let (width, depth) = (inner.width(), inner.depth());
    let runner = if width > depth { [width - 160, 70, 1] } else { [depth - 160, 70, 1] };
    let wall = if width > depth { WallSide::North } else { WallSide::West };
    if room.dice.chance(60) {
        room.lay_flat(K::Rug, inner.centre(), runner, wall);
    }
    if room.dice.chance(70) {
        let walls = room.shuffled_walls();
        if let Some(table) = room.stand_sized(K::ConsoleTable, [90, 26, 80], &walls, WallPreference::Middle, 60) {
            room.apply_finish(table);
            room.place_on_top(table, K::Vase, 0, 0);
            room.hang_over(table, K::Mirror, 20);
        }
    }
    for _ in 0..2 {
        if let Some(shelf) = room.stand_sized(K::Bookshelf, [90, 26, 200], &WallSide::ALL, WallPreference::Anywhere, 90)
        {
            room.apply_finish(shelf);
        }
    }
    if room.dice.chance(40) {
        room.stand_anywhere(K::GrandfatherClock, WallPreference::Anywhere, 80);
    }
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
}

pub(super) fn furnish_laundry(room: &mut RoomFurnisher<'_>) {
    let walls = room.quiet_walls();
    if let Some(washer) = room.stand_at_walls(K::Washer, &walls, WallPreference::Ends, 60) {
        if room.place_beside(washer, K::Dryer, 2).is_none() && room.place_beside(washer, K::Dryer, -2).is_none() {
            room.stand_at_walls(K::Dryer, &walls, WallPreference::Ends, 50);
        }
        room.hang_over(washer, K::Shelf, 50);
    }
    room.stand_anywhere(K::LaundryBasket, WallPreference::Ends, 0);
    room.stand_anywhere(K::IroningBoard, WallPreference::Anywhere, 30);
    room.hang_anywhere(K::Shelf, 150);
}

pub(super) fn furnish_entryway(room: &mut RoomFurnisher<'_>) {
    room.hang_anywhere(K::CoatHooks, 62);
    if let Some(rack) = room.stand_anywhere(K::ShoeRack, WallPreference::Middle, 50) {
        room.apply_finish(rack);
        room.hang_over(rack, K::Mirror, 50);
    }
    if let Some(bench) = room.stand_anywhere(K::Bench, WallPreference::Middle, 50) {
        room.apply_finish(bench);
    }
    if let Some((wall, place)) = room.front_doorstep() {
        let mat = K::DoorMat.size_cm(&mut room.dice);
        room.lay_flat(K::DoorMat, place, mat, wall);
    }
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
}

pub(super) fn furnish_closet(room: &mut RoomFurnisher<'_>) {
    let walls = room.quiet_walls();
    room.stand_at_walls(K::ClothesRack, &walls, WallPreference::Ends, 40);
    room.stand_at_walls(K::ClothesRack, &walls, WallPreference::Ends, 40);
    if let Some(rack) = room.stand_at_walls(K::ShoeRack, &walls, WallPreference::Ends, 40) {
        room.apply_finish(rack);
    }
    room.stand_at_walls(K::Boxes, &walls, WallPreference::Ends, 0);
    room.hang_anywhere(K::Shelf, 180);
}

pub(super) fn furnish_garage(room: &mut RoomFurnisher<'_>) {
    let (x, y) = room.inner.centre();
    let deep = room.inner.depth() >= room.inner.width();
    let wall = if deep { WallSide::North } else { WallSide::West };
    for shift in [0, -30, 30, -60, 60, -80, 80] {
        let (x, y) = if deep { (x + shift, y) } else { (x, y + shift) };
        let (w, d) = if deep { (178, 400) } else { (400, 178) };
        let footprint = RectCm::new(x - w / 2, y - d / 2, x + w / 2, y + d / 2);
        if room.place_at_if_free(K::Car, footprint, wall, true).is_some() {
            break;
        }
    }
    room.stand_anywhere(K::Workbench, WallPreference::Middle, 50);
    room.stand_anywhere(K::MetalShelf, WallPreference::Ends, 40);
    room.stand_anywhere(K::Bicycle, WallPreference::Anywhere, 20);
    room.stand_anywhere(K::Boxes, WallPreference::Ends, 0);
}
