//! The binary part of a GLB file (binary glTF), and the accessors into it: descriptions of the arrays in its bytes.

use glam::Vec3;
use serde_json::{Value, json};

/// glTF's number for components of type float.
const COMPONENT_FLOAT: u32 = 5126;
/// glTF's number for components of type unsigned int.
const UNSIGNED_INT: u32 = 5125;
/// glTF's number for buffer views with vertices.
const ARRAY_BUFFER: u32 = 34962;
/// glTF's number for buffer views with indices.
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// From the world frame (z up, y north) to glTF's (y up, -z north).
#[must_use]
pub fn gltf_from_wayword(position: Vec3) -> Vec3 {
    Vec3::new(position.x, position.z, -position.y)
}

/// Bytes with their views and accessors.
#[derive(Default)]
pub(super) struct GlbBuffer {
    pub(super) bytes: Vec<u8>,
    pub(super) views: Vec<Value>,
    pub(super) accessors: Vec<Value>,
}

impl GlbBuffer {
    /// Adds bytes; gives the index of their view.
    pub(super) fn add_view(&mut self, bytes: &[u8], target: Option<u32>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend_from_slice(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn add_accessor(&mut self, view: usize, component: u32, count: usize, kind: &str) -> usize {
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }

    /// Positions in the world frame, written in glTF's, with their bounds.
    pub(super) fn add_positions(&mut self, positions: &[Vec3]) -> usize {
        let turned: Vec<Vec3> = positions.iter().map(|position| gltf_from_wayword(*position)).collect();
        let low = turned.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = turned.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let accessor = self.add_floats(turned.iter().flat_map(|v| v.to_array()), 3);
        self.accessors[accessor]["min"] = json!(low.to_array());
        self.accessors[accessor]["max"] = json!(high.to_array());
        accessor
    }

    /// Vectors of `width` floats.
    pub(super) fn add_floats(&mut self, values: impl Iterator<Item = f32>, width: usize) -> usize {
        let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
        let view = self.add_view(&bytes, Some(ARRAY_BUFFER));
        self.add_accessor(view, COMPONENT_FLOAT, bytes.len() / 4 / width, &format!("VEC{width}"))
    }

    /// Corners of triangles.
    pub(super) fn add_indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let bytes: Vec<u8> = triangles.iter().flatten().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.add_view(&bytes, Some(ELEMENT_ARRAY_BUFFER));
        self.add_accessor(view, UNSIGNED_INT, bytes.len() / 4, "SCALAR")
    }
}
