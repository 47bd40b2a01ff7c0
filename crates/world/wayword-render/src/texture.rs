//! Textures: storage, repeat wrap, bilinear and trilinear lookup.

use glam::{Vec2, Vec3};

/// The longest side a texture may have.
pub const MAX_TEXTURE_SIDE: u32 = 16_384;

/// An sRGB picture that is laid on triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, alpha as stored (gamma-encoded); row 0 is the top, `width * height` of them.
    pub texels: Vec<[u8; 4]>,
}

/// Why a texture cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextureError {
    /// A side is zero or too long.
    #[error("texture of {width}x{height} texels: each side must lie in 1..={MAX_TEXTURE_SIDE}")]
    Size {
        /// Texels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The texels do not fill the picture.
    #[error("texture of {width}x{height} has {texels} texels: give exactly width x height")]
    Texels {
        /// Texels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Texels given.
        texels: usize,
    },
}

impl Texture {
    /// A texture, if its sides are within bounds and filled by its texels.
    ///
    /// # Errors
    /// [`TextureError`] where they are not.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Result<Self, TextureError> {
        let texture = Self { width, height, texels };
        texture.check()?;
        Ok(texture)
    }

    pub(crate) fn check(&self) -> Result<(), TextureError> {
        let (width, height) = (self.width, self.height);
        let sides = 1..=MAX_TEXTURE_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(TextureError::Size { width, height });
        }
        if self.texels.len() != width as usize * height as usize {
            return Err(TextureError::Texels { width, height, texels: self.texels.len() });
        }
        Ok(())
    }

    /// The picture at half the size: each texel the mean of the four (at odd borders: the repeated ones) under it.
    fn halved(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let texel = |x: u32, y: u32| {
            let (x, y) = (x.min(self.width - 1), y.min(self.height - 1));
            self.texels[y as usize * self.width as usize + x as usize]
        };
        let mut texels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| texel(2 * x + dx, 2 * y + dy));
                texels.push(std::array::from_fn(|c| {
                    let sum: u16 = four.iter().map(|t| u16::from(t[c])).sum();
                    ((sum + 2) / 4) as u8
                }));
            }
        }
        Self { width, height, texels }
    }

    /// Colour at `uv`, 0..=255 per channel: repeat wrap, bilinear between texel centres.
    fn bilinear(&self, uv: Vec2) -> Vec3 {
        let (column, right) = self.split(uv.x, self.width);
        let (row, below) = self.split(uv.y, self.height);
        let next_column = if column + 1 == self.width as usize { 0 } else { column + 1 };
        let next_row = if row + 1 == self.height as usize { 0 } else { row + 1 };
        let (row, next_row) = (row * self.width as usize, next_row * self.width as usize);
        let at = |index: usize| {
            let [r, g, b, _] = self.texels[index];
            Vec3::new(f32::from(r), f32::from(g), f32::from(b))
        };
        let top = mix(at(row + column), at(row + next_column), right);
        let bottom = mix(at(next_row + column), at(next_row + next_column), right);
        mix(top, bottom, below)
    }

    /// The texel at or before the coordinate `u` in an axis of `side` texels, and the weight of the one after it.
    fn split(&self, u: f32, side: u32) -> (usize, f32) {
        // The fraction first: it keeps the texel position exact for coordinates far outside [0, 1].
        let position = (u - floor(u)) * side as f32 - 0.5;
        let position = if position < 0.0 { position + side as f32 } else { position };
        let index = (position as usize).min(side as usize - 1);
        (index, position - index as f32)
    }
}

/// `f32::floor` is a function call on the baseline x86-64; this is not.
fn floor(value: f32) -> f32 {
    if value.abs() >= 8_388_608.0 {
        return value;
    }
    let whole = value as i32 as f32;
    if whole > value { whole - 1.0 } else { whole }
}

fn mix(from: Vec3, to: Vec3, weight: f32) -> Vec3 {
    from + (to - from) * weight
}

/// A texture with its mip chain; without one there is only level 0.
#[derive(Debug)]
pub(crate) struct MipMap {
    levels: Vec<Texture>,
}

impl MipMap {
    pub(crate) fn plain(texture: Texture) -> Self {
        Self { levels: vec![texture] }
    }

    /// Builds the levels down to one texel; averages are taken of the encoded values, as GL does for such textures.
    pub(crate) fn build_chain(&mut self) {
        while let Some(smallest) = self.levels.last() {
            if smallest.width == 1 && smallest.height == 1 {
                break;
            }
            let next = smallest.halved();
            self.levels.push(next);
        }
    }

    pub(crate) fn drop_chain(&mut self) {
        self.levels.truncate(1);
    }

    /// Colour at `uv`, 0..=255 per channel. `footprint` gives the change of `uv` from a pixel to the next one to the
    /// right and below; it is asked only where there are levels to choose from.
    pub(crate) fn sample(&self, uv: Vec2, footprint: impl FnOnce() -> [Vec2; 2]) -> Vec3 {
        let base = &self.levels[0];
        if self.levels.len() == 1 {
            return base.bilinear(uv);
        }
        let size = Vec2::new(base.width as f32, base.height as f32);
        let [across, down] = footprint().map(|d| (d * size).length_squared());
        let level = 0.5 * log2(across.max(down));
        let last = self.levels.len() - 1;
        if level <= 0.0 || level.is_nan() {
            return base.bilinear(uv);
        }
        if level >= last as f32 {
            return self.levels[last].bilinear(uv);
        }
        let index = level as usize;
        mix(self.levels[index].bilinear(uv), self.levels[index + 1].bilinear(uv), level - index as f32)
    }
}

/// Base-2 logarithm to within 0.09, from the number's own bits: enough to choose a level, and alike on every machine.
fn log2(value: f32) -> f32 {
    value.to_bits() as f32 / 8_388_608.0 - 127.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checks(side: u32) -> Texture {
        let texel = |i: u32| if (i % side + i / side).is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
        Texture::new(side, side, (0..side * side).map(texel).collect()).unwrap()
    }

    #[test]
    fn refuses_wrong_sizes() {
        assert_eq!(Texture::new(0, 1, vec![]), Err(TextureError::Size { width: 0, height: 1 }));
        assert_eq!(
            Texture::new(u32::MAX, u32::MAX, vec![]).map_err(|e| matches!(e, TextureError::Size { .. })),
            Err(true)
        );
        assert_eq!(Texture::new(2, 2, vec![[0; 4]; 3]), Err(TextureError::Texels { width: 2, height: 2, texels: 3 }));
    }

    #[test]
    fn texel_centres_are_exact_and_wrap_repeats() {
        let texture = Texture::new(2, 1, vec![[10, 20, 30, 255], [200, 100, 0, 255]]).unwrap();
        assert_eq!(texture.bilinear(Vec2::new(0.25, 0.5)), Vec3::new(10.0, 20.0, 30.0));
        assert_eq!(texture.bilinear(Vec2::new(0.75, 0.5)), Vec3::new(200.0, 100.0, 0.0));
        assert_eq!(texture.bilinear(Vec2::new(-0.25, 3.5)), Vec3::new(200.0, 100.0, 0.0));
        assert_eq!(texture.bilinear(Vec2::new(0.5, 0.5)), Vec3::new(105.0, 60.0, 15.0));
        assert_eq!(texture.bilinear(Vec2::new(0.0, 0.5)), Vec3::new(105.0, 60.0, 15.0));
    }

    #[test]
    fn the_last_row_blends_into_the_first() {
        let texture = Texture::new(1, 2, vec![[0; 4], [200; 4]]).unwrap();
        assert_eq!(texture.bilinear(Vec2::new(0.5, 1.0)), Vec3::splat(100.0));
        assert_eq!(texture.bilinear(Vec2::new(0.5, 0.75)), Vec3::splat(200.0));
    }

    #[test]
    fn a_far_texture_turns_into_its_mean_with_mips_only() {
        let wide = || [Vec2::new(0.9, 0.0), Vec2::new(0.0, 0.9)];
        let mut map = MipMap::plain(checks(64));
        let uv = Vec2::splat(0.5 / 64.0);
        assert_eq!(map.sample(uv, wide), Vec3::splat(255.0));
        map.build_chain();
        assert_eq!(map.levels.len(), 7);
        assert!((map.sample(uv, wide) - Vec3::splat(128.0)).length() < 2.0);
        let near = || [Vec2::new(0.001, 0.0), Vec2::new(0.0, 0.001)];
        assert_eq!(map.sample(uv, near), Vec3::splat(255.0));
    }

    #[test]
    fn hostile_coordinates_stay_inside() {
        let texture = checks(4);
        for u in [f32::MAX, f32::MIN, 1e-38, -1e-38, 8_388_609.0, -0.0] {
            assert!(texture.bilinear(Vec2::new(u, -u)).is_finite());
        }
    }
}
