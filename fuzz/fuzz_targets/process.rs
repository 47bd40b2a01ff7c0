//! Messages of a child process: greeting, scenes, a graph, a view, a path. The child is `cat`, which writes the whole
//! input at once.
//!
//! No containment: JSON (`serde_json`) and pictures (`image`) are read by third-party code, but its panics would reach
//! the user. Memory: a byte of JSON becomes a value of 72 bytes, in a list that is copied while it grows, and then the
//! data that the JSON describes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{sync::Arc, time::Duration};
use wayword_core::{DVec3, Frame, Heading, ObjectId, PathRequest, Platform, Pose, SceneId, ViewGaze};
use wayword_fuzz::{Bound, begin, scratch, seeds::words};
use wayword_platforms::{ProcessPlatform, process::ProcessOptions};

const BOUND: Bound = Bound { flat: 16 << 20, per_byte: 2048 };

fn seeds() -> Vec<Vec<u8>> {
    [words::CHILD, words::WALKER, words::NEIGHBOUR].map(|text| text.as_bytes().to_vec()).to_vec()
}

fuzz_target!(init: begin("process", &seeds()), |data: &[u8]| {
    let folder = scratch::folder();
    scratch::write(folder.path(), "said", data);
    let patience = Duration::from_secs(5);
    let options = ProcessOptions {
        arguments: vec![folder.path().join("said").display().to_string()],
        width_px: 16,
        height_px: 16,
        start_within: patience,
        answer_within: patience,
        restarts: 0,
        ..ProcessOptions::new("cat")
    };
    BOUND.hold(data, || {
        let Ok(platform) = ProcessPlatform::start(options, Arc::new(|_: &str| ())) else { return };
        let _ = platform.list_scenes();
        let scene = SceneId::new("s").expect("a name");
        let _ = platform.graph_for_scene(&scene);
        let pose = Pose::looking_level(DVec3::new(0.0, 0.0, 1.5), Heading::NORTH);
        let frame = Frame { pose, viewpoint: None, level: None };
        let _ = platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH));
        let _ = platform.look_without_picture(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH));
        let _ = platform.sample_path(&scene, &PathRequest { hops: 1..=4, length_m: 0.5..=9.0 }, 3);
        let object = ObjectId::new("7").expect("a name");
        let _ = platform.catalogue().object_name(&scene, &frame, &object);
        let _ = platform.catalogue().visible_from(&scene, &object);
    });
});
