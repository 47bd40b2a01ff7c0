//! Prepares one island for the search for shortest ways.
//!
//! The search (polyanya: Cui, Harabor, Grastien, "Compromise-free Pathfinding on a Navigation Mesh", IJCAI 2017) works
//! in the plane only. It goes from polygon to polygon over shared edges, so storeys that lie above one another do not
//! disturb it. But it identifies the places at which ways bend by their coordinates. So no two vertices may coincide,
//! and the start and the end must be given with their polygons.

use super::{Foothold, polygon::GroundPolygon};
use glam::{DVec2, Vec2};
use polyanya::{Mesh, Vertex};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, contain_panics::run_decoder};

/// Vertices at the ends of portals are merged if they are nearer than this seen from above, metres.
const WELD_M: f64 = 1e-3;
/// Two vertices are merged only if their heights also differ by less than this, metres.
const SAME_STOREY_M: f64 = 0.5;
/// The search returns a bend at most this far from the vertex at which the way bends, metres: mostly within millimetres, but
/// rounding errors add up.
const MAX_BEND_OFFSET_M: f32 = 0.1;
/// Two bends at most this far apart may be the same one, metres (`lands_on` in the search's `instance.rs`).
const NOISE_M: f32 = 3e-3;

/// An island, prepared for the search.
#[derive(Debug)]
pub(super) struct IslandSearchMesh {
    mesh: Mesh,
    /// The mesh's coordinates are relative to this point, so that they stay small and `f32` is exact enough.
    origin: DVec2,
    /// The position of each vertex of the search.
    places: Vec<DVec3>,
    /// The number that the search gives to each polygon.
    numbers: BTreeMap<usize, u32>,
}

impl IslandSearchMesh {
    /// Prepares the polygons with the indices `members`; `None` if the search cannot use them.
    pub(super) fn new(polygons: &[GroundPolygon], members: &[usize]) -> Option<Self> {
        let numbers: BTreeMap<usize, u32> =
            members.iter().enumerate().map(|(at, polygon)| (*polygon, at as u32)).collect();
        let outlines = PolygonOutlines::new(members.iter().map(|polygon| &polygons[*polygon]));
        let low = outlines.places.iter().copied().reduce(DVec3::min)?;
        let high = outlines.places.iter().copied().reduce(DVec3::max)?;
        let origin = ((low + high) / 2.0).truncate();
        let flat = distinct_coords(&outlines.places, origin);
        let vertices = flat
            .into_iter()
            .zip(outlines.polygons_around())
            .map(|(coords, around)| Vertex::new(coords, around))
            .collect();
        let is_dead_end =
            |polygon: &usize| polygons[*polygon].neighbours().filter(|other| numbers.contains_key(other)).count() < 2;
        let pieces = members
            .iter()
            .zip(&outlines.rings)
            .map(|(polygon, ring)| polyanya::Polygon::new(ring.clone(), is_dead_end(polygon)));
        let pieces = pieces.collect();
        let mut mesh = run_decoder(|| Mesh::new(vertices, pieces).map_err(|error| error.to_string())).ok()?;
        let heights = outlines.places.iter().map(|place| place.z as f32).collect();
        mesh.layers.first_mut()?.set_heights(heights).ok()?;
        mesh.set_search_delta(1e-3);
        Some(Self { mesh, origin, places: outlines.places, numbers })
    }

    /// The places at which the shortest way between two places of the island bends. The search rounds, so it can miss a way
    /// through a narrow place that it finds from the other end. Therefore it runs from both ends, and the shorter result
    /// is used.
    pub(super) fn shortest_bends(&self, start: &Foothold, end: &Foothold) -> Option<Vec<DVec3>> {
        let forth = self.search_one_way(start, end);
        let mut back = self.search_one_way(end, start);
        if let Some(back) = &mut back {
            back.reverse();
        }
        let length_m = |bends: &Vec<DVec3>| {
            let places: Vec<DVec3> = [&[start.place], bends.as_slice(), &[end.place]].concat();
            places.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>()
        };
        forth.into_iter().chain(back).min_by(|a, b| length_m(a).total_cmp(&length_m(b)))
    }

    /// The bends that the search finds from `start` to `end`, each as the exact place of its vertex.
    fn search_one_way(&self, start: &Foothold, end: &Foothold) -> Option<Vec<DVec3>> {
        let (from, to) = (self.search_coords(start)?, self.search_coords(end)?);
        let path = run_decoder(|| Ok(self.mesh.path(from, to))).ok()??;
        let layer = self.mesh.layers.first()?;
        let rings: Vec<&[u32]> = path
            .polygons()
            .iter()
            .filter_map(|(_, polygon)| layer.polygons.get(*polygon as usize))
            .map(|polygon| polygon.vertices.as_slice())
            .collect();
        let mut bends = Vec::new();
        let mut reached = 0;
        for bend in path.path.split_last().map_or(&[][..], |(_, before)| before) {
            let later = find_bend_vertex(layer, &rings, reached, *bend, MAX_BEND_OFFSET_M);
            let (at, vertex) = later.or_else(|| find_bend_vertex(layer, &rings, 0, *bend, f32::MAX))?;
            // The way leaves a bend through the last polygon around it, so the next bend does not belong to any earlier polygon.
            let around = rings.iter().skip(at + 1).take_while(|ring| ring.contains(&vertex)).count();
            reached = at + around;
            let place = self.places.get(vertex as usize)?;
            if bends.last() != Some(place) {
                bends.push(*place);
            }
        }
        Some(bends)
    }

    /// A place in the search's coordinates. The search finds polygons by coordinates and mean height. Under a slope it can
    /// therefore return a polygon of another storey; then a place a little further inside is tried.
    fn search_coords(&self, foothold: &Foothold) -> Option<polyanya::Coords> {
        let number = *self.numbers.get(&foothold.polygon)?;
        let layer = self.mesh.layers.first()?;
        let ring = &layer.polygons.get(number as usize)?.vertices;
        let corners = || ring.iter().filter_map(|vertex| layer.vertices.get(*vertex as usize));
        let middle = corners().map(|vertex| vertex.coords).sum::<Vec2>() / ring.len() as f32;
        let mean_m =
            ring.iter().filter_map(|vertex| self.places.get(*vertex as usize)).map(|place| place.z).sum::<f64>()
                / ring.len() as f64;
        let place = (foothold.place.truncate() - self.origin).as_vec2();
        let tries = [0.0, 1e-4, 1e-3, 1e-2].map(|share| place + (middle - place) * share);
        tries.into_iter().find_map(|place| {
            let found = self.mesh.get_closest_point_at_height(place, mean_m as f32)?;
            // The upper byte is the number of the layer; there is only one.
            let found_number = found.polygon() & 0x00ff_ffff;
            (found_number == number || self.share_edge(found_number, number)).then_some(found)
        })
    }

    /// Whether two polygons share an edge. A place on that edge belongs to both of them.
    fn share_edge(&self, a: u32, b: u32) -> bool {
        let layer = self.mesh.layers.first();
        let ring = |number: u32| layer.and_then(|layer| layer.polygons.get(number as usize)).map(|p| &p.vertices);
        let (Some(a), Some(b)) = (ring(a), ring(b)) else { return false };
        a.iter().filter(|vertex| b.contains(vertex)).count() >= 2
    }
}

/// The vertex at which a way bends, at most `most_m` metres from `bend`, and the number of its polygon in `rings`, the
/// outlines that the way goes through. The first outline that has the vertex counts, beginning with number `first`. A
/// vertex of another storey may be as near, but it belongs to a later outline.
fn find_bend_vertex(
    layer: &polyanya::Layer,
    rings: &[&[u32]],
    first: usize,
    bend: Vec2,
    most_m: f32,
) -> Option<(usize, u32)> {
    let off = |vertex: u32| layer.vertices.get(vertex as usize).map_or(f32::MAX, |vertex| vertex.coords.distance(bend));
    let nearest = |ring: &&[u32]| ring.iter().copied().min_by(|a, b| off(*a).total_cmp(&off(*b)));
    let near =
        || rings.iter().enumerate().skip(first).filter_map(|(at, ring)| nearest(ring).map(|vertex| (at, vertex)));
    let least = near().map(|(_, vertex)| off(vertex)).fold(f32::MAX, f32::min);
    near().find(|(_, vertex)| off(*vertex) <= least + NOISE_M && off(*vertex) <= most_m)
}

/// The polygons' outlines with shared vertices, and a vertex at both ends of every portal.
struct PolygonOutlines {
    places: Vec<DVec3>,
    /// For each polygon, counter-clockwise.
    rings: Vec<Vec<u32>>,
}

impl PolygonOutlines {
    fn new<'a>(polygons: impl Iterator<Item = &'a GroundPolygon>) -> Self {
        let mut welds = WeldedVertices::default();
        let ring = |polygon: &GroundPolygon| {
            let mut ring: Vec<u32> = Vec::with_capacity(polygon.corners.len());
            for (corner, next) in polygon.edges() {
                let mut shares: Vec<f64> = corner.portals.iter().flat_map(|portal| [portal.from, portal.to]).collect();
                shares.sort_by(f64::total_cmp);
                let portal_ends = shares.into_iter().map(|share| corner.place.lerp(next.place, share));
                for place in std::iter::once(corner.place).chain(portal_ends) {
                    let vertex = welds.vertex_at(place);
                    if !ring.contains(&vertex) {
                        ring.push(vertex);
                    }
                }
            }
            ring
        };
        let rings = polygons.map(ring).collect();
        Self { places: welds.places, rings }
    }

    /// The polygons at each vertex, and also `u32::MAX` if the vertex lies on the border of the island.
    fn polygons_around(&self) -> Vec<Vec<u32>> {
        let mut around: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); self.places.len()];
        let mut edges: BTreeMap<(u32, u32), u32> = BTreeMap::new();
        for (number, ring) in self.rings.iter().enumerate() {
            for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                around[*a as usize].insert(number as u32);
                *edges.entry((*a.min(b), *a.max(b))).or_default() += 1;
            }
        }
        for ((a, b), _) in edges.into_iter().filter(|(_, polygons)| *polygons == 1) {
            around[a as usize].insert(u32::MAX);
            around[b as usize].insert(u32::MAX);
        }
        around.into_iter().map(|polygons| polygons.into_iter().collect()).collect()
    }
}

/// Vertices by position. Vertices at the same position seen from above are merged, unless they are a storey apart.
/// Tiles that meet in a portal may differ in height by one step (`agent_max_climb_m`).
#[derive(Default)]
struct WeldedVertices {
    places: Vec<DVec3>,
    by_cell: BTreeMap<(i64, i64), Vec<u32>>,
}

impl WeldedVertices {
    /// The number of the vertex at a place; a new one if there is none yet.
    fn vertex_at(&mut self, place: DVec3) -> u32 {
        let (x, y) = ((place.x / WELD_M).floor() as i64, (place.y / WELD_M).floor() as i64);
        let cells = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (x + dx, y + dy)));
        let near = |vertex: &&u32| {
            let off = self.places[**vertex as usize] - place;
            off.truncate().abs().max_element() < WELD_M && off.z.abs() < SAME_STOREY_M
        };
        let known = cells.filter_map(|cell| self.by_cell.get(&cell)).flatten().find(near);
        if let Some(vertex) = known {
            return *vertex;
        }
        let vertex = self.places.len() as u32;
        self.places.push(place);
        self.by_cell.entry((x, y)).or_default().push(vertex);
        vertex
    }
}

/// The places seen from above, relative to the origin. If two of them coincide, one is moved by the smallest possible
/// amount.
fn distinct_coords(places: &[DVec3], origin: DVec2) -> Vec<Vec2> {
    let mut taken = BTreeSet::new();
    let flat = |place: &DVec3| {
        let mut flat = (place.truncate() - origin).as_vec2();
        while !taken.insert((flat.x.to_bits(), flat.y.to_bits())) {
            flat.x = flat.x.next_up();
        }
        flat
    };
    places.iter().map(flat).collect()
}
