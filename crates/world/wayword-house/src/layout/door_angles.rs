//! Chooses how far each door of a house is open.

use super::super::{
    dice::HouseDice,
    leaf::OpenLeaf,
    model::{DoorLeaf, HouseRoom, WallOpening},
};
use super::openings::floor_before_opening;

/// The possible angles between an open leaf and its wall, degrees.
const LEAF_ANGLES_DEG: [i32; 10] = [68, 76, 84, 88, 90, 92, 94, 100, 106, 112];

/// Turns each open leaf to an angle at which it stays in its room and out of the way of the other doors. The choice has
/// its own random numbers, so it changes nothing else in the plan.
pub(super) fn set_door_angles(seed: u64, rooms: &[HouseRoom], openings: &mut [WallOpening]) {
    let mut dice = HouseDice::new(seed, &["ajar"]);
    for index in 0..openings.len() {
        let DoorLeaf::Open { into, hinge_low, .. } = openings[index].leaf else {
            continue;
        };
        let mut angles = LEAF_ANGLES_DEG;
        dice.shuffle(&mut angles);
        let at = |angle_deg: i32| DoorLeaf::Open { into, hinge_low, angle_deg };
        let fits = |angle: &i32| *angle <= 90 || is_clear(rooms, openings, index, into, at(*angle));
        if let Some(angle) = angles.into_iter().find(fits) {
            openings[index].leaf = at(angle);
        }
    }
}

/// Whether a leaf that is turned beyond the right angle touches neither the room's walls nor the floor before another
/// opening.
fn is_clear(rooms: &[HouseRoom], openings: &[WallOpening], index: usize, into: usize, leaf: DoorLeaf) -> bool {
    let turned = WallOpening { leaf, ..openings[index].clone() };
    let Some(leaf) = OpenLeaf::for_opening(&turned, rooms) else {
        return false;
    };
    let (inner, squares) = (rooms[into].inner_area(), leaf.footprint());
    let others = openings.iter().enumerate().filter(|(other, opening)| {
        *other != index && (opening.room == into || opening.beyond == Some(into)) && opening.base_cm == turned.base_cm
    });
    let steps: Vec<_> =
        others.filter_map(|(_, other)| floor_before_opening(&rooms[into].outline, &other.span)).collect();
    // The squares at the hinge reach into the frame.
    squares.iter().skip(2).all(|square| inner.contains(square) && !steps.iter().any(|step| step.overlaps(square)))
}
