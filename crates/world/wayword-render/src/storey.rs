//! Draws a storey of a scene from above, cut open above the eye.

use crate::picture::RenderError;
use crate::scene::RenderScene;
use crate::top_down::top_down;
use glam::{DVec2, DVec3};
use std::sync::Arc;
use wayword_core::{FromAbove, Image, ViewpointGraph};

/// How far above the eye the storey is cut open, metres: this removes ceilings and the tops of doors, but keeps the
/// furniture.
const CUT_M: f64 = 0.3;
/// How far the picture reaches around the viewpoints, metres: about half a room beyond the outermost ones.
const AROUND_M: f64 = 2.0;
/// Longest side of the picture, pixels.
const MAX_STOREY_SIDE_PX: f64 = 1600.0;
/// Smallest side of a pixel, metres.
const MIN_PIXEL_M: f64 = 0.005;
/// Each pixel is the mean of this many by this many finer ones, so that edges are smooth and fine patterns do not
/// shimmer.
const FINER_PIXELS_PER_SIDE: usize = 2;

/// Draws the storey around the viewpoints of a level; `None` if the level has no viewpoints.
///
/// # Errors
/// [`RenderError`] where the viewpoints lie too far apart for a picture.
pub fn draw_storey(scene: &RenderScene, graph: &ViewpointGraph, level: u32) -> Result<Option<FromAbove>, RenderError> {
    let on_level = graph.viewpoints().filter(|viewpoint| graph.level_of(viewpoint) == Some(level));
    let mut eyes: Vec<DVec3> = on_level.filter_map(|viewpoint| graph.position_of(viewpoint)).collect();
    if eyes.is_empty() {
        return Ok(None);
    }
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for eye in &eyes {
        (low, high) = (low.min(eye.truncate()), high.max(eye.truncate()));
    }
    let (low, high) = (low - AROUND_M, high + AROUND_M);
    // The viewpoint of median height is on the floor, even if some are on stairs.
    eyes.sort_by(|a, b| a.z.total_cmp(&b.z));
    let cut_m = eyes[eyes.len() / 2].z + CUT_M;
    let metres_per_px = ((high - low).max_element() / MAX_STOREY_SIDE_PX).max(MIN_PIXEL_M);
    // Whole pixels, each made of whole finer ones.
    let size = ((high - low) / metres_per_px).floor();
    let high = low + size * metres_per_px;
    // Rounding must not add a row or a column.
    let spare = DVec2::splat(0.25 * metres_per_px / FINER_PIXELS_PER_SIDE as f64);
    let corner = DVec2::new(low.x, high.y);
    let fine_low = DVec2::new(low.x, low.y + spare.y);
    let fine_high = DVec2::new(high.x - spare.x, high.y);
    let fine = top_down(scene, fine_low, fine_high, cut_m, metres_per_px / FINER_PIXELS_PER_SIDE as f64)?;
    let (width, height) = (fine.width / FINER_PIXELS_PER_SIDE as u32, fine.height / FINER_PIXELS_PER_SIDE as u32);
    let rgb = average_squares(&fine.rgb, fine.width as usize, [width as usize, height as usize]);
    let image = Image::new(width, height, rgb);
    Ok(image.ok().map(|image| FromAbove { image: Arc::new(image), corner_m: corner.to_array(), metres_per_px }))
}

/// The means of squares of pixels.
fn average_squares(fine: &[u8], fine_width: usize, [width, height]: [usize; 2]) -> Vec<u8> {
    let mut rgb = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            for channel in 0..3 {
                let within = (0..FINER_PIXELS_PER_SIDE * FINER_PIXELS_PER_SIDE).map(|at| {
                    (
                        FINER_PIXELS_PER_SIDE * x + at % FINER_PIXELS_PER_SIDE,
                        FINER_PIXELS_PER_SIDE * y + at / FINER_PIXELS_PER_SIDE,
                    )
                });
                let sum: u32 = within.map(|(x, y)| u32::from(fine[3 * (y * fine_width + x) + channel])).sum();
                rgb.push(
                    ((sum + (FINER_PIXELS_PER_SIDE * FINER_PIXELS_PER_SIDE / 2) as u32)
                        / (FINER_PIXELS_PER_SIDE * FINER_PIXELS_PER_SIDE) as u32) as u8,
                );
            }
        }
    }
    rgb
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mesh, MeshMaterial};
    use glam::Vec3;
    use wayword_core::ViewpointId;

    /// A square of 2 m around a place.
    fn tile(x: f32, y: f32, z: f32, colour: [u8; 3]) -> Mesh {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let colour = colour.map(|channel| f32::from(channel) / 255.0);
        Mesh {
            positions: corners.map(|[dx, dy]| Vec3::new(x + dx, y + dy, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            colours: vec![colour; 4],
            id: 1,
            ..Mesh::default()
        }
    }

    fn graph(nodes: &[([f64; 3], u32)]) -> ViewpointGraph {
        let mut graph = ViewpointGraph::default();
        for (at, (place, level)) in nodes.iter().enumerate() {
            let id = ViewpointId::new(format!("v{at}")).unwrap();
            graph.add_viewpoint(id, DVec3::from_array(*place), Some(*level)).unwrap();
        }
        graph
    }

    #[test]
    fn draw_storey_leaves_out_the_ceiling() {
        // A red floor with a blue ceiling, and a green one upstairs.
        let red = tile(3.0, 1.0, 0.0, [255, 0, 0]);
        let meshes = vec![red, tile(3.0, 1.0, 2.5, [0, 0, 255]), tile(3.0, 1.0, 3.0, [0, 255, 0])];
        let scene = RenderScene::new(meshes, vec![MeshMaterial::default()], vec![]).unwrap();
        let graph = graph(&[([3.0, 1.0, 1.5], 1), ([0.5, 1.0, 1.5], 1), ([3.0, 1.0, 4.5], 2)]);
        for (level, colour) in [(1, [255, 0, 0]), (2, [0, 255, 0])] {
            let above = draw_storey(&scene, &graph, level).unwrap().unwrap();
            let at = |x: f64, y: f64| {
                let column = ((x - above.corner_m[0]) / above.metres_per_px) as usize;
                let row = ((above.corner_m[1] - y) / above.metres_per_px) as usize;
                let start = 3 * (row * above.image.width_px() as usize + column);
                [0, 1, 2].map(|channel| above.image.rgb_bytes()[start + channel])
            };
            assert_eq!([at(2.02, 0.02), at(3.98, 1.98)], [colour; 2], "level {level}");
            assert_eq!([at(1.98, 1.0), at(3.0, 2.02), at(3.0, -0.02)], [[255; 3]; 3], "level {level}");
        }
        assert!(draw_storey(&scene, &graph, 3).unwrap().is_none());
    }

    #[test]
    fn draw_storey_makes_wide_maps_coarse_and_never_too_large() {
        let scene = RenderScene::new(vec![tile(0.0, 0.0, 0.0, [9; 3])], vec![MeshMaterial::default()], vec![]).unwrap();
        for far in [0.0, 7.3, 1e3, 1e6, 1e12] {
            let above = draw_storey(&scene, &graph(&[([0.0; 3], 1), ([far, 0.3 * far, 0.0], 1)]), 1).unwrap().unwrap();
            let size = [above.image.width_px(), above.image.height_px()];
            assert!(size.iter().all(|px| (1..=1600).contains(px)), "{far}: {size:?}");
        }
        assert!(draw_storey(&scene, &graph(&[([-f64::MAX, 0.0, 0.0], 1), ([f64::MAX, 0.0, 0.0], 1)]), 1).is_err());
    }
}
