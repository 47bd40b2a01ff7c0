//! Straight steps over the ground: from polygon to polygon through the edges that they share, up to the border.

use super::{
    Foothold, NavMeshGround,
    polygon::{GroundPolygon, PolygonCorner, nearest_on_edge, side_of_line},
};
use wayword_core::DVec3;

/// Most edges that one step crosses.
const MAX_EDGES: usize = 256;

/// The end of a straight step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundStride {
    /// The place that the step reaches.
    pub end: Foothold,
    /// Whether the ground ends before the step does.
    pub is_blocked: bool,
}

impl NavMeshGround {
    /// Walks straight from a place on the ground to another, seen from above; the height of `to` does not matter. The
    /// walker stops where the ground ends, and does not slide along its border.
    #[must_use]
    pub fn stride_to(&self, from: &Foothold, to: DVec3) -> GroundStride {
        let (start, mut number, mut reached_share) = (from.place, from.polygon, 0.0);
        for _ in 0..MAX_EDGES {
            let Some(polygon) = self.polygons.get(number) else { break };
            let Some((share, corner, on_edge)) = polygon_exit(polygon, start, to) else {
                return GroundStride { end: self.foothold_in(number, to), is_blocked: false };
            };
            reached_share = share.max(reached_share);
            match polygon_behind(corner, on_edge)
                .filter(|other| self.polygons.get(*other).is_some_and(|it| it.is_walkable))
            {
                Some(other) => number = other,
                None => break,
            }
        }
        GroundStride { end: self.foothold_in(number, start.lerp(to, reached_share)), is_blocked: true }
    }

    /// The point of a polygon's surface under or over `place`, or else the nearest one on its border.
    fn foothold_in(&self, number: usize, place: DVec3) -> Foothold {
        let on = self.polygons.get(number).map(|polygon| match polygon.height_m(place) {
            Some(height_m) => place.with_z(height_m),
            None => polygon.nearest_on_border(place),
        });
        let island = self.polygons.get(number).map_or(usize::MAX, |polygon| polygon.island);
        Foothold { place: on.unwrap_or(place), polygon: number, island }
    }
}

/// Where the line from `start` to `to` leaves a polygon: the share of the line's length, the corner at which the crossed
/// edge begins, and the share of that edge's length. `None` if the line ends in the polygon.
fn polygon_exit(polygon: &GroundPolygon, start: DVec3, to: DVec3) -> Option<(f64, &PolygonCorner, f64)> {
    // Polygons are convex, so the line leaves through the first edge that it crosses outwards.
    let crossed = polygon.edges().filter_map(|(a, b)| {
        let (before, after) = (side_of_line(a.place, b.place, start), side_of_line(a.place, b.place, to));
        // `side_of_line` is positive inside, because the corners go counter-clockwise.
        // A start on the edge itself, or just outside because of rounding, leaves at once.
        let share = if after >= 0.0 { return None } else { (before / (before - after)).clamp(0.0, 1.0) };
        let at = nearest_on_edge(a.place, b.place, start.lerp(to, share));
        let length = (b.place - a.place).truncate().length();
        let along = if length > 0.0 { (at - a.place).truncate().length() / length } else { 0.0 };
        Some((share, a, along))
    });
    crossed.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The polygon behind an edge at a share of the edge's length from its corner: the one that shares the whole edge, or the one
/// with a portal (its stretch of the edge) that holds the share.
fn polygon_behind(corner: &PolygonCorner, share: f64) -> Option<usize> {
    let portal = || corner.portals.iter().find(|portal| (portal.from..=portal.to).contains(&share));
    corner.neighbour.or_else(|| portal().map(|portal| portal.polygon))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{paved, ring};
    use super::*;
    use proptest::prelude::*;

    fn step(from: [f64; 2], to: [f64; 2]) -> GroundStride {
        let ground = NavMeshGround::new(&paved(&ring()));
        let place = |[x, y]: [f64; 2]| DVec3::new(x, y, 0.0);
        ground.stride_to(&ground.nearest_foothold(place(from)).unwrap(), place(to))
    }

    #[test]
    fn a_step_crosses_edges_and_ends_at_the_border() {
        let free = step([0.5, 0.5], [2.5, 0.4]);
        assert!(!free.is_blocked && free.end.place.distance(DVec3::new(2.5, 0.4, 0.0)) < 1e-9);
        let into_the_hole = step([0.5, 1.5], [2.5, 1.5]);
        assert!(into_the_hole.is_blocked && (into_the_hole.end.place.x - 1.0).abs() < 1e-9, "{into_the_hole:?}");
        let outside = step([0.5, 0.5], [0.5, -3.0]);
        assert!(outside.is_blocked && outside.end.place.y.abs() < 1e-9);
    }

    proptest! {
        #[test]
        fn a_step_is_free_exactly_where_a_straight_line_is(
            from in (0.01..2.99, 0.01..2.99), to in (-0.5..3.5, -0.5..3.5),
        ) {
            let on = |(x, y): (f64, f64)| {
                (0.0..=3.0).contains(&x) && (0.0..=3.0).contains(&y) && !(1.0 < x && x < 2.0 && 1.0 < y && y < 2.0)
            };
            prop_assume!(on(from));
            let along = |share: f64| (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
            let is_free = (0..=400).all(|n| on(along(f64::from(n) / 400.0)));
            let stride = step([from.0, from.1], [to.0, to.1]);
            let gone = stride.end.place.truncate();
            // Lines that just touch a corner may go either way.
            let near_corner = [1.0, 2.0, 0.0, 3.0].iter().any(|x| (gone.x - x).abs() < 0.02)
                && [1.0, 2.0, 0.0, 3.0].iter().any(|y| (gone.y - y).abs() < 0.02);
            prop_assert!(near_corner || stride.is_blocked != is_free, "{stride:?}, free {is_free}");
        }
    }
}
