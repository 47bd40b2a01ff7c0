//! Small semantic files. The first byte says which file the rest is.

use super::glb;

/// HM3D's list of colours.
pub const ANNOTATIONS: &[u8] = b"HM3D Semantic Annotations\n1,FF0000,\"sofa\",0\n2,00FF00,\"table, round\",0\n";
/// Matterport3D's list of objects.
pub const HOUSE: &[u8] = b"ASCII 1.0\n\
    R 0 0 0 0 l 0 0 0 -9 -9 0 9 9 3 3 0 0 0\n\
    R 1 0 0 0 b 0 0 0 -1 -1 0 1 1 3 3 0 0 0\n\
    O 0 0 0 0 0 0\nO 1 0 1 0 0 0\nC 0 1 sofa\nC 1 2 coffee#table\n";

/// Matterport3D's mesh with numbered faces.
pub fn ply() -> Vec<u8> {
    let mut file =
        b"ply\nformat binary_little_endian 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\n\
        property int object_id\nend_header\n"
            .to_vec();
    for (x, z) in [(0.0_f32, 0.0_f32), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)] {
        file.extend([x, 1.5, z].iter().flat_map(|number| number.to_le_bytes()));
        file.push(7);
    }
    for (corners, object) in [(&[0_i32, 1, 2, 3][..], 0_i32), (&[2, 1, 0], 1)] {
        file.push(corners.len() as u8);
        file.extend(corners.iter().chain([&object]).flat_map(|number| number.to_le_bytes()));
    }
    file
}

/// One of each: annotations, a painted mesh, objects, a numbered mesh.
pub fn all() -> Vec<Vec<u8>> {
    let files = [ANNOTATIONS.to_vec(), glb::binaries().remove(0), HOUSE.to_vec(), ply()];
    (0..).zip(files).map(|(which, file)| [vec![which], file].concat()).collect()
}
