//! Tests of the Python kit and of the simulators that its examples serve.
//!
//! The kit's own tests need any `python3`. The tests with MiniWorld and MuJoCo need a Python that has them;
//! `WAYWORD_PYTHON` names it: `python3 -m venv V && V/bin/pip install miniworld mujoco`, and
//! `WAYWORD_PYTHON=V/bin/python`. If `WAYWORD_PICTURES` names a folder, the tests write panoramas from these simulators
//! there, for a person to look at.

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or counted"
)]

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::Command,
    sync::Arc,
};
use wayword_core::{Frame, Image, PathRequest, Platform, SceneId, ViewGaze};
use wayword_platforms::{ProcessPlatform, process::ProcessOptions};
use wayword_world::labels_around;

fn kit() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../python").canonicalize().unwrap()
}

/// Serves a script of the kit's folder.
fn served(python: &str, script: &str, arguments: &[&str]) -> ProcessPlatform {
    let mut all = vec!["-B".to_owned(), kit().join(script).display().to_string()];
    all.extend(arguments.iter().map(|argument| (*argument).to_owned()));
    let options = ProcessOptions { arguments: all, ..ProcessOptions::new(python) };
    ProcessPlatform::start(options, Arc::new(|line: &str| println!("child: {line}"))).unwrap()
}

fn is_there(python: &str) -> bool {
    let there = Command::new(python).arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("SKIPPED: there is no {python} here, so the Python kit is not tested");
    }
    there
}

fn simulators() -> Option<String> {
    let python = std::env::var("WAYWORD_PYTHON").ok();
    if python.is_none() {
        println!("SKIPPED: WAYWORD_PYTHON names no Python with miniworld and mujoco");
    }
    python
}

#[test]
fn the_kit_passes_its_own_tests() {
    if !is_there("python3") {
        return;
    }
    let output = Command::new("python3")
        .args(["-B", "-m", "unittest", "tests/test_platform.py"])
        .current_dir(kit())
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && !told.contains("Ran 0 tests"), "{told}");
}

#[test]
fn a_world_of_a_few_lines_of_python_is_walked_and_seen() {
    if !is_there("python3") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("world.py");
    std::fs::write(&script, include_str!("process/pillar_world.py")).unwrap();
    let kit = kit().display().to_string();
    let platform = served("python3", script.to_str().unwrap(), &[&kit]);
    let scene = SceneId::new("yard").unwrap();
    let path = walk(&platform, &scene);
    assert_eq!(path.target.as_ref().unwrap().name, "pillar");
    // The child draws north red, east green, south blue and west white.
    let last = path.frames.last().unwrap();
    let colours = ViewGaze::compass_views().map(|gaze| {
        let view = platform.look_from(&scene, last, gaze).unwrap();
        view.image.unwrap().rgb_bytes()[..3].to_vec()
    });
    assert_eq!(colours, [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]);
    let gone = platform.graph_for_scene(&SceneId::new("attic").unwrap()).unwrap_err().to_string();
    assert!(gone.contains("there is no scene attic: there is one, yard"), "{gone}");
}

#[test]
fn miniworld_is_walked_and_seen() {
    let Some(python) = simulators() else { return };
    let platform = served(&python, "examples/miniworld_world.py", &["ThreeRooms-1"]);
    explore(&platform, "ThreeRooms-1", &["ball", "box", "key", "picture", "toy duck"]);
}

#[test]
fn mujoco_is_walked_and_seen() {
    let Some(python) = simulators() else { return };
    let platform = served(&python, "examples/mujoco_world.py", &[]);
    explore(&platform, "flat", &["bed", "bookcase", "coffee table", "floor lamp", "plant", "sofa", "wardrobe"]);
}

fn walk(platform: &ProcessPlatform, scene: &SceneId) -> wayword_core::Path {
    let graph = platform.graph_for_scene(scene).unwrap();
    assert_eq!(graph.count_components(), 1);
    let request = PathRequest::default();
    let path = platform.sample_path(scene, &request, 1).unwrap();
    assert!(request.allows_length_of(&path));
    assert_eq!(path, platform.sample_path(scene, &request, 1).unwrap());
    path
}

/// Follows a path in a real simulator, looks around at every stop, and checks that every object is seen from some
/// viewpoint.
fn explore(platform: &ProcessPlatform, name: &str, things: &[&str]) {
    let scene = SceneId::new(name).unwrap();
    assert!(platform.list_scenes().unwrap().contains(&scene));
    let path = walk(platform, &scene);
    let graph = platform.graph_for_scene(&scene).unwrap();
    println!(
        "{name}: {} viewpoints, {} edges; a path of {:.1} m",
        graph.len(),
        graph.edges().count(),
        path.length_m().unwrap()
    );
    for (number, frame) in path.frames.iter().enumerate() {
        let looked =
            ViewGaze::around_heading(frame.pose.heading).map(|gaze| platform.look_from(&scene, frame, gaze).unwrap());
        let images = looked.map(|view| view.image.unwrap());
        keep(name, number, &images);
        assert!(images.iter().all(|image| (image.width_px(), image.height_px()) == (640, 480)));
        assert!(images.windows(2).any(|pair| pair[0] != pair[1]), "every direction looks the same");
        // The right edge of a view and the left edge of the next one show the same direction. If the pictures were
        // mirrored or the heading wrong, there would be seams.
        let seams: Vec<f64> = (0..4).map(|side| seam(&images[side], &images[(side + 1) % 4])).collect();
        assert!(seams.iter().all(|off| *off < 12.0), "stop {number}: neighbouring views do not meet: {seams:?}");
    }
    let mut seen = BTreeSet::new();
    for id in graph.viewpoints() {
        let frame: Frame = graph.path_frames(std::slice::from_ref(id), None).unwrap().remove(0);
        seen.extend(labels_around(platform, &scene, &frame).unwrap().into_iter().map(|label| label.name));
    }
    assert_eq!(seen.iter().map(String::as_str).collect::<Vec<_>>(), things);
}

/// Mean difference, from 0 to 255, between the last column of a picture and the first of another.
fn seam(left: &Image, right: &Image) -> f64 {
    let (width, height) = (left.width_px() as usize, left.height_px() as usize);
    let row = |image: &Image, y: usize, x: usize| image.rgb_bytes()[(y * width + x) * 3..][..3].to_vec();
    let off = (0..height).flat_map(|y| row(left, y, width - 1).into_iter().zip(row(right, y, 0)));
    off.map(|(a, b)| f64::from(a.abs_diff(b))).sum::<f64>() / (height * 3) as f64
}

/// Writes a panorama to the folder that `WAYWORD_PICTURES` names: ahead, right, behind, left.
fn keep(name: &str, number: usize, images: &[Arc<Image>; 4]) {
    let Some(folder) = std::env::var_os("WAYWORD_PICTURES") else { return };
    let mut all = image::RgbImage::new(4 * 640, 480);
    for (place, picture) in images.iter().enumerate() {
        let part = image::RgbImage::from_raw(640, 480, picture.rgb_bytes().to_vec()).unwrap();
        image::imageops::replace(&mut all, &part, 640 * place as i64, 0);
    }
    all.save(Path::new(&folder).join(format!("{name}-{number}.png"))).unwrap();
}
