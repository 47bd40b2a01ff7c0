//! A cube map, six pictures around a point, and views that are sampled from it as in the Matterport3D simulator.

use crate::camera::check_fov;
use crate::cube_row::{CubeSide, RowRays};
use crate::picture::{RenderError, check_finite, check_size};
use glam::DMat3;
use rayon::prelude::*;

/// The longest side a face may have.
const MAX_FACE_PX: u32 = 8192;
/// Rows that a thread draws at a time, at least.
const MIN_ROWS: usize = 8;

/// One side of the cube, square.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeFace {
    /// Pixels per row, and rows.
    pub side_px: u32,
    /// Gamma-encoded sRGB, three bytes per pixel, from the top left.
    pub rgb: Vec<u8>,
}

/// The six faces in Matterport3D's skybox order: 0 up, 1 to 4 around, 5 down.
#[derive(Clone, Debug, PartialEq)]
pub struct CubeMap {
    sides: [CubeSide; 6],
}

/// Why pictures do not make a cube.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CubeMapError {
    /// A face is not square, empty or too large.
    #[error(
        "face {face} has {bytes} bytes for {side_px}x{side_px} pixels: give three per pixel, side 1 to {MAX_FACE_PX}"
    )]
    Face {
        /// Index of the face.
        face: usize,
        /// Its side.
        side_px: u32,
        /// Its bytes.
        bytes: usize,
    },
    /// The strip is not six squares side by side.
    #[error("skybox strip of {width}x{height} pixels with {bytes} bytes: give six square faces side by side, in RGB")]
    Strip {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Its bytes.
        bytes: usize,
    },
}

impl CubeMap {
    /// A cube map of six checked faces.
    ///
    /// # Errors
    /// [`CubeMapError::Face`] names the first face that is no square or has the wrong number of bytes.
    pub fn new(faces: [CubeFace; 6]) -> Result<Self, CubeMapError> {
        for (index, face) in faces.iter().enumerate() {
            let side = face.side_px as usize;
            if face.side_px == 0 || face.side_px > MAX_FACE_PX || face.rgb.len() != 3 * side * side {
                let bytes = face.rgb.len();
                return Err(CubeMapError::Face { face: index, side_px: face.side_px, bytes });
            }
        }
        Ok(Self { sides: faces.map(|face| CubeSide::new(face.side_px, face.rgb)) })
    }

    /// A cube map from the faces 0 to 5 side by side (Matterport3D's `*_skybox_small.jpg`), RGB.
    ///
    /// # Errors
    /// [`CubeMapError::Strip`] where the picture is not six squares wide.
    pub fn from_strip(width: u32, height: u32, rgb: &[u8]) -> Result<Self, CubeMapError> {
        let (side, bytes) = (height as usize, rgb.len());
        let fits = (1..=MAX_FACE_PX).contains(&height) && width == 6 * height && bytes == 18 * side * side;
        if !fits {
            return Err(CubeMapError::Strip { width, height, bytes });
        }
        let side_at = |index: usize| {
            let rows = rgb.chunks_exact(18 * side);
            let part = rows.flat_map(|row| row[3 * side * index..3 * side * (index + 1)].iter().copied());
            CubeSide::new(height, part.collect())
        };
        Ok(Self { sides: std::array::from_fn(side_at) })
    }
}

/// Samples the perspective view that the Matterport3D simulator shows: RGB, three bytes per pixel, row by row.
///
/// `world_from_skybox` is the rotation of the viewpoint's pose (the upper left 3x3 of `pose`). Heading and elevation
/// are the world frame's. The cube is looked up along l = -(R^T d) for a pixel's world ray d: the simulator's own
/// shader in closed form (peteanderson80/Matterport3DSimulator, MatterSim.cpp).
///
/// # Errors
/// [`RenderError`] where the numbers cannot give a picture.
pub fn sample_view(
    cube: &CubeMap,
    world_from_skybox: &DMat3,
    heading_rad: f64,
    elevation_rad: f64,
    vertical_fov_rad: f64,
    width: u32,
    height: u32,
) -> Result<Vec<u8>, RenderError> {
    check_size(width.into(), height.into())?;
    check_finite("world_from_skybox", world_from_skybox.determinant())?;
    check_finite("heading_rad", heading_rad)?;
    check_finite("elevation_rad", elevation_rad)?;
    check_fov(vertical_fov_rad)?;
    let camera = crate::PinholeCamera {
        position: glam::DVec3::ZERO,
        heading_rad,
        elevation_rad,
        vertical_fov_rad,
        width,
        height,
    };
    let axes = -(world_from_skybox.transpose() * camera.world_from_camera());
    let (right, up, forward) = (axes.x_axis.as_vec3(), axes.y_axis.as_vec3(), -axes.z_axis.as_vec3());
    // The distance between two pixels on the image plane at distance 1.
    let pixel = (1.0 / camera.focal_px()) as f32;
    let across: Vec<f32> = (0..width).map(|x| (x as f32 + 0.5 - 0.5 * width as f32) * pixel).collect();
    let mut rgb = vec![0; 3 * width as usize * height as usize];
    rgb.par_chunks_exact_mut(3 * width as usize).with_min_len(MIN_ROWS).enumerate().for_each(|(y, row)| {
        let start = forward + up * ((0.5 * height as f32 - (y as f32 + 0.5)) * pixel);
        RowRays { start, step: right }.draw_row(&cube.sides, &across, row);
    });
    Ok(rgb)
}
