//! Judges the unit of a scene by the rooms in it: people fit into them.

use super::{
    columns::FreeColumns,
    floors::{largest_island, room_weight},
};
use glam::Vec3;

/// Columns along a side that are enough to see the rooms.
const COLUMNS_ALONG: f64 = 48.0;
/// How much more room for people another unit must give than metres to be read instead.
const CLEARLY_MORE: f64 = 4.0;
/// Least share of the columns with room for people for a unit to be read instead of metres.
const MIN_SHARE: f64 = 0.15;

/// How much more it must give than the next unit.
const MORE_THAN_NEXT: f64 = 1.5;
/// Least floor of a room, square metres.
const MIN_ROOM_M2: f64 = 4.0;
/// Greatest height of a room, metres.
const MAX_ROOM_M: f64 = 20.0;
/// Greatest width of a scene that can be metres if it has no rooms. Wider ones are too large to bake.
const MAX_WIDTH: f32 = 250.0;

/// The units that are tried beside the metre, each with its length in metres.
pub(super) const OTHER_UNITS: [(&str, f64); 2] = [("centimetres", 0.01), ("millimetres", 0.001)];
/// A unit that is asked for only: 9 feet in inches are much like a low room in centimetres.
const INCH_M: f64 = 0.0254;

/// The unit in which a scene is written, by its rooms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SceneUnit {
    /// Metres, or nothing can be told.
    AsRead,
    /// Clearly another one of [`OTHER_UNITS`].
    Other(usize),
    /// Not metres, but which unit it is cannot be told.
    Doubtful,
}

/// Judges the unit of triangles that were read as metres.
pub(super) fn judge_unit(triangles: &[[Vec3; 3]]) -> SceneUnit {
    let lines = [0, 1, 2].map(|axis| FreeColumns::along_axis_with(triangles, axis, COLUMNS_ALONG, 0.0));
    let fit = |unit_m: f64| lines.iter().map(|columns| room_share(columns, unit_m)).fold(0.0, f64::max);
    let least = MIN_SHARE.max(CLEARLY_MORE * fit(1.0));
    let mut others: Vec<(usize, f64)> = OTHER_UNITS.iter().map(|(_, unit_m)| fit(*unit_m)).enumerate().collect();
    others.sort_by(|a, b| b.1.total_cmp(&a.1));
    match others[..] {
        [(best, most), (_, next)] if most >= least => {
            if most >= MORE_THAN_NEXT * next {
                SceneUnit::Other(best)
            } else {
                SceneUnit::Doubtful
            }
        }
        _ if fit(INCH_M) >= least => SceneUnit::Doubtful,
        _ if fit(1.0) < MIN_SHARE && width_of(triangles) > MAX_WIDTH => SceneUnit::Doubtful,
        _ => SceneUnit::AsRead,
    }
}

/// The share of the columns in which people have room, on the largest floor along a line, if a unit has this length. 0 if all
/// would be too small for a room.
fn room_share(columns: &FreeColumns, unit_m: f64) -> f64 {
    let scaled = columns.scaled(unit_m);
    let share = |columns: &FreeColumns| {
        let (floor, worth) = largest_island(columns, |room_m| match room_m {
            Some(room_m) if room_m <= MAX_ROOM_M => room_weight(Some(room_m)),
            _ => 0.0,
        });
        let is_room = floor as f64 * columns.cell_area >= MIN_ROOM_M2;
        if is_room { worth / columns.gaps.len().max(1) as f64 } else { 0.0 }
    };
    share(&scaled).max(share(&scaled.upside_down()))
}

/// The greatest extent of triangles along an axis.
fn width_of(triangles: &[[Vec3; 3]]) -> f32 {
    let corners = || triangles.iter().flatten().copied();
    let low = corners().reduce(Vec3::min).unwrap_or_default();
    (corners().reduce(Vec3::max).unwrap_or_default() - low).max_element()
}
