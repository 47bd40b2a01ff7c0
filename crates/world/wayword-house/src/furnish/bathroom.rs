//! The bathroom: toilet, basin under a mirror, and bathtub or shower.

use super::super::{catalogue::FurnitureKind as K, colour::Colour};
use super::placing::{RoomFurnisher, WallPreference};

pub(super) fn furnish_bathroom(room: &mut RoomFurnisher<'_>) {
    let walls = room.quiet_walls();
    let tub_first = room.dice.chance(60);
    let tub = |room: &mut RoomFurnisher<'_>| room.stand_at_walls(K::Bathtub, &walls, WallPreference::Ends, 50);
    let shower = |room: &mut RoomFurnisher<'_>| room.stand_at_walls(K::Shower, &walls, WallPreference::Ends, 50);
    let tub_or_shower = if tub_first { tub(room).or_else(|| shower(room)) } else { shower(room).or_else(|| tub(room)) };
    let basin_walls = room.shuffled_walls();
    let basin_walls = room.walls_without_windows(&basin_walls);
    let basin = room.stand_at_walls(K::Vanity, &basin_walls, WallPreference::Middle, 60);
    let basin = basin.or_else(|| room.stand_sized(K::Vanity, [56, 44, 86], &basin_walls, WallPreference::Anywhere, 50));
    if let Some(basin) = basin {
        room.hang_over(basin, K::Mirror, 24);
    }
    room.stand_anywhere(K::Toilet, WallPreference::Ends, 50);
    for _ in 0..2 {
        room.hang_anywhere(K::Towel, 90);
    }
    // A shallow cabinet for medicine: a deep one would hide half of so small a room.
    if let Some(cabinet) = room.hang_sized(K::WallCabinet, [60, 17, 66], 134) {
        room.set_colour(cabinet, Colour::White);
    }
    if let Some(tub_or_shower) = tub_or_shower {
        let mat = K::BathMat.size_cm(&mut room.dice);
        let wall = room.wall_behind(tub_or_shower);
        let place = room.floor_in_front(room.piece_at(tub_or_shower).footprint, wall, 70).centre();
        room.lay_flat(K::BathMat, place, mat, wall);
        // A large bathroom has both a bathtub and a shower.
        if room.inner.area_m2() > 9.0 {
            let other = if room.piece_at(tub_or_shower).kind == K::Bathtub { K::Shower } else { K::Bathtub };
            room.stand_at_walls(other, &walls, WallPreference::Ends, 50);
        }
    }
    if room.inner.area_m2() > 6.0 {
        room.stand_anywhere(K::LaundryBasket, WallPreference::Ends, 0);
        room.stand_anywhere(K::Plant, WallPreference::Ends, 0);
    }
}
