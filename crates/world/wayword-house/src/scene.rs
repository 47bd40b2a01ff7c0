//! A house with its meshes, ready to be drawn from anywhere.

use super::{
    drawing,
    model::House,
    objects::{self, Object},
};
use std::collections::BTreeMap;
use wayword_core::{FromAbove, ViewpointGraph};
use wayword_render::{Background, Camera, Filter, Picture, RenderError, Scene, SceneError, render, render_ids, storey};

/// A house with its meshes and the objects behind the numbers in its pictures.
#[derive(Debug)]
pub struct HouseScene {
    /// The house.
    pub house: House,
    /// All objects by their numbers.
    pub objects: BTreeMap<u32, Object>,
    scene: Scene,
}

impl HouseScene {
    /// Prepares a house for drawing.
    ///
    /// # Errors
    /// When a house that was edited or read from a file has something that cannot be drawn.
    pub fn new(house: House) -> Result<Self, SceneError> {
        let drawing = drawing::draw(&house);
        let scene = Scene::new(drawing.meshes, drawing.materials, drawing.textures)?
            .with_background(Background::Plain([176, 206, 232]))
            .with_filter(Filter::Trilinear);
        Ok(Self { objects: objects::objects(&house), house, scene })
    }

    /// A view of the house, with the number of the object in each pixel.
    ///
    /// # Errors
    /// When the camera's numbers are not usable.
    pub fn picture(&self, camera: &Camera) -> Result<Picture, RenderError> {
        render(&self.scene, camera)
    }

    /// The same without colours, which takes less time.
    ///
    /// # Errors
    /// When the camera's numbers are not usable.
    pub fn ids(&self, camera: &Camera) -> Result<Picture, RenderError> {
        render_ids(&self.scene, camera)
    }

    /// A storey (the lowest is 1) from above, around its viewpoints; `None` where there are none.
    ///
    /// # Errors
    /// When the viewpoints lie too far apart for a picture.
    pub fn look_down(&self, graph: &ViewpointGraph, level: u32) -> Result<Option<FromAbove>, RenderError> {
        storey(&self.scene, graph, level)
    }
}
