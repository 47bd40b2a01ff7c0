//! Finds the nearest triangle of each pixel.
//!
//! A triangle covers a pixel if the pixel's centre is inside all three edges. This is computed with integers, so no pixel
//! between two triangles is missed or drawn twice. A centre exactly on an edge belongs to the triangle if the edge is a top
//! or a left one (the top-left rule of GPUs).

use crate::cluster::SceneTriangle;
use crate::triangle_setup::{ScreenTriangle, TriangleBatch, centres_between};
use crate::view::SUBPIXEL_STEPS;
use std::ops::RangeInclusive;

/// Width of a tile of a band, pixels. A tile is as high as its band.
pub(crate) const TILE_WIDTH_PX: usize = 16;

/// A triangle of the batches: the batch and its place there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BatchTriangleIndex {
    pub(crate) batch: u32,
    pub(crate) place: u32,
}

impl BatchTriangleIndex {
    /// The value of a pixel that no triangle covers.
    pub(crate) const NO_TRIANGLE: Self = Self { batch: u32::MAX, place: u32::MAX };
}

/// Some whole rows of the picture, with the nearest triangle of each pixel.
pub(crate) struct PictureBand {
    /// Pixels per row.
    pub(crate) width: u32,
    /// The picture's row with which the band begins.
    pub(crate) first_row: u32,
    /// Nearness of the nearest triangle at each pixel, as in `ScreenCorner::nearness`.
    pub(crate) nearness: Vec<f32>,
    /// The nearest triangle at each pixel.
    pub(crate) seen: Vec<BatchTriangleIndex>,
    /// For each tile of [`TILE_WIDTH_PX`] columns, the least nearness of its pixels when the tiles were last measured.
    pub(crate) tiles: Vec<f32>,
}

impl PictureBand {
    pub(crate) fn new(width: u32, first_row: u32, rows: usize) -> Self {
        let pixels = width as usize * rows;
        Self {
            width,
            first_row,
            nearness: vec![f32::NEG_INFINITY; pixels],
            seen: vec![BatchTriangleIndex::NO_TRIANGLE; pixels],
            tiles: vec![f32::NEG_INFINITY; (width as usize).div_ceil(TILE_WIDTH_PX)],
        }
    }

    /// The row of the picture after the band's last.
    fn end_row(&self) -> u32 {
        self.first_row + (self.nearness.len() / self.width.max(1) as usize) as u32
    }

    /// Whether the band has one of these rows of the picture.
    pub(crate) fn holds_rows(&self, rows: &RangeInclusive<usize>) -> bool {
        (self.first_row as usize) <= *rows.end() && *rows.start() < self.end_row() as usize
    }

    /// Records how far what each tile shows is.
    pub(crate) fn measure_tiles(&mut self) {
        self.tiles.fill(f32::INFINITY);
        for row in self.nearness.chunks_exact(self.width.max(1) as usize) {
            for (tile, pixels) in self.tiles.iter_mut().zip(row.chunks(TILE_WIDTH_PX)) {
                *tile = pixels.iter().copied().fold(*tile, f32::min);
            }
        }
    }

    /// Draws the batches from number `from` on. The result for a pixel depends on no other pixel and not on the order of the
    /// batches, so it is the same for any division into bands and groups.
    pub(crate) fn draw_batches(&mut self, batches: &[TriangleBatch], from: usize, triangles: &[SceneTriangle]) {
        let (first, end) = (self.first_row, self.end_row());
        let overlaps = |[low, high]: [u16; 2]| u32::from(low) < end && u32::from(high) >= first;
        for (index, batch) in batches.iter().enumerate().skip(from) {
            if !overlaps(batch.rows) {
                continue;
            }
            for (place, triangle) in batch.triangles.iter().enumerate() {
                if overlaps(triangle.rows) {
                    let seen = BatchTriangleIndex { batch: index as u32, place: place as u32 };
                    self.draw_triangle(triangle, seen, end, |other| {
                        let other = &batches[other.batch as usize].triangles[other.place as usize];
                        let source = |t: &ScreenTriangle| triangles[t.triangle as usize].source;
                        source(triangle) < source(other)
                    });
                }
            }
        }
    }

    /// Draws one triangle into the rows before `end`. Pixels where it is nearest get its index `seen`. `precedes` decides
    /// between two triangles that are equally near: it is true if this triangle comes before the other.
    fn draw_triangle(
        &mut self,
        triangle: &ScreenTriangle,
        seen: BatchTriangleIndex,
        end: u32,
        precedes: impl Fn(BatchTriangleIndex) -> bool,
    ) {
        let Some([left, right]) = centres_between(triangle.corners.map(|c| c.x), self.width) else { return };
        let edges = triangle_edges(triangle);
        let slope = NearnessPlane::for_triangle(triangle);
        let first = u32::from(triangle.rows[0]).max(self.first_row);
        for row in first..end.min(u32::from(triangle.rows[1]) + 1) {
            let at_left = edges.map(|edge| edge.value_at(u32::from(left), row));
            let Some((start, stop)) = inside_span(&edges, at_left, i64::from(right - left) + 1) else { continue };
            let start_column = usize::from(left) + start as usize;
            let offset = (row - self.first_row) as usize * self.width as usize + start_column;
            let count = (stop - start) as usize;
            let (value, step) = slope.value_and_step(start_column as u32, row);
            let nearness = &mut self.nearness[offset..offset + count];
            let owners = &mut self.seen[offset..offset + count];
            for (i, (nearest, owner)) in nearness.iter_mut().zip(owners).enumerate() {
                let here = value + step * i as f32;
                if here > *nearest
                    || (here == *nearest && *owner != BatchTriangleIndex::NO_TRIANGLE && precedes(*owner))
                {
                    *nearest = here;
                    *owner = seen;
                }
            }
        }
    }
}

/// A directed edge, with a value at each pixel: the pixel is inside the edge if the value is not negative.
#[derive(Clone, Copy, Debug)]
struct TriangleEdge {
    /// Where it begins, sub-pixel steps.
    x: i64,
    y: i64,
    /// From there to its end, sub-pixel steps.
    dx: i64,
    dy: i64,
    /// 0, or -1 where pixels exactly on the edge belong to the neighbour: all but top and left edges.
    bias: i64,
}

impl TriangleEdge {
    /// The edge's value at a pixel's centre.
    fn value_at(&self, column: u32, row: u32) -> i64 {
        self.dx * (pixel_centre(row) - self.y) - self.dy * (pixel_centre(column) - self.x) + self.bias
    }

    /// Change from a pixel to the one right of it.
    fn step_right(&self) -> i64 {
        -self.dy * i64::from(SUBPIXEL_STEPS)
    }
}

/// The centre of a pixel on one axis, in sub-pixel steps.
fn pixel_centre(pixel: u32) -> i64 {
    i64::from(pixel) * i64::from(SUBPIXEL_STEPS) + i64::from(SUBPIXEL_STEPS / 2)
}

/// The three edges of a triangle, in the order of its corners.
fn triangle_edges(triangle: &ScreenTriangle) -> [TriangleEdge; 3] {
    let corners = &triangle.corners;
    [(0, 1), (1, 2), (2, 0)].map(|(from, to)| {
        let (from, to) = (corners[from], corners[to]);
        let (dx, dy) = (i64::from(to.x) - i64::from(from.x), i64::from(to.y) - i64::from(from.y));
        let top_left = dy < 0 || (dy == 0 && dx > 0);
        TriangleEdge { x: from.x.into(), y: from.y.into(), dx, dy, bias: if top_left { 0 } else { -1 } }
    })
}

/// The range (from, to) of pixels inside all edges, in a row of `count` pixels. `at` are the edges' values at the first
/// pixel. An edge's value is linear along the row, so the range follows by division, without a test of each pixel.
fn inside_span(edges: &[TriangleEdge; 3], at: [i64; 3], count: i64) -> Option<(i64, i64)> {
    let (mut start, mut stop) = (0, count);
    for (edge, value) in edges.iter().zip(at) {
        let step = edge.step_right();
        let last = value + step * (count - 1);
        if value < 0 && last < 0 {
            return None;
        }
        if value < 0 {
            start = start.max(ceil_quotient(-value, step));
        } else if last < 0 {
            stop = stop.min(ceil_quotient(value + 1, -step));
        }
    }
    (start < stop).then_some((start, stop))
}

/// The quotient of two positive numbers below 2^52, rounded up. In this range the division of doubles never rounds to
/// another integer, and it is several times faster than the division of integers.
fn ceil_quotient(numerator: i64, denominator: i64) -> i64 {
    let quotient = (numerator as f64 / denominator as f64) as i64;
    if quotient * denominator < numerator { quotient + 1 } else { quotient }
}

/// Nearness as a linear function of the position on the screen.
struct NearnessPlane {
    /// A corner of the triangle, sub-pixel steps.
    x: i64,
    y: i64,
    /// Nearness at this corner.
    base: f64,
    /// Change per step to the right and down.
    gradient: [f64; 2],
}

impl NearnessPlane {
    fn for_triangle(triangle: &ScreenTriangle) -> Self {
        let [a, b, c] = triangle.corners;
        let [ab, ac] = [b, c].map(|to| [f64::from(to.x - a.x), f64::from(to.y - a.y)]);
        let base = f64::from(a.nearness);
        let [to_b, to_c] = [b, c].map(|to| f64::from(to.nearness) - base);
        let scale = 1.0 / triangle.twice_area() as f64;
        let gradient = [(to_b * ac[1] - to_c * ab[1]) * scale, (to_c * ab[0] - to_b * ac[0]) * scale];
        Self { x: a.x.into(), y: a.y.into(), base, gradient }
    }

    /// The value at a pixel's centre, and its change to the next pixel on the right.
    fn value_and_step(&self, column: u32, row: u32) -> (f32, f32) {
        let (x, y) = ((pixel_centre(column) - self.x) as f64, (pixel_centre(row) - self.y) as f64);
        let value = self.base + self.gradient[0] * x + self.gradient[1] * y;
        (value as f32, (self.gradient[0] * f64::from(SUBPIXEL_STEPS)) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn ceil_quotient_is_exact(n in 1i64..(1 << 52), d in 1i64..(1 << 33)) {
            prop_assert_eq!(ceil_quotient(n, d), (n + d - 1) / d);
            let multiple = (n / d).max(1) * d;
            prop_assert_eq!(ceil_quotient(multiple, d), multiple / d);
        }

        #[test]
        fn inside_span_agrees_with_a_test_of_every_pixel(
            corners in proptest::array::uniform6(-20_000i64..20_000), row in 0u32..40,
        ) {
            let [ax, ay, bx, by, cx, cy] = corners;
            let edge = |x: i64, y: i64, to_x: i64, to_y: i64| {
                let (dx, dy) = (to_x - x, to_y - y);
                TriangleEdge { x, y, dx, dy, bias: if dy < 0 || (dy == 0 && dx > 0) { 0 } else { -1 } }
            };
            let edges = [edge(ax, ay, bx, by), edge(bx, by, cx, cy), edge(cx, cy, ax, ay)];
            let inside: Vec<u32> = (0..60).filter(|&x| edges.iter().all(|e| e.value_at(x, row) >= 0)).collect();
            let found = inside_span(&edges, edges.map(|e| e.value_at(0, row)), 60);
            let listed: Vec<u32> = found.map_or(vec![], |(start, stop)| (start as u32..stop as u32).collect());
            prop_assert_eq!(inside, listed);
        }
    }
}
