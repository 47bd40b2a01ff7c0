//! Lays out a map: places the viewpoints, edges and path of a storey on a sheet, and adds the scale bar and the north arrow.

use super::sketch::{InkColour, MapMark, MapSketch, SheetPoint, ink_from_css};
use crate::pages::{
    map::{BADGE_RADIUS, MAX_MAP_NODES, MAX_MAP_SPAN_M, MapSpot, MapTrail, place_spots},
    palette::frame_colour,
    sheet::{MapSheet, SheetLimits},
};
use wayword_core::{ClimbDirection, DVec3, FromAbove, Heading, Path, ViewpointGraph, ViewpointId};

/// The limits of the sheet.
const VIEW_MAP_LIMITS: SheetLimits =
    SheetLimits { most: [800.0, 760.0], least: [240.0, 160.0], padding: 26.0, margin_m: 0.5, most_scale: 64.0 };
/// Height below the map for scale bar and north arrow, units of the sheet.
const FOOT_HEIGHT: f64 = 36.0;
const DARK_INK: InkColour = [30, 38, 52];
const GREY_INK: InkColour = [96, 112, 136];
const WHITE_INK: InkColour = [255; 3];
/// The dashes of a hop on stairs: lengths of a dash and of the gap after it, units of the sheet. With round ends these are dots.
const STAIR_DASH: [f64; 2] = [1.0, 7.0];

/// The content of a map.
pub(super) struct MapPlan<'a> {
    pub(super) graph: &'a ViewpointGraph,
    /// Only this storey; all if the platform knows no storeys.
    pub(super) level: Option<u32>,
    /// The picture of the storey from above.
    pub(super) above: Option<&'a FromAbove>,
    pub(super) path: Option<&'a Path>,
}

/// The drawing, or `None` if the places cannot be drawn.
pub(super) fn sketch_plan(plan: &MapPlan<'_>) -> Option<MapSketch> {
    let stops: Vec<DVec3> =
        plan.path.into_iter().flat_map(|path| &path.frames).map(|frame| frame.pose.position).collect();
    let nodes = || plan.graph.viewpoints().filter(|node| plan.is_here(plan.graph.level_of(node))).take(MAX_MAP_NODES);
    let first = stops.first().copied().or_else(|| nodes().find_map(|node| plan.graph.position_of(node)))?;
    let is_near = |at: &DVec3| (*at - first).abs().max_element() <= MAX_MAP_SPAN_M;
    if !stops.iter().all(is_near) {
        return None;
    }
    let position = |node: &ViewpointId| plan.graph.position_of(node).filter(is_near);
    let corners = plan.above.map(|above| [above.corner_m, above.far_corner_m()]);
    let places = nodes().filter_map(position).chain(stops.iter().copied()).map(|at| [at.x, at.y]);
    let sheet = MapSheet::around_points(places.chain(corners.into_iter().flatten()), &VIEW_MAP_LIMITS)?;
    let mut marks = Vec::new();
    sketch_edges(plan, &sheet, position, &mut marks);
    for node in nodes() {
        if let Some(at) = position(node) {
            let at = sheet.place_point([at.x, at.y]);
            marks.push(MapMark::Disc { at, radius: 4.0, ink: WHITE_INK, title: None });
            marks.push(MapMark::Disc { at, radius: 2.8, ink: GREY_INK, title: Some(node.to_string()) });
        }
    }
    if let Some(path) = plan.path {
        sketch_path(plan, path, &stops, &sheet, &mut marks);
    }
    sketch_foot(&sheet, &mut marks);
    let picture =
        plan.above.zip(corners).map(|(above, corners)| (above.image.clone(), corners.map(|at| sheet.place_point(at))));
    Some(MapSketch { size: [sheet.size[0], sheet.size[1] + FOOT_HEIGHT], picture, marks })
}

impl MapPlan<'_> {
    /// Whether things on this storey are drawn. Things without a known storey always are.
    fn is_here(&self, level: Option<u32>) -> bool {
        level.zip(self.level).is_none_or(|(level, here)| level == here)
    }
}

/// Draws the edges of the graph; those that leave the storey are dotted.
fn sketch_edges(
    plan: &MapPlan<'_>,
    sheet: &MapSheet,
    position: impl Fn(&ViewpointId) -> Option<DVec3>,
    marks: &mut Vec<MapMark>,
) {
    for (from, to, _) in plan.graph.edges().take(4 * MAX_MAP_NODES) {
        let here = [from, to].map(|node| plan.is_here(plan.graph.level_of(node)));
        let (Some(from), Some(to)) = (position(from), position(to)) else { continue };
        if here.contains(&true) {
            let points = vec![sheet.place_point([from.x, from.y]), sheet.place_point([to.x, to.y])];
            let dash = here.contains(&false).then_some([0.1, 4.0]);
            marks.push(MapMark::Line { points, width: 1.2, ink: GREY_INK, dash });
        }
    }
}

/// Draws the path, with a numbered badge for each frame.
fn sketch_path(plan: &MapPlan<'_>, path: &Path, stops: &[DVec3], sheet: &MapSheet, marks: &mut Vec<MapMark>) {
    let at: Vec<SheetPoint> = stops.iter().map(|stop| sheet.place_point([stop.x, stop.y])).collect();
    let Some(start) = path.frames.first().map(|frame| frame.pose.heading) else { return };
    let trail = MapTrail::from_frames(stops, start);
    let spots = place_spots(&trail, &at, sheet.size);
    let line = |points: Vec<SheetPoint>, width: f64, ink: InkColour, dash| MapMark::Line { points, width, ink, dash };
    marks.push(line(at.clone(), 7.5, WHITE_INK, None));
    for (from, hop) in at.windows(2).enumerate() {
        let climbs = ClimbDirection::from_rise(stops[from + 1].z - stops[from].z) != ClimbDirection::Level;
        let fill = ink_from_css(&frame_colour(from, at.len()).fill);
        marks.push(line(hop.to_vec(), 4.5, fill, climbs.then_some(STAIR_DASH)));
    }
    for spot in spots.iter().filter(|spot| spot.is_aside) {
        marks.push(line(vec![spot.at, spot.badge], 1.0, DARK_INK, None));
        marks.push(MapMark::Disc { at: spot.at, radius: 3.0, ink: DARK_INK, title: None });
    }
    if let Some(first) = spots.first() {
        marks.push(facing_mark(first.badge, start));
    }
    for spot in &spots {
        let is_here = plan.is_here(path.frames[spot.stop].level);
        sketch_badge(spot, is_here, marks);
    }
}

/// Draws the badge with a frame's number; it is hollow if the frame is on another storey.
fn sketch_badge(spot: &MapSpot, is_here: bool, marks: &mut Vec<MapMark>) {
    let (at, fill) = (spot.badge, ink_from_css(&spot.colour.fill));
    let mut disc = |radius: f64, ink: InkColour| marks.push(MapMark::Disc { at, radius, ink, title: None });
    if spot.is_last {
        disc(BADGE_RADIUS + 4.5, DARK_INK);
        disc(BADGE_RADIUS + 3.0, WHITE_INK);
    }
    disc(BADGE_RADIUS + 1.5, WHITE_INK);
    disc(BADGE_RADIUS, fill);
    if !is_here {
        disc(BADGE_RADIUS - 1.8, WHITE_INK);
    }
    let ink = if is_here { ink_from_css(spot.colour.ink) } else { DARK_INK };
    marks.push(MapMark::Text { at, size: 10.5, text: spot.number.to_string(), ink, is_centred: true });
}

/// The triangle that points in the heading at the start.
fn facing_mark(at: SheetPoint, heading: Heading) -> MapMark {
    let (sin, cos) = (heading.unit_vector().x, heading.unit_vector().y);
    let turned = |[x, y]: SheetPoint| [at[0] + x * cos - y * sin, at[1] + x * sin + y * cos];
    let corners = [[-8.0, -BADGE_RADIUS - 0.5], [0.0, -BADGE_RADIUS - 13.5], [8.0, -BADGE_RADIUS - 0.5]].map(turned);
    MapMark::Triangle { corners, ink: DARK_INK }
}

/// Draws the scale bar and the north arrow below the map.
fn sketch_foot(sheet: &MapSheet, marks: &mut Vec<MapMark>) {
    let [width, height] = sheet.size;
    let (bar, bar_m) = sheet.scale_bar();
    let (left, ground) = (VIEW_MAP_LIMITS.padding, height + 14.0);
    let line = |points: Vec<SheetPoint>| MapMark::Line { points, width: 1.8, ink: DARK_INK, dash: None };
    let ends = [[left, ground - 6.0], [left, ground], [left + bar, ground], [left + bar, ground - 6.0]];
    marks.push(line(ends.to_vec()));
    let text = |at: SheetPoint, text: String| MapMark::Text { at, size: 12.0, text, ink: DARK_INK, is_centred: false };
    marks.push(text([left + bar + 9.0, ground - 3.0], format!("{bar_m} m")));
    let north = width - VIEW_MAP_LIMITS.padding - 14.0;
    marks.push(line(vec![[north, ground + 8.0], [north, ground - 14.0]]));
    let tip = ground - 20.0;
    marks.push(MapMark::Triangle {
        corners: [[north - 5.0, tip + 10.0], [north, tip], [north + 5.0, tip + 10.0]],
        ink: DARK_INK,
    });
    marks.push(text([north + 8.0, ground - 3.0], "N".to_owned()));
}
