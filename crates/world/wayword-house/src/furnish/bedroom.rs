//! The bedroom: a bed between nightstands, and somewhere to keep clothes.

use super::super::{catalogue::FurnitureKind as K, rect::RectCm};
use super::placing::{RoomFurnisher, WallPreference};

pub(super) fn furnish_bedroom(room: &mut RoomFurnisher<'_>) {
    let walls = room.quiet_walls();
    let width = if room.inner.width().min(room.inner.depth()) > 300 { room.dice.pick([160, 160, 180]) } else { 120 };
    let bed = room.stand_sized(K::Bed, [width, 206, 100], &walls, WallPreference::Middle, 50);
    let bed = bed.or_else(|| room.stand_sized(K::Bed, [100, 206, 96], &walls, WallPreference::Ends, 30));
    if let Some(bed) = bed {
        for gap in [4, -4] {
            if let Some(stand) = room.place_beside(bed, K::Nightstand, gap) {
                room.apply_finish(stand);
                room.place_on_top(stand, K::TableLamp, 0, 0);
            }
        }
        room.hang_over(bed, K::Painting, 40);
        let before = room.floor_in_front(room.piece_at(bed).footprint, room.wall_behind(bed), 60);
        let size = K::Rug.size_cm(&mut room.dice);
        room.lay_flat(K::Rug, before.centre(), size, room.wall_behind(bed));
    }
    if let Some(wardrobe) = room.stand_anywhere(K::Wardrobe, WallPreference::Ends, 60) {
        room.apply_finish(wardrobe);
    }
    if let Some(dresser) = room.stand_anywhere(K::Dresser, WallPreference::Middle, 60) {
        room.apply_finish(dresser);
        room.hang_over(dresser, K::Mirror, 12);
    }
    if room.dice.chance(60) {
        add_desk(room);
    }
    if room.dice.chance(50) {
        room.stand_anywhere(K::Armchair, WallPreference::Ends, 30);
    }
    if room.dice.chance(50) {
        room.stand_anywhere(K::Bookshelf, WallPreference::Ends, 50);
    }
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    room.hang_curtains();
}

/// A desk with its chair.
pub(super) fn add_desk(room: &mut RoomFurnisher<'_>) {
    let walls = room.shuffled_walls();
    let Some(desk) = room.stand_at_walls(K::Desk, &walls, WallPreference::Middle, 70) else {
        return;
    };
    room.apply_finish(desk);
    room.place_on_top(desk, K::Computer, 0, -8);
    if room.dice.chance(70) {
        room.place_on_top(desk, K::TableLamp, 48, -10);
    }
    let (footprint, wall) = (room.piece_at(desk).footprint, room.wall_behind(desk));
    let (x, y) = room.floor_in_front(footprint, wall, 50).centre();
    let (dx, dy) = wall.inward();
    let (x, y) = (x + dx * 6, y + dy * 6);
    let area = RectCm::new(x - 30, y - 30, x + 30, y + 30);
    room.place_at_if_free(K::OfficeChair, area, wall.opposite(), true);
}
