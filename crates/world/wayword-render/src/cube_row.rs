//! Draws one row of a view of a cube map, fast.
//!
//! The rays of a row are evenly spaced, so all coordinates of the lookup are linear in the column as long as the rays meet
//! the same face. The work is done for some columns at a time, in loops without branches, which compilers turn into
//! vector instructions.

use glam::Vec3;

/// Columns that are worked on at a time.
const COLUMNS_PER_STEP: usize = 64;

/// 2^23. A number from 0 up to this loses its fraction when this is added to it, because a float has 23 bits for it: the low
/// bits of the sum are then the nearest whole number.
const WHOLE_NUMBER_OFFSET: f32 = 8_388_608.0;

/// One side of the cube, prepared for lookups.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CubeSide {
    /// Pixels per row, and rows: at least two, so that every place lies between two pixels.
    side_px: usize,
    /// Three bytes per pixel, from the top left, and two more at the end, so that eight bytes can be read at any pair of pixels.
    rgb: Vec<u8>,
}

impl CubeSide {
    /// `rgb` is checked: three bytes for each pixel of a square that is not empty. A side of one pixel becomes 2 x 2 equal ones.
    pub(crate) fn new(side_px: u32, rgb: Vec<u8>) -> Self {
        let (side_px, mut rgb) = match side_px as usize {
            1 => (2, rgb.repeat(4)),
            side_px => (side_px, rgb),
        };
        rgb.reserve_exact(2);
        rgb.extend([0; 2]);
        Self { side_px, rgb }
    }

    /// The pixel at a byte and its neighbour on the right, each in the lowest three bytes.
    fn pixel_pair(&self, start: usize) -> [u32; 2] {
        let eight = self.rgb[start..].first_chunk().copied().unwrap_or_default();
        let both = u64::from_le_bytes(eight);
        [both as u32, (both >> 24) as u32]
    }

    /// The four pixels from the one at a column and a row on: left and right in that row, left and right in the next.
    fn four_pixels(&self, [x, y]: [u32; 2]) -> [u32; 4] {
        let row = 3 * self.side_px;
        let start = y as usize * row + 3 * x as usize;
        let ([a, b], [c, d]) = (self.pixel_pair(start), self.pixel_pair(start + row));
        [a, b, c, d]
    }
}

/// The rays of a row of pixels, in GL's cube frame: `start + step * across`.
pub(crate) struct RowRays {
    pub(crate) start: Vec3,
    pub(crate) step: Vec3,
}

impl RowRays {
    /// Draws the row: three bytes for each of the columns, which lie at `across`.
    pub(crate) fn draw_row(&self, sides: &[CubeSide; 6], across: &[f32], row: &mut [u8]) {
        for (across, row) in across.chunks(COLUMNS_PER_STEP).zip(row.chunks_mut(3 * COLUMNS_PER_STEP)) {
            let met: [u32; COLUMNS_PER_STEP] = self.sides_met(across);
            let mut from = 0;
            for run in met[..across.len()].chunk_by(|a, b| a == b) {
                let (to, side) = (from + run.len(), &sides[run[0] as usize]);
                let rays = [self.start, self.step].map(|ray| to_side_axes(run[0], ray));
                RayLandings::new(side.side_px, rays, &across[from..to]).draw_columns(side, &mut row[3 * from..3 * to]);
                from = to;
            }
        }
    }

    /// For each ray the side of the cube that it meets.
    fn sides_met(&self, across: &[f32]) -> [u32; COLUMNS_PER_STEP] {
        let mut met = [0; COLUMNS_PER_STEP];
        for (met, across) in met.iter_mut().zip(across) {
            let [x, y, z] = (self.start + self.step * *across).to_array();
            let side_x = if x >= 0.0 { 2 } else { 4 };
            let side_y = if y >= 0.0 { 0 } else { 5 };
            let side_z = if z >= 0.0 { 1 } else { 3 };
            let (x, y, z) = (x.abs(), y.abs(), z.abs());
            let side_yz = if y >= z { side_y } else { side_z };
            *met = if (x >= y) & (x >= z) { side_x } else { side_yz };
        }
        met
    }
}

/// A ray in a side's own axes: across the side, down it, and towards it, as in GL's cube lookup. +X is side 2, -X 4, +Y 0,
/// -Y 5, +Z 1 and -Z 3.
fn to_side_axes(side: u32, Vec3 { x, y, z }: Vec3) -> [f32; 3] {
    match side {
        0 => [x, z, y],
        1 => [x, -y, z],
        2 => [-z, -y, x],
        3 => [-x, -y, -z],
        4 => [z, -y, -x],
        _ => [x, -z, -y],
    }
}

/// The places where the rays of some columns meet a side: for each the pixel to its upper left, and its distances from that
/// pixel's centre to the right and down, where 1 is the centre of the next pixel.
struct RayLandings {
    columns: usize,
    left: [u32; COLUMNS_PER_STEP],
    above: [u32; COLUMNS_PER_STEP],
    right: [f32; COLUMNS_PER_STEP],
    down: [f32; COLUMNS_PER_STEP],
}

impl RayLandings {
    fn new(side_px: usize, [start, step]: [[f32; 3]; 2], across: &[f32]) -> Self {
        let mut places = Self {
            columns: across.len(),
            left: [0; COLUMNS_PER_STEP],
            above: [0; COLUMNS_PER_STEP],
            right: [0.0; COLUMNS_PER_STEP],
            down: [0.0; COLUMNS_PER_STEP],
        };
        let (side, last) = (side_px as f32, (side_px - 1) as f32);
        let split = |place: f32| {
            let at = place * side - 0.5;
            // Not by `clamp`: NaN becomes 0 here.
            let at = if at > 0.0 { at } else { 0.0 };
            let at = if at < last { at } else { last };
            // At the far edge the second pixel has all the weight.
            let first = floor_to_count(at).min(side_px as u32 - 2);
            (first, at - first as i32 as f32)
        };
        let spots = places.left.iter_mut().zip(&mut places.above).zip(places.right.iter_mut().zip(&mut places.down));
        for (((left, above), (right, down)), across) in spots.zip(across) {
            let [s, t, major]: [f32; 3] = std::array::from_fn(|axis| start[axis] + step[axis] * across);
            let scale = 0.5 / major;
            (*left, *right) = split(s * scale + 0.5);
            (*above, *down) = split(t * scale + 0.5);
        }
        places
    }

    /// Draws these columns: three bytes each, interpolated between the four pixels around each place.
    fn draw_columns(&self, side: &CubeSide, row: &mut [u8]) {
        // Compilers turn these loops over array indices into vector instructions; they fail to with iterators.
        let columns = self.columns.min(COLUMNS_PER_STEP);
        let mut pixels = [[0; COLUMNS_PER_STEP]; 4];
        for at in 0..columns {
            for (pixels, pixel) in pixels.iter_mut().zip(side.four_pixels([self.left[at], self.above[at]])) {
                pixels[at] = pixel;
            }
        }
        let mut colours = [0; COLUMNS_PER_STEP];
        let [a, b, c, d] = &pixels;
        for at in 0..columns {
            colours[at] = blend_pixels([a[at], b[at], c[at], d[at]], [self.right[at], self.down[at]]);
        }
        for (colour, pixel) in colours.iter().zip(row.chunks_exact_mut(3)) {
            let [red, green, blue, _] = colour.to_le_bytes();
            pixel.copy_from_slice(&[red, green, blue]);
        }
    }
}

/// The colour between four pixels, bilinear and rounded, channel by channel.
fn blend_pixels(pixels: [u32; 4], [right, down]: [f32; 2]) -> u32 {
    let channel = |shift: u32| {
        let [a, b, c, d] = pixels.map(|pixel| f32::from((pixel >> shift) as u8));
        let (top, bottom) = (a + (b - a) * right, c + (d - c) * right);
        (floor_to_count(top + (bottom - top) * down + 0.5) & 0xff) << shift
    };
    channel(0) | channel(8) | channel(16)
}

/// Rounds a number in 0..[`WHOLE_NUMBER_OFFSET`] down. (A conversion with `as` also checks whether the number fits into an integer, and
/// `f32::floor` is a function call on the baseline x86-64.)
fn floor_to_count(value: f32) -> u32 {
    let raised = value + WHOLE_NUMBER_OFFSET;
    let is_above = raised - WHOLE_NUMBER_OFFSET > value;
    raised.to_bits() - WHOLE_NUMBER_OFFSET.to_bits() - u32::from(is_above)
}
