use super::super::{
    generate_house,
    model::{DoorLeaf, House},
    rect::RectCm,
};
use super::*;
use proptest::prelude::*;

/// Pieces that take floor.
fn standing(house: &House) -> Vec<&FurniturePiece> {
    let low = |piece: &&FurniturePiece| {
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
        let house = generate_house(seed);
        for piece in &house.furniture {
            prop_assert!(house.rooms[piece.room].inner_area().contains(&piece.footprint), "{piece:?}");
        }
        for piece in standing(&house) {
            let base_cm = house.rooms[piece.room].base_cm();
            let doors = house.openings.iter().filter(|opening| opening.leaf != DoorLeaf::Garage);
            for opening in doors.filter(|opening| opening.base_cm == base_cm) {
                let passage = opening.span.thickened_by(40);
                prop_assert!(!passage.overlaps(&piece.footprint), "{piece:?} in {opening:?}");
            }
        }
    }

    #[test]
    fn pieces_overlap_only_where_chairs_go_under_tables(seed: u64) {
        let house = generate_house(seed);
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
    fn object_numbers_are_unique(seed: u64) {
        let house = generate_house(seed);
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
fn rooms_have_the_usual_furniture_of_their_kind() {
    let houses: Vec<House> = (0..60).map(generate_house).collect();
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
    for house in (0..20).map(generate_house) {
        for sofa in house.furniture.iter().filter(|piece| piece.kind == FurnitureKind::Sofa) {
            let (dx, dy) = super::super::rect::WallSide::ALL[usize::from(sofa.quarter_turns)].inward();
            let (x, y) = sofa.footprint.centre();
            let ahead = RectCm::new(x + dx * 120 - 5, y + dy * 120 - 5, x + dx * 120 + 5, y + dy * 120 + 5);
            assert!(house.rooms[sofa.room].inner_area().contains(&ahead), "{sofa:?}");
        }
    }
}

#[test]
fn furniture_has_ten_finishes_and_few_pieces_are_brown() {
    let mut seen: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    for house in (0..40).map(generate_house) {
        for piece in house.furniture.iter().filter(|piece| piece.material == "wood" || piece.colour == Colour::Glass) {
            *seen.entry(piece.colour.word()).or_default() += 1;
        }
    }
    let all: usize = seen.values().sum();
    let common = seen.values().filter(|count| **count * 50 >= all).count();
    assert!(common >= 10, "{seen:?}");
    let brown: usize = ["brown", "light brown", "dark brown"].iter().filter_map(|word| seen.get(word)).sum();
    assert!(brown * 4 < all, "{brown} of {all}: {seen:?}");
}

#[test]
fn hangings_keep_clear_of_doors_windows_and_each_other() {
    for house in (0..20).map(generate_house) {
        let on_wall: Vec<&FurniturePiece> =
            house.furniture.iter().filter(|piece| piece.kind.is_slim_on_wall()).collect();
        let covers =
            |piece: &FurniturePiece, low: i32, high: i32| piece.base_cm < high && low < piece.base_cm + piece.height_cm;
        for (index, piece) in on_wall.iter().enumerate() {
            // Curtains hang before the frames of windows.
            if piece.kind == FurnitureKind::Curtain {
                continue;
            }
            for opening in &house.openings {
                let hole = opening.span.thickened_by(10).overlaps(&piece.footprint);
                assert!(!hole || !covers(piece, opening.base_cm, opening.base_cm + opening.height_cm), "{piece:?}");
            }
            for window in house.windows.iter().filter(|window| window.room == piece.room) {
                let hole = window.span.thickened_by(10).overlaps(&piece.footprint);
                assert!(!hole || !covers(piece, window.sill_cm, window.head_cm), "{piece:?} {window:?}");
            }
            for other in on_wall[index + 1..].iter().filter(|other| other.room == piece.room) {
                let clash = other.footprint.overlaps(&piece.footprint)
                    && covers(piece, other.base_cm, other.base_cm + other.height_cm);
                assert!(!clash, "house {}: {piece:?} {other:?}", house.seed);
            }
        }
    }
}

#[test]
fn stairwells_have_pictures_that_clear_the_steps() {
    let mut hung = 0;
    for house in (0..20).map(generate_house) {
        let Some(stairs) = &house.stairs else { continue };
        for piece in house.furniture.iter().filter(|piece| piece.room == stairs.room) {
            let (x, y) = piece.footprint.centre();
            let steps_m = stairs.height_at(f64::from(x) / 100.0, f64::from(y) / 100.0);
            assert!(f64::from(piece.base_cm) / 100.0 > steps_m + 0.4, "{piece:?}");
            hung += 1;
        }
    }
    assert!(hung > 100, "{hung}");
}
