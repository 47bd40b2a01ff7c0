//! The small rooms: hallway, laundry, entryway, closet, garage.

use super::super::{
    catalogue::FurnitureKind as K,
    rect::{RectCm, Wall},
};
use super::placing::{Along, Furnisher};

pub(super) fn hallway(room: &mut Furnisher<'_>) {
    let inner = room.inner;
    let (width, depth) = (inner.width(), inner.depth());
    let runner = if width > depth { [width - 160, 70, 1] } else { [depth - 160, 70, 1] };
    let wall = if width > depth { Wall::North } else { Wall::West };
    if room.dice.chance(60) {
        room.lay(K::Rug, inner.centre(), runner, wall);
    }
    if room.dice.chance(70) {
        let walls = room.shuffled_walls();
        if let Some(table) = room.stand_sized(K::ConsoleTable, [90, 26, 80], &walls, Along::Middle, 60) {
            room.finish(table);
            room.on_top(table, K::Vase, 0, 0);
            room.hang_over(table, K::Mirror, 20);
        }
    }
    for _ in 0..2 {
        if let Some(shelf) = room.stand_sized(K::Bookshelf, [90, 26, 200], &Wall::ALL, Along::Anywhere, 90) {
            room.finish(shelf);
        }
    }
    if room.dice.chance(40) {
        room.stand_anywhere(K::GrandfatherClock, Along::Anywhere, 80);
    }
    room.stand_anywhere(K::Plant, Along::Ends, 0);
}

pub(super) fn laundry(room: &mut Furnisher<'_>) {
    let walls = room.quiet_walls();
    if let Some(washer) = room.stand(K::Washer, &walls, Along::Ends, 60) {
        if room.beside(washer, K::Dryer, 2).is_none() && room.beside(washer, K::Dryer, -2).is_none() {
            room.stand(K::Dryer, &walls, Along::Ends, 50);
        }
        room.hang_over(washer, K::Shelf, 50);
    }
    room.stand_anywhere(K::LaundryBasket, Along::Ends, 0);
    room.stand_anywhere(K::IroningBoard, Along::Anywhere, 30);
    room.hang(K::Shelf, 150);
}

pub(super) fn entryway(room: &mut Furnisher<'_>) {
    room.hang(K::CoatHooks, 62);
    if let Some(rack) = room.stand_anywhere(K::ShoeRack, Along::Middle, 50) {
        room.finish(rack);
        room.hang_over(rack, K::Mirror, 50);
    }
    if let Some(bench) = room.stand_anywhere(K::Bench, Along::Middle, 50) {
        room.finish(bench);
    }
    if let Some((wall, place)) = room.front_doorstep() {
        let mat = K::DoorMat.size_cm(&mut room.dice);
        room.lay(K::DoorMat, place, mat, wall);
    }
    room.stand_anywhere(K::Plant, Along::Ends, 0);
}

pub(super) fn closet(room: &mut Furnisher<'_>) {
    let walls = room.quiet_walls();
    room.stand(K::ClothesRack, &walls, Along::Ends, 40);
    room.stand(K::ClothesRack, &walls, Along::Ends, 40);
    if let Some(rack) = room.stand(K::ShoeRack, &walls, Along::Ends, 40) {
        room.finish(rack);
    }
    room.stand(K::Boxes, &walls, Along::Ends, 0);
    room.hang(K::Shelf, 180);
}

pub(super) fn garage(room: &mut Furnisher<'_>) {
    let (x, y) = room.inner.centre();
    let deep = room.inner.depth() >= room.inner.width();
    let wall = if deep { Wall::North } else { Wall::West };
    for shift in [0, -30, 30, -60, 60, -80, 80] {
        let (x, y) = if deep { (x + shift, y) } else { (x, y + shift) };
        let (w, d) = if deep { (178, 400) } else { (400, 178) };
        let footprint = RectCm::new(x - w / 2, y - d / 2, x + w / 2, y + d / 2);
        if room.try_at(K::Car, footprint, wall, true).is_some() {
            break;
        }
    }
    room.stand_anywhere(K::Workbench, Along::Middle, 50);
    room.stand_anywhere(K::MetalShelf, Along::Ends, 40);
    room.stand_anywhere(K::Bicycle, Along::Anywhere, 20);
    room.stand_anywhere(K::Boxes, Along::Ends, 0);
}
