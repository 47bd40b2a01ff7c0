//! Maps pixels and labels of a level picture to a tilted one, and back.

use wayword_core::{DMat3, DVec3, Heading, Image, ObjectLabel};

/// Level of red, green and blue for pixels that the level picture does not cover.
pub(super) const UNREACHED_GREY_LEVEL: u8 = 128;

/// Two pinhole cameras at one place, with pictures of one size. Pixel coordinates are continuous, with (0, 0) at the
/// top left corner; camera frames are right, up, backward.
pub(super) struct TiltWarp {
    pub(super) level_from_tilted: DMat3,
    /// Tangent of half the horizontal field of view of the level picture.
    pub(super) level_tan: f64,
    /// Tangent of half the horizontal field of view of the tilted picture.
    pub(super) tilted_tan: f64,
    /// Width and height of both pictures, pixels.
    pub(super) size: [f64; 2],
}

impl TiltWarp {
    /// Maps a pixel position of the tilted picture to the level one; `None` outside it.
    pub(super) fn level_px(&self, tilted_px: [f64; 2]) -> Option<[f64; 2]> {
        let [x, y] = self.pixel_of_ray(
            self.level_from_tilted * self.ray_through_pixel(tilted_px, self.tilted_tan),
            self.level_tan,
        )?;
        let [width, height] = self.size;
        ((0.0..=width).contains(&x) && (0.0..=height).contains(&y)).then_some([x, y])
    }

    /// Maps a pixel position of the level picture to the tilted one. The result may lie outside the picture; `None` behind the camera.
    pub(super) fn tilted_px(&self, level_px: [f64; 2]) -> Option<[f64; 2]> {
        self.pixel_of_ray(self.tilted_from_level() * self.ray_through_pixel(level_px, self.level_tan), self.tilted_tan)
    }

    /// Maps a label of the level view, which looks along `ahead`, to the tilted view; `None` if the tilted view lacks it.
    pub(super) fn tilt_label(&self, label: ObjectLabel, ahead: Heading, has_picture: bool) -> Option<ObjectLabel> {
        let (sin, cos) = libm::sincos(ahead.turn_to(label.heading));
        let (up, along) = libm::sincos(label.elevation_rad);
        let [x, y] =
            self.pixel_of_ray(self.tilted_from_level() * DVec3::new(sin * along, up, -cos * along), self.tilted_tan)?;
        let [width, height] = self.size;
        if !(0.0..width).contains(&x) {
            return None;
        }
        match label.box_px.filter(|_| has_picture) {
            Some(box_px) => self.tilted_box(box_px).map(|box_px| ObjectLabel { box_px: Some(box_px), ..label }),
            None => (0.0..=height).contains(&y).then_some(ObjectLabel { box_px: None, ..label }),
        }
    }

    /// The box in the tilted picture around a box of the level one, clipped at the edge; `None` if it lies completely outside.
    pub(super) fn tilted_box(&self, [x, y, width, height]: [f64; 4]) -> Option<[f64; 4]> {
        let corners = [[x, y], [x + width, y], [x, y + height], [x + width, y + height]];
        let mut low = self.size;
        let mut high = [0.0, 0.0];
        for corner in corners {
            let tilted = self.tilted_px(corner)?;
            for axis in 0..2 {
                let within = tilted[axis].clamp(0.0, self.size[axis]);
                low[axis] = within.min(low[axis]);
                high[axis] = within.max(high[axis]);
            }
        }
        let [width, height] = [high[0] - low[0], high[1] - low[1]];
        (width > 0.0 && height > 0.0).then_some([low[0], low[1], width, height])
    }

    fn tilted_from_level(&self) -> DMat3 {
        self.level_from_tilted.transpose()
    }

    /// The ray through a pixel position, in the frame of a camera with this tangent.
    fn ray_through_pixel(&self, [x, y]: [f64; 2], tan: f64) -> DVec3 {
        let [width, height] = self.size;
        let scale = 2.0 * tan / width;
        DVec3::new((x - width / 2.0) * scale, (height / 2.0 - y) * scale, -1.0)
    }

    /// The pixel position at which a ray meets the picture of a camera with this tangent; `None` behind the camera.
    fn pixel_of_ray(&self, ray: DVec3, tan: f64) -> Option<[f64; 2]> {
        let [width, height] = self.size;
        let scale = width / (2.0 * tan * -ray.z);
        (ray.z < 0.0).then_some([width / 2.0 + ray.x * scale, height / 2.0 - ray.y * scale])
    }
}

/// The colour at a pixel position, interpolated between the four pixels around it.
pub(super) fn sample_bilinear(image: &Image, [x, y]: [f64; 2]) -> [u8; 3] {
    let [width, height] = [image.width_px(), image.height_px()].map(|side| side as usize);
    let (left, right, to_right) = neighbour_pixels(x, width);
    let (top, bottom, to_bottom) = neighbour_pixels(y, height);
    std::array::from_fn(|colour| {
        let at = |x: usize, y: usize| f64::from(image.rgb_bytes()[(y * width + x) * 3 + colour]);
        let row = |y: usize| at(left, y) + (at(right, y) - at(left, y)) * to_right;
        (row(top) + (row(bottom) - row(top)) * to_bottom + 0.5) as u8
    })
}

/// The two neighbouring pixels of a position along a line of `count` pixels, and the weight of the second one.
fn neighbour_pixels(place: f64, count: usize) -> (usize, usize, f64) {
    let place = (place - 0.5).clamp(0.0, count.saturating_sub(1) as f64);
    let first = place as usize;
    (first, (first + 1).min(count.saturating_sub(1)), place - place.floor())
}
