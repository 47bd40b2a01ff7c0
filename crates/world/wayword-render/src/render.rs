//! Drawing a scene: clusters to triangles, then bands of rows, each on whatever thread is free.

use crate::background::Background;
use crate::camera::Camera;
use crate::picture::{Picture, RenderError};
use crate::raster::{Band, Seen};
use crate::scene::Scene;
use crate::setup::{Batch, batches};
use crate::shade::Shader;
use crate::view::View;
use rayon::prelude::*;

/// Bands per picture: several per core, so that a crowded one does not hold up the rest.
const BANDS: usize = 16;

/// Draws what a camera sees. The picture is the same to the bit for any number of threads and on any machine.
///
/// # Errors
/// [`RenderError`] where the camera's numbers cannot give a picture.
pub fn render(scene: &Scene, camera: &Camera) -> Result<Picture, RenderError> {
    camera.check()?;
    Ok(draw(scene, &View::of_camera(camera), scene.background))
}

pub(crate) fn draw(scene: &Scene, view: &View, background: Background) -> Picture {
    let (width, height) = (view.width as usize, view.height as usize);
    let mut picture = Picture {
        width: view.width,
        height: view.height,
        rgb: vec![0; 3 * width * height],
        depth_m: vec![f32::INFINITY; width * height],
        ids: vec![0; width * height],
    };
    let batches = batches(scene, view);
    let rows = height.div_ceil(BANDS);
    let bands = picture.rgb.par_chunks_mut(3 * rows * width);
    let bands = bands.zip(picture.depth_m.par_chunks_mut(rows * width));
    let bands = bands.zip(picture.ids.par_chunks_mut(rows * width));
    bands.enumerate().for_each(|(index, ((rgb, depth_m), ids))| {
        let mut band = Band::new(view.width, (index * rows) as u32, ids.len() / width);
        band.draw(&batches, &scene.soup.triangles);
        shade(scene, view, background, &batches, &band, Output { rgb, depth_m, ids });
    });
    picture
}

/// The pixels of one band.
struct Output<'a> {
    rgb: &'a mut [u8],
    depth_m: &'a mut [f32],
    ids: &'a mut [u32],
}

fn shade(scene: &Scene, view: &View, background: Background, batches: &[Batch], band: &Band, output: Output<'_>) {
    let width = band.width as usize;
    let mut shader: Option<(Seen, Shader<'_>)> = None;
    let pixels = output.rgb.chunks_exact_mut(3).zip(output.depth_m).zip(output.ids);
    for (index, ((rgb, depth_m), id)) in pixels.enumerate() {
        let (column, row) = (index % width, index / width + band.first_row as usize);
        let seen = band.seen[index];
        if seen == Seen::NOTHING {
            rgb.copy_from_slice(&background.colour(view.sin_elevation(column, row)));
            continue;
        }
        let ready = match shader.take() {
            Some((of, ready)) if of == seen => ready,
            _ => Shader::new(scene, view, batches, seen),
        };
        rgb.copy_from_slice(&ready.colour(column, row));
        *depth_m = view.depth_m(band.nearness[index]);
        *id = ready.id();
        shader = Some((seen, ready));
    }
}
