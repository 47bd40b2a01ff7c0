//! A building's files in the formats of Matterport3D and REVERIE. The first byte says which one the rest is:
//! connectivity, `.house`, rooms, boxes, centres, or a skybox.
//!
//! No containment: JSON (`serde_json`) and pictures (`image`) are read by third-party code, but its panics would reach
//! the user. Memory: a byte of JSON becomes a value of 72 bytes, in a list that is copied while it grows. A picture may
//! take 256 MiB while it is decoded, which is the program's own limit for any file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_core::{Heading, Platform, ViewGaze};
use wayword_fuzz::{Bound, begin, scratch, seeds::words};
use wayword_platforms::MatterportPlatform;
use wayword_world::labels_around;

const BOUND: Bound = Bound { flat: 300 << 20, per_byte: 1024 };

fuzz_target!(init: begin("matterport", &words::building()), |data: &[u8]| {
    let Some((which, file)) = data.split_first() else { return };
    let folder = scratch::folder();
    let places = [
        ("connectivity/s_connectivity.json", words::CONNECTIVITY),
        ("scans/s/house_segmentations/s.house", words::HOUSE),
        ("scans/s/house_segmentations/panorama_to_region.txt", words::ROOMS),
        ("BBox/s_a.json", words::BOXES),
        ("objpos.json", words::CENTRES),
        ("scans/s/matterport_skybox_images/a_skybox_small.jpg", ""),
    ];
    for (number, (place, usual)) in places.into_iter().enumerate() {
        if number == usize::from(which % 6) {
            scratch::write(folder.path(), place, file);
        } else if !usual.is_empty() {
            scratch::write(folder.path(), place, usual.as_bytes());
        }
    }
    BOUND.hold(data, || {
        let Ok(platform) = MatterportPlatform::open(folder.path()) else { return };
        let Some(scene) = platform.list_scenes().ok().and_then(|scenes| scenes.into_iter().next()) else { return };
        let Ok(graph) = platform.graph_for_scene(&scene) else { return };
        let Some(first) = graph.viewpoints().next() else { return };
        let frames = graph.path_frames(std::slice::from_ref(first), None).expect("a viewpoint of the graph");
        let _ = labels_around(&platform, &scene, &frames[0]);
        let _ = platform.look_from(&scene, &frames[0], ViewGaze::quarter_view(Heading::NORTH));
        for object in ["5", "6"].map(|name| wayword_core::ObjectId::new(name).expect("a name")) {
            let _ = platform.catalogue().visible_from(&scene, &object);
        }
    });
});
