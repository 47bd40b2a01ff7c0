//! Compares the search for shortest ways with a slow but exact one on squares with holes. The exact search joins all corners
//! that see each other by straight lines and runs Dijkstra's algorithm on them.

use super::{NavMeshGround, tests::paved};
use glam::DVec2;
use proptest::prelude::*;
use std::collections::BTreeSet;
use wayword_core::DVec3;

const SQUARES_PER_SIDE: i64 = 6;

/// The squares that are ground.
type GroundSquares = BTreeSet<(i64, i64)>;

fn ground_from_squares(squares: &GroundSquares) -> NavMeshGround {
    let slab = |(x, y): &(i64, i64)| {
        let (x, y) = (*x as f32, *y as f32);
        vec![[x, y, 0.0], [x + 1.0, y, 0.0], [x + 1.0, y + 1.0, 0.0], [x, y + 1.0, 0.0]]
    };
    NavMeshGround::new(&paved(&squares.iter().map(slab).collect::<Vec<_>>()))
}

/// Whether one can walk straight from one place to another: every stretch between two grid lines must be in a square of
/// ground or, if it runs along a grid line, next to one. A line may pass through a corner in which two squares touch.
fn is_open(squares: &GroundSquares, a: DVec2, b: DVec2) -> bool {
    let mut shares = vec![0.0, 1.0];
    for line in 0..=SQUARES_PER_SIDE {
        for (from, to) in [(a.x, b.x), (a.y, b.y)] {
            let share = (line as f64 - from) / (to - from);
            if share > 0.0 && share < 1.0 {
                shares.push(share);
            }
        }
    }
    shares.sort_by(f64::total_cmp);
    shares.dedup_by(|next, last| (*next - *last).abs() < 1e-12);
    let is_ground = |place: DVec2| {
        let ends = |v: f64| [(v - 1e-9).floor() as i64, (v + 1e-9).floor() as i64];
        ends(place.x).into_iter().any(|x| ends(place.y).into_iter().any(|y| squares.contains(&(x, y))))
    };
    shares.windows(2).all(|pair| is_ground(a.lerp(b, (pair[0] + pair[1]) / 2.0)))
}

/// The length of the shortest way from corner to corner along straight lines over the ground.
fn shortest_length(squares: &GroundSquares, from: DVec2, to: DVec2) -> Option<f64> {
    let mut places = vec![from, to];
    let corners: BTreeSet<(i64, i64)> =
        squares.iter().flat_map(|(x, y)| [(*x, *y), (x + 1, *y), (*x, y + 1), (x + 1, y + 1)]).collect();
    places.extend(corners.iter().map(|(x, y)| DVec2::new(*x as f64, *y as f64)));
    let mut best = vec![f64::INFINITY; places.len()];
    let mut done = vec![false; places.len()];
    best[0] = 0.0;
    loop {
        let next = (0..places.len())
            .filter(|at| !done[*at] && best[*at].is_finite())
            .min_by(|a, b| best[*a].total_cmp(&best[*b]))?;
        if next == 1 {
            return Some(best[1]);
        }
        done[next] = true;
        for other in 0..places.len() {
            if !done[other] && is_open(squares, places[next], places[other]) {
                best[other] = best[other].min(best[next] + places[next].distance(places[other]));
            }
        }
    }
}

proptest! {
    #[test]
    fn ways_are_as_short_as_ways_can_be(
        holes in prop::collection::btree_set((0..SQUARES_PER_SIDE, 0..SQUARES_PER_SIDE), 4..16),
        from in (0usize..36, 1u32..1000, 1u32..1000), to in (0usize..36, 1u32..1000, 1u32..1000),
    ) {
        let squares: GroundSquares = (0..SQUARES_PER_SIDE * SQUARES_PER_SIDE).map(|n| (n % SQUARES_PER_SIDE, n / SQUARES_PER_SIDE)).filter(|square| !holes.contains(square)).collect();
        let place = |(number, x, y): (usize, u32, u32)| {
            let square = squares.iter().nth(number % squares.len()).copied().unwrap_or_default();
            DVec2::new(square.0 as f64 + f64::from(x) / 1000.0, square.1 as f64 + f64::from(y) / 1000.0)
        };
        let (from, to) = (place(from), place(to));
        let way = ground_from_squares(&squares).geodesic(DVec3::new(from.x, from.y, 0.0), DVec3::new(to.x, to.y, 0.0));
        if let Ok(way) = way {
            let expected = shortest_length(&squares, from, to).unwrap();
            prop_assert!(way.length_m >= expected - 1e-6, "{way:?} is shorter than {expected}");
            prop_assert!(has_pinched_corner(&squares) || way.length_m <= expected + 1e-3, "{way:?} is longer than {expected}");
        }
    }
}

/// Whether two squares touch only in a corner. There the exact search passes through, but the tested one must not.
fn has_pinched_corner(squares: &GroundSquares) -> bool {
    let has = |x: i64, y: i64| squares.contains(&(x, y));
    (0..SQUARES_PER_SIDE - 1).any(|x| {
        (0..SQUARES_PER_SIDE - 1).any(|y| {
            let [a, b, c, d] = [has(x, y), has(x + 1, y), has(x, y + 1), has(x + 1, y + 1)];
            (a && d && !b && !c) || (b && c && !a && !d)
        })
    })
}
