//! Shortest ways over the ground.

use super::{Foothold, Ground};
use wayword_core::{DVec3, Way};

/// Why there is no way.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoWay {
    /// A place without ground near it.
    #[error("there is no walkable ground within 2 m of ({:.2}, {:.2}, {:.2})", .0.x, .0.y, .0.z)]
    OffGround(DVec3),
    /// Two places between which nobody can walk.
    #[error("the two places lie on islands that are not joined")]
    Apart,
}

impl Ground {
    /// The shortest way between two places, as Habitat has it: each is taken to the nearest polygon, and the way begins and ends
    /// where it was asked to where that lies over the polygon, else on the polygon's border.
    ///
    /// # Errors
    /// [`NoWay`] where a place lies off the ground, or the two on different islands.
    pub fn geodesic(&self, from: DVec3, to: DVec3) -> Result<Way, NoWay> {
        let start = self.nearest(from).ok_or(NoWay::OffGround(from))?;
        let end = self.nearest(to).ok_or(NoWay::OffGround(to))?;
        let bends = self.bends(&start, &end).ok_or(NoWay::Apart)?;
        let clamped = |place: DVec3, foothold: &Foothold| {
            let polygon = &self.polygons[foothold.polygon];
            if polygon.holds(place) { place } else { polygon.nearest_on_border(place) }
        };
        let mut corners = vec![clamped(from, &start)];
        corners.extend(bends);
        corners.push(clamped(to, &end));
        let length_m = corners.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        Ok(Way { corners, length_m })
    }

    /// Where the shortest way bends; `None` where there is none.
    fn bends(&self, start: &Foothold, end: &Foothold) -> Option<Vec<DVec3>> {
        if start.island != end.island {
            return None;
        }
        if start.polygon == end.polygon {
            return Some(Vec::new());
        }
        let island = self.islands.get(start.island)?;
        let maze = island.maze.get_or_init(|| super::Maze::new(&self.polygons, &island.polygons));
        maze.as_ref()?.bends(start, end)
    }
}
