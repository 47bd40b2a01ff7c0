//! Tests on navmeshes that they build themselves.

use super::*;
use crate::navmesh::{
    NavMeshSettings,
    build::{TilePiece, TileSurface, single_tile},
};
use proptest::prelude::*;
use std::collections::BTreeMap;
use wayword_core::seeded_rng;

/// A navmesh of polygons given by their corners in Wayword's frame, counter-clockwise. Polygons that share two corners
/// are neighbours.
pub(crate) fn paved(polygons: &[Vec<[f32; 3]>]) -> NavMesh {
    let mut surface = TileSurface { low_m: [-50.0; 3], high_m: [50.0; 3], ..TileSurface::default() };
    let mut edges: BTreeMap<(u16, u16), (usize, usize)> = BTreeMap::new();
    for (number, polygon) in polygons.iter().enumerate() {
        let mut piece = TilePiece { neighbours: vec![0; polygon.len()], ..TilePiece::default() };
        for [x, y, z] in polygon {
            let vert = [*x, *z, -*y];
            let known = surface.verts.iter().position(|other| *other == vert);
            piece.corners.push(known.unwrap_or(surface.verts.len()) as u16);
            if known.is_none() {
                surface.verts.push(vert);
            }
        }
        for edge in 0..polygon.len() {
            let (a, b) = (piece.corners[edge], piece.corners[(edge + 1) % polygon.len()]);
            if let Some((other, other_edge)) = edges.insert((a.min(b), a.max(b)), (number, edge)) {
                piece.neighbours[edge] = other as u16 + 1;
                surface.pieces[other].neighbours[other_edge] = number as u16 + 1;
            }
        }
        piece.detail_tris = (2..polygon.len() as u8).map(|last| [0, last - 1, last, 0]).collect();
        surface.pieces.push(piece);
    }
    single_tile(&surface, NavMeshSettings::default())
}

/// A rectangle at a height.
fn slab(x: [f32; 2], y: [f32; 2], z: f32) -> Vec<[f32; 3]> {
    vec![[x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z]]
}

/// A floor of 3 x 3 squares of 1 m, without the middle one.
pub(crate) fn ring() -> Vec<Vec<[f32; 3]>> {
    let squares = (0..9).filter(|n| *n != 4).map(|n| ((n % 3) as f32, (n / 3) as f32));
    squares.map(|(x, y)| slab([x, x + 1.0], [y, y + 1.0], 0.0)).collect()
}

/// Two floors of 4 x 4 m above one another, made of strips, and a ramp along their side from the far end of the lower one
/// to the near end of the upper one. The way up leads along the floor and back up the ramp, to a place above its start.
pub(crate) fn two_storeys() -> Vec<Vec<[f32; 3]>> {
    let strip = |n: u8, z: f32| slab([0.0, 4.0], [f32::from(n), f32::from(n) + 1.0], z);
    let mut polygons: Vec<_> = (0..4).map(|n| strip(n, 0.0)).collect();
    polygons.extend((0..4).map(|n| strip(n, 3.0)));
    polygons.push(vec![[4.0, 3.0, 0.0], [5.0, 3.0, 0.0], [5.0, 4.0, 0.0], [4.0, 4.0, 0.0]]);
    polygons.push(vec![[4.0, 1.0, 3.0], [5.0, 1.0, 3.0], [5.0, 3.0, 0.0], [4.0, 3.0, 0.0]]);
    polygons.push(vec![[4.0, 0.0, 3.0], [5.0, 0.0, 3.0], [5.0, 1.0, 3.0], [4.0, 1.0, 3.0]]);
    polygons
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

#[test]
fn ways_bend_around_holes_in_the_ground() {
    let ground = NavMeshGround::new(&paved(&ring()));
    assert!((ground.area_m2() - 8.0).abs() < 1e-6);
    let way = ground.geodesic(at(0.5, 1.5, 0.0), at(2.5, 1.4, 0.0)).unwrap();
    assert_eq!(way.corners, [at(0.5, 1.5, 0.0), at(1.0, 1.0, 0.0), at(2.0, 1.0, 0.0), at(2.5, 1.4, 0.0)]);
    let expected = 0.5_f64.hypot(0.5) + 1.0 + 0.5_f64.hypot(0.4);
    assert!((way.length_m - expected).abs() < 1e-6);
}

#[test]
fn a_place_under_another_floor_is_reached_by_the_ramp() {
    let ground = NavMeshGround::new(&paved(&two_storeys()));
    assert_eq!(ground.islands_m2().count(), 1);
    let (below, above) = (at(2.0, 0.5, 0.0), at(2.0, 0.5, 3.0));
    let way = ground.geodesic(below, above).unwrap();
    // Along the lower floor, up between (4, 3) and (4, 1), where the ramp is steep, and back.
    assert_eq!(way.corners.len(), 4, "{way:?}");
    let ramp = at(4.0, 3.0, 0.0).distance(at(4.0, 1.0, 3.0));
    let expected = below.distance(at(4.0, 3.0, 0.0)) + ramp + at(4.0, 1.0, 3.0).distance(above);
    assert!((way.length_m - expected).abs() < 1e-6, "{way:?}");
    assert_eq!((ground.level_at(below), ground.level_at(above)), (1, 2));
    // A place a little below or above a floor is assigned to that floor.
    assert_eq!(ground.nearest_foothold(at(2.0, 0.5, 2.2)).unwrap().place, above);
    assert_eq!(ground.nearest_foothold(at(2.0, 0.5, 0.9)).unwrap().place, below);
}

#[test]
fn a_way_bends_twice_at_places_above_one_another() {
    // Two rings, and stairs at their side that turn back: the way from a place to the one above it bends around both
    // holes alike.
    let mut polygons = ring();
    polygons.extend(ring().into_iter().map(|polygon| polygon.into_iter().map(|[x, y, _]| [x, y, 3.0]).collect()));
    let ramp =
        |x: f32, from: f32, to: f32| vec![[x, 1.0, from], [x + 1.0, 1.0, from], [x + 1.0, 2.0, to], [x, 2.0, to]];
    polygons.push(slab([3.0, 4.0], [0.0, 1.0], 0.0));
    polygons.push(ramp(3.0, 0.0, 1.5));
    polygons.push(slab([3.0, 4.0], [2.0, 3.0], 1.5));
    polygons.push(slab([4.0, 5.0], [2.0, 3.0], 1.5));
    polygons.push(ramp(4.0, 3.0, 1.5));
    polygons.push(slab([4.0, 5.0], [0.0, 1.0], 3.0));
    polygons.push(slab([3.0, 4.0], [0.0, 1.0], 3.0));
    let ground = NavMeshGround::new(&paved(&polygons));
    let way = ground.geodesic(at(0.5, 1.5, 0.0), at(0.5, 1.5, 3.0)).unwrap();
    for bend in [at(1.0, 1.0, 0.0), at(1.0, 1.0, 3.0)] {
        assert!(way.corners.contains(&bend), "{way:?}");
    }
    let back = ground.geodesic(at(0.5, 1.5, 3.0), at(0.5, 1.5, 0.0)).unwrap();
    assert!((way.length_m - back.length_m).abs() < 1e-6, "{way:?} {back:?}");
}

#[test]
fn nearest_ground_includes_the_height_of_a_step() {
    let ground = NavMeshGround::new(&paved(&[slab([0.0, 1.0], [0.0, 1.0], 0.0), slab([1.05, 2.0], [0.0, 1.0], 0.15)]));
    assert_eq!(ground.nearest_foothold(at(0.97, 0.5, 0.15)).unwrap().place, at(0.97, 0.5, 0.0));
}

#[test]
fn ground_that_is_not_joined_cannot_be_reached() {
    let apart = vec![slab([0.0, 1.0], [0.0, 1.0], 0.0), slab([3.0, 5.0], [0.0, 1.0], 0.0)];
    let ground = NavMeshGround::new(&paved(&apart));
    assert_eq!(ground.islands_m2().map(f64::round).collect::<Vec<_>>(), [2.0, 1.0]);
    assert_eq!(ground.geodesic(at(0.5, 0.5, 0.0), at(4.0, 0.5, 0.0)), Err(GeodesicError::Apart));
    let far = at(0.5, 9.0, 0.0);
    assert_eq!(ground.geodesic(far, at(4.0, 0.5, 0.0)), Err(GeodesicError::OffGround(far)));
    assert!(ground.nearest_foothold(at(f64::NAN, 0.0, 0.0)).is_none());
}

#[test]
fn polygons_wound_the_other_way_keep_their_neighbours() {
    let clockwise: Vec<Vec<[f32; 3]>> = ring().into_iter().map(|polygon| polygon.into_iter().rev().collect()).collect();
    for polygons in [ring(), clockwise] {
        let ground = NavMeshGround::new(&paved(&polygons));
        for polygon in &ground.polygons {
            for (corner, next) in polygon.edges() {
                // The middle of every edge inside the ring lies on two polygons.
                let middle = (corner.place + next.place) / 2.0;
                let on = ground.polygons.iter().filter(|other| other.contains_place(middle)).count();
                assert_eq!(corner.neighbour.is_some(), on == 2, "{middle}");
                assert!(corner.neighbour.is_none_or(|other| ground.polygons[other].contains_place(middle)));
            }
        }
    }
}

#[test]
fn slivers_are_no_ground() {
    let sliver = vec![[1.0, 0.0, 0.0], [1.0 + 1e-6, 0.5, 0.0], [1.0, 1.0, 0.0]];
    let ground = NavMeshGround::new(&paved(&[slab([0.0, 1.0], [0.0, 1.0], 0.0), sliver]));
    assert!((ground.area_m2() - 1.0).abs() < 1e-9);
}

#[test]
fn tiles_are_joined_where_their_edges_overlap() {
    // Two neighbouring tiles. The door between them is the half of the first one's edge that the second one's edge
    // covers.
    let mut mesh = paved(&[slab([0.0, 2.0], [0.0, 2.0], 0.0)]);
    let mut beside = paved(&[slab([2.0, 4.0], [1.0, 3.0], 0.1)]);
    mesh.tiles[0].polys[0].open(1, 0);
    beside.tiles[0].polys[0].open(3, 4);
    beside.tiles[0].header.place = [1, 0, 0];
    mesh.tiles.append(&mut beside.tiles);
    let ground = NavMeshGround::new(&mesh);
    assert_eq!(ground.islands_m2().count(), 1);
    let way = ground.geodesic(at(1.0, 0.0, 0.0), at(4.0, 1.0, 0.1)).unwrap();
    assert_eq!(way.corners.len(), 3, "{way:?}");
    assert!(way.corners[1].truncate().distance(glam::DVec2::new(2.0, 1.0)) < 1e-6);
    assert!(NavMesh::from_bytes(&mesh.to_bytes()).is_ok());
}

#[test]
fn frames_stand_at_equal_distances_and_both_ends() {
    let ground = NavMeshGround::new(&paved(&ring()));
    let way = ground.geodesic(at(0.5, 0.5, 0.0), at(2.5, 0.5, 0.0)).unwrap();
    let stops = stops_along(&ground, &way, 0.75);
    let xs: Vec<f64> = stops.iter().map(|stop| (stop.position.x * 1000.0).round() / 1000.0).collect();
    assert_eq!(xs, [0.5, 1.167, 1.833, 2.5]);
    assert!(stops.iter().all(|stop| stop.position.z == crate::axes::EYE_M && stop.level == Some(1)));
}

#[test]
fn the_viewpoint_graph_reaches_every_floor() {
    let ground = NavMeshGround::new(&paved(&two_storeys()));
    let graph = viewpoint_graph(&ground, 0).unwrap();
    assert_eq!(graph.count_components(), 1);
    let levels: std::collections::BTreeSet<_> = graph.viewpoints().map(|id| graph.level_of(id)).collect();
    assert_eq!(levels, [Some(1), Some(2)].into());
    assert!(graph.len() > 6, "{} viewpoints", graph.len());
    for (a, b, length_m) in graph.edges() {
        let under = |id| graph.position_of(id).unwrap() - DVec3::Z * crate::axes::EYE_M;
        let walk = ground.geodesic(under(a), under(b)).unwrap();
        assert!(walk.length_m <= length_m * 1.1 + 1e-6, "{a} to {b}");
    }
}

#[test]
fn what_is_near_over_the_ground_is_near_over_the_graph() {
    let ground = NavMeshGround::new(&paved(&two_storeys()));
    let graph = viewpoint_graph(&ground, 0).unwrap();
    let under = |id| graph.position_of(id).unwrap() - DVec3::Z * crate::axes::EYE_M;
    let (mut near, mut arrived) = (0, 0);
    for a in graph.viewpoints() {
        let over_graph = graph.distances_from(a).unwrap();
        for b in graph.viewpoints().filter(|b| *b > a && under(a).distance(under(b)) < 3.0) {
            if ground.geodesic(under(a), under(b)).unwrap().length_m < 3.0 {
                near += 1;
                arrived += usize::from(over_graph[b] < 3.0);
            }
        }
    }
    assert!(near > 10 && 10 * arrived >= 9 * near, "{arrived} of {near}");
}

proptest! {
    #[test]
    fn corrupt_navmeshes_never_panic_the_search(at in 0usize..2400, with: [u8; 2], seed: u64) {
        let mut bytes = paved(&two_storeys()).to_bytes();
        let at = at % bytes.len();
        for (byte, new) in bytes.iter_mut().skip(at).zip(with) {
            *byte = new;
        }
        if let Ok(mesh) = NavMesh::from_bytes(&bytes) {
            let ground = NavMeshGround::new(&mesh);
            let mut rng = seeded_rng(seed, &["test"]);
            let [a, b] = [0; 2].map(|island| ground.random_place(island, &mut rng).map(|foothold| foothold.place));
            if let (Some(a), Some(b)) = (a, b) {
                let _ = ground.geodesic(a, b);
                let _ = ground.nearest_foothold(a);
            }
        }
    }

    #[test]
    fn random_places_lie_on_the_ground(seed: u64) {
        let ground = NavMeshGround::new(&paved(&two_storeys()));
        let mut rng = seeded_rng(seed, &["test"]);
        let foothold = ground.random_place(0, &mut rng).unwrap();
        let again = ground.nearest_foothold(foothold.place).unwrap();
        prop_assert!(again.place.distance(foothold.place) < 1e-6);
    }

    #[test]
    fn ways_keep_the_triangle_inequality_and_are_the_same_backwards(seed: u64) {
        let ground = NavMeshGround::new(&paved(&two_storeys()));
        let mut rng = seeded_rng(seed, &["test"]);
        let places: Vec<DVec3> = (0..3).map(|_| ground.random_place(0, &mut rng).unwrap().place).collect();
        let length = |a: usize, b: usize| ground.geodesic(places[a], places[b]).unwrap().length_m;
        prop_assert!(length(0, 1) >= places[0].distance(places[1]) - 1e-6);
        // The search is exact in the plane; on the ramp the surface is longer than its projection.
        prop_assert!((length(0, 1) - length(1, 0)).abs() < 1e-3);
        prop_assert!(length(0, 2) <= (length(0, 1) + length(1, 2)) * 1.3);
    }
}

/// The file has one triangle with sides of many kilometres.
#[test]
fn a_country_has_no_more_viewpoints_than_can_be_joined() {
    let far = 5e4;
    let country = NavMeshGround::new(&paved(&[vec![[-far, -far, 0.0], [far, -far, 0.0], [0.0, far, 0.0]]]));
    let graph = viewpoint_graph(&country, 0).unwrap();
    assert_eq!((graph.len(), graph.count_components()), (2000, 1));
}

/// The squares lie on top of one another, on both sides of a border between two tiles.
#[test]
fn edges_on_top_of_one_another_are_not_all_joined_with_all() {
    let mut mesh = paved(&vec![slab([0.0, 1.0], [0.0, 1.0], 0.0); 200]);
    for poly in &mut mesh.tiles[0].polys {
        poly.neis = [0; 6];
        poly.neis[1] = 0x8000;
    }
    let mut beside = mesh.tiles[0].clone();
    beside.header.place[0] += 1;
    beside.verts.iter_mut().for_each(|vert| vert[0] += 1.0);
    for poly in &mut beside.polys {
        poly.neis = [0; 6];
        poly.neis[3] = 0x8004;
    }
    mesh.tiles.push(beside);
    let ground = NavMeshGround::new(&mesh);
    let doors = ground.polygons.iter().flat_map(|polygon| &polygon.corners).map(|corner| corner.portals.len());
    assert_eq!(doors.max(), Some(32));
}
