//! Shortest ways over the ground, measured as Habitat measures geodesic distances.

use super::{Foothold, NavMeshGround};
use wayword_core::{DVec3, GroundRoute};

/// Why there is no way between two places.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GeodesicError {
    /// There is no ground near this place.
    #[error("there is no walkable ground within 2 m of ({:.2}, {:.2}, {:.2})", .0.x, .0.y, .0.z)]
    OffGround(DVec3),
    /// One cannot walk between the two places.
    #[error("the two places lie on islands that are not connected")]
    Apart,
}

impl NavMeshGround {
    /// The shortest way between two places, as Habitat computes it: each place is assigned to the nearest polygon. The
    /// way begins or ends at the place itself if it lies over that polygon, else at the nearest point of the polygon's
    /// border.
    ///
    /// # Errors
    /// [`GeodesicError`] if a place lies off the ground, or the two lie on different islands.
    pub fn geodesic(&self, from: DVec3, to: DVec3) -> Result<GroundRoute, GeodesicError> {
        let start = self.nearest_foothold(from).ok_or(GeodesicError::OffGround(from))?;
        let end = self.nearest_foothold(to).ok_or(GeodesicError::OffGround(to))?;
        let bends = self.way_bends(&start, &end).ok_or(GeodesicError::Apart)?;
        let clamped = |place: DVec3, foothold: &Foothold| {
            let polygon = &self.polygons[foothold.polygon];
            if polygon.contains_place(place) { place } else { polygon.nearest_on_border(place) }
        };
        let mut corners = vec![clamped(from, &start)];
        corners.extend(bends);
        corners.push(clamped(to, &end));
        let length_m = corners.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        Ok(GroundRoute { corners, length_m })
    }

    /// The corners of the shortest way, without its start and end; `None` if there is no way.
    fn way_bends(&self, start: &Foothold, end: &Foothold) -> Option<Vec<DVec3>> {
        if start.island != end.island {
            return None;
        }
        if start.polygon == end.polygon {
            return Some(Vec::new());
        }
        let island = self.islands.get(start.island)?;
        let search_mesh =
            island.search_mesh.get_or_init(|| super::IslandSearchMesh::new(&self.polygons, &island.polygons));
        search_mesh.as_ref()?.shortest_bends(start, end)
    }
}
