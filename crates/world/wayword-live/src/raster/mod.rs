//! A floor as a grid of cells that are free or occupied. It serves simulators that report free floor and no graph.
//!
//! From the grid this module makes viewpoints (far from obstacles, well apart), edges (straight free walks), and shortest
//! ways.

#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use wayword_core::{DVec3, ViewpointGraph, ViewpointId, graph::GraphError};
use wayword_world::grid_search::{find_shortest_way, free_steps_around, min_way_length, pull_taut};

/// Most cells of a floor: 500 m by 500 m at 25 cm.
pub(crate) const MAX_CELLS: usize = 4_000_000;
/// No viewpoint lies nearer to another than this, metres.
const MIN_VIEWPOINT_DISTANCE_M: f64 = 1.5;
/// Longest edge of the viewpoint graph, metres.
const MAX_EDGE_M: f64 = 3.0;
/// Offsets in columns and rows from a cell to the four beside it.
const STRAIGHT_STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Cells over a floor. Cell 0 is the south-western one; rows are counted from south to north.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FloorRaster {
    /// Middle of cell 0, metres, world frame.
    origin_m: [f64; 2],
    cell_m: f64,
    columns: usize,
    free: Vec<bool>,
}

impl FloorRaster {
    /// A raster over a rectangle; `is_free` is called with the middle of each cell. `None` where the raster would have
    /// no cell, or more than [`MAX_CELLS`].
    pub(crate) fn over_rectangle(
        [x0, y0]: [f64; 2],
        [x1, y1]: [f64; 2],
        cell_m: f64,
        is_free: impl Fn([f64; 2]) -> bool,
    ) -> Option<Self> {
        let count = |from: f64, to: f64| {
            let count = ((to - from) / cell_m).round() + 1.0;
            (1.0..=MAX_CELLS as f64).contains(&count).then_some(count as usize)
        };
        let (columns, rows) = (count(x0, x1)?, count(y0, y1)?);
        let cells = columns.checked_mul(rows).filter(|cells| *cells <= MAX_CELLS)?;
        let mut raster = Self { origin_m: [x0, y0], cell_m, columns, free: Vec::new() };
        raster.free = (0..cells).map(|cell| is_free(raster.cell_middle(cell))).collect();
        Some(raster)
    }

    /// A raster from the middles of cells. Cells that are listed with `true` are free, and all others are not.
    pub(crate) fn from_cells(cells: &[([f64; 2], bool)], cell_m: f64) -> Option<Self> {
        let finite = || cells.iter().filter(|(middle, _)| middle.iter().all(|number| number.is_finite()));
        let bound = |axis: usize, start: f64, better: fn(f64, f64) -> f64| {
            finite().map(|(middle, _)| middle[axis]).fold(start, better)
        };
        let low = [0, 1].map(|axis| bound(axis, f64::INFINITY, f64::min));
        let high = [0, 1].map(|axis| bound(axis, f64::NEG_INFINITY, f64::max));
        let mut raster = Self::over_rectangle(low, high, cell_m, |_| false)?;
        for (middle, is_free) in finite() {
            if let Some(cell) = raster.cell_at(*middle) {
                raster.free[cell] = *is_free;
            }
        }
        Some(raster)
    }

    /// The middle of a cell, metres.
    pub(crate) fn cell_middle(&self, cell: usize) -> [f64; 2] {
        let (column, row) = (cell % self.columns, cell / self.columns);
        [self.origin_m[0] + column as f64 * self.cell_m, self.origin_m[1] + row as f64 * self.cell_m]
    }

    /// The cell of a point.
    fn cell_at(&self, point: [f64; 2]) -> Option<usize> {
        let step = |axis: usize| {
            let step = ((point[axis] - self.origin_m[axis]) / self.cell_m).round();
            (step >= 0.0 && step < self.free.len() as f64).then_some(step as usize)
        };
        let (column, row) = (step(0).filter(|column| *column < self.columns)?, step(1)?);
        Some(row.checked_mul(self.columns)? + column).filter(|cell| *cell < self.free.len())
    }

    /// Whether a point lies in a free cell.
    pub(crate) fn is_free(&self, point: [f64; 2]) -> bool {
        self.cell_at(point).is_some_and(|cell| self.free[cell])
    }

    /// The cell at an offset in columns and rows; `None` outside the raster.
    fn neighbour_cell(&self, cell: usize, (dx, dy): (i32, i32)) -> Option<usize> {
        let (column, row) =
            ((cell % self.columns) as i64 + i64::from(dx), (cell / self.columns) as i64 + i64::from(dy));
        let inside = (0..self.columns as i64).contains(&column) && row >= 0;
        let next = (row * self.columns as i64 + column) as usize;
        (inside && next < self.free.len()).then_some(next)
    }

    /// Keeps only the largest connected part in which one can walk.
    pub(crate) fn keep_largest_part(&mut self) {
        let mut part = vec![0_usize; self.free.len()];
        let mut sizes = vec![0_usize];
        for start in 0..self.free.len() {
            if !self.free[start] || part[start] != 0 {
                continue;
            }
            sizes.push(0);
            let (part_number, mut open) = (sizes.len() - 1, vec![start]);
            part[start] = part_number;
            while let Some(cell) = open.pop() {
                sizes[part_number] += 1;
                for next in STRAIGHT_STEPS.into_iter().filter_map(|step| self.neighbour_cell(cell, step)) {
                    if self.free[next] && part[next] == 0 {
                        part[next] = part_number;
                        open.push(next);
                    }
                }
            }
        }
        // Of equally large parts the first one wins.
        let largest = (1..sizes.len()).rev().max_by_key(|part_number| sizes[*part_number]).unwrap_or(0);
        self.free.iter_mut().zip(part).for_each(|(free, part_number)| *free = *free && part_number == largest);
    }

    /// Steps from each cell to the nearest one that is not free. Everything outside the raster counts as not free.
    fn cell_clearances(&self) -> Vec<u32> {
        let mut steps = vec![u32::MAX; self.free.len()];
        let mut open = VecDeque::new();
        for (cell, clearance) in steps.iter_mut().enumerate() {
            let at_edge = STRAIGHT_STEPS.into_iter().any(|step| self.neighbour_cell(cell, step).is_none());
            if !self.free[cell] || at_edge {
                // 0 where it is occupied, 1 for a free cell at the edge.
                *clearance = u32::from(self.free[cell]);
                open.push_back(cell);
            }
        }
        while let Some(cell) = open.pop_front() {
            for next in STRAIGHT_STEPS.into_iter().filter_map(|step| self.neighbour_cell(cell, step)) {
                if steps[next] > steps[cell] + 1 {
                    steps[next] = steps[cell] + 1;
                    open.push_back(next);
                }
            }
        }
        steps
    }

    /// Places for viewpoints: those farthest from obstacles first, none too near to another.
    pub(crate) fn viewpoint_places(&self) -> Vec<[f64; 2]> {
        let clearances = self.cell_clearances();
        let mut cells: Vec<usize> = (0..self.free.len()).filter(|cell| self.free[*cell]).collect();
        cells.sort_by_key(|cell| (std::cmp::Reverse(clearances[*cell]), *cell));
        let mut chosen: Vec<[f64; 2]> = Vec::new();
        for place in cells.into_iter().map(|cell| self.cell_middle(cell)) {
            if chosen.iter().all(|other| floor_distance(*other, place) >= MIN_VIEWPOINT_DISTANCE_M) {
                chosen.push(place);
            }
        }
        chosen
    }

    /// Whether one can walk straight from one point to another.
    pub(crate) fn can_walk_straight(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        let count = (floor_distance(from, to) / self.cell_m * 4.0).ceil().max(1.0) as usize;
        (0..=count).all(|step| {
            let share = step as f64 / count as f64;
            self.is_free([0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * share))
        })
    }

    /// The corners of a way between two points, both ends included; `None` where there is no way. It is at most a few
    /// percent longer than the shortest way, because it keeps to the middles of cells.
    pub(crate) fn shortest_way(&self, from: [f64; 2], to: [f64; 2]) -> Option<Vec<[f64; 2]>> {
        let start = self.cell_at(from).filter(|cell| self.free[*cell])?;
        let goal = self.cell_at(to).filter(|cell| self.free[*cell])?;
        let place = |cell: usize| ((cell % self.columns) as u64, (cell / self.columns) as u64);
        // The least cost from a cell to the goal. With it the search tries the most promising cells first.
        let least_left = |cell: usize| {
            let ((x, y), (gx, gy)) = (place(cell), place(goal));
            min_way_length(x.abs_diff(gx), y.abs_diff(gy))
        };
        let steps = |cell: usize| {
            free_steps_around(move |step| self.neighbour_cell(cell, step).filter(|next| self.free[*next]))
        };
        let cells = find_shortest_way(self.free.len(), start, goal, least_left, steps)?;
        // The way begins and ends at the points that were asked for, and not in the middles of their cells.
        let middles = cells.into_iter().map(|cell| self.cell_middle(cell));
        let points: Vec<[f64; 2]> = [from].into_iter().chain(middles).chain([to]).collect();
        Some(pull_taut(&points, |a, b| self.can_walk_straight(a, b)))
    }

    /// A viewpoint graph over eye positions above this floor. Its edges are straight, free walks. Where parts of it are
    /// not connected, the corners of a shortest way between them become viewpoints too.
    pub(crate) fn viewpoint_graph(&self, eyes: &[DVec3]) -> Result<ViewpointGraph, GraphError> {
        let mut graph = ViewpointGraph::default();
        let mut nodes: Vec<(ViewpointId, DVec3)> = Vec::new();
        for eye in eyes {
            self.add_viewpoint(&mut graph, &mut nodes, *eye)?;
        }
        // Each round joins the first part to the nearest other one, or stops because there is no way to it.
        for _ in 0..eyes.len() {
            if graph.count_components() < 2 || !self.join_parts(&mut graph, &mut nodes)? {
                break;
            }
        }
        Ok(graph)
    }

    /// Adds a viewpoint with edges to all near viewpoints to which one can walk straight.
    fn add_viewpoint(
        &self,
        graph: &mut ViewpointGraph,
        nodes: &mut Vec<(ViewpointId, DVec3)>,
        eye: DVec3,
    ) -> Result<(), GraphError> {
        // Names made of digits are always valid.
        let Ok(id) = ViewpointId::new(format!("v{}", nodes.len())) else { return Ok(()) };
        graph.add_viewpoint(id.clone(), eye, None)?;
        for (other, place) in nodes.iter() {
            if place.distance(eye) <= MAX_EDGE_M && self.can_walk_straight(floor_point(eye), floor_point(*place)) {
                graph.join_viewpoints(&id, other)?;
            }
        }
        nodes.push((id, eye));
        Ok(())
    }

    /// Joins the first part to the nearest node outside it: the corners of the shortest way between them become
    /// viewpoints. Returns whether there is such a way.
    fn join_parts(
        &self,
        graph: &mut ViewpointGraph,
        nodes: &mut Vec<(ViewpointId, DVec3)>,
    ) -> Result<bool, GraphError> {
        let Some((first, _)) = nodes.first() else { return Ok(false) };
        let reached = graph.distances_from(first)?;
        let (inside, outside): (Vec<_>, Vec<_>) = nodes.iter().cloned().partition(|(id, _)| reached.contains_key(id));
        drop(reached);
        let pairs = inside.iter().flat_map(|a| outside.iter().map(move |b| (a, b)));
        let Some((a, b)) = pairs.min_by(|(a, b), (c, d)| a.1.distance(b.1).total_cmp(&c.1.distance(d.1))) else {
            return Ok(false);
        };
        let Some(way) = self.shortest_way(floor_point(a.1), floor_point(b.1)) else { return Ok(false) };
        let mut before = a.0.clone();
        for corner in way.iter().skip(1).take(way.len().saturating_sub(2)) {
            self.add_viewpoint(graph, nodes, DVec3::new(corner[0], corner[1], a.1.z))?;
            let Some((id, _)) = nodes.last() else { return Ok(false) };
            graph.join_viewpoints(&before, id)?;
            before = id.clone();
        }
        graph.join_viewpoints(&before, &b.0)?;
        Ok(true)
    }
}

fn floor_point(place: DVec3) -> [f64; 2] {
    [place.x, place.y]
}

/// The distance between two points of the floor, metres.
fn floor_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx + dy * dy).sqrt()
}
