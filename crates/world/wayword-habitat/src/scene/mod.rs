//! Reads scenes as Habitat does: GLB and glTF with their textures, rotated according to the stage configuration.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod accessor;
mod asset;
mod file_kind;
mod nodes;
mod paints;
mod pictures;
mod primitive;
mod stage;
mod studio;
#[cfg(test)]
pub(crate) mod tests;

pub(crate) use asset::{EXPORT_HINT, files_beside};
pub use stage::HabitatStage;
pub(crate) use stage::{has_ending, scene_stem};

use crate::{axes::wayword_from_habitat, file_error::FileError};
use asset::GltfAsset;
use glam::{DMat3, Vec3};
use paints::SurfacePaint;
use std::{collections::BTreeMap, path::Path};
use wayword_render::{MAX_COORDINATE_M, Mesh, MeshMaterial, RenderScene, SceneError, Texture, TextureFilter};

const PLACE_HINT: &str = "correct its position or the scale of its node, or write units_to_meters into its stage_config.json if it is \
    not in metres";
const PICTURE_HINT: &str = "write its pictures as PNG or JPEG, and export the scene again";
/// Triangle corners that any file may have. There is a limit because a file can place one mesh many times.
const FREE_CORNERS: u64 = 1 << 22;
/// Further triangle corners that a file may have for each of its bytes.
const CORNERS_PER_BYTE: u64 = 64;

/// The geometry and textures of a scene, in Wayword's frame.
#[derive(Debug, Default)]
pub struct SceneModel {
    /// Triangles, grouped by material.
    pub meshes: Vec<Mesh>,
    /// The materials.
    pub materials: Vec<MeshMaterial>,
    /// The materials' textures.
    pub textures: Vec<Texture>,
    /// How each texture is looked up.
    pub filters: Vec<TextureFilter>,
}

impl SceneModel {
    /// Reads a stage's file.
    ///
    /// # Errors
    /// If it cannot be read; the message names the faulty item of the file.
    pub fn from_stage(stage: &HabitatStage) -> Result<Self, FileError> {
        Self::read_file(&stage.asset, stage.habitat_from_asset)
    }

    pub(crate) fn read_file(file: &Path, habitat_from_asset: DMat3) -> Result<Self, FileError> {
        let asset = GltfAsset::read(file)?;
        let mut builder = SceneModelBuilder::from_asset(&asset, file)?;
        builder.read_materials(file)?;
        builder.place_meshes(file, habitat_from_asset)
    }

    /// Reads a file's triangles without decoding its pictures; it checks only that their bytes are there. This takes a small
    /// part of the time and memory.
    pub(crate) fn read_shape(file: &Path, habitat_from_asset: DMat3) -> Result<Self, FileError> {
        let asset = GltfAsset::read(file)?;
        asset.check_views().map_err(|reason| FileError::new(file, reason, EXPORT_HINT))?;
        SceneModelBuilder::from_asset(&asset, file)?.place_meshes(file, habitat_from_asset)
    }

    /// The scene as Habitat draws it.
    ///
    /// # Errors
    /// [`SceneError`] names the first mesh, material or texture that cannot be drawn.
    pub fn into_drawable(self) -> Result<RenderScene, SceneError> {
        let scene = RenderScene::new(self.meshes, self.materials, self.textures)?;
        Ok(scene.with_texture_filters(&self.filters))
    }

    /// Its triangles.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.meshes.iter().flat_map(|mesh| {
            let corner = |vertex: u32| mesh.positions.get(vertex as usize).copied().unwrap_or_default();
            mesh.triangles.iter().map(move |triangle| triangle.map(corner))
        })
    }
}

/// Returns an error that names the first vertex that lies nowhere, or so far away that it cannot be drawn.
fn check_coordinates(positions: &[Vec3]) -> Result<(), String> {
    let is_far = |place: &Vec3| !place.is_finite() || place.abs().max_element() > MAX_COORDINATE_M;
    match positions.iter().enumerate().find(|(_, place)| is_far(place)) {
        None => Ok(()),
        Some((vertex, Vec3 { x, y, z })) => Err(format!(
            "vertex {vertex} lies at {x:.3e} {y:.3e} {z:.3e} m in the scene; at most {MAX_COORDINATE_M:e} m from its \
             origin can be drawn"
        )),
    }
}

/// Gives a mesh without a material colours as if it were lit in a studio, one for each face. Its faces no longer share corners.
///
/// # Errors
/// If the faces have more corners than a mesh may have.
fn light_mesh(mesh: &mut Mesh) -> Result<(), String> {
    let corner = |vertex: u32| mesh.positions.get(vertex as usize).copied().unwrap_or_default();
    let faces: Vec<[Vec3; 3]> = mesh.triangles.iter().map(|triangle| triangle.map(corner)).collect();
    let corners = u32::try_from(faces.as_flattened().len())
        .map_err(|_| format!("has {} triangles, more than a mesh without a material may have", faces.len()))?;
    mesh.triangles = (0..corners).step_by(3).map(|first| [first, first + 1, first + 2]).collect();
    mesh.colours = faces.iter().flat_map(|[a, b, c]| [studio::studio_light((*b - *a).cross(*c - *a)); 3]).collect();
    mesh.positions = faces.into_iter().flatten().collect();
    Ok(())
}

/// A model that is being read.
struct SceneModelBuilder<'a> {
    asset: &'a GltfAsset,
    model: SceneModel,
    /// The colours of each material of the file.
    paints: Vec<SurfacePaint>,
    /// Index in the model of each texture of the file.
    textures: BTreeMap<usize, usize>,
    /// The material for meshes without one.
    plain: Option<usize>,
}

impl<'a> SceneModelBuilder<'a> {
    fn from_asset(asset: &'a GltfAsset, file: &Path) -> Result<Self, FileError> {
        let paint = |(number, material)| {
            SurfacePaint::from_material(material)
                .map_err(|reason| FileError::new(file, format!("material {number}: {reason}"), EXPORT_HINT))
        };
        let paints: Result<Vec<SurfacePaint>, FileError> = asset.root.materials.iter().enumerate().map(paint).collect();
        Ok(Self { asset, model: SceneModel::default(), paints: paints?, textures: BTreeMap::new(), plain: None })
    }

    /// The triangles, placed in Wayword's frame.
    fn place_meshes(mut self, file: &Path, habitat_from_asset: DMat3) -> Result<SceneModel, FileError> {
        let asset = self.asset;
        let most_corners = FREE_CORNERS + CORNERS_PER_BYTE.saturating_mul(asset.total_bytes());
        let mut corners = 0;
        let placed = nodes::placed_meshes(&asset.root);
        for (number, place) in placed.map_err(|reason| FileError::new(file, reason, EXPORT_HINT))? {
            let mesh = asset.root.meshes.get(number);
            for (index, primitive) in mesh.iter().flat_map(|mesh| mesh.primitives.iter().enumerate()) {
                let wrong_with =
                    |reason, hint| FileError::new(file, format!("mesh {number}, primitive {index}: {reason}"), hint);
                let wrong = |reason| wrong_with(reason, EXPORT_HINT);
                let paint = primitive.material.and_then(|material| self.paints.get(material.value()));
                let texture_set = paint.map_or(0, SurfacePaint::texture_set);
                let Some(mut mesh) = primitive::read_primitive(asset, primitive, texture_set).map_err(wrong)? else {
                    continue;
                };
                corners += mesh.positions.len() as u64 + 3 * mesh.triangles.len() as u64;
                if corners > most_corners {
                    let reason =
                        format!("its meshes are placed so often that they have more than {most_corners} corners");
                    return Err(FileError::new(file, reason, EXPORT_HINT));
                }
                mesh.material = match primitive.material.map(|material| material.value()) {
                    Some(material) if material < asset.root.materials.len() => material,
                    Some(material) => return Err(wrong(format!("material {material} does not exist"))),
                    None => self.plain_material(),
                };
                self.finish_uvs(&mut mesh, primitive);
                if place.determinant() < 0.0 {
                    // A mirror turns the winding around (glTF 2.0, "Instantiation").
                    mesh.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
                }
                for position in &mut mesh.positions {
                    let placed = habitat_from_asset * place.transform_point3(position.as_dvec3());
                    *position = wayword_from_habitat(placed).as_vec3();
                }
                check_coordinates(&mesh.positions).map_err(|reason| wrong_with(reason, PLACE_HINT))?;
                if self.plain == Some(mesh.material) && mesh.colours.is_empty() {
                    light_mesh(&mut mesh).map_err(wrong)?;
                }
                self.model.meshes.push(mesh);
            }
        }
        Ok(self.model)
    }

    /// Reads the file's materials with their textures. Factors are used without conversion, because Habitat's unlit
    /// shader multiplies stored colours by them (Magnum's `FlatGL`).
    fn read_materials(&mut self, file: &Path) -> Result<(), FileError> {
        for (number, material) in self.asset.root.materials.iter().enumerate() {
            let Some(SurfacePaint { factor, texture }) = self.paints.get(number) else { continue };
            let base_colour = factor.map(|factor| if factor.is_finite() { factor.max(0.0) } else { 1.0 });
            let texture = match texture.as_ref().map(|info| info.index.value()) {
                None => None,
                Some(texture) => {
                    let wrong = |reason| FileError::new(file, format!("material {number}: {reason}"), PICTURE_HINT);
                    Some(self.texture_index(texture).map_err(wrong)?)
                }
            };
            self.model.materials.push(MeshMaterial { base_colour, texture, double_sided: material.double_sided });
        }
        Ok(())
    }

    /// Index in the model of texture `number` of the file, which is read when it is first needed.
    fn texture_index(&mut self, number: usize) -> Result<usize, String> {
        if let Some(known) = self.textures.get(&number) {
            return Ok(*known);
        }
        let (texture, filter) = pictures::read_texture(self.asset, number)?;
        self.model.textures.push(texture);
        self.model.filters.push(filter);
        let index = self.model.textures.len() - 1;
        let texels: u64 = self.model.textures.iter().map(|texture| texture.texels.len() as u64).sum();
        let most = pictures::max_total_texels(self.asset.total_bytes());
        if texels > most {
            return Err(format!("texture {number}: the pictures have more than {most} texels together"));
        }
        self.textures.insert(number, index);
        Ok(index)
    }

    /// Index of the material for meshes without one.
    fn plain_material(&mut self) -> usize {
        *self.plain.get_or_insert_with(|| {
            self.model.materials.push(MeshMaterial::default());
            self.model.materials.len() - 1
        })
    }

    /// Transforms texture coordinates according to the material. A textured mesh without coordinates shows the texture's
    /// corner.
    fn finish_uvs(&self, mesh: &mut Mesh, primitive: &gltf::json::mesh::Primitive) {
        if self.model.materials.get(mesh.material).is_none_or(|material| material.texture.is_none()) {
            mesh.uvs = Vec::new();
            return;
        }
        mesh.uvs.resize(mesh.positions.len(), glam::Vec2::ZERO);
        let paint = primitive.material.and_then(|material| self.paints.get(material.value()));
        let info = paint.and_then(|paint| paint.texture.as_ref());
        let transform = info.and_then(|info| info.extensions.as_ref()).and_then(|all| all.texture_transform.as_ref());
        let Some(transform) = transform else { return };
        let (sin, cos) = (libm::sinf(transform.rotation.0), libm::cosf(transform.rotation.0));
        let ([sx, sy], [ox, oy]) = (transform.scale.0, transform.offset.0);
        for uv in &mut mesh.uvs {
            let (u, v) = (uv.x * sx, uv.y * sy);
            *uv = glam::Vec2::new(cos * u + sin * v + ox, cos * v - sin * u + oy);
        }
    }
}
