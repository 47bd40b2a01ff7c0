//! Finds the ground nearest to any place: Detour's `findNearestPoly`, as Habitat calls it.

use super::{
    NavMeshGround,
    polygon::{GroundPolygon, nearest_on_edge},
};
use wayword_core::DVec3;

/// Half the size of the box in which ground is searched around a place, metres (`PathFinder::Impl`, `polyPickExt`).
const REACH_M: DVec3 = DVec3::new(2.0, 2.0, 4.0);

/// A place on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foothold {
    /// The position on the surface.
    pub place: DVec3,
    pub(super) polygon: usize,
    /// Number of the island; the largest is 0.
    pub island: usize,
}

impl NavMeshGround {
    /// The ground nearest to a place, within 2 m to all sides and 4 m up and down. Straight below or above a place,
    /// ground within the height of a step counts as distance 0.
    #[must_use]
    pub fn nearest_foothold(&self, place: DVec3) -> Option<Foothold> {
        self.nearest_where(place, |_| true)
    }

    /// The ground of one island nearest to a place, under the same rules as [`Self::nearest_foothold`].
    #[must_use]
    pub fn nearest_on(&self, island: usize, place: DVec3) -> Option<Foothold> {
        self.nearest_where(place, |polygon| polygon.island == island)
    }

    /// The nearest ground of the wanted polygons; of several at one distance, the first polygon's.
    fn nearest_where(&self, place: DVec3, wanted: impl Fn(&GroundPolygon) -> bool) -> Option<Foothold> {
        if !place.is_finite() {
            return None;
        }
        let (low, high) = (place - REACH_M, place + REACH_M);
        let mut best: Option<(f64, Foothold)> = None;
        for (index, polygon) in self.polygons.iter().enumerate() {
            let meets = polygon.low.cmple(high).all() && polygon.high.cmpge(low).all();
            if !(meets && polygon.is_walkable && wanted(polygon)) {
                continue;
            }
            let (on, off) = self.nearest_in_polygon(polygon, place);
            if best.is_none_or(|(least, _)| off < least) {
                best = Some((off, Foothold { place: on, polygon: index, island: polygon.island }));
            }
        }
        best.map(|(_, foothold)| foothold)
    }

    /// The nearest place of a polygon, and the square of its distance, as [`Self::nearest_foothold`] counts it.
    fn nearest_in_polygon(&self, polygon: &GroundPolygon, place: DVec3) -> (DVec3, f64) {
        if let Some(height_m) = polygon.contains_place(place).then(|| polygon.height_m(place)).flatten() {
            let off_m = ((place.z - height_m).abs() - self.climb_m).max(0.0);
            return (place.with_z(height_m), off_m * off_m);
        }
        let sides = polygon.triangles.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]);
        let on = sides.map(|(a, b)| nearest_on_edge(a, b, place));
        let off = |on: &DVec3| (*on - place).truncate().length_squared();
        let on = on.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_else(|| polygon.nearest_on_border(place));
        (on, on.distance_squared(place))
    }
}
