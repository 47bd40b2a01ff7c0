//! Computes the map of an item or a replay: converts metres in world coordinates to units of an SVG, north up.

use super::{
    palette::{FrameColour, frame_colour},
    sheet::{MapSheet, SheetLimits, round_to_tenth},
};
use serde::Serialize;
use std::fmt::Write;
use wayword_core::{ClimbDirection, DVec3, Heading, Path};
use wayword_run::run_folder::PathMap;

/// A map, ready to be drawn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct MapView {
    pub(super) width: f64,
    pub(super) height: f64,
    /// Edges of the viewpoint graph, as path data.
    pub(super) edges: String,
    /// Its nodes, as path data: strokes of no length, round at the ends.
    pub(super) nodes: String,
    /// The path, hop by hop.
    pub(super) hops: Vec<MapHop>,
    /// The frames.
    pub(super) spots: Vec<MapSpot>,
    /// Heading at the start, degrees clockwise from north.
    pub(super) start_deg: f64,
    /// Length of the scale bar.
    pub(super) bar: f64,
    /// Its length in the scene, metres.
    pub(super) bar_m: u32,
    /// The annotated path, if the walk is compared with one.
    pub(super) annotated: Option<AnnotatedPathView>,
}

/// The path that people annotated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct AnnotatedPathView {
    pub(super) data: String,
    pub(super) goal: [f64; 2],
}

/// A straight line between two frames.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct MapHop {
    /// The place of its first frame on the trail, from 0.
    pub(super) from: usize,
    pub(super) data: String,
    pub(super) fill: String,
    /// Whether it goes up or down stairs.
    pub(super) climbs: bool,
    /// Whether it goes back to where the walk came from.
    pub(super) is_back: bool,
}

/// A frame on the map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct MapSpot {
    /// Its place on the trail, from 0.
    pub(crate) stop: usize,
    /// The number that is shown.
    pub(crate) number: usize,
    /// Whether the last frame is here.
    pub(crate) is_last: bool,
    /// The frame's place.
    pub(crate) at: [f64; 2],
    /// The place of its number: next to the frame if another number is in the way.
    pub(crate) badge: [f64; 2],
    pub(crate) is_aside: bool,
    pub(crate) colour: FrameColour,
}

/// A map as wide as a phone, so that its numbers are readable there. The graph goes on beyond its edge.
const ITEM_MAP_LIMITS: SheetLimits =
    SheetLimits { most: [360.0, 330.0], least: [220.0, 170.0], padding: 34.0, margin_m: 1.2, most_scale: 42.0 };
/// Radius of the badge with a frame's number, units of the drawing.
pub(crate) const BADGE_RADIUS: f64 = 9.5;
/// The smallest distance between the centres of two badges, units: they may overlap a little, but each has to be readable.
const MIN_BADGE_DISTANCE: f64 = 1.5 * BADGE_RADIUS;
/// How far the control point of a hop back is from the straight line, units.
const HOP_BACK_BEND: f64 = 32.0;
/// A map with a stop farther than this from the first one, on either axis, is not drawn; nodes that far are left out. Metres.
pub(crate) const MAX_MAP_SPAN_M: f64 = 2_000.0;
/// Most nodes of the graph that are drawn. The limits on edges are multiples of it.
pub(crate) const MAX_MAP_NODES: usize = 4_000;

impl MapView {
    /// The map of the first `frames` frames, or `None` if their positions are not known or cannot be drawn.
    pub(super) fn new(path: &Path, map: &PathMap, frames: usize) -> Option<Self> {
        if !path.motion.is_known() {
            return None;
        }
        let stops: Vec<DVec3> = path.frames.iter().take(frames).map(|frame| frame.pose.position).collect();
        let start = path.frames.first()?.pose.heading;
        Self::draw_trail(map, &MapTrail::from_frames(&stops, start))
    }

    /// The map of a trail, or `None` if its positions cannot be drawn.
    pub(super) fn draw_trail(map: &PathMap, trail: &MapTrail<'_>) -> Option<Self> {
        let first = *trail.stops.first()?;
        let is_near = |x: f64, y: f64| (x - first.x).abs() <= MAX_MAP_SPAN_M && (y - first.y).abs() <= MAX_MAP_SPAN_M;
        let all_stops = || trail.stops.iter().chain(trail.annotated);
        if !all_stops().all(|stop| is_near(stop.x, stop.y) && stop.z.is_finite()) {
            return None;
        }
        let nodes: Vec<Option<[f64; 2]>> =
            map.nodes.iter().take(MAX_MAP_NODES).map(|[x, y]| is_near(*x, *y).then_some([*x, *y])).collect();
        let sheet = MapSheet::around_points(all_stops().map(|stop| [stop.x, stop.y]), &ITEM_MAP_LIMITS)?;
        let places: Vec<Option<[f64; 2]>> = nodes.iter().map(|node| node.map(|node| sheet.place_point(node))).collect();
        let at: Vec<[f64; 2]> = trail.stops.iter().map(|stop| sheet.place_point([stop.x, stop.y])).collect();
        let (bar, bar_m) = sheet.scale_bar();
        Some(Self {
            width: sheet.size[0],
            height: sheet.size[1],
            edges: edge_data(&places, &map.edges),
            nodes: dot_data(&places),
            hops: map_hops(trail, &at),
            spots: place_spots(trail, &at, sheet.size),
            start_deg: round_to_tenth(trail.start.deg()),
            bar,
            bar_m,
            annotated: annotated_path(trail.annotated, &sheet),
        })
    }
}

/// A walk to be drawn on a map; positions in metres, world frame.
pub(crate) struct MapTrail<'a> {
    pub(crate) stops: &'a [DVec3],
    /// The heading at the start.
    pub(crate) start: Heading,
    /// For each hop whether it goes back. Hops without a value do not.
    pub(crate) backs: &'a [bool],
    /// The path that people annotated; its last place is the goal.
    pub(crate) annotated: &'a [DVec3],
    /// The number of the first stop.
    pub(crate) first_number: usize,
    /// Whether a place has only one number, that of the first stop there, however often the walk returns.
    pub(crate) is_numbered_once: bool,
}

impl<'a> MapTrail<'a> {
    /// The frames of a path, numbered from 0 as in run folders and on the terminal.
    pub(crate) fn from_frames(stops: &'a [DVec3], start: Heading) -> Self {
        Self { stops, start, backs: &[], annotated: &[], first_number: 0, is_numbered_once: false }
    }
}

fn edge_data(places: &[Option<[f64; 2]>], edges: &[[usize; 2]]) -> String {
    let mut data = String::new();
    for [from, to] in edges.iter().take(2 * MAX_MAP_NODES) {
        if let (Some(Some(from)), Some(Some(to))) = (places.get(*from), places.get(*to)) {
            data.push_str(&line_data(*from, *to));
        }
    }
    data
}

fn dot_data(places: &[Option<[f64; 2]>]) -> String {
    places.iter().flatten().fold(String::new(), |mut data, [x, y]| {
        // Writing to a text cannot fail.
        let _ = write!(data, "M{x} {y}h0");
        data
    })
}

fn line_data(from: [f64; 2], to: [f64; 2]) -> String {
    format!("M{} {}L{} {}", from[0], from[1], to[0], to[1])
}

fn map_hops(trail: &MapTrail<'_>, at: &[[f64; 2]]) -> Vec<MapHop> {
    let hop = |from: usize| {
        let is_back = trail.backs.get(from).is_some_and(|is_back| *is_back);
        MapHop {
            from,
            data: if is_back { bow_data(at[from], at[from + 1]) } else { line_data(at[from], at[from + 1]) },
            fill: frame_colour(from, at.len()).fill,
            climbs: ClimbDirection::from_rise(trail.stops[from + 1].z - trail.stops[from].z) != ClimbDirection::Level,
            is_back,
        }
    };
    (0..at.len().saturating_sub(1)).map(hop).collect()
}

/// A bent line for a hop back, so that it does not hide the straight hop in the other direction.
fn bow_data(from: [f64; 2], to: [f64; 2]) -> String {
    let [x, y] = [0, 1].map(|axis| to[axis] - from[axis]);
    let length = x.hypot(y).max(1.0);
    let control =
        [(from[0] + to[0]) / 2.0 - y / length * HOP_BACK_BEND, (from[1] + to[1]) / 2.0 + x / length * HOP_BACK_BEND]
            .map(round_to_tenth);
    format!("M{} {}Q{} {} {} {}", from[0], from[1], control[0], control[1], to[0], to[1])
}

fn annotated_path(path: &[DVec3], sheet: &MapSheet) -> Option<AnnotatedPathView> {
    let at: Vec<[f64; 2]> = path.iter().map(|stop| sheet.place_point([stop.x, stop.y])).collect();
    let data = at.iter().zip("M".chars().chain(std::iter::repeat('L'))).map(|([x, y], verb)| format!("{verb}{x} {y}"));
    Some(AnnotatedPathView { data: data.collect(), goal: *at.last()? })
}

/// The eight directions in which a number may move aside, the most usual first.
const ASIDE_DIRECTIONS: [[f64; 2]; 8] =
    [[1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0], [0.7, -0.7], [-0.7, -0.7], [0.7, 0.7], [-0.7, 0.7]];

/// Puts each number on its frame, or next to it where an earlier number is in the way (stairs, loops, close frames).
pub(crate) fn place_spots(trail: &MapTrail<'_>, at: &[[f64; 2]], size: [f64; 2]) -> Vec<MapSpot> {
    let first_at = |stop: usize| {
        let earlier = trail.stops.iter().position(|other| *other == trail.stops[stop]);
        earlier.filter(|_| trail.is_numbered_once).unwrap_or(stop)
    };
    let last = at.len().checked_sub(1).map(first_at);
    let mut spots: Vec<MapSpot> = Vec::new();
    for (stop, place) in at.iter().enumerate().filter(|(stop, _)| first_at(*stop) == *stop) {
        let is_free = |spot: &[f64; 2]| {
            let is_inside = (0..2).all(|axis| spot[axis] >= BADGE_RADIUS && spot[axis] <= size[axis] - BADGE_RADIUS);
            is_inside
                && spots
                    .iter()
                    .all(|other| (spot[0] - other.badge[0]).hypot(spot[1] - other.badge[1]) >= MIN_BADGE_DISTANCE)
        };
        // Distances from the frame, in radii of a badge.
        let beside = [2.3, 3.6, 5.0].into_iter().flat_map(|far| {
            ASIDE_DIRECTIONS.map(|way| [0, 1].map(|axis| round_to_tenth(place[axis] + way[axis] * far * BADGE_RADIUS)))
        });
        let badge = std::iter::once(*place).chain(beside).find(is_free).unwrap_or(*place);
        spots.push(MapSpot {
            stop,
            number: trail.first_number + stop,
            is_last: last == Some(stop),
            at: *place,
            badge,
            is_aside: *place != badge,
            colour: frame_colour(stop, at.len()),
        });
    }
    spots
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{Frame, PathMotion, Pose, SceneId};

    fn path(stops: &[[f64; 3]]) -> Path {
        let frame = |[x, y, z]: &[f64; 3]| Frame {
            pose: Pose::looking_level(DVec3::new(*x, *y, *z), Heading::NORTH),
            viewpoint: None,
            level: None,
        };
        Path {
            id: "p".into(),
            scene: SceneId::new("s").unwrap(),
            frames: stops.iter().map(frame).collect(),
            motion: PathMotion::Known,
            target: None,
        }
    }

    fn map_of(stops: &[[f64; 3]]) -> Option<MapView> {
        MapView::new(&path(stops), &PathMap::default(), stops.len())
    }

    #[test]
    fn north_is_up_and_the_bar_is_to_scale() {
        let map = map_of(&[[0.0, 0.0, 0.0], [0.0, 4.0, 0.0], [3.0, 4.0, 0.0]]).unwrap();
        let at: Vec<[f64; 2]> = map.spots.iter().map(|spot| spot.at).collect();
        assert!(at[1][1] < at[0][1] && at[1][0] == at[0][0] && at[2][0] > at[1][0]);
        let units_per_m = (at[0][1] - at[1][1]) / 4.0;
        assert!((map.bar - units_per_m * f64::from(map.bar_m)).abs() < 0.2);
    }

    #[test]
    fn everything_lies_on_the_sheet() {
        for stops in [
            vec![[0.0; 3]],
            vec![[0.0; 3], [900.0, 0.1, 0.0]],
            vec![[5.0, 1.0, 0.0]; 40],
            vec![[0.0; 3], [0.0, 60.0, 0.0]],
        ] {
            let map = map_of(&stops).unwrap();
            for place in map.spots.iter().flat_map(|spot| [spot.at, spot.badge]) {
                assert!((0.0..=map.width).contains(&place[0]) && (0.0..=map.height).contains(&place[1]), "{place:?}");
            }
            assert!(map.width <= ITEM_MAP_LIMITS.most[0] && map.height <= ITEM_MAP_LIMITS.most[1]);
        }
    }

    #[test]
    fn spots_puts_numbers_of_stacked_frames_side_by_side() {
        let map = map_of(&[[0.0, 0.0, 0.0], [0.1, 0.0, 1.0], [0.0, 0.1, 2.0]]).unwrap();
        for (at, spot) in map.spots.iter().enumerate() {
            for other in &map.spots[..at] {
                let apart = (spot.badge[0] - other.badge[0]).hypot(spot.badge[1] - other.badge[1]);
                assert!(apart >= MIN_BADGE_DISTANCE);
            }
        }
        assert_eq!(map.spots.iter().map(|spot| spot.is_aside).collect::<Vec<_>>(), [false, true, true]);
        assert!(map.hops.iter().all(|hop| hop.climbs));
    }

    #[test]
    fn a_way_back_is_bent_to_where_a_number_is_and_the_annotated_path_is_on_the_sheet() {
        let stops = [[0.0, 0.0], [0.0, 3.0], [0.0, 0.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let annotated = [stops[0], DVec3::new(30.0, 0.0, 0.0)];
        let trail = MapTrail {
            stops: &stops,
            start: Heading::NORTH,
            backs: &[false, true],
            annotated: &annotated,
            first_number: 1,
            is_numbered_once: true,
        };
        let map = MapView::draw_trail(&PathMap::default(), &trail).unwrap();
        assert_eq!(map.hops.iter().map(|hop| hop.is_back).collect::<Vec<_>>(), [false, true]);
        let numbers: Vec<(usize, bool)> = map.spots.iter().map(|spot| (spot.number, spot.is_last)).collect();
        assert_eq!(numbers, [(1, true), (2, false)]);
        assert!(map.hops[0].data.contains('L') && map.hops[1].data.contains('Q'));
        let annotated = map.annotated.unwrap();
        assert!((0.0..=map.width).contains(&annotated.goal[0]) && annotated.goal[0] > map.spots[0].at[0] + 100.0);
        let far = [DVec3::new(1e300, 0.0, 0.0)];
        assert_eq!(MapView::draw_trail(&PathMap::default(), &MapTrail { annotated: &far, ..trail }), None);
    }

    #[test]
    fn hostile_numbers_make_no_map_and_hostile_edges_are_left_out() {
        assert_eq!(map_of(&[[0.0; 3], [1e300, 0.0, 0.0]]), None);
        assert_eq!(map_of(&[]), None);
        let map =
            PathMap { nodes: vec![[0.0, 0.0], [f64::MAX, 0.0], [1.0, 1.0]], edges: vec![[0, 1], [0, 99], [0, 2]] };
        let view = MapView::new(&path(&[[0.0; 3]]), &map, 1).unwrap();
        assert_eq!((view.edges.matches('M').count(), view.nodes.matches('M').count()), (1, 2));
    }
}
