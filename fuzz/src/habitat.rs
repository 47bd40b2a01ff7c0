//! Calls Habitat's readers in the same way as the program.

use crate::scratch;
use std::path::Path;
use wayword_core::{Frame, Heading, Platform, PlatformError, View, ViewGaze};
use wayword_habitat::{
    HabitatOptions, HabitatPlatform,
    scene::{HabitatStage, SceneModel},
};
use wayword_render::{PinholeCamera, RenderScene, render_scene};

/// Reads a scene's file and draws it, small.
pub fn draw(file: &Path) -> Option<()> {
    let model = SceneModel::from_stage(&HabitatStage::from_file(file).ok()?).ok()?;
    let scene = RenderScene::new(model.meshes, model.materials, model.textures).ok()?;
    let camera = PinholeCamera {
        position: wayword_core::DVec3::new(0.0, -2.0, 1.0),
        heading_rad: 0.0,
        elevation_rad: 0.0,
        vertical_fov_rad: 1.0,
        width: 16,
        height: 12,
    };
    render_scene(&scene, &camera).ok().map(drop)
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
    let scene = platform.list_scenes()?.remove(0);
    let graph = platform.graph_for_scene(&scene)?;
    let first = graph.viewpoints().next().cloned();
    let frames: Vec<Frame> = graph.path_frames(first.as_slice(), None).unwrap_or_default();
    let frame = frames.into_iter().next().ok_or(PlatformError::NotAViewpoint { scene: scene.clone() })?;
    platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH))
}
