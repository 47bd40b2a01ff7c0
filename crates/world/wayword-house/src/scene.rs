//! A house that is ready to be looked at.

use super::{
    drawing,
    model::House,
    objects::{self, Object},
};
use std::collections::BTreeMap;
use wayword_core::{FromAbove, ViewpointGraph};
use wayword_render::{Background, Camera, Filter, Picture, RenderError, Scene, SceneError, render, storey};

/// A house with its drawing and the meaning of the numbers in its pictures.
#[derive(Debug)]
pub struct HouseScene {
    /// What was drawn.
    pub house: House,
    /// Everything that has a number.
    pub objects: BTreeMap<u32, Object>,
    scene: Scene,
}

impl HouseScene {
    /// Draws up a house.
    ///
    /// # Errors
    /// When a house that was edited or read from a file holds what cannot be drawn.
    pub fn new(house: House) -> Result<Self, SceneError> {
        let drawing = drawing::draw(&house);
        let scene = Scene::new(drawing.meshes, drawing.materials, drawing.textures)?
            .with_background(Background::Plain([176, 206, 232]))
            .with_filter(Filter::Trilinear);
        Ok(Self { objects: objects::objects(&house), house, scene })
    }

    /// A view of it, with the numbers of what is seen in each pixel.
    ///
    /// # Errors
    /// When the camera's numbers are not usable.
    pub fn picture(&self, camera: &Camera) -> Result<Picture, RenderError> {
        render(&self.scene, camera)
    }

    /// A storey (the lowest is 1) from above, around its viewpoints; `None` where there are none.
    ///
    /// # Errors
    /// When the viewpoints lie too far apart for a picture.
    pub fn look_down(&self, graph: &ViewpointGraph, level: u32) -> Result<Option<FromAbove>, RenderError> {
        storey(&self.scene, graph, level)
    }
}
