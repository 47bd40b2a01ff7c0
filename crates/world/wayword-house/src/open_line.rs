//! Whether anything as high as the eyes stands on a straight line over a floor: a wall, a wardrobe, or the frame and the leaf of an open door.

use super::{
    model::{FurniturePiece, HALF_WALL_CM, House, STOREY_CM, WallOpening},
    rect::RectCm,
    structure::post_footprints,
};
use wayword_core::DVec3;

/// Height of the eyes over the floor, centimetres.
const EYE_CM: i32 = 150;
/// Distance between two tested points of a line, metres.
const SAMPLE_M: f64 = 0.02;

/// The areas of a storey over which one sees, and what stands in them higher than the eyes.
pub(super) struct OpenFloor {
    open: Vec<RectCm>,
    tall: Vec<RectCm>,
}

impl OpenFloor {
    /// The storey with this number, 0 at the ground. A number that no room has gives an empty one.
    pub(super) fn for_storey(house: &House, storey: usize) -> Self {
        let here = |opening: &&WallOpening| {
            usize::try_from(opening.base_cm / STOREY_CM) == Ok(storey) && opening.is_passable()
        };
        let rooms = house.rooms.iter().filter(|room| room.floor as usize == storey).map(|room| room.inner_area());
        let passages = house.openings.iter().filter(here).map(|opening| opening.span.thickened_by(HALF_WALL_CM));
        let leaves = house.openings.iter().filter(here).flat_map(|opening| opening.open_leaf(&house.rooms));
        let is_tall = |piece: &&FurniturePiece| {
            let base = storey as i32 * STOREY_CM;
            house.rooms.get(piece.room).is_some_and(|room| room.floor as usize == storey)
                && piece.base_cm < base + EYE_CM
                && piece.base_cm + piece.height_cm > base + EYE_CM
        };
        let tall = house.furniture.iter().filter(is_tall).map(|piece| piece.footprint);
        let posts = house.openings.iter().filter(here).flat_map(post_footprints);
        Self { open: rooms.chain(passages).collect(), tall: leaves.chain(posts).chain(tall).collect() }
    }

    /// Whether a straight line between two places, in metres, meets no wall and nothing tall.
    pub(super) fn is_clear(&self, from: DVec3, to: DVec3) -> bool {
        let samples = (from.distance(to) / SAMPLE_M).ceil().max(1.0) as usize;
        (0..=samples).map(|at| from.lerp(to, at as f64 / samples as f64)).all(|place| {
            let holds = |area: &RectCm| area.holds_m(place.x, place.y);
            self.open.iter().any(holds) && !self.tall.iter().any(holds)
        })
    }
}
