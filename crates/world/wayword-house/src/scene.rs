//! A house with its meshes, ready to be drawn from anywhere.

use super::{
    drawing,
    model::House,
    objects::{self, NumberedObject},
};
use std::{collections::BTreeMap, sync::OnceLock};
use wayword_core::{FromAbove, ViewpointGraph};
use wayword_render::{
    MeshMaterial, PictureBackground, PinholeCamera, RenderError, RenderScene, RenderedPicture, SceneError,
    TextureFilter, draw_storey, render_ids, render_scene,
};

/// A house with its meshes and the objects behind the numbers in its pictures.
///
/// It has two drawings of the same surfaces. One has few triangles and no light, for object numbers and depths. The other has the
/// light and the textures of pictures, which take most of the time to make, so it is made for the first picture.
#[derive(Debug)]
pub struct HouseScene {
    /// The house.
    pub house: House,
    /// All objects by their numbers.
    pub objects: BTreeMap<u32, NumberedObject>,
    surfaces: RenderScene,
    lit: OnceLock<Result<RenderScene, SceneError>>,
}

/// Why a picture of a house cannot be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HousePictureError {
    /// The house has something that cannot be drawn.
    #[error(transparent)]
    House(#[from] SceneError),
    /// The numbers of the camera or the map are not usable.
    #[error(transparent)]
    Camera(#[from] RenderError),
}

impl HouseScene {
    /// Prepares a house for drawing.
    ///
    /// # Errors
    /// When a house that was edited or read from a file has something that cannot be drawn.
    pub fn new(house: House) -> Result<Self, SceneError> {
        let mut surfaces = drawing::build_surfaces(&house);
        surfaces.iter_mut().for_each(|mesh| mesh.material = 0);
        let surfaces = RenderScene::new(surfaces, vec![MeshMaterial::default()], Vec::new())?;
        Ok(Self { objects: objects::objects_by_id(&house), house, surfaces, lit: OnceLock::new() })
    }

    /// The scene of pictures.
    fn lit_scene(&self) -> Result<&RenderScene, SceneError> {
        let build_lit = || {
            let drawing = drawing::draw_house(&self.house);
            let scene = RenderScene::new(drawing.meshes, drawing.materials, drawing.textures)?;
            let sky = PictureBackground::Plain([176, 206, 232]);
            Ok(scene.with_background(sky).with_filter(TextureFilter::Trilinear))
        };
        self.lit.get_or_init(build_lit).as_ref().map_err(Clone::clone)
    }

    /// A view of the house, with the number of the object in each pixel.
    ///
    /// # Errors
    /// When the camera's numbers are not usable, or the house has something that cannot be drawn.
    pub fn render_picture(&self, camera: &PinholeCamera) -> Result<RenderedPicture, HousePictureError> {
        Ok(render_scene(self.lit_scene()?, camera)?)
    }

    /// The same without colours, in a small part of the time.
    ///
    /// # Errors
    /// When the camera's numbers are not usable.
    pub fn render_object_ids(&self, camera: &PinholeCamera) -> Result<RenderedPicture, RenderError> {
        render_ids(&self.surfaces, camera)
    }

    /// A storey (the lowest is 1) from above, around its viewpoints; `None` where there are none.
    ///
    /// # Errors
    /// When the viewpoints lie too far apart for a picture, or the house has something that cannot be drawn.
    pub fn look_down(&self, graph: &ViewpointGraph, level: u32) -> Result<Option<FromAbove>, HousePictureError> {
        Ok(draw_storey(self.lit_scene()?, graph, level)?)
    }
}
