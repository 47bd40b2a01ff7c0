//! Puts windows into outer walls, at equal distances.

use super::super::{
    model::{HouseRoom, HouseWindow, RoomKind, STOREY_CM, WallOpening},
    rect::{SpanCm, WallSide},
};
use super::{FloorPlan, ObjectIdCounter};

/// Width, sill and head of the windows of a kind of room, centimetres; `None` if it has none.
fn window_size(kind: RoomKind) -> Option<(i32, i32, i32)> {
    match kind {
        RoomKind::Closet | RoomKind::Garage => None,
        RoomKind::Bathroom | RoomKind::LaundryRoom => Some((70, 135, 215)),
        RoomKind::Kitchen => Some((140, 115, 220)),
        RoomKind::LivingRoom => Some((210, 40, 225)),
        RoomKind::Staircase => Some((160, 215, 420)),
        RoomKind::Hallway | RoomKind::Entryway => Some((90, 60, 218)),
        _ => Some((160, 70, 220)),
    }
}

/// The windows of all rooms, without those that would lie in an opening.
pub(super) fn cut_windows(
    plan: &FloorPlan,
    rooms: &[HouseRoom],
    openings: &[WallOpening],
    ids: &mut ObjectIdCounter,
) -> Vec<HouseWindow> {
    let mut windows = Vec::new();
    for (index, room) in rooms.iter().enumerate() {
        let Some((width, sill, head)) = window_size(room.kind) else {
            continue;
        };
        for span in WallSide::ALL.into_iter().flat_map(|wall| window_spans(plan, rooms, index, wall, width)) {
            if openings.iter().all(|opening| {
                !opening.span.thickened_by(1).overlaps(&span.thickened_by(1)) || is_on_other_storey(opening, room)
            }) {
                let (sill_cm, head_cm) = (room.base_cm() + sill, room.base_cm() + head);
                windows.push(HouseWindow { id: ids.next_id(), room: index, span, sill_cm, head_cm });
            }
        }
    }
    windows
}

/// Whether an opening lies on another storey than a room.
fn is_on_other_storey(opening: &WallOpening, room: &HouseRoom) -> bool {
    opening.base_cm / STOREY_CM != room.floor as i32
}

/// Evenly spaced windows in the stretches of a wall that have no room behind them.
fn window_spans(plan: &FloorPlan, rooms: &[HouseRoom], index: usize, wall: WallSide, width: i32) -> Vec<SpanCm> {
    let edge = rooms[index].outline.edge_at(wall);
    let behind = |other: &usize| {
        let shares = rooms[index].outline.shared_edge(&rooms[*other].outline);
        shares.filter(|(shared, _)| *shared == wall).map(|(_, span)| (span.from, span.to))
    };
    // A staircase has an upper storey (a garage has none), so its neighbours there count too.
    let beside = |other: &usize| {
        let is_well = plan.rooms[index].kind == RoomKind::Staircase || plan.rooms[*other].kind == RoomKind::Staircase;
        *other != index && (rooms[*other].floor == rooms[index].floor || is_well)
    };
    let mut covered: Vec<_> = (0..rooms.len()).filter(beside).filter_map(|other| behind(&other)).collect();
    covered.sort_unstable();
    let mut free = Vec::new();
    let mut from = edge.from;
    for (start, end) in covered {
        free.push((from, start));
        from = from.max(end);
    }
    free.push((from, edge.to));
    // Each window needs 90 cm of wall beside it, and a stretch of wall gets three windows at most.
    let per_window = width + 90;
    free.into_iter()
        .flat_map(|(from, to)| {
            let count = ((to - from) / per_window).clamp(0, 3);
            (0..count).map(move |n| from + (to - from) * (2 * n + 1) / (2 * count) - width / 2)
        })
        .map(|from| SpanCm { from, to: from + width, ..edge })
        .collect()
}
