//! Turns positions on a floor, as VLN-CE's episodes have them, into the frames of a path.

use wayword_core::{
    DVec3, Frame, Heading, Path, Platform, PlatformError, Pose, SceneId, ViewGaze, ViewpointGraph, ViewpointId,
    path::PathStop,
};

/// How high the eyes are over the floor, metres: about the height of Matterport3D's cameras and of Habitat's agents.
const EYE_OVER_FLOOR_M: f64 = 1.5;
/// A position within this distance of a viewpoint is at it, metres over the floor. VLN-CE moved viewpoints onto the nearest navigable
/// point.
const AT_VIEWPOINT_M: f64 = 0.5;
/// Floors that differ by more are two storeys, metres.
const SAME_FLOOR_M: f64 = 1.0;
/// A route over the graph stands for the positions between two viewpoints if it is at most this many times as long as they are, plus
/// [`ROUTE_SLACK_M`].
const ROUTE_FACTOR: f64 = 1.2;
/// See [`ROUTE_FACTOR`], metres.
const ROUTE_SLACK_M: f64 = 0.5;

/// The frames of a walk over `floor`: positions on the floor, metres, world frame. The first frame looks along `heading`, or else along
/// the first hop.
///
/// A platform that shows every place gets a frame at each position, with the eye 1.5 m above it. A platform that shows only the
/// viewpoints of its graph gets the viewpoints within half a metre of the positions, and the route between them; positions far from
/// every viewpoint stay frames without one.
///
/// # Errors
/// When the scene is unknown, or its data cannot be read.
pub fn frames_over_floor(
    platform: &dyn Platform,
    scene: &SceneId,
    floor: &[DVec3],
    heading: Option<Heading>,
) -> Result<Vec<Frame>, PlatformError> {
    let Some(start) = floor.first() else { return Ok(Vec::new()) };
    let graph = platform.graph_for_scene(scene)?;
    let between: Vec<PathStop> = floor.iter().map(|position| stop_between(&graph, *position)).collect();
    if shows_every_place(platform, scene, *start)? {
        return Ok(Path::frames_along(between, heading));
    }
    let stops = floor.iter().zip(between).map(|(position, between)| match viewpoint_at(&graph, *position) {
        Some(viewpoint) => stop_at(&graph, viewpoint).unwrap_or(between),
        None => between,
    });
    Ok(Path::frames_along(stops_over_graph(&graph, stops.collect()), heading))
}

/// Whether the platform gives views from places that are no viewpoints.
fn shows_every_place(platform: &dyn Platform, scene: &SceneId, floor: DVec3) -> Result<bool, PlatformError> {
    let pose = Pose::looking_level(floor + DVec3::Z * EYE_OVER_FLOOR_M, Heading::NORTH);
    let frame = Frame { pose, viewpoint: None, level: None };
    match platform.look_without_picture(scene, &frame, ViewGaze::quarter_view(pose.heading)) {
        Ok(_) => Ok(true),
        Err(PlatformError::NotAViewpoint { .. } | PlatformError::UnknownViewpoint { .. }) => Ok(false),
        Err(error) => Err(error),
    }
}

/// The place on the floor under a viewpoint, metres, world frame.
fn floor_under(graph: &ViewpointGraph, viewpoint: &ViewpointId) -> Option<DVec3> {
    let eye = graph.position_of(viewpoint)?;
    Some(eye.with_z(graph.floor_m(viewpoint).unwrap_or(eye.z - EYE_OVER_FLOOR_M)))
}

/// The viewpoints on the storey of a position on the floor, each with its distance over the floor, metres.
fn viewpoints_on_floor(graph: &ViewpointGraph, floor: DVec3) -> impl Iterator<Item = (&ViewpointId, f64)> {
    graph.viewpoints().filter_map(move |viewpoint| {
        let off = floor_under(graph, viewpoint)? - floor;
        (off.z.abs() <= SAME_FLOOR_M).then(|| (viewpoint, off.truncate().length()))
    })
}

fn viewpoint_at(graph: &ViewpointGraph, floor: DVec3) -> Option<&ViewpointId> {
    let near = viewpoints_on_floor(graph, floor).filter(|(_, off_m)| *off_m <= AT_VIEWPOINT_M);
    near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(viewpoint, _)| viewpoint)
}

fn stop_at(graph: &ViewpointGraph, viewpoint: &ViewpointId) -> Option<PathStop> {
    let position = graph.position_of(viewpoint)?;
    Some(PathStop { position, viewpoint: Some(viewpoint.clone()), level: graph.level_of(viewpoint) })
}

/// A stop at no viewpoint. Its storey is that of the nearest viewpoint on its floor.
fn stop_between(graph: &ViewpointGraph, floor: DVec3) -> PathStop {
    let nearest = viewpoints_on_floor(graph, floor).min_by(|a, b| a.1.total_cmp(&b.1));
    let level = nearest.and_then(|(viewpoint, _)| graph.level_of(viewpoint));
    PathStop { position: floor + DVec3::Z * EYE_OVER_FLOOR_M, viewpoint: None, level }
}

/// Replaces the stops between two viewpoints by the route over the graph, where that is about as long.
fn stops_over_graph(graph: &ViewpointGraph, stops: Vec<PathStop>) -> Vec<PathStop> {
    let mut over_graph: Vec<PathStop> = Vec::new();
    // The index in `over_graph` of the last viewpoint, and the distance since.
    let mut last_viewpoint: Option<usize> = None;
    let mut walked_m = 0.0;
    let mut before: Option<DVec3> = None;
    for stop in stops {
        walked_m += before.map_or(0.0, |before| before.distance(stop.position));
        before = Some(stop.position);
        let Some(viewpoint) = &stop.viewpoint else {
            over_graph.push(stop);
            continue;
        };
        let from = last_viewpoint.and_then(|at| Some((at, over_graph[at].viewpoint.clone()?)));
        let route = match from {
            Some((at, from)) => graph.shortest_path(&from, viewpoint).ok().flatten().map(|route| (at, route)),
            None => None,
        };
        match route.filter(|(_, route)| route.length_m <= ROUTE_FACTOR * walked_m + ROUTE_SLACK_M) {
            Some((at, route)) => {
                over_graph.truncate(at + 1);
                over_graph.extend(route.viewpoints.iter().skip(1).filter_map(|viewpoint| stop_at(graph, viewpoint)));
            }
            None => over_graph.push(stop),
        }
        last_viewpoint = Some(over_graph.len() - 1);
        walked_m = 0.0;
    }
    over_graph
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::sync::Arc;
    use wayword_core::{PathRequest, View};

    /// A building with two storeys, seen from its viewpoints alone or from every place.
    struct TwoStoreys {
        graph: Arc<ViewpointGraph>,
        shows_every_place: bool,
    }

    /// Viewpoints on the lower storey, joined in a row, and one above the third.
    const EYES: [[f64; 3]; 5] = [[0.0, 0.0, 1.5], [2.5, 0.0, 1.4], [2.5, 3.0, 1.5], [5.0, 3.0, 1.6], [2.5, 3.0, 4.5]];

    fn name(number: usize) -> ViewpointId {
        ViewpointId::new(format!("v{number}")).unwrap()
    }

    fn building(shows_every_place: bool) -> TwoStoreys {
        let mut graph = ViewpointGraph::default();
        for (number, eye) in EYES.iter().enumerate() {
            let level = if eye[2] > 3.0 { 2 } else { 1 };
            graph.add_viewpoint(name(number), DVec3::from_array(*eye), Some(level)).unwrap();
        }
        for number in 1..EYES.len() {
            graph.join_viewpoints(&name(number - 1), &name(number)).unwrap();
        }
        TwoStoreys { graph: Arc::new(graph), shows_every_place }
    }

    impl Platform for TwoStoreys {
        fn name(&self) -> &'static str {
            "two storeys"
        }

        fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
            Ok(vec![scene()])
        }

        fn graph_for_scene(&self, _: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
            Ok(Arc::clone(&self.graph))
        }

        fn sample_path(&self, scene: &SceneId, _: &PathRequest, _: u64) -> Result<Path, PlatformError> {
            Err(PlatformError::UnknownScene { scene: scene.to_string(), hint: String::new() })
        }

        fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
            if from.viewpoint.is_none() && !self.shows_every_place {
                return Err(PlatformError::NotAViewpoint { scene: scene.clone() });
            }
            Ok(View::new(from.pose, gaze.horizontal_fov_rad, None, None))
        }
    }

    fn scene() -> SceneId {
        SceneId::new("s").unwrap()
    }

    fn floor(number: usize) -> DVec3 {
        DVec3::from_array(EYES[number]) - DVec3::Z * 1.5
    }

    fn viewpoints(positions: &[DVec3]) -> Vec<Option<ViewpointId>> {
        let frames = frames_over_floor(&building(false), &scene(), positions, None).unwrap();
        frames.into_iter().map(|frame| frame.viewpoint).collect()
    }

    fn names(numbers: &[usize]) -> Vec<Option<ViewpointId>> {
        numbers.iter().map(|number| Some(name(*number))).collect()
    }

    #[test]
    fn positions_near_viewpoints_are_the_path_over_the_graph() {
        let frames = frames_over_floor(&building(false), &scene(), &[floor(0), floor(1), floor(2)], None).unwrap();
        let over_graph = building(false).graph.path_frames(&[name(0), name(1), name(2)], None).unwrap();
        assert_eq!(frames, over_graph);
        // The storey above is another place.
        assert_eq!(
            viewpoints(&[floor(0), floor(2)]),
            names(&[0, 2]),
            "a short cut over the floor is no way over the graph"
        );
        assert_eq!(viewpoints(&[floor(2), floor(4)])[1], Some(name(4)));
    }

    #[test]
    fn positions_far_from_every_viewpoint_stay_places_without_one() {
        let far = DVec3::new(-3.0, 0.0, 0.0);
        assert_eq!(viewpoints(&[far, floor(0), floor(1)]), [None, Some(name(0)), Some(name(1))]);
        let frames = frames_over_floor(&building(false), &scene(), &[far], None).unwrap();
        assert_eq!((frames[0].pose.position.z, frames[0].level), (1.5, Some(1)));
        assert!(frames_over_floor(&building(false), &scene(), &[], None).unwrap().is_empty());
    }

    #[test]
    fn a_platform_that_shows_every_place_gets_a_frame_at_each_position() {
        let positions = [floor(0), DVec3::new(1.2, 0.1, 0.0), floor(1)];
        let frames = frames_over_floor(&building(true), &scene(), &positions, None).unwrap();
        let eyes: Vec<DVec3> = frames.iter().map(|frame| frame.pose.position).collect();
        assert_eq!(eyes, positions.map(|position| position + DVec3::Z * 1.5));
        assert!(frames.iter().all(|frame| frame.viewpoint.is_none() && frame.level == Some(1)));
    }

    proptest! {
        #[test]
        fn a_walk_in_small_steps_beside_the_edges_is_the_path_over_them(
            off in prop::collection::vec((-0.3..0.3f64, -0.3..0.3f64, -0.3..0.3f64), 4),
            step_m in 0.2..0.6f64,
        ) {
            let corners: Vec<DVec3> =
                off.iter().enumerate().map(|(number, off)| floor(number) + DVec3::from(*off)).collect();
            let mut steps = vec![corners[0]];
            for pair in corners.windows(2) {
                let count = (pair[0].distance(pair[1]) / step_m).ceil();
                steps.extend((1..=count as usize).map(|at| pair[0].lerp(pair[1], at as f64 / count)));
            }
            prop_assert_eq!(viewpoints(&steps), names(&[0, 1, 2, 3]));
        }
    }
}
