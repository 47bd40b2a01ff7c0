//! Walkable ground: the polygons of a navmesh with who borders on whom, to stand on and to walk over.
//!
//! All in Wayword's frame. What counts as ground is what Habitat's `PathFinder` takes for it (habitat-sim 0.3.3,
//! `PathFinder.cpp`): polygons without area are left out, islands are what can be reached over shared edges.

#[cfg(test)]
mod exact;
mod frames;
mod geodesic;
mod islands;
mod levels;
mod locate;
mod maze;
mod polygon;
mod portals;
mod roadmap;
mod sample;
#[cfg(test)]
mod tests;

pub use frames::stops_along;
pub use geodesic::NoWay;
pub use locate::Foothold;
pub use roadmap::viewpoint_graph;

use crate::navmesh::{Behind, NavMesh};
use maze::Maze;
use polygon::Polygon;
use std::sync::OnceLock;
use wayword_core::DVec3;

/// Polygons with less area are no ground (`PathFinder::removeZeroAreaPolys`), square metres.
const LEAST_AREA_M2: f64 = 1e-5;

/// The walkable ground of a scene.
#[derive(Debug)]
pub struct Ground {
    polygons: Vec<Polygon>,
    /// By falling area.
    islands: Vec<Island>,
    /// The island that walks keep to, the largest unless told otherwise.
    main: usize,
    /// Heights of the storeys of that island, from the lowest.
    storeys_m: Vec<f64>,
    /// Highest step that an agent takes, metres.
    climb_m: f64,
}

/// Ground that hangs together.
#[derive(Debug)]
struct Island {
    /// Sorted.
    polygons: Vec<usize>,
    area_m2: f64,
    /// Made ready for shortest ways when the first is asked for.
    maze: OnceLock<Option<Maze>>,
}

impl Ground {
    /// The ground of a navmesh.
    #[must_use]
    pub fn new(mesh: &NavMesh) -> Self {
        let mut polygons = Vec::new();
        for tile in &mesh.tiles {
            let first = polygons.len();
            for (index, poly) in tile.polys.iter().enumerate() {
                let neighbour = |edge| match poly.behind(edge) {
                    Behind::Polygon(other) => Some(first + other),
                    Behind::Border | Behind::Portal(_) => None,
                };
                polygons.push(Polygon::new(tile, index, neighbour));
            }
        }
        let climb_m = mesh.tiles.first().map_or(0.0, |tile| f64::from(tile.header.agent_m[2]));
        portals::open(mesh, &mut polygons, climb_m);
        // The others keep their places, as they are known by them, but nobody stands on them or crosses them.
        for polygon in &mut polygons {
            polygon.is_walkable &= polygon.area_m2 >= LEAST_AREA_M2;
        }
        let islands = islands::find(&mut polygons);
        Self { polygons, islands, main: 0, storeys_m: Vec::new(), climb_m }.keeping_to(0)
    }

    /// The same ground, with walks that keep to an island; storeys are counted on it.
    #[must_use]
    pub fn keeping_to(mut self, island: usize) -> Self {
        self.main = island;
        self.storeys_m = levels::storeys(&self);
        self
    }

    /// The island that walks keep to.
    #[must_use]
    pub fn main(&self) -> usize {
        self.main
    }

    /// Area of all ground, square metres, as the surface lies.
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        self.islands.iter().map(|island| island.area_m2).sum()
    }

    /// Areas of the islands, square metres, the largest first.
    pub fn islands_m2(&self) -> impl Iterator<Item = f64> {
        self.islands.iter().map(|island| island.area_m2)
    }

    /// The lowest and the highest corner of the ground; `None` where there is none.
    #[must_use]
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let walkable = self.polygons.iter().filter(|polygon| polygon.is_walkable);
        walkable.map(|polygon| (polygon.low, polygon.high)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }
}
