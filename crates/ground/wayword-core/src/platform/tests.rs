use super::*;
use crate::{
    DVec3, DepthImage, FromAbove, GroundIsland, GroundRoute, Heading, ObjectId, PlacedObject, Pose, SceneCondition,
    ViewpointId,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
    sync::Mutex,
};

/// A platform without data that counts its calls by method. All its answers differ from the defaults.
#[derive(Default)]
struct CountingPlatform {
    calls: Mutex<BTreeMap<&'static str, usize>>,
}

impl CountingPlatform {
    fn count(&self, method: &'static str) {
        *self.calls.lock().unwrap().entry(method).or_default() += 1;
    }

    fn fail<T>(&self, method: &'static str) -> Result<T, PlatformError> {
        self.count(method);
        Err(PlatformError::UnknownScene { scene: method.to_owned(), hint: String::new() })
    }
}

impl Platform for CountingPlatform {
    fn name(&self) -> &'static str {
        self.count("name");
        "counting"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.fail("list_scenes")
    }

    fn graph_for_scene(&self, _: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.fail("graph_for_scene")
    }

    fn sample_path(&self, _: &SceneId, _: &PathRequest, _: u64) -> Result<Path, PlatformError> {
        self.fail("sample_path")
    }

    fn look_from(&self, _: &SceneId, _: &Frame, _: ViewGaze) -> Result<View, PlatformError> {
        self.fail("look_from")
    }

    fn look_without_picture(&self, _: &SceneId, _: &Frame, _: ViewGaze) -> Result<View, PlatformError> {
        self.fail("look_without_picture")
    }

    fn ground(&self) -> &dyn Ground {
        self
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }

    fn files(&self) -> &dyn SceneFiles {
        self
    }
}

impl Ground for CountingPlatform {
    fn ground_route(&self, _: &SceneId, _: &Frame, _: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        self.fail("ground_route")
    }

    fn ground_islands(&self, _: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
        self.fail("ground_islands")
    }

    fn look_down(&self, _: &SceneId, _: u32) -> Result<Option<FromAbove>, PlatformError> {
        self.fail("look_down")
    }

    fn view_depth(&self, _: &SceneId, _: &Frame, _: ViewGaze) -> Result<Option<DepthImage>, PlatformError> {
        self.fail("view_depth")
    }
}

impl SceneCatalogue for CountingPlatform {
    fn object_name(&self, _: &SceneId, _: &Frame, _: &ObjectId) -> Result<Option<String>, PlatformError> {
        self.fail("object_name")
    }

    fn visible_from(&self, _: &SceneId, _: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        self.fail("visible_from")
    }

    fn listed_objects(&self, _: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
        self.fail("listed_objects")
    }

    fn lists_everything(&self) -> bool {
        self.count("lists_everything");
        false
    }
}

impl SceneFiles for CountingPlatform {
    fn check_scenes(&self, _: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        self.fail("check_scenes")
    }

    fn canonical_scene(&self, _: &SceneId) -> SceneId {
        self.count("canonical_scene");
        SceneId::new("canonical").unwrap()
    }

    fn candidate_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.fail("candidate_scenes")
    }

    fn examine_scene(&self, _: &SceneId) -> Result<Option<SceneCondition>, PlatformError> {
        self.fail("examine_scene")
    }

    fn scene_file(&self, _: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        self.fail("scene_file")
    }

    fn source_files(&self, _: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.fail("source_files")
    }
}

/// A wrapper that has only the methods without a default, and perhaps `inner`.
struct PlainWrapper<P> {
    platform: P,
    has_inner: bool,
}

impl<P: Platform> Platform for PlainWrapper<P> {
    fn name(&self) -> &'static str {
        self.platform.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.platform.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.platform.graph_for_scene(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.platform.sample_path(scene, request, seed)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.platform.look_from(scene, from, gaze)
    }

    fn inner(&self) -> Option<&dyn Platform> {
        self.has_inner.then_some(&self.platform)
    }
}

fn scene() -> SceneId {
    SceneId::new("scene").unwrap()
}

fn frame() -> Frame {
    let pose = Pose { position: DVec3::ZERO, heading: Heading::NORTH, elevation_rad: 0.0 };
    Frame { pose, viewpoint: None, level: None }
}

const PLATFORM_METHODS: [&str; 6] =
    ["name", "list_scenes", "graph_for_scene", "sample_path", "look_from", "look_without_picture"];
const GROUND_METHODS: [&str; 4] = ["ground_route", "ground_islands", "look_down", "view_depth"];
const CATALOGUE_METHODS: [&str; 4] = ["object_name", "visible_from", "listed_objects", "lists_everything"];
const FILE_METHODS: [&str; 6] =
    ["check_scenes", "canonical_scene", "candidate_scenes", "examine_scene", "scene_file", "source_files"];

/// Calls each method of the four traits once. The errors of a [`CountingPlatform`] are dropped.
fn call_every_method(platform: &dyn Platform) {
    let (scene, frame, gaze) = (scene(), frame(), ViewGaze::quarter_view(Heading::NORTH));
    let object = ObjectId::new("object").unwrap();
    platform.name();
    let _ = platform.list_scenes();
    let _ = platform.graph_for_scene(&scene);
    let _ = platform.sample_path(&scene, &PathRequest::default(), 1);
    let _ = platform.look_from(&scene, &frame, gaze);
    let _ = platform.look_without_picture(&scene, &frame, gaze);
    let ground = platform.ground();
    let _ = ground.ground_route(&scene, &frame, &frame);
    let _ = ground.ground_islands(&scene);
    let _ = ground.look_down(&scene, 1);
    let _ = ground.view_depth(&scene, &frame, gaze);
    let catalogue = platform.catalogue();
    let _ = catalogue.object_name(&scene, &frame, &object);
    let _ = catalogue.visible_from(&scene, &object);
    let _ = catalogue.listed_objects(&scene);
    catalogue.lists_everything();
    let files = platform.files();
    let _ = files.check_scenes(&BTreeSet::from([&scene]));
    files.canonical_scene(&scene);
    let _ = files.candidate_scenes();
    let _ = files.examine_scene(&scene);
    let _ = files.scene_file(&scene);
    let _ = files.source_files(&scene);
}

/// The calls that reach a [`CountingPlatform`] through a wrapper.
fn calls_through<W: Platform>(wrap: impl FnOnce(Arc<CountingPlatform>) -> W) -> BTreeMap<&'static str, usize> {
    let platform = Arc::new(CountingPlatform::default());
    call_every_method(&wrap(Arc::clone(&platform)));
    let calls = platform.calls.lock().unwrap();
    calls.clone()
}

fn each_once() -> BTreeMap<&'static str, usize> {
    let extras = GROUND_METHODS.into_iter().chain(CATALOGUE_METHODS).chain(FILE_METHODS);
    PLATFORM_METHODS.into_iter().chain(extras).map(|method| (method, 1)).collect()
}

/// A look without a picture becomes a look with one, which the wrapper may change.
fn each_once_through_a_wrapper() -> BTreeMap<&'static str, usize> {
    let mut calls = each_once();
    calls.remove("look_without_picture");
    calls.insert("look_from", 2);
    calls
}

#[test]
fn pointers_forward_every_method() {
    assert_eq!(calls_through(|platform| platform), each_once());
    assert_eq!(calls_through(|platform| platform as Arc<dyn Platform>), each_once());
    assert_eq!(calls_through(|platform| Box::new(platform) as Box<dyn Platform>), each_once());
    let platform = CountingPlatform::default();
    call_every_method(&&platform);
    assert_eq!(*platform.calls.lock().unwrap(), each_once());
}

#[test]
fn wrapper_with_only_inner_forwards_every_method() {
    let wrapped = |platform| PlainWrapper { platform, has_inner: true };
    assert_eq!(calls_through(wrapped), each_once_through_a_wrapper());
    let twice = |platform| PlainWrapper { platform: wrapped(platform), has_inner: true };
    assert_eq!(calls_through(twice), each_once_through_a_wrapper());
    let pointed = |platform| Box::new(wrapped(platform)) as Box<dyn Platform>;
    assert_eq!(calls_through(pointed), each_once_through_a_wrapper());
}

#[test]
fn platform_without_ground_objects_and_files_has_the_defaults() {
    let counting = CountingPlatform::default();
    let platform = PlainWrapper { platform: &counting, has_inner: false };
    call_every_method(&platform);
    let reached: BTreeSet<&str> = counting.calls.lock().unwrap().keys().copied().collect();
    assert_eq!(reached, PLATFORM_METHODS[..5].iter().copied().collect());

    let (scene, frame, gaze) = (scene(), frame(), ViewGaze::quarter_view(Heading::NORTH));
    let object = ObjectId::new("object").unwrap();
    assert!(platform.inner().is_none());
    let ground = platform.ground();
    assert_eq!(ground.ground_route(&scene, &frame, &frame).unwrap(), None);
    assert!(ground.ground_islands(&scene).unwrap().is_empty());
    assert!(ground.look_down(&scene, 1).unwrap().is_none());
    assert!(ground.view_depth(&scene, &frame, gaze).unwrap().is_none());
    let catalogue = platform.catalogue();
    assert_eq!(catalogue.object_name(&scene, &frame, &object).unwrap(), None);
    assert_eq!(catalogue.visible_from(&scene, &object).unwrap(), None);
    assert!(catalogue.listed_objects(&scene).unwrap().is_empty());
    assert!(catalogue.lists_everything());
    let files = platform.files();
    files.check_scenes(&BTreeSet::from([&scene])).unwrap();
    assert_eq!(files.canonical_scene(&scene), scene);
    assert!(files.candidate_scenes().unwrap().is_empty());
    assert!(files.examine_scene(&scene).unwrap().is_none());
    assert_eq!(files.scene_file(&scene).unwrap(), None);
    assert!(files.source_files(&scene).unwrap().is_empty());
}
