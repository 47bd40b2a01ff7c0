//! A house with its meshes, ready to be drawn from anywhere.

use super::{
    drawing,
    model::House,
    objects::{self, NumberedObject},
};
use std::collections::BTreeMap;
use wayword_core::{FromAbove, ViewpointGraph};
use wayword_render::{
    PictureBackground, PinholeCamera, RenderError, RenderScene, RenderedPicture, SceneError, TextureFilter,
    draw_storey, render_ids, render_scene,
};

/// A house with its meshes and the objects behind the numbers in its pictures.
#[derive(Debug)]
pub struct HouseScene {
    /// The house.
    pub house: House,
    /// All objects by their numbers.
    pub objects: BTreeMap<u32, NumberedObject>,
    scene: RenderScene,
}

impl HouseScene {
    /// Prepares a house for drawing.
    ///
    /// # Errors
    /// When a house that was edited or read from a file has something that cannot be drawn.
    pub fn new(house: House) -> Result<Self, SceneError> {
        let drawing = drawing::draw_house(&house);
        let scene = RenderScene::new(drawing.meshes, drawing.materials, drawing.textures)?
            .with_background(PictureBackground::Plain([176, 206, 232]))
            .with_filter(TextureFilter::Trilinear);
        Ok(Self { objects: objects::objects_by_id(&house), house, scene })
    }

    /// A view of the house, with the number of the object in each pixel.
    ///
    /// # Errors
    /// When the camera's numbers are not usable.
    pub fn render_picture(&self, camera: &PinholeCamera) -> Result<RenderedPicture, RenderError> {
        render_scene(&self.scene, camera)
    }

    /// The same without colours, which takes less time.
    ///
    /// # Errors
    /// When the camera's numbers are not usable.
    pub fn render_object_ids(&self, camera: &PinholeCamera) -> Result<RenderedPicture, RenderError> {
        render_ids(&self.scene, camera)
    }

    /// A storey (the lowest is 1) from above, around its viewpoints; `None` where there are none.
    ///
    /// # Errors
    /// When the viewpoints lie too far apart for a picture.
    pub fn look_down(&self, graph: &ViewpointGraph, level: u32) -> Result<Option<FromAbove>, RenderError> {
        draw_storey(&self.scene, graph, level)
    }
}
