//! Compares our views with those of the genuine Matterport3D simulator. Without the simulator's recorded views (the oracle
//! data), the test prints that it is skipped.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use glam::DMat3;
use std::path::PathBuf;
use wayword_render::{CubeMap, sample_view};

/// The scan of the oracle data.
const SCAN: &str = "17DRP5sb8fy";

#[allow(clippy::approx_constant, reason = "the exact numbers that the simulator was given")]
const VIEWS: [(f64, f64); 6] = [
    (0.0, 0.0),
    (0.5235987755982988, 0.0),
    (1.5707963267948966, 0.0),
    (3.14159, 0.5235987),
    (4.7, -0.5235987),
    (0.0, 0.9),
];

#[test]
fn views_equal_the_simulators() {
    let data = std::env::var_os("WAYWORD_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data"), PathBuf::from);
    let oracle = data.join("oracles/matterport_views");
    let Ok(graph) = std::fs::read_to_string(oracle.join(format!("graph/{SCAN}_connectivity.json"))) else {
        eprintln!("SKIPPED: no oracle at {} (set WAYWORD_DATA)", oracle.display());
        return;
    };
    let (viewpoint, world_from_skybox) = first_viewpoint(&graph);
    let strip = oracle.join(format!("scans/{SCAN}/matterport_skybox_images/{viewpoint}_skybox_small.jpg"));
    let strip = image::open(strip).unwrap().to_rgb8();
    let cube = CubeMap::from_strip(strip.width(), strip.height(), &strip).unwrap();
    for (index, (heading, elevation)) in VIEWS.into_iter().enumerate() {
        let genuine = image::open(oracle.join(format!("v{index}.png"))).unwrap().to_rgb8();
        let fov = 60f64.to_radians();
        let ours = sample_view(&cube, &world_from_skybox, heading, elevation, fov, 640, 480).unwrap();
        let off: Vec<u8> = ours.iter().zip(genuine.as_raw()).map(|(a, b)| a.abs_diff(*b)).collect();
        let mean = off.iter().map(|&d| f64::from(d)).sum::<f64>() / off.len() as f64;
        let far = off.chunks(3).filter(|d| d.iter().any(|&d| d > 8)).count();
        println!("v{index}: mean {mean:.4}, pixels off by more than 8: {far}");
        assert!(mean <= 0.05, "v{index}: mean difference {mean}");
        assert!(far as f64 <= 1e-5 * 640.0 * 480.0, "v{index}: {far} pixels off by more than 8");
    }
}

/// The id and rotation of the file's first item. It is read without a JSON library because this file can be trusted.
fn first_viewpoint(graph: &str) -> (String, DMat3) {
    let after = |key: &str| graph.split_once(&format!("\"{key}\":")).unwrap().1.trim_start();
    let id = after("image_id").trim_start_matches('"').split_once('"').unwrap().0.to_owned();
    let pose = after("pose").trim_start_matches('[').split_once(']').unwrap().0;
    let pose: Vec<f64> = pose.split(',').map(|number| number.trim().parse().unwrap()).collect();
    let row = |i: usize| [pose[4 * i], pose[4 * i + 1], pose[4 * i + 2]];
    (id, DMat3::from_cols_array_2d(&[row(0), row(1), row(2)]).transpose())
}
