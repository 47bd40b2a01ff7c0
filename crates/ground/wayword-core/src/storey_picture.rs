//! Pictures of a storey from above, for maps.

use crate::Image;
use std::sync::Arc;

/// A picture of a storey straight from above, without perspective and to scale: +x is to the right, +y (north) is up.
#[derive(Debug, Clone)]
pub struct FromAbove {
    /// The picture.
    pub image: Arc<Image>,
    /// World x and y of its upper left corner, metres.
    pub corner_m: [f64; 2],
    /// Side of a pixel, metres.
    pub metres_per_px: f64,
}

impl FromAbove {
    /// World x and y of its lower right corner, metres.
    #[must_use]
    pub fn far_corner_m(&self) -> [f64; 2] {
        let size_m = [self.image.width_px(), self.image.height_px()].map(|px| f64::from(px) * self.metres_per_px);
        [self.corner_m[0] + size_m[0], self.corner_m[1] - size_m[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn north_is_up() {
        let image = Arc::new(Image::new(4, 2, vec![0; 24]).unwrap());
        let above = FromAbove { image, corner_m: [1.0, 5.0], metres_per_px: 0.5 };
        assert_eq!(above.far_corner_m(), [3.0, 4.0]);
    }
}
