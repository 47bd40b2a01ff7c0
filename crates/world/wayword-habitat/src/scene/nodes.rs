//! Flattens the node tree of a glTF scene into a list of meshes with their transforms.

use glam::{DMat4, DQuat, DVec3};
use gltf::json::{Root, scene::Node};

/// Every mesh of the scene with its transform into the file's frame. A node that is reached twice is skipped, so that a
/// cycle ends; glTF does not allow cycles.
pub(super) fn placed_meshes(root: &Root) -> Vec<(usize, DMat4)> {
    let mut seen = vec![false; root.nodes.len()];
    let first = root.scene.map_or(0, |scene| scene.value());
    let mut pending: Vec<(usize, DMat4)> = match root.scenes.get(first) {
        Some(scene) => scene.nodes.iter().rev().map(|node| (node.value(), DMat4::IDENTITY)).collect(),
        // If a file has no scenes, all nodes without a parent are shown.
        None => root_nodes(root).into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect(),
    };
    let mut placed = Vec::new();
    while let Some((index, above)) = pending.pop() {
        let (Some(node), Some(seen)) = (root.nodes.get(index), seen.get_mut(index)) else { continue };
        if std::mem::replace(seen, true) {
            continue;
        }
        let here = above * local_transform(node);
        if let Some(mesh) = node.mesh {
            placed.push((mesh.value(), here));
        }
        pending.extend(node.children.iter().flatten().rev().map(|child| (child.value(), here)));
    }
    placed
}

/// The nodes without a parent.
fn root_nodes(root: &Root) -> Vec<usize> {
    let mut has_parent = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(has_parent) = has_parent.get_mut(child.value()) {
            *has_parent = true;
        }
    }
    has_parent.iter().enumerate().filter(|(_, has_parent)| !**has_parent).map(|(node, _)| node).collect()
}

/// The transform from a node's frame into that of its parent.
fn local_transform(node: &Node) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |given: Option<[f32; 3]>, default: DVec3| given.map_or(default, |v| DVec3::from(v.map(f64::from)));
    let rotation =
        node.rotation.map_or(DQuat::IDENTITY, |rotation| DQuat::from_array(rotation.0.map(f64::from)).normalize());
    DMat4::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    )
}
