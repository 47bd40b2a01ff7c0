//! Walkable ground: the polygons of a navmesh and their neighbours, with shortest ways, storeys and viewpoints on them.
//!
//! All in Wayword's frame. Ground is what Habitat's `PathFinder` counts as ground (habitat-sim 0.3.3,
//! `PathFinder.cpp`): polygons without area are left out, and the polygons of an island can be reached from one another
//! over shared edges.

#[cfg(test)]
mod exact_search_tests;
mod frames;
mod geodesic;
mod islands;
mod levels;
mod locate;
mod polygon;
mod portals;
mod roadmap;
mod sample;
mod search_mesh;
mod stride;
#[cfg(test)]
pub(crate) mod tests;

pub use frames::stops_along;
pub use geodesic::GeodesicError;
pub use locate::Foothold;
pub use roadmap::viewpoint_graph;
pub use stride::GroundStride;

use crate::navmesh::{EdgeNeighbour, NavMesh};
use polygon::GroundPolygon;
use search_mesh::IslandSearchMesh;
use std::sync::OnceLock;
use wayword_core::DVec3;

/// Polygons with less area than this do not count as ground (`PathFinder::removeZeroAreaPolys`), square metres.
const MIN_POLYGON_AREA_M2: f64 = 1e-5;

/// The walkable ground of a scene.
#[derive(Debug)]
pub struct NavMeshGround {
    polygons: Vec<GroundPolygon>,
    /// The largest first.
    islands: Vec<NavMeshIsland>,
    /// The island that paths stay on: the largest, unless another is chosen.
    main: usize,
    /// Heights of the storeys of that island, from the lowest.
    storeys_m: Vec<f64>,
    /// Highest step that an agent takes, metres.
    climb_m: f64,
}

/// A connected part of the ground.
#[derive(Debug)]
struct NavMeshIsland {
    /// Sorted.
    polygons: Vec<usize>,
    area_m2: f64,
    /// Prepared for shortest ways when the first one is needed.
    search_mesh: OnceLock<Option<IslandSearchMesh>>,
}

impl NavMeshGround {
    /// The ground of a navmesh.
    #[must_use]
    pub fn new(mesh: &NavMesh) -> Self {
        let mut polygons = Vec::new();
        for tile in &mesh.tiles {
            let first = polygons.len();
            for (index, poly) in tile.polys.iter().enumerate() {
                let neighbour = |edge| match poly.neighbour_behind(edge) {
                    EdgeNeighbour::Polygon(other) => Some(first + other),
                    EdgeNeighbour::Border | EdgeNeighbour::Portal(_) => None,
                };
                polygons.push(GroundPolygon::new(tile, index, neighbour));
            }
        }
        let climb_m = mesh.tiles.first().map_or(0.0, |tile| f64::from(tile.header.agent_m[2]));
        portals::open_portals(mesh, &mut polygons, climb_m);
        // Smaller polygons stay in the list, because polygons are referred to by index, but one cannot stand on them or
        // cross them.
        for polygon in &mut polygons {
            polygon.is_walkable &= polygon.area_m2 >= MIN_POLYGON_AREA_M2;
        }
        let islands = islands::find_islands(&mut polygons);
        Self { polygons, islands, main: 0, storeys_m: Vec::new(), climb_m }.keeping_to(0)
    }

    /// The same ground with another island for paths. Storeys are counted on that island.
    #[must_use]
    pub fn keeping_to(mut self, island: usize) -> Self {
        self.main = island;
        self.storeys_m = levels::find_storeys(&self);
        self
    }

    /// The island that paths stay on.
    #[must_use]
    pub fn main(&self) -> usize {
        self.main
    }

    /// Area of all ground, square metres, measured along the surface and not seen from above.
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        self.islands.iter().map(|island| island.area_m2).sum()
    }

    /// Areas of the islands, square metres, the largest first.
    pub fn islands_m2(&self) -> impl Iterator<Item = f64> {
        self.islands.iter().map(|island| island.area_m2)
    }

    /// The lowest and the highest corner of the ground; `None` if there is no ground.
    #[must_use]
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let walkable = self.polygons.iter().filter(|polygon| polygon.is_walkable);
        walkable.map(|polygon| (polygon.low, polygon.high)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}
