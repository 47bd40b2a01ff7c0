//! The bathroom: toilet, basin under a mirror, and bathtub or shower.

use super::super::{catalogue::FurnitureKind as K, colour::Colour};
use super::placing::{Along, Furnisher};

pub(super) fn furnish(room: &mut Furnisher<'_>) {
    let walls = room.quiet_walls();
    let tub_first = room.dice.chance(60);
    let tub = |room: &mut Furnisher<'_>| room.stand(K::Bathtub, &walls, Along::Ends, 50);
    let shower = |room: &mut Furnisher<'_>| room.stand(K::Shower, &walls, Along::Ends, 50);
    let washed = if tub_first { tub(room).or_else(|| shower(room)) } else { shower(room).or_else(|| tub(room)) };
    let basin_walls = room.shuffled_walls();
    let basin_walls = room.windowless(&basin_walls);
    let basin = room.stand(K::Vanity, &basin_walls, Along::Middle, 60);
    let basin = basin.or_else(|| room.stand_sized(K::Vanity, [56, 44, 86], &basin_walls, Along::Anywhere, 50));
    if let Some(basin) = basin {
        room.hang_over(basin, K::Mirror, 24);
    }
    room.stand_anywhere(K::Toilet, Along::Ends, 50);
    for _ in 0..2 {
        room.hang(K::Towel, 90);
    }
    // A shallow one for medicine: a deep one would hide half of so small a room.
    if let Some(cabinet) = room.hang_sized(K::WallCabinet, [60, 17, 66], 134) {
        room.paint(cabinet, Colour::White);
    }
    if let Some(washed) = washed {
        let mat = K::BathMat.size_cm(&mut room.dice);
        let wall = room.wall_behind(washed);
        let place = room.in_front(room.piece(washed).footprint, wall, 70).centre();
        room.lay(K::BathMat, place, mat, wall);
        // A large bathroom has both.
        if room.inner.area_m2() > 9.0 {
            let other = if room.piece(washed).kind == K::Bathtub { K::Shower } else { K::Bathtub };
            room.stand(other, &walls, Along::Ends, 50);
        }
    }
    if room.inner.area_m2() > 6.0 {
        room.stand_anywhere(K::LaundryBasket, Along::Ends, 0);
        room.stand_anywhere(K::Plant, Along::Ends, 0);
    }
}
