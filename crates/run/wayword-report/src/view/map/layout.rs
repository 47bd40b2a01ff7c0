//! Lays out a map: places the viewpoints, edges and path of a storey on a sheet, and adds the scale bar and the north arrow.

use super::sketch::{Ink, Mark, Point, Sketch, ink};
use crate::pages::{
    map::{MOST_NODES, MOST_SPAN_M, RADIUS, Spot, Trail, spots},
    palette::colour,
    sheet::{Paper, Sheet},
};
use wayword_core::{Climb, DVec3, FromAbove, Heading, Path, ViewpointGraph, ViewpointId};

/// The limits of the sheet.
const PAPER: Paper =
    Paper { most: [800.0, 760.0], least: [240.0, 160.0], padding: 26.0, margin_m: 0.5, most_scale: 64.0 };
/// Height below the map for scale bar and north arrow.
const FOOT: f64 = 36.0;
const DARK: Ink = [30, 38, 52];
const GREY: Ink = [96, 112, 136];
const WHITE: Ink = [255; 3];
const STAIRS: [f64; 2] = [1.0, 7.0];

/// The content of a map.
pub(super) struct Plan<'a> {
    pub(super) graph: &'a ViewpointGraph,
    /// Only this storey; all if the platform knows no storeys.
    pub(super) level: Option<u32>,
    /// The picture of the storey from above.
    pub(super) above: Option<&'a FromAbove>,
    pub(super) path: Option<&'a Path>,
}

/// The drawing, or `None` if the places cannot be drawn.
pub(super) fn sketch(plan: &Plan<'_>) -> Option<Sketch> {
    let stops: Vec<DVec3> =
        plan.path.into_iter().flat_map(|path| &path.frames).map(|frame| frame.pose.position).collect();
    let nodes = || plan.graph.viewpoints().filter(|node| plan.is_here(plan.graph.level(node))).take(MOST_NODES);
    let first = stops.first().copied().or_else(|| nodes().find_map(|node| plan.graph.position(node)))?;
    let is_near = |at: &DVec3| (*at - first).abs().max_element() <= MOST_SPAN_M;
    if !stops.iter().all(is_near) {
        return None;
    }
    let position = |node: &ViewpointId| plan.graph.position(node).filter(is_near);
    let corners = plan.above.map(|above| [above.corner_m, above.far_corner_m()]);
    let places = nodes().filter_map(position).chain(stops.iter().copied()).map(|at| [at.x, at.y]);
    let sheet = Sheet::around(places.chain(corners.into_iter().flatten()), &PAPER)?;
    let mut marks = Vec::new();
    ways(plan, &sheet, position, &mut marks);
    for node in nodes() {
        if let Some(at) = position(node) {
            let at = sheet.place([at.x, at.y]);
            marks.push(Mark::Disc { at, radius: 4.0, ink: WHITE, title: None });
            marks.push(Mark::Disc { at, radius: 2.8, ink: GREY, title: Some(node.to_string()) });
        }
    }
    if let Some(path) = plan.path {
        walk(plan, path, &stops, &sheet, &mut marks);
    }
    foot(&sheet, &mut marks);
    let picture =
        plan.above.zip(corners).map(|(above, corners)| (above.image.clone(), corners.map(|at| sheet.place(at))));
    Some(Sketch { size: [sheet.size[0], sheet.size[1] + FOOT], picture, marks })
}

impl Plan<'_> {
    /// Whether things on this storey are drawn. Things without a known storey always are.
    fn is_here(&self, level: Option<u32>) -> bool {
        level.zip(self.level).is_none_or(|(level, here)| level == here)
    }
}

/// Draws the edges of the graph; those that leave the storey are dotted.
fn ways(plan: &Plan<'_>, sheet: &Sheet, position: impl Fn(&ViewpointId) -> Option<DVec3>, marks: &mut Vec<Mark>) {
    for (from, to, _) in plan.graph.edges().take(4 * MOST_NODES) {
        let here = [from, to].map(|node| plan.is_here(plan.graph.level(node)));
        let (Some(from), Some(to)) = (position(from), position(to)) else { continue };
        if here.contains(&true) {
            let points = vec![sheet.place([from.x, from.y]), sheet.place([to.x, to.y])];
            let dash = here.contains(&false).then_some([0.1, 4.0]);
            marks.push(Mark::Line { points, width: 1.2, ink: GREY, dash });
        }
    }
}

/// Draws the path, with a numbered badge for each frame.
fn walk(plan: &Plan<'_>, path: &Path, stops: &[DVec3], sheet: &Sheet, marks: &mut Vec<Mark>) {
    let at: Vec<Point> = stops.iter().map(|stop| sheet.place([stop.x, stop.y])).collect();
    let Some(start) = path.frames.first().map(|frame| frame.pose.heading) else { return };
    let trail = Trail::of_frames(stops, start);
    let spots = spots(&trail, &at, sheet.size);
    let line = |points: Vec<Point>, width: f64, ink: Ink, dash| Mark::Line { points, width, ink, dash };
    marks.push(line(at.clone(), 7.5, WHITE, None));
    for (from, hop) in at.windows(2).enumerate() {
        let climbs = Climb::from_rise(stops[from + 1].z - stops[from].z) != Climb::Level;
        let fill = ink(&colour(from, at.len()).fill);
        marks.push(line(hop.to_vec(), 4.5, fill, climbs.then_some(STAIRS)));
    }
    for spot in spots.iter().filter(|spot| spot.is_aside) {
        marks.push(line(vec![spot.at, spot.badge], 1.0, DARK, None));
        marks.push(Mark::Disc { at: spot.at, radius: 3.0, ink: DARK, title: None });
    }
    if let Some(first) = spots.first() {
        marks.push(facing(first.badge, start));
    }
    for spot in &spots {
        let is_here = plan.is_here(path.frames[spot.stop].level);
        badge(spot, is_here, marks);
    }
}

/// Draws the badge with a frame's number; it is hollow if the frame is on another storey.
fn badge(spot: &Spot, is_here: bool, marks: &mut Vec<Mark>) {
    let (at, fill) = (spot.badge, ink(&spot.colour.fill));
    let mut disc = |radius: f64, ink: Ink| marks.push(Mark::Disc { at, radius, ink, title: None });
    if spot.is_last {
        disc(RADIUS + 4.5, DARK);
        disc(RADIUS + 3.0, WHITE);
    }
    disc(RADIUS + 1.5, WHITE);
    disc(RADIUS, fill);
    if !is_here {
        disc(RADIUS - 1.8, WHITE);
    }
    let ink = if is_here { ink(spot.colour.ink) } else { DARK };
    marks.push(Mark::Text { at, size: 10.5, text: spot.number.to_string(), ink, is_centred: true });
}

/// The triangle that points in the heading at the start.
fn facing(at: Point, heading: Heading) -> Mark {
    let (sin, cos) = (heading.direction().x, heading.direction().y);
    let turned = |[x, y]: Point| [at[0] + x * cos - y * sin, at[1] + x * sin + y * cos];
    let corners = [[-8.0, -RADIUS - 0.5], [0.0, -RADIUS - 13.5], [8.0, -RADIUS - 0.5]].map(turned);
    Mark::Triangle { corners, ink: DARK }
}

/// Draws the scale bar and the north arrow below the map.
fn foot(sheet: &Sheet, marks: &mut Vec<Mark>) {
    let [width, height] = sheet.size;
    let (bar, bar_m) = sheet.bar();
    let (left, ground) = (PAPER.padding, height + 14.0);
    let line = |points: Vec<Point>| Mark::Line { points, width: 1.8, ink: DARK, dash: None };
    let ends = [[left, ground - 6.0], [left, ground], [left + bar, ground], [left + bar, ground - 6.0]];
    marks.push(line(ends.to_vec()));
    let text = |at: Point, text: String| Mark::Text { at, size: 12.0, text, ink: DARK, is_centred: false };
    marks.push(text([left + bar + 9.0, ground - 3.0], format!("{bar_m} m")));
    let north = width - PAPER.padding - 14.0;
    marks.push(line(vec![[north, ground + 8.0], [north, ground - 14.0]]));
    let tip = ground - 20.0;
    marks.push(Mark::Triangle {
        corners: [[north - 5.0, tip + 10.0], [north, tip], [north + 5.0, tip + 10.0]],
        ink: DARK,
    });
    marks.push(text([north + 8.0, ground - 3.0], "N".to_owned()));
}
