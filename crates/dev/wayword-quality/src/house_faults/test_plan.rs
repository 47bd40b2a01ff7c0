//! A house and a walk for tests, made by hand so that every distance can be worked out.

use super::{plan::HousePlan, subject::FaultSubject};
use wayword_core::{DVec3, Frame, Heading, Path, path::PathStop};
use wayword_house::{
    EYE_M, FurnitureKind, House, RectCm, SpanCm, generate_house,
    model::{DoorLeaf, FurniturePiece, HouseRoom, RoomKind, WallOpening},
};

/// A hallway of 12 x 2 m from west to east. North of it are a kitchen in the west and a bedroom in the east, each
/// behind a doorway: the kitchen's from x = 1 to 2 m, the bedroom's from x = 8 to 9 m. A bookshelf (x = 1.5 to 2.45
/// m) and a plant (x = 5.2 to 5.7 m) stand at the hallway's northern wall, a bed and a dresser in the bedroom.
pub(super) fn hallway_house() -> House {
    let model = generate_house(1);
    let room = |kind, outline| HouseRoom { kind, outline, floor: 0, height_cm: 270, ..model.rooms[0].clone() };
    let opening = |id, beyond, from| WallOpening {
        id,
        room: 0,
        beyond: Some(beyond),
        span: SpanCm { along_x: true, at: 200, from, to: from + 100 },
        base_cm: 0,
        height_cm: 210,
        leaf: DoorLeaf::None,
        ..model.openings[0].clone()
    };
    let piece = |id, name: &str, room, footprint| FurniturePiece {
        id,
        kind: FurnitureKind::Dresser,
        name: name.to_owned(),
        room,
        footprint,
        base_cm: 0,
        height_cm: 90,
        ..model.furniture[0].clone()
    };
    House {
        storeys: 1,
        rooms: vec![
            room(RoomKind::Hallway, RectCm::new(0, 0, 1200, 200)),
            room(RoomKind::Kitchen, RectCm::new(0, 200, 700, 700)),
            room(RoomKind::Bedroom, RectCm::new(700, 200, 1200, 700)),
        ],
        openings: vec![opening(1, 1, 100), opening(2, 2, 800)],
        windows: Vec::new(),
        stairs: None,
        furniture: vec![
            piece(10, "bookshelf", 0, RectCm::new(150, 165, 245, 194)),
            piece(11, "plant", 0, RectCm::new(520, 145, 570, 194)),
            piece(12, "bed", 2, RectCm::new(1000, 450, 1190, 650)),
            piece(13, "dresser", 2, RectCm::new(710, 600, 800, 690)),
        ],
        ..model
    }
}

/// Frames along straight lines between corners of a walk, given as places of the floor, metres.
pub(super) fn frames_along(corners: &[[f64; 2]]) -> Vec<Frame> {
    let stop = |[x, y]: &[f64; 2]| PathStop { position: DVec3::new(*x, *y, EYE_M), viewpoint: None, level: None };
    Path::frames_along(corners.iter().map(stop).collect(), None)
}

/// 8 m along the hallway to the east, then a left turn, and through the doorway into the bedroom (9.2 m from the
/// start), where the walk ends after 12.7 m.
pub(super) fn hallway_walk() -> Vec<Frame> {
    frames_along(&[[0.5, 0.8], [4.5, 0.8], [8.5, 0.8], [8.5, 2.5], [8.5, 5.5]])
}

/// A text about [`hallway_walk`].
pub(super) fn hallway_subject<'p>(plan: &'p HousePlan, text: &str) -> FaultSubject<'p> {
    FaultSubject::new(plan, &hallway_walk(), text).unwrap()
}

/// The heading to the east.
pub(super) fn east() -> Heading {
    Heading::new(std::f64::consts::FRAC_PI_2).unwrap()
}
