//! Reads the photographs of a viewpoint, and makes a view in any direction from them.

use super::{
    file_reading::{self, PICTURE_HINT},
    layout::{MatterportLayout, SkyboxFiles},
    thirty_six::ThirtySixViews,
};
use glam::DMat3;
use wayword_core::{Image, PlatformError, SceneId, ViewGaze};
use wayword_render::{CubeFace, CubeMap, sample_view};
use wayword_world::connectivity::PanoramaViewpoint;

/// Width of a view, pixels.
const WIDTH_PX: u32 = 640;
/// Height of a view, pixels.
const HEIGHT_PX: u32 = 480;
/// Widest field of view of a flat picture, radians.
const MAX_FOV_RAD: f64 = 2.8;

/// The photographs of a viewpoint, in one of two forms.
pub(crate) enum ViewpointPhotographs {
    /// Six pictures around the viewpoint, and the rotation from their axes to the world frame.
    Skybox { cube: Box<CubeMap>, world_from_skybox: DMat3 },
    /// The simulator's 36 views.
    Views(ThirtySixViews),
}

impl ViewpointPhotographs {
    /// Reads a viewpoint's skybox, or else its 36 views; `None` if there are neither.
    ///
    /// # Errors
    /// If a picture of the set is missing or broken.
    pub(crate) fn read_photographs(
        layout: &MatterportLayout,
        scene: &SceneId,
        at: &PanoramaViewpoint,
    ) -> Result<Option<Self>, PlatformError> {
        if let Some(files) = layout.skybox_files(scene, &at.id) {
            return Ok(Some(Self::Skybox {
                cube: Box::new(read_cube_map(&files)?),
                world_from_skybox: at.world_from_skybox,
            }));
        }
        let views = layout.views_folder(scene, &at.id).map(|folder| ThirtySixViews::read_views(&folder)).transpose()?;
        Ok(views.map(Self::Views))
    }

    /// The picture along a gaze; `None` if the gaze is too wide or too narrow for a flat picture.
    pub(crate) fn view_along(&self, gaze: ViewGaze) -> Option<Image> {
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
            Self::Views(views) => views.sample_gaze(gaze, WIDTH_PX, HEIGHT_PX),
        };
        Image::new(WIDTH_PX, HEIGHT_PX, rgb).ok()
    }
}

fn read_cube_map(files: &SkyboxFiles) -> Result<CubeMap, PlatformError> {
    match files {
        SkyboxFiles::Strip(file) => {
            let strip = file_reading::read_picture(file)?;
            CubeMap::from_strip(strip.width_px(), strip.height_px(), strip.rgb_bytes())
                .map_err(|error| file_reading::file_error(file, error.to_string(), PICTURE_HINT))
        }
        SkyboxFiles::Faces(files) => {
            let [first, ..] = files;
            let mut faces = Vec::with_capacity(6);
            for file in files {
                let picture = file_reading::read_picture(file)?;
                faces.push(CubeFace { side_px: picture.height_px(), rgb: picture.rgb_bytes().to_vec() });
            }
            let faces = <[CubeFace; 6]>::try_from(faces)
                .map_err(|_| file_reading::file_error(first, "must have six faces", PICTURE_HINT))?;
            CubeMap::new(faces).map_err(|error| file_reading::file_error(first, error.to_string(), PICTURE_HINT))
        }
    }
}
