//! Reads the triangles of one primitive of a glTF mesh.

use super::{accessor, asset::GltfAsset};
use glam::{Vec2, Vec3};
use gltf::json::{
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};
use wayword_render::Mesh;

/// The triangles in the node's frame, without a material, with the texture coordinates of a set; `None` for points and lines.
pub(super) fn read_primitive(
    asset: &GltfAsset,
    primitive: &Primitive,
    texture_set: u32,
) -> Result<Option<Mesh>, String> {
    let Checked::Valid(mode) = primitive.mode else { return Err("has an unknown mode".to_owned()) };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(None);
    }
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let positions = attribute(Semantic::Positions).ok_or("has no positions")?;
    let positions: Vec<Vec3> = accessor::read_floats(asset, positions)?.into_iter().map(Vec3::from_array).collect();
    let (set, paint) = (attribute(Semantic::TexCoords(texture_set)), attribute(Semantic::Colors(0)));
    let uvs: Vec<Vec2> = match set {
        Some(index) => accessor::read_floats(asset, index)?.into_iter().map(Vec2::from_array).collect(),
        None => Vec::new(),
    };
    let colours = match paint {
        Some(index) => accessor::read_floats::<3>(asset, index)?,
        None => Vec::new(),
    };
    let order = match primitive.indices {
        Some(index) => accessor::read_indices(asset, index)?,
        None => {
            let count = u32::try_from(positions.len());
            (0..count.map_err(|_| format!("has {} positions, more than a mesh may have", positions.len()))?).collect()
        }
    };
    let vertices = positions.len();
    for (name, is_there, count) in [("TEXCOORD", set.is_some(), uvs.len()), ("COLOR_0", paint.is_some(), colours.len())]
    {
        if is_there && count != vertices {
            return Err(format!("{name} has {count} entries, but POSITION has {vertices}: each vertex needs one"));
        }
    }
    if let Some(vertex) = order.iter().find(|vertex| **vertex as usize >= vertices) {
        return Err(format!("its indices name vertex {vertex}, but there are {vertices}, counted from 0"));
    }
    if mode == Mode::Triangles && !order.len().is_multiple_of(3) {
        return Err(format!("its triangles have {} corners, which is no multiple of 3", order.len()));
    }
    Ok(Some(Mesh { positions, uvs, colours, triangles: triangles_from_order(mode, &order), ..Mesh::default() }))
}

/// The triangles that a list, strip or fan of vertices forms.
fn triangles_from_order(mode: Mode, order: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let winding = |(at, [a, b, c]): (usize, [u32; 3])| if at % 2 == 0 { [a, b, c] } else { [b, a, c] };
            let corners = order.windows(3).filter_map(|corners| corners.first_chunk().copied());
            corners.enumerate().map(winding).collect()
        }
        Mode::TriangleFan => {
            let Some((first, fan)) = order.split_first() else { return Vec::new() };
            fan.windows(2).filter_map(|pair| pair.first_chunk::<2>()).map(|[b, c]| [*first, *b, *c]).collect()
        }
        _ => order.as_chunks().0.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles_from_order(Mode::TriangleStrip, &[0, 1, 2, 3]), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(triangles_from_order(Mode::TriangleFan, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles_from_order(Mode::Triangles, &[0, 1, 2, 3]), [[0, 1, 2]]);
        assert!(triangles_from_order(Mode::TriangleFan, &[]).is_empty());
    }
}
