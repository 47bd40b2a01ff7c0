use super::{super::model::DoorLeaf, *};
use proptest::prelude::*;

/// Rooms that can be reached from the first one.
fn reached(layout: &HouseLayout) -> Vec<bool> {
    let mut seen = vec![false; layout.rooms.len()];
    let mut open = vec![0];
    while let Some(room) = open.pop() {
        if std::mem::replace(&mut seen[room], true) {
            continue;
        }
        for opening in layout.openings.iter().filter(|opening| opening.is_passable()) {
            match opening.beyond {
                Some(beyond) if opening.room == room => open.push(beyond),
                Some(beyond) if beyond == room => open.push(opening.room),
                _ => {}
            }
        }
    }
    seen
}

proptest! {
    #[test]
    fn every_room_can_be_reached_and_none_overlap(seed: u64) {
        let layout = lay_out(seed);
        prop_assert!(reached(&layout).into_iter().all(|seen| seen));
        for (index, a) in layout.rooms.iter().enumerate() {
            for b in &layout.rooms[index + 1..] {
                let same = a.floor == b.floor || a.kind == RoomKind::Staircase || b.kind == RoomKind::Staircase;
                prop_assert!(!same || !a.outline.overlaps(&b.outline), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn openings_lie_on_both_rooms_walls_and_apart_from_each_other(seed: u64) {
        let layout = lay_out(seed);
        for (index, opening) in layout.openings.iter().enumerate() {
            prop_assert!(opening.span.length() >= NARROWEST_WALKABLE_CM, "{opening:?}");
            prop_assert!(layout.rooms[opening.room].outline.wall_of(&opening.span).is_some());
            if let Some(beyond) = opening.beyond {
                prop_assert!(layout.rooms[beyond].outline.wall_of(&opening.span).is_some());
            }
            for other in &layout.openings[index + 1..] {
                let meet = other.base_cm == opening.base_cm && other.span.thickened_by(5).overlaps(&opening.span.thickened_by(5));
                prop_assert!(!meet, "{opening:?} {other:?}");
            }
        }
    }

    #[test]
    fn layouts_have_the_rooms_of_a_home(seed: u64) {
        let layout = lay_out(seed);
        let count = |kind| layout.rooms.iter().filter(|room| room.kind == kind).count();
        for kind in [RoomKind::LivingRoom, RoomKind::Kitchen, RoomKind::Entryway, RoomKind::Hallway] {
            prop_assert!(count(kind) >= 1, "no {kind:?}");
        }
        prop_assert!(count(RoomKind::Bedroom) >= 1 && count(RoomKind::Bathroom) >= 1);
        prop_assert_eq!(count(RoomKind::Staircase), usize::from(layout.storeys == 2));
        prop_assert_eq!(layout.openings.iter().filter(|opening| opening.leaf == DoorLeaf::Closed).count(), 1);
        let areas = layout.rooms.iter().map(|room| room.outline.area_m2());
        prop_assert!(areas.clone().all(|area| (2.0..40.0).contains(&area)), "{:?}", areas.collect::<Vec<_>>());
    }
}

const NARROWEST_WALKABLE_CM: i32 = 75;
