use super::super::{
    generate,
    model::{House, Leaf},
    rect::RectCm,
};
use super::*;
use proptest::prelude::*;

/// Pieces that take floor.
fn standing(house: &House) -> Vec<&Furniture> {
    let low = |piece: &&Furniture| {
        let above = piece.base_cm - house.rooms[piece.room].base_cm();
        above == 0 && !piece.kind.is_flat() && !piece.kind.is_slim_on_wall()
    };
    house.furniture.iter().filter(low).collect()
}

fn count(house: &House, room: RoomKind, kind: FurnitureKind) -> usize {
    house.furniture.iter().filter(|piece| house.rooms[piece.room].kind == room && piece.kind == kind).count()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn furniture_keeps_to_its_room_and_out_of_doors(seed: u64) {
        let house = generate(seed);
        for piece in &house.furniture {
            prop_assert!(house.rooms[piece.room].inner().contains(&piece.footprint), "{piece:?}");
        }
        for piece in standing(&house) {
            let base_cm = house.rooms[piece.room].base_cm();
            let doors = house.openings.iter().filter(|opening| opening.leaf != Leaf::Garage);
            for opening in doors.filter(|opening| opening.base_cm == base_cm) {
                let passage = opening.span.thickened(40);
                prop_assert!(!passage.overlaps(&piece.footprint), "{piece:?} in {opening:?}");
            }
        }
    }

    #[test]
    fn nothing_stands_in_anything_but_chairs_under_tables(seed: u64) {
        let house = generate(seed);
        let pieces = standing(&house);
        for (index, a) in pieces.iter().enumerate() {
            for b in &pieces[index + 1..] {
                let is_seated = matches!((a.kind, b.kind), (FurnitureKind::DiningTable, FurnitureKind::Chair));
                let clash = a.room == b.room && a.footprint.overlaps(&b.footprint);
                prop_assert!(is_seated || !clash, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn object_numbers_are_taken_once(seed: u64) {
        let house = generate(seed);
        let mut ids: Vec<u32> = house.furniture.iter().map(|piece| piece.id).collect();
        ids.extend(house.openings.iter().map(|opening| opening.id));
        ids.extend(house.windows.iter().map(|window| window.id));
        ids.extend(house.stairs.iter().flat_map(|stairs| [stairs.id, stairs.railing_id]));
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        prop_assert_eq!(ids.len(), all);
    }
}

#[test]
fn rooms_are_furnished_as_such_rooms_are() {
    let houses: Vec<House> = (0..60).map(generate).collect();
    let share = |room, kind| {
        let with = houses.iter().filter(|house| count(house, room, kind) > 0).count();
        let having = houses.iter().filter(|house| house.rooms.iter().any(|each| each.kind == room)).count();
        with as f64 / having.max(1) as f64
    };
    let wanted = [
        (RoomKind::LivingRoom, FurnitureKind::Sofa),
        (RoomKind::LivingRoom, FurnitureKind::Television),
        (RoomKind::Kitchen, FurnitureKind::Stove),
        (RoomKind::Kitchen, FurnitureKind::KitchenSink),
        (RoomKind::Bedroom, FurnitureKind::Bed),
        (RoomKind::Bathroom, FurnitureKind::Toilet),
        (RoomKind::DiningRoom, FurnitureKind::DiningTable),
        (RoomKind::Office, FurnitureKind::Desk),
        (RoomKind::LaundryRoom, FurnitureKind::Washer),
        (RoomKind::Garage, FurnitureKind::Car),
    ];
    let rare: Vec<_> =
        wanted.into_iter().map(|(room, kind)| (kind, share(room, kind))).filter(|(_, share)| *share < 0.9).collect();
    assert_eq!(rare, []);
}

#[test]
fn sofas_look_at_open_floor() {
    for house in (0..20).map(generate) {
        for sofa in house.furniture.iter().filter(|piece| piece.kind == FurnitureKind::Sofa) {
            let (dx, dy) = super::super::rect::Wall::ALL[usize::from(sofa.quarter_turns)].inward();
            let (x, y) = sofa.footprint.centre();
            let ahead = RectCm::new(x + dx * 120 - 5, y + dy * 120 - 5, x + dx * 120 + 5, y + dy * 120 + 5);
            assert!(house.rooms[sofa.room].inner().contains(&ahead), "{sofa:?}");
        }
    }
}
