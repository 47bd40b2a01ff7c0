//! Decorates the walls of a stairwell with pictures that follow the flights.

use super::super::{
    catalogue::FurnitureKind as K,
    model::{HouseStairs, STOREY_CM},
    rect::WallSide,
};
use super::placing::RoomFurnisher;

/// Least width of a column of pictures, centimetres.
const COLUMN_CM: i32 = 50;
/// Distance between two columns, centimetres.
const GAP_CM: i32 = 8;
/// From the steps up to the lowest picture, centimetres.
const OVER_STEPS_CM: i32 = 55;
/// Distance between two pictures of a column, centimetres.
const APART_CM: i32 = 12;
/// Height above the ground floor at which the highest picture ends, centimetres.
const TOP_CM: i32 = STOREY_CM + 240;
/// Usual height of a picture, centimetres; the highest one of a column may be lower.
const HEIGHT_CM: i32 = 138;
/// How many columns in a hundred have pictures.
const FILLED_PERCENT: i32 = 86;
/// Height above the ground floor of the lowest picture over the opening at the foot of the stairs, centimetres.
const OVER_OPENING_CM: i32 = 236;

/// Hangs columns of pictures on every wall.
pub(super) fn furnish_stairwell(room: &mut RoomFurnisher<'_>, stairs: &HouseStairs) {
    for wall in WallSide::ALL {
        let edge = room.inner.edge_at(wall);
        let count = (edge.length() - GAP_CM) / (COLUMN_CM + GAP_CM);
        let width = (edge.length() - GAP_CM) / count.max(1) - GAP_CM;
        for column in 0..count {
            let from = edge.from + GAP_CM + column * (width + GAP_CM);
            // Not every column: a stairwell is no gallery.
            if room.dice.chance(FILLED_PERCENT)
                && let Some(base) = lowest_picture_height(room, stairs, wall, [from, width])
            {
                hang_column(room, wall, [from, width], base);
            }
        }
    }
}

/// The height over the floor from which a column may hang.
fn lowest_picture_height(
    room: &RoomFurnisher<'_>,
    stairs: &HouseStairs,
    wall: WallSide,
    [from, width]: [i32; 2],
) -> Option<i32> {
    let area = room.footprint_at_wall(wall, from, [width, 4, 0]);
    let (x, y) = area.centre();
    let ends = if wall.along_x() { [(area.x0, y), (x, y), (area.x1, y)] } else { [(x, area.y0), (x, y), (x, area.y1)] };
    let steps_m = ends.map(|(x, y)| stairs.height_at(f64::from(x) / 100.0, f64::from(y) / 100.0));
    let steps_cm = (steps_m.into_iter().fold(0.0, f64::max) * 100.0) as i32;
    if wall != stairs.entry {
        return Some(steps_cm + OVER_STEPS_CM);
    }
    // Over the opening above there is no room; the opening below ends at the lower flight's width.
    let (low, high) = stairs.flight_across(true);
    let lower = stairs.rect_across(low, high, [0, 10]);
    lower.contains(&area).then_some(OVER_OPENING_CM)
}

/// Hangs pictures one above the other, from the height `lowest` upwards, wherever the wall is bare.
fn hang_column(room: &mut RoomFurnisher<'_>, wall: WallSide, [from, width]: [i32; 2], lowest: i32) {
    let mut base = lowest;
    while base + HEIGHT_CM / 2 <= TOP_CM {
        let height = HEIGHT_CM.min(TOP_CM - base);
        let kind =
            if height < 110 || room.dice.chance(60) { K::Painting } else { room.dice.pick([K::Photos, K::Tapestry]) };
        let area = room.footprint_at_wall(wall, from, [width, 4, height]);
        if room.wall_is_bare(wall, &area, base, base + height, true) {
            room.hang_apart(kind, area, base, height, wall);
            base += height + APART_CM;
        } else {
            base += 20;
        }
    }
}
