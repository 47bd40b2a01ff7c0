//! Draws maps: a scene seen straight from above, cut open at a height.

use crate::background::PictureBackground;
use crate::picture::{RenderError, RenderedPicture, check_finite, check_size};
use crate::render::draw_view;
use crate::scene::RenderScene;
use crate::view::ViewProjection;
use glam::{DVec2, DVec3};

/// The background of a map.
const PAPER_BACKGROUND: PictureBackground = PictureBackground::Plain([255; 3]);

/// Draws the scene from straight above, without perspective: +x to the right, +y up. Everything higher than
/// `cut_height_m` is cut away. The top left corner of the picture is (`bounds_min.x`, `bounds_max.y`); the sides are
/// rounded up to whole pixels, so the world point (x, y) falls on the pixel position
/// ((x - bounds_min.x) / metres_per_pixel, (bounds_max.y - y) / metres_per_pixel). Depths count from the cut down.
///
/// # Errors
/// [`RenderError`] where the bounds are empty or not finite, or give a picture of too many pixels.
pub fn top_down(
    scene: &RenderScene,
    bounds_min: DVec2,
    bounds_max: DVec2,
    cut_height_m: f64,
    metres_per_pixel: f64,
) -> Result<RenderedPicture, RenderError> {
    check_finite("cut_height_m", cut_height_m)?;
    check_finite("bounds_min.x", bounds_min.x)?;
    check_finite("bounds_min.y", bounds_min.y)?;
    if !(metres_per_pixel.is_finite() && metres_per_pixel > 0.0) {
        let (field, wanted) = ("metres_per_pixel", "finite and positive");
        return Err(RenderError::Number { field, value: metres_per_pixel, wanted });
    }
    let size = (bounds_max - bounds_min) / metres_per_pixel;
    // Casting saturates, and NaN and negative sizes become 0. `check_size` refuses all of these.
    let (width, height) = (size.x.ceil() as u64, size.y.ceil() as u64);
    check_size(width, height)?;
    let half = DVec2::new(width as f64, -(height as f64)) * (0.5 * metres_per_pixel);
    let centre = DVec2::new(bounds_min.x, bounds_max.y) + half;
    let origin = DVec3::new(centre.x, centre.y, cut_height_m);
    let view = ViewProjection::for_map(origin, 1.0 / metres_per_pixel, [width as u32, height as u32]);
    Ok(draw_view(scene, &view, Some(PAPER_BACKGROUND)))
}
