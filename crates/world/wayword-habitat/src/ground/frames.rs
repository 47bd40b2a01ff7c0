//! Places the frames of a path at equal distances along a way.

use super::NavMeshGround;
use crate::axes::EYE_M;
use wayword_core::{DVec3, GroundRoute, path::PathStop};

/// Most frames of one way; on a longer way they are further apart.
const MAX_STOPS: f64 = 10_000.0;

/// Positions of the eye at equal distances of at most `interval_m` along a way, both ends included. Each is [`EYE_M`]
/// above the ground there, and has its storey.
#[must_use]
pub fn stops_along(ground: &NavMeshGround, way: &GroundRoute, interval_m: f64) -> Vec<PathStop> {
    let interval_m = if interval_m.is_finite() { interval_m.max(0.05) } else { 1.0 };
    let count = (way.length_m / interval_m - 1e-9).ceil().clamp(1.0, MAX_STOPS) as usize;
    let stop = |step: usize| {
        let on_way = place_at(way, way.length_m * step as f64 / count as f64);
        // The way runs straight from corner to corner, so on stairs it can lie above or below the treads. The ground counts only
        // straight under or over the way (within 5 cm), and on the same storey (within 1 m).
        let under = ground.nearest_foothold(on_way).map(|foothold| foothold.place);
        let near =
            under.filter(|place| (*place - on_way).truncate().length() < 0.05 && (place.z - on_way.z).abs() < 1.0);
        let place = near.unwrap_or(on_way);
        PathStop { position: place + DVec3::Z * EYE_M, viewpoint: None, level: Some(ground.level_at(place)) }
    };
    (0..=count).map(stop).collect()
}

/// The place at a distance of `left_m` metres from the start of the way.
fn place_at(way: &GroundRoute, mut left_m: f64) -> DVec3 {
    for pair in way.corners.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        if left_m <= length_m && length_m > 0.0 {
            return pair[0].lerp(pair[1], left_m / length_m);
        }
        left_m -= length_m;
    }
    way.corners.last().copied().unwrap_or_default()
}
