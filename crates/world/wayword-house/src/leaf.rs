//! The geometry of an open door's leaf, at any angle to its wall.

use super::{
    model::{DoorLeaf, HALF_WALL_CM, HouseRoom, LEAF_CM, WallOpening},
    rect::RectCm,
};

/// Distance between two of the squares that cover a leaf on the floor, centimetres.
const STEP_CM: i32 = 6;
/// Half the side of each of these squares: large enough for the leaf's thickness at any angle.
const HALF_SQUARE_CM: i32 = 4;

/// Where a leaf hangs and which way it points, world frame, centimetres. The two directions have length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OpenLeaf {
    /// The edge at the hinge.
    pub(super) hinge: (f64, f64),
    /// From the hinge along the leaf.
    pub(super) along: (f64, f64),
    /// From the face at the hinge through the leaf.
    pub(super) through: (f64, f64),
    /// As long as the opening is wide.
    pub(super) length_cm: i32,
}

impl OpenLeaf {
    /// The open leaf of an opening; `None` if it has none.
    pub(super) fn for_opening(opening: &WallOpening, rooms: &[HouseRoom]) -> Option<Self> {
        let DoorLeaf::Open { into, hinge_low, angle_deg } = opening.leaf else {
            return None;
        };
        let span = opening.span;
        let (dx, dy) = rooms.get(into)?.outline.wall_of(&span)?.inward();
        let (inward, step) = ((f64::from(dx), f64::from(dy)), f64::from(dx + dy));
        let (at, towards) = if hinge_low { (span.from, 1.0) } else { (span.to, -1.0) };
        let line = f64::from(span.at) + step * f64::from(HALF_WALL_CM);
        let (hinge, across) = if span.along_x {
            ((f64::from(at), line), (towards, 0.0))
        } else {
            ((line, f64::from(at)), (0.0, towards))
        };
        let (sin, cos) = sin_cos_deg(angle_deg);
        let mix = |a: (f64, f64), x: f64, b: (f64, f64), y: f64| (a.0 * x + b.0 * y, a.1 * x + b.1 * y);
        Some(Self {
            hinge,
            along: mix(inward, sin, across, cos),
            through: mix(across, sin, inward, -cos),
            length_cm: span.length(),
        })
    }

    /// Squares of floor that together cover the leaf.
    pub(super) fn footprint(&self) -> Vec<RectCm> {
        let place = |far: i32| {
            let on = |hinge: f64, along: f64, through: f64| {
                libm::round(hinge + along * f64::from(far) + through * f64::from(LEAF_CM) / 2.0) as i32
            };
            let (x, y) =
                (on(self.hinge.0, self.along.0, self.through.0), on(self.hinge.1, self.along.1, self.through.1));
            let half = HALF_SQUARE_CM;
            RectCm::new(x - half, y - half, x + half, y + half)
        };
        // The outermost squares end where the leaf ends.
        let (from, to) = (HALF_SQUARE_CM, self.length_cm - HALF_SQUARE_CM);
        (from..to).step_by(STEP_CM as usize).chain([to]).map(place).collect()
    }

    /// Whether the leaf, seen from above, lies to the left of its direction: then a shape that is built to its right is
    /// mirrored.
    pub(super) fn is_mirrored(&self) -> bool {
        self.along.0 * self.through.1 - self.along.1 * self.through.0 < 0.0
    }
}

impl WallOpening {
    /// Squares of floor that together cover the open leaf; none if no leaf is open.
    #[must_use]
    pub fn open_leaf(&self, rooms: &[HouseRoom]) -> Vec<RectCm> {
        OpenLeaf::for_opening(self, rooms).map_or_else(Vec::new, |leaf| leaf.footprint())
    }
}

/// Sine and cosine, exact at a right angle.
fn sin_cos_deg(angle_deg: i32) -> (f64, f64) {
    if angle_deg == 90 {
        return (1.0, 0.0);
    }
    let rad = f64::from(angle_deg).to_radians();
    (libm::sin(rad), libm::cos(rad))
}

#[cfg(test)]
mod tests {
    use super::super::{generate_house, ground::HouseGround, model::House};
    use super::*;
    use wayword_core::DVec3;

    fn open_doors(house: &House) -> Vec<(&WallOpening, OpenLeaf, i32)> {
        let with_leaf = |opening| Some((opening, OpenLeaf::for_opening(opening, &house.rooms)?));
        let doors = house.openings.iter().filter_map(with_leaf);
        doors
            .map(|(opening, leaf)| match opening.leaf {
                DoorLeaf::Open { angle_deg, .. } => (opening, leaf, angle_deg),
                _ => (opening, leaf, 0),
            })
            .collect()
    }

    #[test]
    fn doors_open_at_many_angles_and_leaves_stay_in_their_rooms() {
        let mut angles = std::collections::BTreeSet::new();
        for house in (0..30).map(generate_house) {
            for (opening, leaf, angle_deg) in open_doors(&house) {
                angles.insert(angle_deg);
                let DoorLeaf::Open { into, .. } = opening.leaf else { continue };
                for square in leaf.footprint() {
                    assert!(house.rooms[into].outline.contains(&square), "{opening:?} {square:?}");
                }
            }
        }
        assert!(angles.len() >= 5 && angles.iter().all(|angle| (60..=115).contains(angle)), "{angles:?}");
    }

    #[test]
    fn open_leaves_block_the_ground_and_their_doors_do_not() {
        for house in (0..12).map(generate_house) {
            let ground = HouseGround::for_house(&house);
            for (opening, leaf, _) in open_doors(&house) {
                let z_m = f64::from(opening.base_cm) / 100.0;
                let at = |far: f64| {
                    let on = |hinge: f64, along: f64| (hinge + along * far) / 100.0;
                    DVec3::new(on(leaf.hinge.0, leaf.along.0), on(leaf.hinge.1, leaf.along.1), z_m)
                };
                for far in [10, leaf.length_cm / 2, leaf.length_cm] {
                    assert!(!ground.is_walkable(at(f64::from(far))), "house {}: {opening:?}", house.seed);
                }
                let span = opening.span.thickened_by(0);
                let free =
                    (span.x0..=span.x1).step_by(5).flat_map(|x| (span.y0..=span.y1).step_by(5).map(move |y| (x, y)));
                let is_free = |(x, y): (i32, i32)| {
                    ground.is_walkable(DVec3::new(f64::from(x) / 100.0, f64::from(y) / 100.0, z_m))
                };
                assert!(free.into_iter().any(is_free), "house {}: {opening:?}", house.seed);
            }
        }
    }
}
