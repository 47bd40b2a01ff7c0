//! One convex piece of ground.

use crate::{axes::wayword_from_habitat, navmesh::NavMeshTile};
use wayword_core::DVec3;

/// A convex piece of ground with its surface.
#[derive(Debug)]
pub(super) struct GroundPolygon {
    /// Counter-clockwise seen from above; at least three, unless the polygon is not ground.
    pub(super) corners: Vec<PolygonCorner>,
    /// Its surface.
    pub(super) triangles: Vec<[DVec3; 3]>,
    pub(super) area_m2: f64,
    /// The box around it: the smallest and the largest coordinates.
    pub(super) low: DVec3,
    pub(super) high: DVec3,
    pub(super) is_walkable: bool,
    /// Number of its island; the largest is 0.
    pub(super) island: usize,
}

/// A corner, and the edge from it to the next one.
#[derive(Clone, Debug)]
pub(super) struct PolygonCorner {
    pub(super) place: DVec3,
    /// The polygon of the same tile behind the edge.
    pub(super) neighbour: Option<usize>,
    /// The polygons of other tiles behind the edge, with the ends of the shared part.
    pub(super) portals: Vec<EdgePortal>,
}

/// A part of an edge behind which there is a polygon of another tile.
#[derive(Clone, Debug)]
pub(super) struct EdgePortal {
    pub(super) polygon: usize,
    /// Fractions of the edge's length, the smaller first.
    pub(super) from: f64,
    pub(super) to: f64,
}

/// A position of a navmesh file in Wayword's frame.
pub(super) fn wayword_place(place: [f32; 3]) -> DVec3 {
    wayword_from_habitat(glam::Vec3::from(place).as_dvec3())
}

impl GroundPolygon {
    /// A polygon of a tile; `neighbour` returns the polygon behind each of its edges.
    pub(super) fn new(tile: &NavMeshTile, index: usize, neighbour: impl Fn(usize) -> Option<usize>) -> Self {
        let poly = &tile.polys[index];
        let places: Vec<DVec3> =
            poly.corners().iter().map(|vert| wayword_place(tile.verts[usize::from(*vert)])).collect();
        let corner =
            |edge: usize| PolygonCorner { place: places[edge], neighbour: neighbour(edge), portals: Vec::new() };
        let mut corners: Vec<PolygonCorner> = (0..places.len()).map(corner).collect();
        if doubled_area(&places) < 0.0 {
            // The edge of a corner leads to the next corner: after the reversal it belongs to its other end.
            corners.reverse();
            let first = corners.first().map(|corner| corner.neighbour);
            for at in 0..corners.len() {
                let next = corners.get(at + 1).map(|corner| corner.neighbour).or(first);
                corners[at].neighbour = next.flatten();
            }
        }
        let triangles: Vec<[DVec3; 3]> =
            tile.polygon_triangles(index).into_iter().map(|triangle| triangle.map(wayword_place)).collect();
        let area = |[a, b, c]: &[DVec3; 3]| 0.5 * (*b - *a).cross(*c - *a).length();
        let all = || triangles.iter().flatten().chain(&places);
        Self {
            area_m2: triangles.iter().map(area).sum(),
            low: all().copied().reduce(DVec3::min).unwrap_or_default(),
            high: all().copied().reduce(DVec3::max).unwrap_or_default(),
            is_walkable: poly.is_ground() && corners.len() >= 3,
            island: usize::MAX,
            corners,
            triangles,
        }
    }

    /// The edges, each as its corner and the next one.
    pub(super) fn edges(&self) -> impl Iterator<Item = (&PolygonCorner, &PolygonCorner)> {
        self.corners.iter().zip(self.corners.iter().cycle().skip(1))
    }

    /// Indices of the polygons that share an edge with it, in its own tile and in others.
    pub(super) fn neighbours(&self) -> impl Iterator<Item = usize> {
        let portals = self.corners.iter().flat_map(|corner| &corner.portals).map(|portal| portal.polygon);
        self.corners.iter().filter_map(|corner| corner.neighbour).chain(portals)
    }

    /// Whether a place is inside it seen from above; its edges count as inside.
    pub(super) fn contains_place(&self, place: DVec3) -> bool {
        self.edges().all(|(a, b)| side_of_line(a.place, b.place, place) >= 0.0)
    }

    /// The height of its surface at a place that is inside it seen from above.
    pub(super) fn height_m(&self, place: DVec3) -> Option<f64> {
        let over = |triangle: &&[DVec3; 3]| {
            let [a, b, c] = **triangle;
            let sides = [side_of_line(a, b, place), side_of_line(b, c, place), side_of_line(c, a, place)];
            // Both windings count, and a small tolerance keeps a place from falling between two triangles.
            sides.iter().all(|side| *side >= -1e-9) || sides.iter().all(|side| *side <= 1e-9)
        };
        let [a, b, c] = *self.triangles.iter().find(over)?;
        let whole = side_of_line(a, b, c);
        if whole == 0.0 {
            return Some(a.z);
        }
        let (to_b, to_c) = (side_of_line(c, a, place) / whole, side_of_line(a, b, place) / whole);
        Some(a.z + (b.z - a.z) * to_b + (c.z - a.z) * to_c)
    }

    /// The place on its border that is nearest to another place, seen from above.
    pub(super) fn nearest_on_border(&self, place: DVec3) -> DVec3 {
        let edges = self.edges().map(|(a, b)| nearest_on_edge(a.place, b.place, place));
        let off = |on: &DVec3| (*on - place).truncate().length_squared();
        edges.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(place)
    }
}

/// Twice the area of a triangle seen from above; positive if c lies to the left of the line from a to b.
pub(super) fn side_of_line(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Twice the area of a polygon seen from above; negative if its corners go clockwise.
fn doubled_area(places: &[DVec3]) -> f64 {
    let first = places.first().copied().unwrap_or_default();
    places.windows(2).map(|pair| side_of_line(first, pair[0], pair[1])).sum()
}

/// The place on an edge that is nearest to another place seen from above, with the edge's height there.
pub(super) fn nearest_on_edge(a: DVec3, b: DVec3, place: DVec3) -> DVec3 {
    let along = (b - a).truncate();
    let length_squared = along.length_squared();
    let share = if length_squared > 0.0 { (place - a).truncate().dot(along) / length_squared } else { 0.0 };
    a + (b - a) * share.clamp(0.0, 1.0)
}
