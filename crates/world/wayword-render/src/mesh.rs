//! Meshes and materials, as the caller gives them: triangles with texture coordinates, baked light and a surface.

use glam::{Vec2, Vec3};

/// The surface of a mesh.
///
/// Colours are multiplied as they are stored (gamma-encoded sRGB, 1.0 = byte 255), as in Habitat's unlit shader. A factor
/// `f` for linear light is the factor `f.powf(1.0 / 2.2)` here.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshMaterial {
    /// Red, green, blue, alpha factor, each finite and not negative. Alpha is not used: everything drawn is opaque.
    pub base_colour: [f32; 4],
    /// Index into the scene's textures; `None` draws the plain base colour.
    pub texture: Option<usize>,
    /// Whether triangles seen from behind are drawn too.
    pub double_sided: bool,
}

impl Default for MeshMaterial {
    fn default() -> Self {
        Self { base_colour: [1.0; 4], texture: None, double_sided: false }
    }
}

/// Triangles of one material and one id, in world space (metres, z up).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, metres.
    pub positions: Vec<Vec3>,
    /// Texture coordinates, one per position: (0, 0) is the top left corner of the picture, v grows downwards
    /// (glTF's convention); values outside [0, 1] repeat it. May be empty where the material has no texture.
    pub uvs: Vec<Vec2>,
    /// Baked light, one multiplier per position, in the colour space of [`MeshMaterial`]; empty means 1. Values above 1
    /// brighten; the product saturates at white.
    pub colours: Vec<[f32; 3]>,
    /// Three indices into `positions` each; the front is the side from which they run counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Index into the scene's materials.
    pub material: usize,
    /// The number that is written to the id buffer; 0 counts as background there.
    pub id: u32,
}
