//! Dresses the walls that are still bare once a room is furnished: with large things that hang flat, because whoever
//! walks up to a wall sees little else.

use super::super::{
    catalogue::FurnitureKind as K,
    model::{RoomKind, STOREY_CM, Stairs},
    rect::{RectCm, Wall},
};
use super::placing::{Furnisher, Piece};

/// Distance between two places along a wall that are tried, centimetres.
const STEP_CM: i32 = 6;
/// A landing or a tread is at least this far below what hangs over it, centimetres.
const OVER_TREAD_CM: i32 = 55;

/// Something that may hang on a wall: what, its width and height, and the height of its lower edge, centimetres.
#[derive(Clone, Copy)]
struct Hung {
    kind: K,
    width: i32,
    height: i32,
    base: i32,
}

const fn hung(kind: K, width: i32, height: i32, base: i32) -> Hung {
    Hung { kind, width, height, base }
}

/// From the largest to the smallest; those that reach the floor come first.
fn choices(kind: RoomKind) -> &'static [Hung] {
    const HALL: [Hung; 9] = [
        hung(K::ClosetDoor, 180, 212, 0),
        hung(K::WallBookshelf, 120, 208, 0),
        hung(K::ClosetDoor, 120, 212, 0),
        hung(K::Tapestry, 150, 172, 42),
        hung(K::WallBookshelf, 80, 208, 0),
        hung(K::Painting, 150, 118, 88),
        hung(K::Mirror, 70, 172, 28),
        hung(K::Tapestry, 62, 165, 46),
        hung(K::Painting, 52, 92, 104),
    ];
    const SLEEP: [Hung; 7] = [
        hung(K::ClosetDoor, 200, 212, 0),
        hung(K::ClosetDoor, 140, 212, 0),
        hung(K::Painting, 160, 122, 88),
        hung(K::Tapestry, 120, 160, 60),
        hung(K::Mirror, 70, 168, 28),
        hung(K::Painting, 96, 100, 98),
        hung(K::Painting, 52, 84, 108),
    ];
    const LIVE: [Hung; 8] = [
        hung(K::WallBookshelf, 200, 208, 0),
        hung(K::Painting, 190, 128, 84),
        hung(K::Tapestry, 170, 172, 42),
        hung(K::WallBookshelf, 120, 208, 0),
        hung(K::Painting, 140, 116, 90),
        hung(K::Tapestry, 84, 165, 50),
        hung(K::Painting, 90, 104, 96),
        hung(K::Painting, 52, 84, 108),
    ];
    const WET: [Hung; 6] = [
        hung(K::ClosetDoor, 120, 206, 0),
        hung(K::WallCabinet, 100, 70, 134),
        hung(K::Mirror, 90, 112, 92),
        hung(K::Towel, 76, 112, 72),
        hung(K::Mirror, 56, 160, 34),
        hung(K::Towel, 56, 104, 82),
    ];
    match kind {
        RoomKind::Hallway | RoomKind::Entryway => &HALL,
        RoomKind::Bedroom | RoomKind::Closet => &SLEEP,
        RoomKind::Bathroom | RoomKind::LaundryRoom | RoomKind::Kitchen => &WET,
        RoomKind::LivingRoom | RoomKind::DiningRoom | RoomKind::Office | RoomKind::Garage => &LIVE,
        RoomKind::Staircase => &[],
    }
}

/// Hangs as much as there is room for.
pub(super) fn dress(room: &mut Furnisher<'_>, kind: RoomKind) {
    for wall in room.shuffled_walls() {
        for choice in choices(kind) {
            // One kind is not hung again and again along a wall.
            let mut left = if choice.width > 100 { 2 } else { 3 };
            while left > 0 && hang_somewhere(room, wall, *choice).is_some() {
                left -= 1;
            }
        }
    }
    finish(room, kind);
}

/// What goes where there is still room: radiators below what hangs, and a clock.
fn finish(room: &mut Furnisher<'_>, kind: RoomKind) {
    let mut radiators = if room.inner.area_m2() > 12.0 { 2 } else { 1 };
    for wall in room.shuffled_walls() {
        for width in [120, 90, 60] {
            if radiators > 0 && hang_somewhere(room, wall, hung(K::Radiator, width, 58, 12)).is_some() {
                radiators -= 1;
            }
        }
    }
    if matches!(kind, RoomKind::Kitchen | RoomKind::Office | RoomKind::LivingRoom | RoomKind::Hallway) {
        room.hang(K::Clock, 175);
    }
}

/// Hangs something at the first place of a wall where nothing is in its way, from the middle outwards.
fn hang_somewhere(room: &mut Furnisher<'_>, wall: Wall, choice: Hung) -> Option<Piece> {
    let edge = room.inner.edge(wall);
    let spare = edge.length() - choice.width;
    let mut offsets: Vec<i32> = (0..=spare.max(-1) / STEP_CM).map(|step| step * STEP_CM).collect();
    if spare < 0 {
        offsets.clear();
    }
    offsets.sort_by_key(|offset| (2 * offset - spare).abs());
    let size = [choice.width, choice.kind.entry().size_cm[1], choice.height];
    let hung = offsets
        .into_iter()
        .find_map(|offset| room.hang_at(choice.kind, wall, edge.from + offset, choice.base, size))?;
    match choice.kind {
        K::ClosetDoor => room.paint(hung, room.taste.closet),
        K::WallBookshelf => room.paint(hung, room.taste.wood),
        _ => {}
    }
    Some(hung)
}

/// Pictures along the stairs: over both flights, over the landing, and where the upper storey looks down into the well.
pub(super) fn dress_stairs(room: &mut Furnisher<'_>, stairs: &Stairs) {
    let walls = Wall::ALL.into_iter().filter(|wall| *wall != stairs.entry);
    for wall in walls {
        let edge = room.inner.edge(wall);
        for (width, height) in [(170, 170), (130, 130), (96, 120), (62, 110), (46, 80)] {
            for base in (60..STOREY_CM + 255 - height).step_by(20) {
                for from in (edge.from + 8..=edge.to - 8 - width).step_by(10) {
                    let area = room.at_wall(wall, from, [width, 4, height]);
                    if base >= highest_under(stairs, &area) + OVER_TREAD_CM {
                        let kind = if width == 170 || room.dice.chance(30) { K::Tapestry } else { K::Painting };
                        room.hang_at(kind, wall, from, base, [width, 4, height]);
                    }
                }
            }
        }
    }
}

/// Height of the highest tread below an area, over the floor of the staircase, centimetres.
fn highest_under(stairs: &Stairs, area: &RectCm) -> i32 {
    let reach = area.inset(-4);
    let half = STOREY_CM / 2;
    let landing = stairs.across(0, stairs.width_cm(), [stairs.flight_cm, stairs.depth_cm()]);
    let mut highest = if landing.overlaps(&reach) { half } else { 0 };
    for lower in [true, false] {
        let (from, to) = stairs.flight_across(lower);
        for deep in (0..stairs.flight_cm).step_by(10) {
            if stairs.across(from, to, [deep, deep + 10]).overlaps(&reach) {
                let far = if lower { deep + 10 } else { stairs.flight_cm - deep };
                highest = highest.max(far * half / stairs.flight_cm + if lower { 0 } else { half });
            }
        }
    }
    highest
}
