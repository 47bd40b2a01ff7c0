//! The living room: a sofa that faces a television, with a table between them.

use super::super::{catalogue::FurnitureKind as K, rect::RectCm};
use super::placing::{PieceIndex, RoomFurnisher, WallPreference};

pub(super) fn furnish_living_room(room: &mut RoomFurnisher<'_>) {
    let walls = room.quiet_walls();
    let sofa = room.stand_at_walls(K::Sofa, &walls, WallPreference::Middle, 150);
    let sofa = sofa.or_else(|| room.stand_sized(K::Sofa, [180, 90, 82], &walls, WallPreference::Middle, 110));
    let sofa = sofa.or_else(|| room.stand_sized(K::Sofa, [150, 86, 82], &walls, WallPreference::Middle, 80));
    if let Some(sofa) = sofa {
        furnish_around_sofa(room, sofa);
    }
    if room.dice.chance(40) {
        let walls = room.walls_without_windows(&walls);
        if let Some(fireplace) = room.stand_at_walls(K::Fireplace, &walls, WallPreference::Middle, 60) {
            room.hang_over(fireplace, K::Painting, 18);
        }
    }
    room.stand_anywhere(K::Armchair, WallPreference::Ends, 40);
    room.stand_anywhere(K::Bookshelf, WallPreference::Ends, 50);
    room.stand_anywhere(K::Armchair, WallPreference::Anywhere, 40);
    if let Some(sideboard) = room.stand_anywhere(K::Sideboard, WallPreference::Middle, 50) {
        room.apply_finish(sideboard);
        room.place_on_top(sideboard, K::Vase, 30, 0);
        room.hang_over(sideboard, K::Painting, 50);
    }
    if room.dice.chance(35) {
        room.stand_anywhere(K::Piano, WallPreference::Middle, 60);
    }
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    room.stand_anywhere(K::FloorLamp, WallPreference::Ends, 0);
    room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    room.hang_curtains();
}

/// Places a television opposite the sofa, a rug and a coffee table in front of it, a side table beside it, and a painting
/// over it.
fn furnish_around_sofa(room: &mut RoomFurnisher<'_>, sofa: PieceIndex) {
    let wall = room.wall_behind(sofa);
    let stand = room.stand_at_walls(K::TvStand, &[wall.opposite()], WallPreference::Middle, 60);
    let stand = stand.or_else(|| room.stand_anywhere(K::TvStand, WallPreference::Middle, 60));
    if let Some(stand) = stand {
        room.place_on_top(stand, K::Television, 0, 0);
    }
    let before = room.floor_in_front(room.piece_at(sofa).footprint, wall, 150);
    let [width, depth, height] = K::Rug.size_cm(&mut room.dice);
    room.lay_flat(K::Rug, before.centre(), [width, depth, height], wall);
    let table = K::CoffeeTable.size_cm(&mut room.dice);
    let (x, y) = room.floor_in_front(room.piece_at(sofa).footprint, wall, 2 * 38 + table[1]).centre();
    let (w, d) = if wall.along_x() { (table[0], table[1]) } else { (table[1], table[0]) };
    let footprint = RectCm::new(x - w / 2, y - d / 2, x - w / 2 + w, y - d / 2 + d);
    if let Some(table) = room.place_at_if_free(K::CoffeeTable, footprint, wall, true) {
        room.apply_finish(table);
        if room.dice.chance(60) {
            room.place_on_top(table, K::Vase, 10, 0);
        }
    }
    if let Some(table) = room.place_beside(sofa, K::SideTable, 6) {
        room.apply_finish(table);
        room.place_on_top(table, K::TableLamp, 0, 0);
    }
    room.hang_over(sofa, K::Painting, 45);
}
