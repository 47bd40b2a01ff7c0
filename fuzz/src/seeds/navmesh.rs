//! Small navmeshes.

use wayword_habitat::{NavMeshSettings, bake::bake_navmesh, scene::SceneModel};
use wayword_render::Mesh;

/// A floor of 4 x 3 m with a table in its middle, baked.
pub fn baked() -> Vec<u8> {
    let mut mesh = Mesh::default();
    let mut quad = |corners: [[f32; 3]; 4]| {
        let first = mesh.positions.len() as u32;
        corners.into_iter().for_each(|corner| mesh.positions.push(corner.into()));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    };
    quad([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [0.0, 3.0, 0.0]]);
    quad([[1.5, 1.0, 0.8], [2.5, 1.0, 0.8], [2.5, 2.0, 0.8], [1.5, 2.0, 0.8]]);
    let model = SceneModel { meshes: vec![mesh], ..SceneModel::default() };
    bake_navmesh(&model, &NavMeshSettings::default()).expect("a navmesh").to_bytes()
}

/// A square metre at a tile's place. Its four edges lead into the tiles around it, and detail raises its second half.
fn tile(place: [i32; 2], reference: u32) -> Vec<u8> {
    let (x, z) = (place[0] as f32, place[1] as f32);
    let verts = [[x, 0.0, z], [x, 0.0, z + 1.0], [x + 1.0, 0.0, z + 1.0], [x + 1.0, 0.0, z]];
    let mut bytes = Vec::new();
    let ints = |bytes: &mut Vec<u8>, all: &[i32]| bytes.extend(all.iter().flat_map(|number| number.to_le_bytes()));
    let floats = |bytes: &mut Vec<u8>, all: &[f32]| bytes.extend(all.iter().flat_map(|number| number.to_le_bytes()));
    ints(&mut bytes, &[0x444E_4156, 7, place[0], place[1], 0, 0, 1, 4, 0, 1, 1, 4, 0, 0, 1]);
    floats(&mut bytes, &[1.5, 0.1, 0.2, x, 0.0, z, x + 1.0, 0.2, z + 1.0, 20.0]);
    verts.iter().for_each(|vert| floats(&mut bytes, vert));
    ints(&mut bytes, &[-1]);
    // Portals to -x, +z, +x and -z, with Detour's numbers of the sides.
    for corner in [0_u16, 1, 2, 3, 0, 0, 0x8004, 0x8002, 0x8000, 0x8006, 0, 0, 1] {
        bytes.extend(corner.to_le_bytes());
    }
    bytes.extend([4, 0]);
    ints(&mut bytes, &[0, 0]);
    bytes.extend([1, 4, 0, 0]);
    floats(&mut bytes, &[x + 0.5, 0.1, z + 0.5]);
    bytes.extend([[0, 1, 4, 0], [1, 2, 4, 0], [2, 3, 4, 0], [3, 0, 4, 0]].concat());
    [reference.to_le_bytes().to_vec(), (bytes.len() as u32).to_le_bytes().to_vec(), bytes].concat()
}

/// Four tiles around a corner, as Recast's own demo writes them (version 1).
pub fn tiled() -> Vec<u8> {
    let mut bytes = Vec::new();
    for number in [0x4D53_4554_i32, 1, 4] {
        bytes.extend(number.to_le_bytes());
    }
    for number in [0.0_f32, 0.0, 0.0, 1.0, 1.0] {
        bytes.extend(number.to_le_bytes());
    }
    for number in [4_i32, 16] {
        bytes.extend(number.to_le_bytes());
    }
    for (number, place) in [[0, 0], [1, 0], [0, 1], [1, 1]].into_iter().enumerate() {
        bytes.extend(tile(place, 1 << 4 | number as u32));
    }
    bytes
}

/// Both kinds.
pub fn all() -> Vec<Vec<u8>> {
    vec![baked(), tiled()]
}
