//! Reads the photographs of a viewpoint, and makes a view in any direction from them.

use super::{
    layout::{Layout, SkyboxFiles},
    read::{self, PICTURE_HINT},
    thirty_six::ThirtySix,
};
use glam::DMat3;
use wayword_core::{Gaze, Image, PlatformError, SceneId};
use wayword_render::{CubeMap, Face, sample_view};
use wayword_world::connectivity::Viewpoint;

const WIDTH_PX: u32 = 640;
const HEIGHT_PX: u32 = 480;
/// Widest field of view of a flat picture, radians.
const MAX_FOV_RAD: f64 = 2.8;

/// The photographs of a viewpoint, in one of two forms.
pub(crate) enum Photographs {
    Skybox { cube: Box<CubeMap>, world_from_skybox: DMat3 },
    Views(ThirtySix),
}

impl Photographs {
    /// Reads a viewpoint's skybox, or else its 36 views; `None` if there are neither.
    ///
    /// # Errors
    /// If a picture of the set is missing or broken.
    pub(crate) fn read(layout: &Layout, scene: &SceneId, at: &Viewpoint) -> Result<Option<Self>, PlatformError> {
        if let Some(files) = layout.skybox(scene, &at.id) {
            return Ok(Some(Self::Skybox { cube: Box::new(cube(&files)?), world_from_skybox: at.world_from_skybox }));
        }
        let views = layout.views(scene, &at.id).map(|folder| ThirtySix::read(&folder)).transpose()?;
        Ok(views.map(Self::Views))
    }

    /// The picture along a gaze; `None` if the gaze is too wide or too narrow for a flat picture.
    pub(crate) fn view(&self, gaze: Gaze) -> Option<Image> {
        if !(0.01..=MAX_FOV_RAD).contains(&gaze.horizontal_fov_rad) {
            return None;
        }
        let rgb = match self {
            Self::Skybox { cube, world_from_skybox } => {
                let half_width = libm::tan(gaze.horizontal_fov_rad / 2.0);
                let vertical_fov_rad = 2.0 * libm::atan(half_width * f64::from(HEIGHT_PX) / f64::from(WIDTH_PX));
                let heading_rad = gaze.heading.rad();
                sample_view(cube, world_from_skybox, heading_rad, 0.0, vertical_fov_rad, WIDTH_PX, HEIGHT_PX).ok()?
            }
            Self::Views(views) => views.sample(gaze, WIDTH_PX, HEIGHT_PX),
        };
        Image::new(WIDTH_PX, HEIGHT_PX, rgb).ok()
    }
}

fn cube(files: &SkyboxFiles) -> Result<CubeMap, PlatformError> {
    match files {
        SkyboxFiles::Strip(file) => {
            let strip = read::picture(file)?;
            CubeMap::from_strip(strip.width_px(), strip.height_px(), strip.rgb())
                .map_err(|error| read::wrong(file, error.to_string(), PICTURE_HINT))
        }
        SkyboxFiles::Faces(files) => {
            let mut faces = Vec::with_capacity(6);
            for file in files {
                let picture = read::picture(file)?;
                faces.push(Face { side_px: picture.height_px(), rgb: picture.rgb().to_vec() });
            }
            let faces = <[Face; 6]>::try_from(faces)
                .map_err(|_| read::wrong(&files[0], "must have six faces", PICTURE_HINT))?;
            CubeMap::new(faces).map_err(|error| read::wrong(&files[0], error.to_string(), PICTURE_HINT))
        }
    }
}
