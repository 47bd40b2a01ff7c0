//! Calls Habitat's readers in the same way as the program.

use crate::scratch;
use std::path::Path;
use wayword_core::{Frame, Gaze, Heading, Platform, PlatformError, View};
use wayword_habitat::{
    HabitatOptions, HabitatPlatform,
    scene::{Model, Stage},
};
use wayword_render::{Camera, Scene, render};

/// Reads a scene's file and draws it, small.
pub fn draw(file: &Path) -> Option<()> {
    let model = Model::of(&Stage::of(file).ok()?).ok()?;
    let scene = Scene::new(model.meshes, model.materials, model.textures).ok()?;
    let camera = Camera {
        position: wayword_core::DVec3::new(0.0, -2.0, 1.0),
        heading_rad: 0.0,
        elevation_rad: 0.0,
        vertical_fov_rad: 1.0,
        width: 16,
        height: 12,
    };
    render(&scene, &camera).ok().map(drop)
}

/// Draws a scene with these bytes as its only picture.
pub fn draw_picture(bytes: &[u8]) -> Option<()> {
    let folder = scratch::folder();
    scratch::write(folder.path(), "x.glb", &crate::seeds::glb::with_picture(bytes));
    draw(&folder.path().join("x.glb"))
}

/// Opens a folder of scenes as a platform, and looks from the first viewpoint of its first one.
pub fn visit(folder: &Path) -> Result<View, PlatformError> {
    let options = HabitatOptions { width_px: 16, height_px: 12, ..HabitatOptions::default() };
    let platform = HabitatPlatform::open(folder, options, std::sync::Arc::new(|_: &str| {}))?;
    let scene = platform.scenes()?.remove(0);
    let graph = platform.graph(&scene)?;
    let first = graph.viewpoints().next().cloned();
    let frames: Vec<Frame> = graph.walk(first.as_slice(), None).unwrap_or_default();
    let frame = frames.into_iter().next().ok_or(PlatformError::NotAViewpoint { scene: scene.clone() })?;
    platform.look(&scene, &frame, Gaze::quarter(Heading::NORTH))
}
