//! Tests of the reader and the writer on a navmesh of two polygons, intact and damaged.

use super::build::{TilePiece, TileSurface, single_tile};
use super::*;
use proptest::prelude::*;

/// Two squares of 1 m side by side, with a higher vertex in the middle of the second.
fn two_squares() -> NavMesh {
    let verts =
        vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, 0.0], [2.0, 0.0, 1.0], [2.0, 0.0, 0.0]];
    let flat = TilePiece {
        corners: vec![0, 1, 2, 3],
        neighbours: vec![0, 0, 2, 0],
        detail_tris: vec![[0, 1, 2, 0], [0, 2, 3, 0]],
        ..TilePiece::default()
    };
    let raised = TilePiece {
        corners: vec![3, 2, 4, 5],
        neighbours: vec![1, 0, 0, 0],
        detail_verts: vec![[1.5, 0.1, 0.5]],
        detail_tris: vec![[0, 1, 4, 0], [1, 2, 4, 0], [2, 3, 4, 0], [3, 0, 4, 0]],
    };
    let surface = TileSurface { verts, pieces: vec![flat, raised], low_m: [0.0; 3], high_m: [2.0, 0.1, 1.0] };
    let mut mesh = single_tile(&surface, NavMeshSettings::default());
    // Arbitrary bytes: a writer leaves the previous contents of its memory here.
    mesh.tiles[0].links = (0..12 * 8).map(|byte| byte as u8 ^ 0xa5).collect();
    mesh.tiles[0].detail_meshes[1].padding = [7, 9];
    mesh
}

#[test]
fn to_bytes_returns_the_bytes_that_were_read() {
    let mut bytes = two_squares().to_bytes();
    bytes.extend_from_slice(b"and more");
    let mesh = NavMesh::from_bytes(&bytes).unwrap();
    assert_eq!(mesh.polygon_count(), 2);
    assert_eq!(mesh.tiles[0].polys[0].neighbour_behind(2), EdgeNeighbour::Polygon(1));
    assert_eq!(mesh.settings().unwrap().cell_size_m, 0.05);
    assert_eq!(mesh.to_bytes(), bytes);
}

#[test]
fn recasts_own_files_have_no_settings() {
    let recast = NavMesh { settings: None, ..two_squares() };
    let bytes = recast.to_bytes();
    assert_eq!(bytes.len() + 56, two_squares().to_bytes().len());
    assert_eq!(NavMesh::from_bytes(&bytes).unwrap(), recast);
}

#[test]
fn box_tree_nodes_hold_the_number_of_nodes_to_skip() {
    let mesh = two_squares();
    let nodes = &mesh.tiles[0].bv_nodes;
    assert_eq!(nodes.iter().map(|node| node.index).collect::<Vec<_>>(), [-3, 0, 1, 0]);
    assert_eq!((nodes[0].low, nodes[0].high), ([0; 3], [40, 2, 20]));
}

#[test]
fn navmesh_errors_name_the_byte_and_the_expected_value() {
    let good = two_squares().to_bytes();
    let broken = |at: usize, with: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        NavMesh::from_bytes(&bytes).unwrap_err().to_string()
    };
    holds(&[
        (
            broken(0, b"glTF"),
            "byte 0: the file's magic number is 0x46546c67, expected 0x4d534554: not a navmesh of Habitat or Recast",
        ),
        (broken(4, &[3, 0, 0, 0]), "byte 4: the file's version is 3, expected 1 (Recast) or 2 (Habitat)"),
        (
            broken(8, &[255, 255, 255, 127]),
            "byte 8: the number of tiles is 2147483647, expected at most 4, because the file has no room for more",
        ),
        (broken(8, &[255, 255, 255, 255]), "byte 8: the number of tiles is -1, expected a count of 0 or more"),
        (
            broken(100, &[255, 255, 255, 127]),
            "byte 100: a tile's size is 2147483647, expected 100 to 456, the bytes that are left",
        ),
    ]);
    // The tile begins at 104; its polygons after 100 bytes of header and 6 vertices of 12.
    let poly = 104 + 100 + 72;
    holds(&[
        (broken(poly + 4, &[6, 0]), "byte 280: a polygon's corner is 6, expected below 6"),
        (broken(poly + 16, &[3, 0]), "byte 292: a polygon's neighbour is 3, expected at most 2"),
        (broken(poly + 30, &[7]), "byte 306: a polygon's number of corners is 7, expected 3 to 6"),
        (
            broken(204, &f32::NAN.to_le_bytes()),
            "byte 204: a vertex is NaN, expected metres within 1000 km of the origin",
        ),
    ]);
    let cut = NavMesh::from_bytes(&good[..50]).unwrap_err().to_string();
    assert!(cut.starts_with("byte 48: a number of the settings needs 4 bytes, and 2 are left"), "{cut}");
}

fn holds(pairs: &[(String, &str)]) {
    for (found, expected) in pairs {
        assert_eq!(found, expected);
    }
}

proptest! {
    #[test]
    fn navmesh_reader_survives_any_bytes(at in 0usize..600, with: [u8; 4], cut in 0usize..600) {
        let mut bytes = two_squares().to_bytes();
        for (byte, new) in bytes.iter_mut().skip(at).zip(with) {
            *byte = new;
        }
        bytes.truncate(cut.max(at));
        if let Ok(mesh) = NavMesh::from_bytes(&bytes) {
            prop_assert_eq!(mesh.to_bytes(), bytes);
            for tile in &mesh.tiles {
                for poly in 0..tile.polys.len() {
                    prop_assert!(tile.polygon_triangles(poly).iter().flatten().flatten().all(|number| number.is_finite()));
                }
            }
        }
    }
}
