//! A platform for tests: a cross of corridors, with a thing at the end of each arm.

use crate::agents::AgentStart;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};
use wayword_core::{
    DVec3, Frame, GroundTruth, Heading, ObjectId, ObjectLabel, Path, PathRequest, Platform, PlatformError, Pose,
    SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};

/// Arms of two nodes to the north, east, south and west of `middle`: `n1`, `n2`, `e1` and so on. Beyond the end of each arm is a
/// thing that is visible only from the arm's last node.
pub(crate) struct Cross {
    graph: Arc<ViewpointGraph>,
    things: BTreeMap<&'static str, &'static str>,
    rooms: BTreeMap<&'static str, &'static str>,
    has_labels: bool,
    pub(crate) looks: AtomicUsize,
    looked_from: Mutex<BTreeSet<ViewpointId>>,
}

const ARMS: [(&str, f64); 4] = [("n", 0.0), ("e", 90.0), ("s", 180.0), ("w", 270.0)];

/// Which way a node's arm leads.
fn outward(node: &str) -> Heading {
    let (_, deg) = ARMS.into_iter().find(|(arm, _)| node.starts_with(arm)).unwrap_or(("", 0.0));
    Heading::new(deg.to_radians()).unwrap()
}

pub(crate) fn id(name: &str) -> ViewpointId {
    ViewpointId::new(name).unwrap()
}

pub(crate) fn scene() -> SceneId {
    SceneId::new("cross").unwrap()
}

impl Cross {
    /// The things at the ends of the arms.
    pub(crate) fn new(things: &[(&'static str, &'static str)]) -> Self {
        let mut graph = ViewpointGraph::default();
        graph.add_viewpoint(id("middle"), DVec3::ZERO, Some(1)).unwrap();
        for (arm, deg) in ARMS {
            let out = Heading::new(f64::to_radians(deg)).unwrap().unit_vector();
            let mut before = id("middle");
            for at in 1..=2 {
                let node = id(&format!("{arm}{at}"));
                graph.add_viewpoint(node.clone(), out * 2.0 * f64::from(at), Some(1)).unwrap();
                graph.join_viewpoints(&before, &node).unwrap();
                before = node;
            }
        }
        Self {
            graph: Arc::new(graph),
            things: things.iter().copied().collect(),
            rooms: BTreeMap::new(),
            has_labels: true,
            looks: AtomicUsize::new(0),
            looked_from: Mutex::default(),
        }
    }

    /// Without labels.
    pub(crate) fn blind() -> Self {
        Self { has_labels: false, ..Self::new(&[]) }
    }

    /// The rooms of nodes.
    pub(crate) fn with_rooms(mut self, rooms: &[(&'static str, &'static str)]) -> Self {
        self.rooms = rooms.iter().copied().collect();
        self
    }

    /// The nodes from which an agent looked.
    pub(crate) fn looked_from(&self) -> BTreeSet<ViewpointId> {
        self.looked_from.lock().unwrap().clone()
    }

    /// The thing that is seen from a node.
    pub(crate) fn labels(&self, node: &ViewpointId) -> Vec<ObjectLabel> {
        let label = |name: &&str| ObjectLabel {
            object: ObjectId::new(*name).unwrap(),
            name: (*name).to_owned(),
            heading: outward(node.as_str()),
            elevation_rad: 0.0,
            box_px: None,
            distance_m: Some(1.0),
            position: None,
            colour: None,
            room: None,
        };
        self.things.get(node.as_str()).iter().map(|name| label(name)).collect()
    }

    /// In the middle, looking north.
    pub(crate) fn start() -> AgentStart {
        AgentStart { scene: scene(), viewpoint: id("middle"), heading: Heading::NORTH }
    }
}

impl Platform for Cross {
    fn name(&self) -> &'static str {
        "cross"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(vec![scene()])
    }

    fn graph_for_scene(&self, _: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(Arc::clone(&self.graph))
    }

    fn sample_path(&self, _: &SceneId, _: &PathRequest, _: u64) -> Result<Path, PlatformError> {
        panic!("no test here samples a path")
    }

    fn look_from(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.looks.fetch_add(1, Ordering::Relaxed);
        let node = from.viewpoint.clone().unwrap();
        let labels = if gaze.holds_heading(outward(node.as_str())) { self.labels(&node) } else { Vec::new() };
        let room = self.rooms.get(node.as_str()).map(|room| (*room).to_owned());
        self.looked_from.lock().unwrap().insert(node);
        let truth = self.has_labels.then_some(GroundTruth { labels, lists_objects: true, room });
        Ok(View::new(Pose::looking_level(from.pose.position, gaze.heading), gaze.horizontal_fov_rad, None, truth))
    }
}
