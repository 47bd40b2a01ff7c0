//! Adds the furniture that is built into walls or fixed to them: closets, shelves with books, radiators.

use super::super::{catalogue::FurnitureKind as K, model::RoomKind, rect::WallSide};
use super::placing::{PieceIndex, RoomFurnisher};

/// Distance between two places along a wall that are tried, centimetres.
const STEP_CM: i32 = 6;

/// The built-in furniture of a kind of room, with its widths: the widest piece that fits is taken, once on each wall.
fn usual_built_ins(kind: RoomKind) -> &'static [(K, i32)] {
    match kind {
        RoomKind::Hallway => &[(K::ClosetDoor, 180), (K::WallBookshelf, 120), (K::ClosetDoor, 120)],
        RoomKind::Entryway => &[(K::ClosetDoor, 120)],
        RoomKind::Bedroom => &[(K::ClosetDoor, 200), (K::ClosetDoor, 140)],
        RoomKind::LivingRoom => &[(K::WallBookshelf, 200), (K::WallBookshelf, 120)],
        RoomKind::Office | RoomKind::DiningRoom => &[(K::WallBookshelf, 120)],
        _ => &[],
    }
}

/// Adds a room's usual built-in furniture to bare walls, and then its radiators.
pub(super) fn add_built_ins(room: &mut RoomFurnisher<'_>, kind: RoomKind) {
    let walls = room.shuffled_walls();
    // A bedroom has one closet, and a living room one wall of books; a hallway has several of both.
    let max_pieces = if kind == RoomKind::Hallway { 4 } else { 1 };
    let on_walls =
        walls.iter().flat_map(|wall| usual_built_ins(kind).iter().map(move |(kind, width)| (*wall, *kind, *width)));
    let mut built = 0;
    for (wall, kind, width) in on_walls {
        if built < max_pieces && fix_to_wall(room, wall, kind, width, 0).is_some() {
            built += 1;
        }
    }
    let radiators = walls.iter().flat_map(|wall| [120, 90, 60].map(|width| (*wall, width)));
    let mut radiators_left = match kind {
        RoomKind::Garage | RoomKind::Closet | RoomKind::LaundryRoom | RoomKind::Staircase => 0,
        _ if room.inner.area_m2() > 12.0 => 2,
        _ => 1,
    };
    for (wall, width) in radiators {
        if radiators_left > 0 && fix_to_wall(room, wall, K::Radiator, width, 12).is_some() {
            radiators_left -= 1;
        }
    }
}

/// Fixes a piece of this width to a wall, `base` centimetres over the floor, at the first place where the wall is bare,
/// from the middle outwards.
fn fix_to_wall(room: &mut RoomFurnisher<'_>, wall: WallSide, kind: K, width: i32, base: i32) -> Option<PieceIndex> {
    let [_, depth, height] = kind.entry().size_cm;
    let edge = room.inner.edge_at(wall);
    let spare = edge.length() - width;
    let mut offsets: Vec<i32> = (0..=spare / STEP_CM).map(|step| step * STEP_CM).take_while(|_| spare >= 0).collect();
    offsets.sort_by_key(|offset| (2 * offset - spare).abs());
    let place = |offset: i32| room.hang_at(kind, wall, edge.from + offset, base, [width, depth, height]);
    let piece = offsets.into_iter().find_map(place)?;
    if kind != K::Radiator {
        room.apply_finish(piece);
    }
    Some(piece)
}
