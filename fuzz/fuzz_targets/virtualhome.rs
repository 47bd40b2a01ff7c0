//! VirtualHome's graph of a home, as JSON over HTTP: read, turned into a floor, and walked on.
//!
//! No containment: JSON (`serde_json`) and HTTP (`ureq`) are read by third-party code, but its panics would reach the
//! user. Memory: a floor has at most 80 x 80 m in cells of 10 cm, whatever the graph. JSON grows to some hundred times
//! its length.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{sync::OnceLock, time::Duration};
use wayword_core::{Heading, PathRequest, Platform, SceneId, ViewGaze};
use wayword_fuzz::{Bound, begin, seeds, virtualhome};
use wayword_live::{
    LivePictureOptions,
    virtualhome::{VirtualHomeOptions, VirtualHomePlatform},
};

const BOUND: Bound = Bound { flat: 96 << 20, per_byte: 1024 };

static URL: OnceLock<String> = OnceLock::new();

fuzz_target!(init: begin("virtualhome", &[seeds::words::HOME.into()]), |data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let url = URL.get_or_init(virtualhome::start).clone();
    virtualhome::set_graph(text.to_owned());
    BOUND.hold(data, || {
        let pictures = LivePictureOptions { width_px: 16, height_px: 12, ..LivePictureOptions::default() };
        let options = VirtualHomeOptions { url, timeout: Duration::from_secs(60), pictures };
        let platform = VirtualHomePlatform::new(options);
        let home = SceneId::new("home_0").expect("a name");
        let Ok(graph) = platform.graph_for_scene(&home) else { return };
        let Some(first) = graph.viewpoints().next() else { return };
        let frames = graph.path_frames(std::slice::from_ref(first), None).expect("a viewpoint of the graph");
        let _ = platform.look_from(&home, &frames[0], ViewGaze::quarter_view(Heading::NORTH));
        let _ = platform.sample_path(&home, &PathRequest { hops: 0..=9, length_m: 0.5..=4.0 }, 3);
    });
});
