//! Flattens the node tree of a glTF scene into a list of meshes with their transforms.

use glam::{DMat4, DQuat, DVec3};
use gltf::json::{Root, scene::Node};

/// Every mesh of the scene with its transform into the file's frame. A node that is reached twice is skipped, so that a
/// cycle ends; glTF does not allow cycles.
///
/// # Errors
/// Names the scene, node or mesh that does not exist, and what refers to it.
pub(super) fn placed_meshes(root: &Root) -> Result<Vec<(usize, DMat4)>, String> {
    let mut seen = vec![false; root.nodes.len()];
    let first = root.scene.map_or(0, |scene| scene.value());
    let top = match root.scenes.get(first) {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        // If a file has no scenes, all nodes without a parent are shown.
        None if root.scenes.is_empty() => root_nodes(root),
        None => return Err(missing("scene", first, root.scenes.len())),
    };
    let absent = top.iter().find(|node| **node >= root.nodes.len());
    if let Some(node) = absent {
        return Err(format!("scene {first}: {}", missing("node", *node, root.nodes.len())));
    }
    let mut pending: Vec<(usize, DMat4)> = top.into_iter().rev().map(|node| (node, DMat4::IDENTITY)).collect();
    let mut placed = Vec::new();
    while let Some((index, above)) = pending.pop() {
        let (Some(node), Some(seen)) = (root.nodes.get(index), seen.get_mut(index)) else { continue };
        if std::mem::replace(seen, true) {
            continue;
        }
        let here = above * local_transform(node);
        let wrong = |reason| format!("node {index}: {reason}");
        if let Some(mesh) = node.mesh.map(|mesh| mesh.value()) {
            if mesh >= root.meshes.len() {
                return Err(wrong(missing("mesh", mesh, root.meshes.len())));
            }
            placed.push((mesh, here));
        }
        let children = || node.children.iter().flatten().map(|child| child.value());
        if let Some(child) = children().find(|child| *child >= root.nodes.len()) {
            return Err(wrong(missing("node", child, root.nodes.len())));
        }
        pending.extend(children().rev().map(|child| (child, here)));
    }
    Ok(placed)
}

/// The fault of a number that is not in a list of the file.
fn missing(what: &str, number: usize, count: usize) -> String {
    format!("{what} {number} does not exist: the file has {count}, counted from 0")
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
