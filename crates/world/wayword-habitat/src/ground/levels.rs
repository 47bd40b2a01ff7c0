//! Finds the storeys from the heights at which the ground lies.

use super::NavMeshGround;
use wayword_core::DVec3;

/// Height of the slices into which the ground is sorted, metres.
const SLICE_M: f64 = 0.25;
/// Least height between two storeys, metres.
const MIN_STOREY_HEIGHT_M: f64 = 2.0;
/// Least area of a storey, as a share of the largest one's area; a landing has less.
const MIN_STOREY_AREA_SHARE: f64 = 0.15;
/// A place at most this far below a storey's floor belongs to that storey, because it is nearer than the storey below;
/// metres.
const BELOW_M: f64 = 1.0;

/// Heights of the storeys of the island that paths stay on, from the lowest. The slice with the most ground is a storey. Then the
/// slice with the next most ground is one, and so on, if it is far enough from the storeys found before.
pub(super) fn find_storeys(ground: &NavMeshGround) -> Vec<f64> {
    let Some(island) = ground.islands.get(ground.main) else { return Vec::new() };
    let mut slices: std::collections::BTreeMap<i64, f64> = std::collections::BTreeMap::new();
    for triangle in island.polygons.iter().flat_map(|polygon| &ground.polygons[*polygon].triangles) {
        let [a, b, c] = triangle;
        let slice = ((a.z + b.z + c.z) / 3.0 / SLICE_M).floor() as i64;
        *slices.entry(slice).or_default() += 0.5 * (*b - *a).cross(*c - *a).length();
    }
    // A floor that lies on the border between two slices counts in both.
    let around = |slice: i64| -> f64 { (slice - 1..=slice + 1).filter_map(|slice| slices.get(&slice)).sum() };
    let mut by_area: Vec<(i64, f64)> = slices.keys().map(|slice| (*slice, around(*slice))).collect();
    by_area.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let largest = by_area.first().map_or(0.0, |slice| slice.1);
    let mut floors: Vec<f64> = Vec::new();
    for (slice, area_m2) in by_area {
        let height_m = (slice as f64 + 0.5) * SLICE_M;
        if area_m2 >= MIN_STOREY_AREA_SHARE * largest
            && floors.iter().all(|floor| (floor - height_m).abs() >= MIN_STOREY_HEIGHT_M)
        {
            floors.push(height_m);
        }
    }
    floors.sort_by(f64::total_cmp);
    floors
}

impl NavMeshGround {
    /// The storey of a place on the ground; the lowest is 1.
    #[must_use]
    pub fn level_at(&self, place: DVec3) -> u32 {
        let under = self.storeys_m.iter().filter(|floor_m| **floor_m <= place.z + BELOW_M).count();
        under.max(1) as u32
    }
}
