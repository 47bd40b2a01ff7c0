//! A scene: its meshes, materials and textures are checked once, and can then be drawn from anywhere.

use crate::background::PictureBackground;
use crate::cluster::TriangleSoup;
use crate::mesh::{Mesh, MeshMaterial};
use crate::mipmap::MipMap;
use crate::texture::{Texture, TextureError, TextureFilter};

/// Most triangles of a scene.
pub const MAX_TRIANGLES: usize = 1 << 26;

/// Positions must not lie further from the origin than this, on any axis.
pub const MAX_COORDINATE_M: f32 = 1e6;

/// Meshes, materials and textures, checked and prepared for drawing.
#[derive(Debug)]
pub struct RenderScene {
    /// The triangles of all meshes.
    pub(crate) soup: TriangleSoup,
    /// One for each mesh.
    pub(crate) surfaces: Vec<MeshSurface>,
    pub(crate) materials: Vec<MeshMaterial>,
    pub(crate) textures: Vec<MipMap>,
    pub(crate) background: PictureBackground,
}

/// What the triangles of one mesh share.
#[derive(Clone, Debug)]
pub(crate) struct MeshSurface {
    pub(crate) id: u32,
    /// Index into the scene's materials.
    pub(crate) material: usize,
}

/// Why a scene cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// More triangles than the renderer can number.
    #[error("the scene has {triangles} triangles: at most {MAX_TRIANGLES} can be drawn")]
    TooManyTriangles {
        /// Triangles given, all meshes together.
        triangles: usize,
    },
    /// A triangle refers to a vertex that does not exist.
    #[error(
        "mesh {mesh}, triangle {triangle}: vertex {vertex} does not exist: the mesh has {vertices}, counted from 0"
    )]
    Vertex {
        /// Index of the mesh.
        mesh: usize,
        /// Index of the triangle in it.
        triangle: usize,
        /// The index it holds.
        vertex: u32,
        /// Vertices of the mesh.
        vertices: usize,
    },
    /// A list has another length than the positions.
    #[error(
        "mesh {mesh}: {field} has length {length}, but positions has length {vertices}: give one per position{or_none}"
    )]
    Length {
        /// Index of the mesh.
        mesh: usize,
        /// The list.
        field: &'static str,
        /// Its length.
        length: usize,
        /// Vertices of the mesh.
        vertices: usize,
        /// A phrase for lists that may also be empty.
        or_none: &'static str,
    },
    /// A value is NaN, infinite, or beyond its bounds.
    #[error("mesh {mesh}: {field}[{index}] must be {wanted}")]
    Value {
        /// Index of the mesh.
        mesh: usize,
        /// The list.
        field: &'static str,
        /// The entry.
        index: usize,
        /// What it should be.
        wanted: &'static str,
    },
    /// A mesh refers to a material that does not exist.
    #[error("mesh {mesh}: material {material} does not exist: the scene has {materials}, counted from 0")]
    NoMaterial {
        /// Index of the mesh.
        mesh: usize,
        /// The index it holds.
        material: usize,
        /// Materials of the scene.
        materials: usize,
    },
    /// A material refers to a texture that does not exist.
    #[error("material {material}: texture {texture} does not exist: the scene has {textures}, counted from 0")]
    NoTexture {
        /// Index of the material.
        material: usize,
        /// The index it holds.
        texture: usize,
        /// Textures of the scene.
        textures: usize,
    },
    /// A material's base colour is NaN, infinite or negative.
    #[error("material {material}: base_colour must be finite and not negative")]
    Colour {
        /// Index of the material.
        material: usize,
    },
    /// A texture's texels do not fill it.
    #[error("texture {texture} cannot be drawn")]
    Texture {
        /// Index of the texture.
        texture: usize,
        /// The reason.
        source: TextureError,
    },
}

impl RenderScene {
    /// Checks everything and prepares it for drawing: triangles are sorted into clusters that lie together.
    ///
    /// # Errors
    /// [`SceneError`] names the first mesh, material or texture that cannot be drawn.
    pub fn new(meshes: Vec<Mesh>, materials: Vec<MeshMaterial>, textures: Vec<Texture>) -> Result<Self, SceneError> {
        let triangles = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        if triangles > MAX_TRIANGLES {
            return Err(SceneError::TooManyTriangles { triangles });
        }
        for (index, texture) in textures.iter().enumerate() {
            texture.check_texels().map_err(|source| SceneError::Texture { texture: index, source })?;
        }
        for (index, material) in materials.iter().enumerate() {
            check_material(index, material, textures.len())?;
        }
        let mut soup = TriangleSoup::default();
        let mut surfaces = Vec::with_capacity(meshes.len());
        for (index, mesh) in meshes.into_iter().enumerate() {
            let no_material =
                SceneError::NoMaterial { mesh: index, material: mesh.material, materials: materials.len() };
            let material = materials.get(mesh.material).ok_or(no_material)?;
            check_mesh(index, &mesh, material.texture.is_some())?;
            soup.add_mesh(&mesh, surfaces.len() as u32);
            surfaces.push(MeshSurface { id: mesh.id, material: mesh.material });
        }
        let textures = textures.into_iter().map(|texture| MipMap::without_chain(&texture)).collect();
        Ok(Self { soup, surfaces, materials, textures, background: PictureBackground::default() })
    }

    /// The same scene with another background (the default is black).
    #[must_use]
    pub fn with_background(mut self, background: PictureBackground) -> Self {
        self.background = background;
        self
    }

    /// The same scene with another texture lookup (the default is [`TextureFilter::Bilinear`]).
    #[must_use]
    pub fn with_filter(mut self, filter: TextureFilter) -> Self {
        self.textures.iter_mut().for_each(|texture| texture.set_filter(filter));
        self
    }

    /// The same scene with a lookup for each texture, in their order. Textures without one keep theirs.
    #[must_use]
    pub fn with_texture_filters(mut self, filters: &[TextureFilter]) -> Self {
        self.textures.iter_mut().zip(filters).for_each(|(texture, filter)| texture.set_filter(*filter));
        self
    }
}

fn check_material(material: usize, given: &MeshMaterial, textures: usize) -> Result<(), SceneError> {
    if !given.base_colour.iter().all(|c| c.is_finite() && *c >= 0.0) {
        return Err(SceneError::Colour { material });
    }
    match given.texture {
        Some(texture) if texture >= textures => Err(SceneError::NoTexture { material, texture, textures }),
        _ => Ok(()),
    }
}

fn check_mesh(index: usize, mesh: &Mesh, textured: bool) -> Result<(), SceneError> {
    let vertices = mesh.positions.len();
    let check_length = |field, length: usize, may_be_empty| {
        if length == vertices || (may_be_empty && length == 0) {
            return Ok(());
        }
        let or_none = if may_be_empty { ", or none" } else { "" };
        Err(SceneError::Length { mesh: index, field, length, vertices, or_none })
    };
    check_length("uvs", mesh.uvs.len(), !textured)?;
    check_length("colours", mesh.colours.len(), true)?;
    let check_value = |field, bad: Option<usize>, wanted| match bad {
        Some(at) => Err(SceneError::Value { mesh: index, field, index: at, wanted }),
        None => Ok(()),
    };
    let far = mesh.positions.iter().position(|p| !p.is_finite() || p.abs().max_element() > MAX_COORDINATE_M);
    check_value("positions", far, "finite and within 1000 km of the origin")?;
    check_value("uvs", mesh.uvs.iter().position(|uv| !uv.is_finite()), "finite")?;
    let dark = mesh.colours.iter().position(|c| !c.iter().all(|v| v.is_finite() && *v >= 0.0));
    check_value("colours", dark, "finite and not negative")?;
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
            return Err(SceneError::Vertex { mesh: index, triangle, vertex, vertices });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec2, Vec3};

    fn mesh() -> Mesh {
        Mesh { positions: vec![Vec3::ZERO; 3], triangles: vec![[0, 1, 2]], ..Mesh::default() }
    }

    fn refusal(mesh: Mesh) -> String {
        RenderScene::new(vec![mesh], vec![MeshMaterial::default()], vec![]).unwrap_err().to_string()
    }

    #[test]
    fn scene_errors_name_the_mesh_and_the_problem() {
        let vertex = refusal(Mesh { triangles: vec![[0, 1, 2], [0, 1, 3]], ..mesh() });
        assert_eq!(vertex, "mesh 0, triangle 1: vertex 3 does not exist: the mesh has 3, counted from 0");
        let uvs = refusal(Mesh { uvs: vec![Vec2::ZERO; 2], ..mesh() });
        assert_eq!(uvs, "mesh 0: uvs has length 2, but positions has length 3: give one per position, or none");
        let material = refusal(Mesh { material: 1, ..mesh() });
        assert_eq!(material, "mesh 0: material 1 does not exist: the scene has 1, counted from 0");
        let positions = vec![Vec3::ZERO, Vec3::new(0.0, f32::NAN, 0.0), Vec3::ZERO];
        assert!(refusal(Mesh { positions, ..mesh() }).starts_with("mesh 0: positions[1] must be finite"));
        let far = vec![Vec3::ZERO, Vec3::ZERO, Vec3::new(0.0, 0.0, 1e30)];
        assert!(refusal(Mesh { positions: far, ..mesh() }).starts_with("mesh 0: positions[2]"));
        let colours = vec![[1.0; 3], [f32::INFINITY; 3], [1.0; 3]];
        assert_eq!(refusal(Mesh { colours, ..mesh() }), "mesh 0: colours[1] must be finite and not negative");
    }

    #[test]
    fn a_textured_material_needs_its_texture_and_uvs() {
        let material = MeshMaterial { texture: Some(0), ..MeshMaterial::default() };
        let texture = Texture { width: 1, height: 1, texels: vec![[9; 4]] };
        let none = RenderScene::new(vec![mesh()], vec![material.clone()], vec![]).unwrap_err();
        assert_eq!(none, SceneError::NoTexture { material: 0, texture: 0, textures: 0 });
        let bare = RenderScene::new(vec![mesh()], vec![material.clone()], vec![texture.clone()]).unwrap_err();
        assert_eq!(bare.to_string(), "mesh 0: uvs has length 0, but positions has length 3: give one per position");
        let torn = Texture { width: 1, height: 1, texels: vec![] };
        assert!(matches!(RenderScene::new(vec![], vec![], vec![torn]), Err(SceneError::Texture { texture: 0, .. })));
        let dressed = Mesh { uvs: vec![Vec2::ZERO; 3], ..mesh() };
        assert!(RenderScene::new(vec![dressed], vec![material], vec![texture]).is_ok());
    }

    #[test]
    fn empty_scenes_are_fine() {
        assert!(RenderScene::new(vec![], vec![], vec![]).is_ok());
        assert!(RenderScene::new(vec![Mesh::default()], vec![MeshMaterial::default()], vec![]).is_ok());
    }
}
