//! Random places, uniform over the ground.

use super::{Foothold, NavMeshGround};
use rand::Rng;

impl NavMeshGround {
    /// A random place on an island (0 is the largest), uniform over its area; `None` if the island does not exist.
    #[must_use]
    pub fn random_place(&self, island: usize, rng: &mut impl Rng) -> Option<Foothold> {
        let members = &self.islands.get(island)?.polygons;
        let area = |[a, b, c]: &[wayword_core::DVec3; 3]| 0.5 * (*b - *a).cross(*c - *a).length();
        let all = || members.iter().flat_map(|at| self.polygons[*at].triangles.iter().map(move |each| (*at, each)));
        let mut rest_m2 = rng.random::<f64>() * self.islands.get(island)?.area_m2;
        // Rounding can leave a positive rest after the last triangle: then the last one is chosen.
        let mut chosen = None;
        for (polygon, triangle) in all() {
            chosen = Some((polygon, triangle));
            rest_m2 -= area(triangle);
            if rest_m2 < 0.0 {
                break;
            }
        }
        let (polygon, [a, b, c]) = chosen?;
        let (mut to_b, mut to_c) = (rng.random::<f64>(), rng.random::<f64>());
        if to_b + to_c > 1.0 {
            (to_b, to_c) = (1.0 - to_b, 1.0 - to_c);
        }
        let place = *a + (*b - *a) * to_b + (*c - *a) * to_c;
        Some(Foothold { place, polygon, island })
    }
}
