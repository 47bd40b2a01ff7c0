//! What colours a surface in an unlit picture: the texture and the factor of a glTF material.

use gltf::json::{Material, texture::Info};
use serde::Deserialize;

/// The colours of a material.
#[derive(Debug)]
pub(super) struct SurfacePaint {
    /// Red, green, blue, alpha.
    pub(super) factor: [f32; 4],
    /// The texture that the factor multiplies.
    pub(super) texture: Option<Info>,
}

/// The extension `KHR_materials_pbrSpecularGlossiness`.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct SpecularGlossiness {
    #[serde(default = "white")]
    diffuse_factor: [f32; 4],
    diffuse_texture: Option<Info>,
}

fn white() -> [f32; 4] {
    [1.0; 4]
}

impl SurfacePaint {
    /// The base colour; where a material has none, what stands for it: the diffuse colour, or the light that it emits.
    pub(super) fn from_material(material: &Material) -> Result<Self, String> {
        let base = &material.pbr_metallic_roughness;
        let factor = base.base_color_factor.0;
        let is_black = factor.iter().take(3).all(|part| *part <= 0.0);
        let is_plain = base.base_color_texture.is_none() && factor == white();
        let diffuse =
            material.extensions.as_ref().and_then(|all| all.others.get("KHR_materials_pbrSpecularGlossiness"));
        if let Some(diffuse) = diffuse.filter(|_| is_plain) {
            let diffuse = SpecularGlossiness::deserialize(diffuse)
                .map_err(|error| format!("KHR_materials_pbrSpecularGlossiness: {error}"))?;
            return Ok(Self { factor: diffuse.diffuse_factor, texture: diffuse.diffuse_texture });
        }
        let [red, green, blue] = material.emissive_factor.0;
        let emits = [red, green, blue].iter().any(|part| *part > 0.0);
        // A surface without a colour of its own shows its light. A light without a picture would not be seen on white.
        if emits && (is_black || (is_plain && material.emissive_texture.is_some())) {
            return Ok(Self { factor: [red, green, blue, 1.0], texture: material.emissive_texture.clone() });
        }
        Ok(Self { factor, texture: base.base_color_texture.clone() })
    }

    /// Number of the coordinate set that the texture uses.
    pub(super) fn texture_set(&self) -> u32 {
        let Some(info) = &self.texture else { return 0 };
        let transform = info.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
        transform.and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord)
    }
}
