//! Textures prepared for lookup, with nearest, bilinear or trilinear filtering. Outside [0, 1] they repeat.
//!
//! Trilinear filtering uses a mip chain: copies of the texture, each half as large as the one before. Far surfaces look up
//! a small copy, so that fine patterns do not shimmer.

use crate::texture::{Texture, TextureFilter};
use glam::{Vec2, Vec3};

/// Weights between texels come in this many steps, as on GPUs and in llvmpipe.
const WEIGHT_STEPS: f32 = 256.0;

/// One size of a texture.
///
/// Texels are stored in blocks of 4 x 4, a cache line each. So a lookup and those of neighbouring pixels mostly touch one
/// line, in whichever direction the texture lies in the view.
#[derive(Debug)]
struct MipLevel {
    width: u32,
    height: u32,
    blocks_per_row: usize,
    /// Red, green, blue, alpha from the lowest byte up.
    texels: Vec<u32>,
}

impl MipLevel {
    fn new(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Self {
        let blocks_per_row = width.div_ceil(4) as usize;
        let mut level = Self { width, height, blocks_per_row, texels: Vec::new() };
        level.texels.resize(16 * blocks_per_row * height.div_ceil(4) as usize, 0);
        for y in 0..height {
            for x in 0..width {
                let index = level.in_row(x as usize) + level.row_offset(y as usize);
                level.texels[index] = u32::from_le_bytes(texel(x, y));
            }
        }
        level
    }

    /// The part of a texel's index that depends on its row. The index is `row_offset(y) + in_row(x)`.
    fn row_offset(&self, y: usize) -> usize {
        (y >> 2) * self.blocks_per_row * 16 + (y & 3) * 4
    }

    /// The part of a texel's index that depends on its column.
    fn in_row(&self, x: usize) -> usize {
        (x >> 2) * 16 + (x & 3)
    }

    /// The picture at half the size. Each texel is the mean of the four under it; where a side has only one texel, that
    /// one is repeated. The mean is taken of the encoded values, as GL does for these textures.
    fn half_size(&self) -> Self {
        let texel = |x: u32, y: u32| {
            let (x, y) = (x.min(self.width - 1) as usize, y.min(self.height - 1) as usize);
            self.texels[self.in_row(x) + self.row_offset(y)].to_le_bytes()
        };
        Self::new((self.width / 2).max(1), (self.height / 2).max(1), |x, y| {
            let four = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| texel(2 * x + dx, 2 * y + dy));
            std::array::from_fn(|channel| {
                let sum: u16 = four.iter().map(|texel| u16::from(texel[channel])).sum();
                ((sum + 2) / 4) as u8
            })
        })
    }

    /// Colour of the texel that holds `uv`, repeat wrap.
    fn nearest_texel(&self, uv: Vec2) -> Vec3 {
        let at = |u: f32, side: u32| (((u - fast_floor(u)) * side as f32) as usize).min(side as usize - 1);
        let index = self.in_row(at(uv.x, self.width)) + self.row_offset(at(uv.y, self.height));
        let [red, green, blue, _] = self.texels[index].to_le_bytes();
        Vec3::new(red.into(), green.into(), blue.into())
    }

    /// Colour at `uv`, 0..=255 per channel: repeat wrap, bilinear between texel centres.
    fn bilinear_texel(&self, uv: Vec2) -> Vec3 {
        let (left, right, across) = split_coordinate(uv.x, self.width);
        let (above, below, down) = split_coordinate(uv.y, self.height);
        let (left, right) = (self.in_row(left), self.in_row(right));
        let (above, below) = (self.row_offset(above), self.row_offset(below));
        let whole = WEIGHT_STEPS as u64;
        let corners = [
            (above + left, (whole - across) * (whole - down)),
            (above + right, across * (whole - down)),
            (below + left, (whole - across) * down),
            (below + right, across * down),
        ];
        // Two channels at a time in the halves of a word: 255 x 256 x 256 fits into each.
        let (mut red_blue, mut green) = (0, 0);
        for (index, weight) in corners {
            let texel = u64::from(self.texels[index]);
            red_blue += ((texel & 0xff) | (texel & 0xff_0000) << 16) * weight;
            green += (texel >> 8 & 0xff) * weight;
        }
        let sums = [red_blue as u32 as i32, green as i32, (red_blue >> 32) as i32];
        Vec3::from(sums.map(|sum| sum as f32)) * (1.0 / (WEIGHT_STEPS * WEIGHT_STEPS))
    }
}

/// The texels on both sides of the coordinate `u` in an axis of `side` texels, and the weight of the latter.
fn split_coordinate(u: f32, side: u32) -> (usize, usize, u64) {
    // The fraction is taken first: this keeps the texel position exact for coordinates far outside [0, 1].
    let position = (u - fast_floor(u)) * side as f32 - 0.5;
    let position = if position < 0.0 { position + side as f32 } else { position };
    let whole = position as i32;
    let weight = ((position - whole as f32) * WEIGHT_STEPS + 0.5) as i32;
    let index = (whole as usize).min(side as usize - 1);
    let next = if index + 1 == side as usize { 0 } else { index + 1 };
    (index, next, weight.clamp(0, WEIGHT_STEPS as i32) as u64)
}

/// Rounds down. (`f32::floor` is a function call on the baseline x86-64; this is not.) From 2^23 on, a number has no
/// fraction.
fn fast_floor(value: f32) -> f32 {
    if value.abs() >= 8_388_608.0 {
        return value;
    }
    let whole = value as i32 as f32;
    if whole > value { whole - 1.0 } else { whole }
}

/// A texture with its mip chain; without one there is only level 0.
#[derive(Debug)]
pub(crate) struct MipMap {
    base: MipLevel,
    /// Each half as large as the one before, the first half as large as the base.
    smaller: Vec<MipLevel>,
    /// Whether lookups take the nearest texel without blending.
    is_nearest: bool,
}

impl MipMap {
    /// A checked texture without its chain.
    pub(crate) fn without_chain(texture: &Texture) -> Self {
        let texel = |x: u32, y: u32| texture.texels[y as usize * texture.width as usize + x as usize];
        let base = MipLevel::new(texture.width, texture.height, texel);
        Self { base, smaller: Vec::new(), is_nearest: false }
    }

    /// Prepares the texture for a way of looking it up.
    pub(crate) fn set_filter(&mut self, filter: TextureFilter) {
        self.is_nearest = filter == TextureFilter::Nearest;
        self.smaller.clear();
        if filter == TextureFilter::Trilinear {
            self.build_chain();
        }
    }

    /// Builds the levels down to one texel.
    fn build_chain(&mut self) {
        loop {
            let smallest = self.smaller.last().unwrap_or(&self.base);
            if smallest.width == 1 && smallest.height == 1 {
                return;
            }
            let next = smallest.half_size();
            self.smaller.push(next);
        }
    }

    /// Colour at `uv`, 0..=255 per channel. `footprint` gives the change of `uv` from a pixel to the next one to the
    /// right and below; it is called only where there are levels to choose from.
    pub(crate) fn sample_at(&self, uv: Vec2, footprint: impl FnOnce() -> [Vec2; 2]) -> Vec3 {
        if self.is_nearest {
            return self.base.nearest_texel(uv);
        }
        if self.smaller.is_empty() {
            return self.base.bilinear_texel(uv);
        }
        let size = Vec2::new(self.base.width as f32, self.base.height as f32);
        let [across, down] = footprint().map(|change| (change * size).length_squared());
        let level = 0.5 * rough_log2(across.max(down));
        if level <= 0.0 || level.is_nan() {
            return self.base.bilinear_texel(uv);
        }
        let index = level as usize;
        let sharp = if index == 0 { &self.base } else { &self.smaller[(index - 1).min(self.smaller.len() - 1)] };
        let Some(soft) = self.smaller.get(index) else { return sharp.bilinear_texel(uv) };
        let sharp = sharp.bilinear_texel(uv);
        sharp + (soft.bilinear_texel(uv) - sharp) * (level - index as f32)
    }
}

/// Base-2 logarithm to within 0.09, from the number's own bits: enough to choose a level, and the same on every
/// machine.
fn rough_log2(value: f32) -> f32 {
    value.to_bits() as f32 / 8_388_608.0 - 127.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn map(width: u32, height: u32, texels: Vec<[u8; 4]>) -> MipMap {
        MipMap::without_chain(&Texture::new(width, height, texels).unwrap())
    }

    fn checks(side: u32) -> MipMap {
        let texel = |i: u32| if (i % side + i / side).is_multiple_of(2) { [255; 4] } else { [0, 0, 0, 255] };
        map(side, side, (0..side * side).map(texel).collect())
    }

    fn at(map: &MipMap, u: f32, v: f32) -> Vec3 {
        map.sample_at(Vec2::new(u, v), || [Vec2::ZERO; 2])
    }

    #[test]
    fn texel_centres_are_exact_and_wrap_repeats() {
        let two = map(2, 1, vec![[10, 20, 30, 255], [200, 100, 0, 255]]);
        assert_eq!(at(&two, 0.25, 0.5), Vec3::new(10.0, 20.0, 30.0));
        assert_eq!(at(&two, 0.75, 0.5), Vec3::new(200.0, 100.0, 0.0));
        assert_eq!(at(&two, -0.25, 3.5), Vec3::new(200.0, 100.0, 0.0));
        assert_eq!(at(&two, 0.5, 0.5), Vec3::new(105.0, 60.0, 15.0));
        assert_eq!(at(&two, 0.0, 0.5), Vec3::new(105.0, 60.0, 15.0));
    }

    #[test]
    fn nearest_texels_are_never_blended() {
        let mut two = map(2, 1, vec![[10, 20, 30, 255], [200, 100, 0, 255]]);
        two.set_filter(TextureFilter::Nearest);
        for (u, red) in [(0.0, 10.0), (0.49, 10.0), (0.51, 200.0), (0.99, 200.0), (-0.01, 200.0), (1.01, 10.0)] {
            assert_eq!(at(&two, u, 0.3).x, red, "{u}");
        }
    }

    #[test]
    fn the_last_row_blends_into_the_first() {
        let two = map(1, 2, vec![[0; 4], [200; 4]]);
        assert_eq!(at(&two, 0.5, 1.0), Vec3::splat(100.0));
        assert_eq!(at(&two, 0.5, 0.75), Vec3::splat(200.0));
    }

    #[test]
    fn a_far_texture_turns_into_its_mean_with_mips_only() {
        let wide = || [Vec2::new(0.9, 0.0), Vec2::new(0.0, 0.9)];
        let mut map = checks(64);
        let uv = Vec2::splat(0.5 / 64.0);
        assert_eq!(map.sample_at(uv, wide), Vec3::splat(255.0));
        map.set_filter(TextureFilter::Trilinear);
        assert_eq!(map.smaller.len(), 6);
        assert!((map.sample_at(uv, wide) - Vec3::splat(128.0)).length() < 2.0);
        let near = || [Vec2::new(0.001, 0.0), Vec2::new(0.0, 0.001)];
        assert_eq!(map.sample_at(uv, near), Vec3::splat(255.0));
        let beyond = || [Vec2::new(f32::INFINITY, 0.0), Vec2::new(f32::NAN, 0.0)];
        assert!((map.sample_at(uv, beyond) - Vec3::splat(128.0)).length() < 2.0);
    }

    #[test]
    fn hostile_coordinates_stay_inside() {
        let mut map = checks(4);
        for filter in [TextureFilter::Trilinear, TextureFilter::Bilinear, TextureFilter::Nearest] {
            map.set_filter(filter);
            for u in [f32::MAX, f32::MIN, 1e-38, -1e-38, 8_388_609.0, -0.0, f32::NAN, f32::INFINITY] {
                assert!(at(&map, u, -u).is_finite());
            }
        }
    }

    proptest! {
        #[test]
        fn blocks_hold_every_texel_of_any_size(width in 1u32..40, height in 1u32..40, x: u32, y: u32) {
            let (x, y) = (x % width, y % height);
            let texels = (0..width * height).map(|i| [(i % width) as u8, (i / width) as u8, 7, 255]).collect();
            let seen = at(&map(width, height, texels), (x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32);
            prop_assert!((seen - Vec3::new(x as f32, y as f32, 7.0)).length() < 0.01);
        }
    }
}
