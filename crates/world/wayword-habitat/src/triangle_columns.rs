//! Looks up the triangles of a scene by their position seen from above.
//!
//! The triangles are sorted into the cells of a grid on the ground. So a question about one vertical line (is there a ceiling, how
//! far is the floor) reads one cell, and a question about a straight line between two positions reads the cells along it.

use glam::Vec3;
use wayword_core::DVec3;

/// Smallest side of a cell, metres.
const MIN_CELL_SIDE_M: f32 = 0.25;
/// Most cells per triangle, on average. If a grid would need more, it is made coarser.
const CELLS_PER_TRIANGLE: u64 = 8;
/// Cells that any scene may use in addition to these, however few triangles it has.
const FREE_CELLS: u64 = 1 << 20;
/// A surface nearer to the feet than this is the ground itself, metres: a navmesh lies up to one voxel above or below
/// the floor, and runs straight over the treads of stairs.
const GROUND_TOLERANCE_M: f64 = 0.5;
/// Room that a standing person needs, metres.
const HEADROOM_M: f64 = 1.8;

/// The triangles of a scene, sorted into the cells that they touch as seen from above. In Wayword's frame.
#[derive(Debug)]
pub(crate) struct TriangleColumns {
    triangles: Vec<[Vec3; 3]>,
    /// The caller's number for the owner of each triangle.
    tags: Vec<u32>,
    /// The grid's corner with the smallest x and y, metres.
    corner: glam::Vec2,
    /// Side of a cell.
    side_m: f32,
    /// Cells along x and along y.
    size: [usize; 2],
    /// Where the triangles of each cell begin in `members`; the length is the number of cells and 1.
    starts: Vec<u32>,
    /// Indices of triangles, cell by cell.
    members: Vec<u32>,
}

/// The cover above a position on the ground: a ceiling, or the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum OverheadCover {
    /// A ceiling; its height above the ground, metres.
    Ceiling(f64),
    /// The sky above, and solid ground below.
    Sky,
    /// The sky above, and below the ground a space in which a person could stand: the ground is a roof.
    SkyOnRoof,
}

impl TriangleColumns {
    /// Columns of triangles without numbers. Upright triangles are left out.
    pub(crate) fn new(triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        Self::with_tags(triangles.map(|triangle| (triangle, 0)))
    }

    /// Columns of triangles with a number each, which [`TriangleColumns::tags_at`] returns. Upright triangles are left out.
    pub(crate) fn with_tags(triangles: impl Iterator<Item = ([Vec3; 3], u32)>) -> Self {
        // An upright triangle has no area seen from above.
        let has_area = |[a, b, c]: &[Vec3; 3]| (*b - *a).truncate().perp_dot((*c - *a).truncate()).abs() > 1e-9;
        let (triangles, tags) = triangles.filter(|(triangle, _)| has_area(triangle) && is_finite(triangle)).unzip();
        Self::sort_into_cells(triangles, tags)
    }

    /// Columns that include the upright triangles, for [`TriangleColumns::is_open`].
    pub(crate) fn with_walls(triangles: impl Iterator<Item = [Vec3; 3]>) -> Self {
        let triangles: Vec<[Vec3; 3]> = triangles.filter(is_finite).collect();
        let tags = vec![0; triangles.len()];
        Self::sort_into_cells(triangles, tags)
    }

    /// Makes the grid as fine as the limits for its cells allow, and sorts the triangles into it.
    fn sort_into_cells(triangles: Vec<[Vec3; 3]>, tags: Vec<u32>) -> Self {
        let corners = || triangles.iter().flatten().map(|corner| corner.truncate());
        let low = corners().reduce(glam::Vec2::min).unwrap_or_default();
        let high = corners().reduce(glam::Vec2::max).unwrap_or_default();
        let (starts, members) = (Vec::new(), Vec::new());
        let mut columns = Self { triangles, tags, corner: low, side_m: MIN_CELL_SIDE_M, size: [1, 1], starts, members };
        let extent = high - low;
        loop {
            // Casts saturate; the additional cell takes the triangles on the far edge.
            columns.size = [extent.x, extent.y].map(|side| ((side / columns.side_m) as usize).saturating_add(1));
            let cells = (columns.size[0] as u64).saturating_mul(columns.size[1] as u64);
            let touched_cells = columns.triangles.iter().map(|triangle| columns.touched_cell_count(triangle));
            let touched_cells = touched_cells.fold(0, u64::saturating_add);
            let max_cells = FREE_CELLS + CELLS_PER_TRIANGLE * columns.triangles.len() as u64;
            if columns.size == [1, 1] || (cells <= max_cells && touched_cells <= max_cells) {
                break;
            }
            columns.side_m *= 2.0;
        }
        columns.fill_cells();
        columns
    }

    /// Fills `starts` and `members` by a counting sort.
    fn fill_cells(&mut self) {
        let cells = self.size[0] * self.size[1];
        let mut starts = vec![0_u32; cells + 1];
        for triangle in &self.triangles {
            self.touched_cells(triangle).for_each(|cell| starts[cell + 1] += 1);
        }
        for cell in 0..cells {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        self.members = vec![0; starts[cells] as usize];
        for (number, triangle) in self.triangles.iter().enumerate() {
            for cell in self.touched_cells(triangle) {
                self.members[next[cell] as usize] = number as u32;
                next[cell] += 1;
            }
        }
        self.starts = starts;
    }

    /// First and last cell along each axis that a triangle's bounds touch.
    fn cell_span(&self, [a, b, c]: &[Vec3; 3]) -> [[usize; 2]; 2] {
        let (low, high) = (a.min(*b).min(*c).truncate(), a.max(*b).max(*c).truncate());
        let at = |place: glam::Vec2| ((place - self.corner) / self.side_m).to_array();
        let (low, high) = (at(low), at(high));
        [0, 1].map(|axis| [low[axis], high[axis]].map(|at| (at as usize).min(self.size[axis] - 1)))
    }

    fn touched_cell_count(&self, triangle: &[Vec3; 3]) -> u64 {
        let count = |[first, last]: [usize; 2]| (last.saturating_sub(first) as u64).saturating_add(1);
        self.cell_span(triangle).map(count).into_iter().fold(1, u64::saturating_mul)
    }

    fn touched_cells(&self, triangle: &[Vec3; 3]) -> impl Iterator<Item = usize> + use<> {
        let ([[left, right], [near, far]], wide) = (self.cell_span(triangle), self.size[0]);
        (near..=far).flat_map(move |y| (left..=right).map(move |x| y * wide + x))
    }

    /// The triangles over and under a position: those of its cell.
    fn triangles_near(&self, place: DVec3) -> &[u32] {
        let at = (place.truncate().as_vec2() - self.corner) / self.side_m;
        let inside = at.min_element() >= 0.0 && (at.x as usize) < self.size[0] && (at.y as usize) < self.size[1];
        if !inside {
            return &[];
        }
        let cell = at.y as usize * self.size[0] + at.x as usize;
        &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }

    /// The surfaces that a vertical line through a position meets, from the lowest: height in metres, and whether it
    /// faces up.
    fn surfaces_at(&self, place: DVec3) -> Vec<(f64, bool)> {
        let members = self.triangles_near(place).iter();
        let mut surfaces: Vec<(f64, bool)> =
            members.filter_map(|number| height_on_triangle(&self.triangles[*number as usize], place)).collect();
        surfaces.sort_by(|a, b| a.0.total_cmp(&b.0));
        surfaces
    }

    /// How far below a position the next surface lies, metres, whichever way it faces; `None` where there is none.
    pub(crate) fn drop_m(&self, place: DVec3) -> Option<f64> {
        let members = self.triangles_near(place).iter();
        let heights = members.filter_map(|number| height_on_triangle(&self.triangles[*number as usize], place));
        let below = heights.map(|(height_m, _)| place.z - height_m).filter(|drop_m| *drop_m > 0.0);
        below.min_by(f64::total_cmp)
    }

    /// Whether no triangle blocks the straight line between two positions. A triangle that only touches an end does not block it.
    /// `budget` is lowered by the number of triangles that were tested; once it is spent, the line counts as open.
    pub(crate) fn is_open(&self, from: DVec3, to: DVec3, budget: &mut u64) -> bool {
        let mut cells = self.cells_along(from, to);
        !cells.any(|cell| {
            let members = &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize];
            if members.len() as u64 > *budget {
                *budget = 0;
                return false;
            }
            *budget -= members.len() as u64;
            members.iter().any(|number| crosses_line(&self.triangles[*number as usize], from, to))
        })
    }

    /// The cells over and under a straight line, strip by strip along x.
    fn cells_along(&self, from: DVec3, to: DVec3) -> impl Iterator<Item = usize> + use<> {
        let place = |place: DVec3| (place.truncate() - self.corner.as_dvec2()) / f64::from(self.side_m);
        let (left, right) = if from.x <= to.x { (place(from), place(to)) } else { (place(to), place(from)) };
        let [wide, deep] = self.size;
        let strips = cells_between(left.x, right.x, wide);
        strips.flat_map(move |x| {
            // The part of the line that lies in this strip; a line along y lies in one strip with all its length.
            let at = |x: f64| {
                let share = if right.x > left.x { (x - left.x) / (right.x - left.x) } else { 0.0 };
                left.y + share.clamp(0.0, 1.0) * (right.y - left.y)
            };
            let (a, b) = if right.x > left.x { (at(x as f64), at(x as f64 + 1.0)) } else { (left.y, right.y) };
            cells_between(a.min(b), a.max(b), deep).map(move |y| y * wide + x)
        })
    }

    /// The largest number of triangles in one cell: the most that a look-up at one position has to test.
    pub(crate) fn max_triangles_per_cell(&self) -> usize {
        self.starts.windows(2).map(|cell| (cell[1] - cell[0]) as usize).max().unwrap_or_default()
    }

    /// The surfaces that a vertical line through a position meets, in no order: height in metres, and the triangle's tag.
    pub(crate) fn tags_at(&self, place: DVec3) -> impl Iterator<Item = (f64, u32)> {
        let members = self.triangles_near(place).iter().map(|number| *number as usize);
        members
            .filter_map(move |number| Some((height_on_triangle(&self.triangles[number], place)?.0, self.tags[number])))
    }

    /// The cover above a position on the ground.
    pub(crate) fn cover_over(&self, ground: DVec3) -> OverheadCover {
        let surfaces = self.surfaces_at(ground);
        if let Some((height_m, _)) = surfaces.iter().find(|(height_m, _)| *height_m > ground.z + GROUND_TOLERANCE_M) {
            return OverheadCover::Ceiling(height_m - ground.z);
        }
        // A person could stand on a surface below if it faces up and has enough room above it.
        let is_room = |pair: &[(f64, bool)]| pair[0].1 && pair[1].0 - pair[0].0 >= HEADROOM_M;
        if surfaces.windows(2).any(is_room) { OverheadCover::SkyOnRoof } else { OverheadCover::Sky }
    }
}

impl OverheadCover {
    /// Whether a person can stand upright under it.
    pub(crate) fn is_headroom(&self) -> bool {
        !matches!(self, Self::Ceiling(height_m) if *height_m < HEADROOM_M)
    }
}

fn is_finite(triangle: &[Vec3; 3]) -> bool {
    triangle.iter().all(|corner| corner.is_finite())
}

/// The range of cells, of `count` in a row, between two positions that are measured in sides of a cell.
fn cells_between(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    // Casts saturate. The range is a little wider than needed, because the line may run along the border of cells.
    let end = if high < 0.0 { 0 } else { ((high + 1e-6) as usize).saturating_add(1).min(count) };
    ((low - 1e-6).max(0.0) as usize).min(end)..end
}

/// Whether a triangle crosses the straight line between two positions (Möller and Trumbore's test).
fn crosses_line([a, b, c]: &[Vec3; 3], from: DVec3, to: DVec3) -> bool {
    let [a, b, c] = [a, b, c].map(|corner| corner.as_dvec3());
    let (way, ab, ac) = (to - from, b - a, c - a);
    let across = way.cross(ac);
    let whole = ab.dot(across);
    if whole == 0.0 {
        return false;
    }
    let start = from - a;
    let (along_b, turned) = (start.dot(across) / whole, start.cross(ab));
    let (along_c, share) = (way.dot(turned) / whole, ac.dot(turned) / whole);
    along_b >= 0.0 && along_c >= 0.0 && along_b + along_c <= 1.0 && share > 1e-6 && share < 1.0 - 1e-6
}

/// The height at which a vertical line through a position meets a triangle, and whether the triangle faces up.
fn height_on_triangle([a, b, c]: &[Vec3; 3], place: DVec3) -> Option<(f64, bool)> {
    let [a, b, c] = [a, b, c].map(|corner| corner.as_dvec3());
    let side = |a: DVec3, b: DVec3| (b - a).truncate().perp_dot((place - a).truncate());
    let (to_c, to_a, to_b) = (side(a, b), side(b, c), side(c, a));
    let whole = to_a + to_b + to_c;
    let within = (to_a >= 0.0 && to_b >= 0.0 && to_c >= 0.0) || (to_a <= 0.0 && to_b <= 0.0 && to_c <= 0.0);
    (within && whole != 0.0).then(|| ((a.z * to_a + b.z * to_b + c.z * to_c) / whole, whole > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A square around the origin at a height, facing up or down.
    fn sheet(half_m: f32, height_m: f32, is_up: bool) -> Vec<[Vec3; 3]> {
        let corner = |x: f32, y: f32| Vec3::new(x * half_m, y * half_m, height_m);
        let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        if is_up { vec![[a, b, c], [a, c, d]] } else { vec![[a, c, b], [a, d, c]] }
    }

    fn columns(sheets: &[Vec<[Vec3; 3]>]) -> TriangleColumns {
        TriangleColumns::new(sheets.iter().flatten().copied())
    }

    #[test]
    fn under_a_slab_there_is_a_ceiling_and_on_top_of_it_a_roof() {
        let flat = columns(&[sheet(4.0, 0.0, true), sheet(4.0, 2.6, false), sheet(4.0, 2.8, true)]);
        let OverheadCover::Ceiling(height_m) = flat.cover_over(DVec3::new(1.0, 0.5, 0.1)) else {
            panic!("there is a ceiling")
        };
        assert!((height_m - 2.5).abs() < 1e-6);
        assert_eq!(flat.cover_over(DVec3::new(1.0, 0.5, 2.9)), OverheadCover::SkyOnRoof);
        assert_eq!(flat.cover_over(DVec3::new(9.0, 0.5, 2.9)), OverheadCover::Sky);
    }

    #[test]
    fn solid_ground_of_any_thickness_is_no_roof() {
        let block = columns(&[sheet(4.0, -3.0, false), sheet(4.0, 0.0, true)]);
        assert_eq!(block.cover_over(DVec3::new(1.0, 0.5, 0.0)), OverheadCover::Sky);
        // A crawl space does not count as a room.
        let raised = columns(&[sheet(4.0, -1.0, true), sheet(4.0, -0.2, false), sheet(4.0, 0.0, true)]);
        assert_eq!(raised.cover_over(DVec3::new(1.0, 0.5, 0.0)), OverheadCover::Sky);
    }

    #[test]
    fn a_low_ceiling_leaves_no_headroom() {
        let cellar = columns(&[sheet(4.0, 0.0, true), sheet(4.0, 1.7, false)]);
        assert!(!cellar.cover_over(DVec3::ZERO).is_headroom());
        assert!(OverheadCover::Ceiling(1.9).is_headroom() && OverheadCover::Sky.is_headroom());
    }

    #[test]
    fn a_large_scene_of_large_triangles_takes_a_coarse_grid() {
        let wide = columns(&[sheet(5e5, 0.0, true), sheet(5e5, 3.0, false)]);
        assert!(wide.members.len() < 4_000_000 && wide.side_m > MIN_CELL_SIDE_M);
        assert_eq!(wide.cover_over(DVec3::new(4e5, -4e5, 0.0)), OverheadCover::Ceiling(3.0));
        assert_eq!(TriangleColumns::new(std::iter::empty()).cover_over(DVec3::ZERO), OverheadCover::Sky);
    }

    #[test]
    fn coordinates_that_no_scene_has_do_not_overflow() {
        for half_m in [2e19, 1e30, 3e38] {
            let far = columns(&[sheet(half_m, 0.0, true), sheet(half_m, 3.0, false)]);
            let _ = (far.cover_over(DVec3::ZERO), far.drop_m(DVec3::new(1.0, 1.0, 2.0)));
            let _ = far.is_open(DVec3::ZERO, DVec3::new(5.0, 5.0, 5.0), &mut 1000);
        }
    }

    /// A wall along y at x = 1 with a doorway from y = 0 to y = 1, and a floor.
    fn walled() -> TriangleColumns {
        let corner = |y: f32, z: f32| Vec3::new(1.0, y, z);
        let piece = |low: f32, high: f32| {
            let [a, b, c, d] = [corner(low, 0.0), corner(high, 0.0), corner(high, 2.5), corner(low, 2.5)];
            vec![[a, b, c], [a, c, d]]
        };
        let parts = [sheet(4.0, 0.0, true), piece(-4.0, 0.0), piece(1.0, 4.0)];
        TriangleColumns::with_walls(parts.iter().flatten().copied())
    }

    #[test]
    fn a_line_through_a_wall_is_not_open_and_one_through_its_doorway_is() {
        let walled = walled();
        let open = |a: [f64; 2], b: [f64; 2]| {
            let eye = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.5);
            let both = [walled.is_open(eye(a), eye(b), &mut 1000), walled.is_open(eye(b), eye(a), &mut 1000)];
            assert_eq!(both[0], both[1], "{a:?} {b:?}");
            both[0]
        };
        assert!(!open([0.0, -2.0], [2.0, -2.0]) && !open([-3.0, -3.0], [3.0, 3.9]) && !open([0.5, -0.5], [3.9, -0.1]));
        assert!(open([0.0, 0.5], [2.0, 0.5]) && open([0.9, -3.0], [0.9, 3.0]) && open([-3.0, -3.0], [0.9, 3.0]));
        assert!(open([2.0, -3.0], [2.0, 3.0]) && open([-9.0, 9.0], [9.0, 9.0]), "the last one is outside");
        assert_eq!(walled.drop_m(DVec3::new(0.0, 0.0, 1.5)), Some(1.5));
        assert_eq!(walled.drop_m(DVec3::new(9.0, 0.0, 1.5)), None);
    }

    #[test]
    fn is_open_stops_when_its_budget_is_spent() {
        let mut budget = 2;
        assert!(walled().is_open(DVec3::new(-3.0, -3.0, 1.5), DVec3::new(3.0, -3.0, 1.5), &mut budget));
        assert_eq!(budget, 0);
    }

    proptest! {
        #[test]
        fn is_open_misses_no_wall_on_a_line(a in [-3.9..3.9_f64, -3.9..3.9], b in [-3.9..3.9_f64, -3.9..3.9]) {
            let eye = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.2);
            let (walled, from, to) = (walled(), eye(a), eye(b));
            let all = walled.triangles.iter().any(|triangle| crosses_line(triangle, from, to));
            prop_assert_eq!(walled.is_open(from, to, &mut 1_000_000), !all);
        }
    }
}
