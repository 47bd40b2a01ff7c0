//! Generated houses as scans: z up, without a stage configuration and without a navmesh, as HM3D, Gibson and Matterport3D
//! ship them, and their viewpoint graphs as files in Matterport's format.

use serde_json::{Value, json};
use std::{f64::consts::FRAC_1_SQRT_2, fs, path::Path};
use wayword_core::{DVec3, ViewpointGraph, ViewpointId};
use wayword_house::{
    EYE_M, House, HouseGround, encode_glb, generate_house, semantic_glb, semantic_txt, viewpoint_graph,
};

/// The first houses of one storey.
pub(crate) fn flats() -> impl Iterator<Item = House> {
    let is_flat = |house: &House| house.rooms.iter().all(|room| room.base_cm() == house.rooms[0].base_cm());
    (0..).map(generate_house).filter(is_flat)
}

/// A house's viewpoint graph.
pub(crate) fn graph_of(house: &House) -> ViewpointGraph {
    viewpoint_graph(house, &HouseGround::for_house(house)).unwrap()
}

/// Writes a house as `NAME.glb` (or with another ending) into a folder, with its semantic files next to it.
pub(crate) fn write_scan(house: &House, folder: &Path, name: &str, ending: &str) {
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join(format!("{name}{ending}")), with_z_up(&encode_glb(house).unwrap())).unwrap();
    fs::write(folder.join(format!("{name}.semantic.glb")), with_z_up(&semantic_glb(house).unwrap())).unwrap();
    fs::write(folder.join(format!("{name}.semantic.txt")), semantic_txt(house)).unwrap();
}

/// The first viewpoint of a graph and those that are nearest to it on foot, from the nearest. The graphs of the tests include
/// no others, because a run looks from every viewpoint.
pub(crate) fn included(graph: &ViewpointGraph) -> Vec<&ViewpointId> {
    const MOST: usize = 8;
    let first = graph.viewpoints().next().unwrap();
    let mut near: Vec<_> = graph.distances_from(first).unwrap().into_iter().collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    near.into_iter().map(|(id, _)| id).take(MOST).collect()
}

/// A graph in Matterport's format, where `place` writes a position.
pub(crate) fn connectivity(graph: &ViewpointGraph, place: impl Fn(DVec3) -> DVec3) -> Value {
    let (all, included): (Vec<_>, _) = (graph.viewpoints().collect(), included(graph));
    let item = |id| {
        let open = graph.neighbours_of(id);
        let open: Vec<bool> = all.iter().map(|other| open.contains(other)).collect();
        let DVec3 { x, y, z } = place(graph.position_of(id).unwrap());
        json!({
            "image_id": id, "included": included.contains(&id), "height": EYE_M, "unobstructed": open, "visible": open,
            "pose": [0.0, -1.0, 0.0, x, 0.0, 0.0, -1.0, y, 1.0, 0.0, 0.0, z, 0.0, 0.0, 0.0, 1.0],
        })
    };
    all.iter().map(|id| item(*id)).collect()
}

/// The same GLB below a node that turns y up to z up.
fn with_z_up(glb: &[u8]) -> Vec<u8> {
    let length = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap()) as usize;
    let (text, rest) = glb[20..].split_at(length(12));
    let mut document: Value = serde_json::from_slice(text).unwrap();
    let nodes = document["nodes"].as_array_mut().unwrap();
    let root = nodes.len();
    nodes.push(
        json!({ "children": (0..root).collect::<Vec<_>>(), "rotation": [FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2] }),
    );
    document["scenes"][0]["nodes"] = json!([root]);
    let mut text = serde_json::to_vec(&document).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let size = |bytes: usize| u32::try_from(bytes).unwrap().to_le_bytes();
    let mut turned = b"glTF\x02\0\0\0".to_vec();
    turned.extend(size(20 + text.len() + rest.len()));
    turned.extend(size(text.len()));
    turned.extend(b"JSON");
    turned.extend(text);
    turned.extend(rest);
    turned
}
