//! The free spaces of a scene along one of its axes: what lies between a surface that faces up and the next one above it, which
//! faces down.

use crate::triangle_columns::TriangleColumns;
use glam::{DVec2, Vec3};

/// Most columns along the longer side of the grid.
const MAX_COLUMNS_ALONG: f64 = 240.0;
/// Least distance between columns, metres: a doorway has four columns or more.
const MIN_STEP_M: f64 = 0.15;
/// Most tests of a triangle for one grid: about a second.
const TRIANGLE_BUDGET: f64 = 2e8;
/// Least cosine of the angle between a level surface's normal and the vertical: Recast's 45 degrees.
const MIN_LEVEL_COSINE: f32 = 0.707;

/// The free spaces over a grid of places, as seen along one axis.
pub(super) struct FreeColumns {
    /// Columns along the first and the second axis of the grid.
    pub(super) size: [usize; 2],
    /// Area for each column, in the unit of the triangles.
    pub(super) cell_area: f64,
    /// The free spaces of each column, from the lowest.
    pub(super) gaps: Vec<Vec<ColumnGap>>,
}

/// A free space in a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ColumnGap {
    /// The surface below; `None` if there is nothing below.
    pub(super) below: Option<GapEnd>,
    /// The surface above; `None` under the open sky.
    pub(super) above: Option<GapEnd>,
}

/// A surface at the end of a free space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GapEnd {
    pub(super) height: f64,
    pub(super) is_level: bool,
}

impl ColumnGap {
    /// The height of the space; `None` if it is open.
    pub(super) fn height(&self) -> Option<f64> {
        Some(self.above?.height - self.below?.height)
    }

    fn upside_down(self) -> Self {
        let turned = |end: GapEnd| GapEnd { height: -end.height, ..end };
        Self { below: self.above.map(turned), above: self.below.map(turned) }
    }
}

impl FreeColumns {
    /// The free spaces along an axis (0 is x). The other axes follow in their order, so that left and right stay.
    pub(super) fn along_axis(triangles: &[[Vec3; 3]], axis: usize) -> Self {
        Self::along_axis_with(triangles, axis, MAX_COLUMNS_ALONG, MIN_STEP_M)
    }

    /// The same with at most `along` columns along a side, which are at least `min_step` apart.
    pub(super) fn along_axis_with(triangles: &[[Vec3; 3]], axis: usize, along: f64, min_step: f64) -> Self {
        let upright = |corner: Vec3| match axis {
            0 => Vec3::new(corner.y, corner.z, corner.x),
            1 => Vec3::new(corner.z, corner.x, corner.y),
            _ => corner,
        };
        let turned = || triangles.iter().map(|triangle| triangle.map(upright));
        let low = turned().flatten().reduce(Vec3::min).unwrap_or_default().as_dvec3();
        let high = turned().flatten().reduce(Vec3::max).unwrap_or_default().as_dvec3();
        let surfaces = TriangleColumns::with_tags(turned().map(|triangle| (triangle, surface_tag(&triangle))));
        let affordable = (TRIANGLE_BUDGET / surfaces.max_triangles_per_cell().max(1) as f64).sqrt();
        let extent = (high - low).truncate();
        let step = (extent.max_element() / along.min(affordable).max(8.0)).max(min_step);
        // Casts saturate. The grid lies around the middle, so that a turned scene has the same columns.
        let size = [extent.x, extent.y].map(|side| (side / step - 1e-6).ceil().max(1.0) as usize);
        let cell = extent / DVec2::new(size[0] as f64, size[1] as f64);
        let place = |row: usize, column: usize| {
            (low.truncate() + (DVec2::new(column as f64, row as f64) + 0.5) * cell).extend(0.0)
        };
        let grid = (0..size[1]).flat_map(|row| (0..size[0]).map(move |column| (row, column)));
        let gaps = grid.map(|(row, column)| gaps_between(surfaces.tags_at(place(row, column)).collect())).collect();
        Self { size, cell_area: cell.x * cell.y, gaps }
    }

    /// The same free spaces in another unit.
    pub(super) fn scaled(&self, by: f64) -> Self {
        let end = |end: GapEnd| GapEnd { height: end.height * by, ..end };
        let gap = |gap: &ColumnGap| ColumnGap { below: gap.below.map(end), above: gap.above.map(end) };
        let gaps = self.gaps.iter().map(|gaps| gaps.iter().map(gap).collect()).collect();
        Self { size: self.size, cell_area: self.cell_area * by * by, gaps }
    }

    /// The same free spaces with the axis turned around.
    pub(super) fn upside_down(&self) -> Self {
        let turned = |gaps: &Vec<ColumnGap>| gaps.iter().rev().map(|gap| gap.upside_down()).collect();
        Self { size: self.size, cell_area: self.cell_area, gaps: self.gaps.iter().map(turned).collect() }
    }
}

const FACES_UP: u32 = 1;
const LEVEL: u32 = 2;

/// Whether a triangle faces up, and whether it is level.
fn surface_tag([a, b, c]: &[Vec3; 3]) -> u32 {
    let normal = (*b - *a).cross(*c - *a).normalize_or_zero();
    let (up, level) = (normal.z > 0.0, normal.z.abs() >= MIN_LEVEL_COSINE);
    u32::from(up) * FACES_UP + u32::from(level) * LEVEL
}

/// The free spaces between the surfaces of a column.
fn gaps_between(mut surfaces: Vec<(f64, u32)>) -> Vec<ColumnGap> {
    surfaces.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let faces_up = |tag: u32| tag & FACES_UP != 0;
    let end = |(height, tag): (f64, u32)| GapEnd { height, is_level: tag & LEVEL != 0 };
    let mut gaps = Vec::new();
    if let Some(lowest) = surfaces.first().filter(|(_, tag)| !faces_up(*tag)) {
        gaps.push(ColumnGap { below: None, above: Some(end(*lowest)) });
    }
    for pair in surfaces.windows(2) {
        if let [below, above] = pair
            && faces_up(below.1)
            && !faces_up(above.1)
        {
            gaps.push(ColumnGap { below: Some(end(*below)), above: Some(end(*above)) });
        }
    }
    if let Some(highest) = surfaces.last().filter(|(_, tag)| faces_up(*tag)) {
        gaps.push(ColumnGap { below: Some(end(*highest)), above: None });
    }
    gaps
}
