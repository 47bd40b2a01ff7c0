//! Draws a scene: turns its clusters into screen triangles, then draws bands of rows, each on any free thread.

use crate::background::PictureBackground;
use crate::camera::PinholeCamera;
use crate::hidden::{is_hidden, sort_by_distance};
use crate::picture::{RenderError, RenderedPicture};
use crate::raster::{BatchTriangleIndex, PictureBand};
use crate::scene::RenderScene;
use crate::shade::TriangleShader;
use crate::triangle_setup::{TriangleBatch, batches_for_clusters, clusters_within};
use crate::view::ViewProjection;
use rayon::prelude::*;

/// Bands per picture: several per core, so that a crowded band does not delay the rest.
const BANDS_PER_PICTURE: usize = 16;
/// Least rows of a band: each band goes through all clusters.
const MIN_BAND_ROWS: usize = 20;
/// Clusters of the first group that is drawn; each further group has twice as many as the one before.
const FIRST_GROUP_CLUSTERS: usize = 48;

/// Draws what a camera sees. The picture is the same to the bit for any number of threads and on any machine.
///
/// # Errors
/// [`RenderError`] where the camera's numbers cannot give a picture.
pub fn render_scene(scene: &RenderScene, camera: &PinholeCamera) -> Result<RenderedPicture, RenderError> {
    camera.check_numbers()?;
    Ok(draw_view(scene, &ViewProjection::for_camera(camera), Some(scene.background)))
}

/// The same depths and ids without colours, in about a third of the time: [`RenderedPicture::rgb`] is empty.
///
/// # Errors
/// [`RenderError`] where the camera's numbers cannot give a picture.
pub fn render_ids(scene: &RenderScene, camera: &PinholeCamera) -> Result<RenderedPicture, RenderError> {
    camera.check_numbers()?;
    Ok(draw_view(scene, &ViewProjection::for_camera(camera), None))
}

/// Draws a view, with colours if a background is given, or else with depths and ids alone.
pub(crate) fn draw_view(
    scene: &RenderScene,
    view: &ViewProjection,
    background: Option<PictureBackground>,
) -> RenderedPicture {
    let (width, height) = (view.width as usize, view.height as usize);
    let mut picture = RenderedPicture {
        width: view.width,
        height: view.height,
        rgb: vec![0; background.map_or(0, |_| 3 * width * height)],
        depth_m: vec![f32::INFINITY; width * height],
        ids: vec![0; width * height],
    };
    let rows = height.div_ceil(BANDS_PER_PICTURE).max(MIN_BAND_ROWS);
    let (batches, bands) = draw_bands(scene, view, rows);
    let results = picture.depth_m.par_chunks_mut(rows * width).zip(picture.ids.par_chunks_mut(rows * width));
    results.zip(&bands).for_each(|((depth_m, ids), band)| {
        write_depths(view, band, depth_m);
        for (id, seen) in ids.iter_mut().zip(&band.seen) {
            *id = visible_id(scene, &batches, *seen);
        }
    });
    if let Some(background) = background {
        let colours = picture.rgb.par_chunks_mut(3 * rows * width);
        colours.zip(&bands).for_each(|(rgb, band)| {
            BandPainter { scene, view, background, batches: &batches, band }.paint_band(rgb);
        });
    }
    picture
}

/// Finds the nearest triangle of each pixel, in bands of `rows` rows. The clusters are drawn in groups, the nearest first, and those
/// that are hidden by the groups before are left out.
fn draw_bands(scene: &RenderScene, view: &ViewProjection, rows: usize) -> (Vec<TriangleBatch>, Vec<PictureBand>) {
    let height = view.height as usize;
    let band = |first: usize| PictureBand::new(view.width, first as u32, rows.min(height - first));
    let mut bands: Vec<PictureBand> = (0..height).step_by(rows).map(band).collect();
    let clusters = sort_by_distance(clusters_within(scene, view), view);
    let mut batches: Vec<TriangleBatch> = Vec::new();
    let (mut rest, mut group_len) = (clusters.as_slice(), FIRST_GROUP_CLUSTERS);
    while !rest.is_empty() {
        let (group, later) = rest.split_at(group_len.min(rest.len()));
        let shown: Vec<_> = group.iter().copied().filter(|cluster| !is_hidden(cluster, view, &bands)).collect();
        let from = batches.len();
        batches.extend(batches_for_clusters(scene, view, &shown));
        bands.par_iter_mut().for_each(|band| {
            band.draw_batches(&batches, from, &scene.soup.triangles);
            band.measure_tiles();
        });
        (rest, group_len) = (later, 2 * group_len);
    }
    (batches, bands)
}

/// The depth of each pixel of a band.
fn write_depths(view: &ViewProjection, band: &PictureBand, depth_m: &mut [f32]) {
    for ((depth_m, seen), &nearness) in depth_m.iter_mut().zip(&band.seen).zip(&band.nearness) {
        if *seen != BatchTriangleIndex::NO_TRIANGLE {
            *depth_m = view.depth_m(nearness);
        }
    }
}

/// The id of what a pixel shows.
fn visible_id(scene: &RenderScene, batches: &[TriangleBatch], seen: BatchTriangleIndex) -> u32 {
    if seen == BatchTriangleIndex::NO_TRIANGLE {
        0
    } else {
        scene.surfaces[batches[seen.batch as usize].surface as usize].id
    }
}

/// Gives the pixels of a band their colours, after their triangles are known.
struct BandPainter<'a> {
    scene: &'a RenderScene,
    view: &'a ViewProjection,
    background: PictureBackground,
    batches: &'a [TriangleBatch],
    band: &'a PictureBand,
}

impl BandPainter<'_> {
    /// Colours the pixels run by run: neighbours in a row that show the same triangle.
    fn paint_band(&self, rgb: &mut [u8]) {
        let width = self.band.width as usize;
        for (row, seen) in self.band.seen.chunks_exact(width).enumerate() {
            let mut start = row * width;
            for run in seen.chunk_by(|a, b| a == b) {
                let end = start + run.len();
                let place = [start - row * width, row + self.band.first_row as usize];
                let colours = rgb[3 * start..3 * end].chunks_exact_mut(3);
                if run[0] == BatchTriangleIndex::NO_TRIANGLE {
                    self.paint_background(colours, place);
                } else {
                    let shader = TriangleShader::new(self.scene, self.view, self.batches, run[0]);
                    for (column, colour) in (place[0]..).zip(colours) {
                        colour.copy_from_slice(&shader.shade_pixel(column, place[1]));
                    }
                }
                start += run.len();
            }
        }
    }

    /// Colours a run of background pixels from column `first` of a row on.
    fn paint_background<'b>(&self, colours: impl Iterator<Item = &'b mut [u8]>, [first, row]: [usize; 2]) {
        for (column, colour) in (first..).zip(colours) {
            colour.copy_from_slice(&self.background.colour_along(self.view.sin_elevation(column, row)));
        }
    }
}
