//! The kitchen: a row of counters with sink and stove, a refrigerator at its end, and an island or a table.

use super::super::{
    catalogue::FurnitureKind as K,
    rect::{RectCm, WallSide},
};
use super::placing::{PieceIndex, RoomFurnisher, WallPreference};

/// The pieces of the row, from one end to the other.
const COUNTER_ROW: [K; 6] = [K::Refrigerator, K::Counter, K::Stove, K::Counter, K::KitchenSink, K::Counter];

pub(super) fn furnish_kitchen(room: &mut RoomFurnisher<'_>) {
    let mut walls = room.quiet_walls();
    // For the row, a long wall matters more than a wall without openings.
    walls.sort_by_key(|wall| -room.inner.edge_at(*wall).length() / 80);
    let row = walls.iter().find_map(|wall| place_counter_row(room, *wall));
    let on_counter = [K::Microwave, K::Toaster, K::Kettle];
    if let Some(row) = row {
        let counters: Vec<PieceIndex> =
            row.iter().copied().filter(|piece| room.piece_at(*piece).kind == K::Counter).collect();
        for (counter, kind) in counters.into_iter().zip(on_counter) {
            room.place_on_top(counter, kind, 0, -8);
        }
        for piece in row {
            finish_kitchen_piece(room, piece);
        }
    }
    add_island(room);
    for _ in 0..2 {
        add_counter(room);
    }
    add_breakfast_table(room);
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    room.hang_anywhere(K::Shelf, 140);
}

/// Another stretch of worktop with a cupboard over it.
fn add_counter(room: &mut RoomFurnisher<'_>) {
    let walls = room.shuffled_walls();
    let colour = room.taste.kitchen;
    if let Some(counter) = room.stand_sized(K::Counter, [120, 62, 91], &walls, WallPreference::Ends, 70) {
        room.set_colour(counter, colour);
        if let Some(cabinet) = room.hang_over(counter, K::WallCabinet, 54) {
            room.set_colour(cabinet, colour);
        }
    }
}

/// A small table with a chair at either end, where there is still room.
fn add_breakfast_table(room: &mut RoomFurnisher<'_>) {
    let walls = room.shuffled_walls();
    let Some(table) = room.stand_sized(K::DiningTable, [90, 70, 75], &walls, WallPreference::Anywhere, 70) else {
        return;
    };
    room.apply_finish(table);
    for gap in [2, -2] {
        room.place_beside(table, K::Chair, gap);
    }
}

/// Places the row of counters at a wall; `None` if not even a short row fits. One piece as long as the whole row is placed
/// first and taken away again, which finds the free stretch of wall.
fn place_counter_row(room: &mut RoomFurnisher<'_>, wall: WallSide) -> Option<Vec<PieceIndex>> {
    let mut kinds = COUNTER_ROW;
    if room.dice.chance(50) {
        kinds.reverse();
    }
    // Tries shorter rows where the long one does not fit: each list has the indices of the pieces that are left out.
    for skip in [&[][..], &[3][..], &[3, 5][..], &[1, 3, 5][..], &[0, 1, 3, 5][..]] {
        let kept = kinds.iter().enumerate().filter(|(at, _)| !skip.contains(at));
        let sizes: Vec<_> = kept.map(|(_, kind)| (*kind, kind.entry().size_cm)).collect();
        let length: i32 = sizes.iter().map(|(_, size)| size[0]).sum();
        let probe = [length, 70, 91];
        let Some(whole) = room.stand_sized(K::Counter, probe, &[wall], WallPreference::Ends, 90) else {
            continue;
        };
        let footprint = room.piece_at(whole).footprint;
        room.forget_last();
        let mut from = if wall.along_x() { footprint.x0 } else { footprint.y0 };
        let mut row = Vec::new();
        for (kind, size) in sizes {
            let area = room.footprint_at_wall(wall, from, size);
            row.push(room.add_piece(kind, area, 0, size[2], wall));
            from += size[0];
        }
        return Some(row);
    }
    None
}

/// Hangs the cabinet or hood above a piece, and paints all fronts in one colour.
fn finish_kitchen_piece(room: &mut RoomFurnisher<'_>, piece: PieceIndex) {
    let colour = room.taste.kitchen;
    match room.piece_at(piece).kind {
        K::Counter => {
            room.set_colour(piece, colour);
            let footprint = room.piece_at(piece).footprint;
            let wall = room.wall_behind(piece);
            let from = if wall.along_x() { footprint.x0 } else { footprint.y0 };
            if let Some(cabinet) = room.hang_at(K::WallCabinet, wall, from, 145, [60, 36, 66]) {
                room.set_colour(cabinet, colour);
            }
        }
        K::Stove => {
            room.hang_over(piece, K::RangeHood, 62);
        }
        _ => {}
    }
}

/// Places an island in or near the middle of the room, with a bowl of fruit on it and two stools in front.
fn add_island(room: &mut RoomFurnisher<'_>) {
    let (x, y) = room.inner.centre();
    let colour = room.taste.kitchen;
    for along_x in [room.inner.width() >= room.inner.depth(), room.inner.width() < room.inner.depth()] {
        let (w, d) = if along_x { (140, 76) } else { (76, 140) };
        let wall = if along_x { WallSide::North } else { WallSide::West };
        for shift in [(0, 0), (30, 0), (-30, 0), (0, 30), (0, -30), (40, 40), (-40, 40), (40, -40), (-40, -40)] {
            let (x, y) = (x + shift.0, y + shift.1);
            let footprint = RectCm::new(x - w / 2, y - d / 2, x + w / 2, y + d / 2);
            if let Some(island) = room.place_at_if_free(K::Island, footprint, wall, false) {
                room.set_colour(island, colour);
                room.place_on_top(island, K::FruitBowl, 20, 0);
                add_stools(room, footprint, wall);
                return;
            }
        }
    }
}

fn add_stools(room: &mut RoomFurnisher<'_>, island: RectCm, wall: WallSide) {
    let before = room.floor_in_front(island, wall, 44);
    let (x, y) = before.centre();
    for shift in [-38, 38] {
        let (x, y) = if wall.along_x() { (x + shift, y) } else { (x, y + shift) };
        room.place_at_if_free(K::BarStool, RectCm::new(x - 19, y - 19, x + 19, y + 19), wall.opposite(), false);
    }
}
