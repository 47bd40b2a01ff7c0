//! Compares pictures with those that the genuine simulator drew, if they are available (`WAYWORD_DATA`).

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or counted"
)]

use std::{f64::consts::FRAC_PI_6, path::PathBuf};
use wayword_core::{Heading, Platform, SceneId, ViewGaze, ViewpointId};
use wayword_platforms::MatterportPlatform;

fn oracle() -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data"));
    let folder = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from).join("oracles/matterport_views");
    let there = folder.join("graph").is_dir();
    if !there {
        println!("SKIPPED: no pictures of the simulator in {}; set WAYWORD_DATA", folder.display());
    }
    there.then_some(folder)
}

#[test]
fn a_look_shows_what_the_simulator_shows() {
    let Some(folder) = oracle() else { return };
    let platform = MatterportPlatform::open(&folder).unwrap();
    let scene = SceneId::new("17DRP5sb8fy").unwrap();
    let graph = platform.graph_for_scene(&scene).unwrap();
    let first = graph.viewpoints().next().unwrap().clone();
    let frame = graph.path_frames(&[first], None).unwrap().remove(0);
    for (name, heading_rad) in [("v0", 0.0), ("v1", FRAC_PI_6), ("v2", std::f64::consts::FRAC_PI_2)] {
        let heading = Heading::new(heading_rad).unwrap();
        let horizontal_fov_rad = 2.0 * (FRAC_PI_6.tan() * 4.0 / 3.0).atan();
        let view = platform.look_from(&scene, &frame, ViewGaze { heading, horizontal_fov_rad }).unwrap();
        let shown = view.image.unwrap();
        let genuine = image::open(folder.join(format!("{name}.png"))).unwrap().into_rgb8();
        assert_eq!((genuine.width(), genuine.height()), (shown.width_px(), shown.height_px()));
        let off: u64 = genuine.as_raw().iter().zip(shown.rgb_bytes()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = off as f64 / shown.rgb_bytes().len() as f64;
        println!("{name}: mean difference {mean:.4} of 255");
        assert!(mean < 0.5, "{name}: {mean}");
    }
}

/// A real panorama's 36 views, put under a viewpoint of the made-up building.
#[cfg(unix)]
#[test]
fn along_the_axis_of_one_of_36_views_that_view_comes_back() {
    let Some(oracle) = oracle() else { return };
    let real = oracle.join("../../images/matterport_36_views");
    let folder = tempfile::tempdir().unwrap();
    wayword_testkit::write_building(folder.path()).unwrap();
    let views = folder.path().join("views").join(wayword_testkit::SCAN);
    std::fs::create_dir_all(&views).unwrap();
    std::os::unix::fs::symlink(&real, views.join(wayword_testkit::viewpoint_id(0))).unwrap();
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    let scene = SceneId::new(wayword_testkit::SCAN).unwrap();
    let first = ViewpointId::new(wayword_testkit::viewpoint_id(0)).unwrap();
    let frame = platform.graph_for_scene(&scene).unwrap().path_frames(&[first], None).unwrap().remove(0);
    for column in 0..12 {
        let heading = Heading::new(f64::from(column) * FRAC_PI_6).unwrap();
        let horizontal_fov_rad = 2.0 * (FRAC_PI_6.tan() * 4.0 / 3.0).atan();
        let shown =
            platform.look_from(&scene, &frame, ViewGaze { heading, horizontal_fov_rad }).unwrap().image.unwrap();
        let genuine = image::open(real.join(format!("{}.jpg", 12 + column))).unwrap().into_rgb8();
        let off: u64 = genuine.as_raw().iter().zip(shown.rgb_bytes()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        let mean = off as f64 / shown.rgb_bytes().len() as f64;
        println!("view {}: mean difference {mean:.2} of 255", 12 + column);
        assert!(mean < 4.0, "view {}: {mean}", 12 + column);
    }
}
