//! Compares our frames with frames that habitat-sim drew. Needs the oracle data; without it the tests print that they
//! are skipped.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use wayword_core::DVec3;
use wayword_habitat::{
    NavMesh, NavMeshGround,
    axes::{EYE_M, forward_from_habitat_rotation},
    bake::bake_navmesh,
    scene::{HabitatStage, SceneModel},
};
use wayword_render::{PinholeCamera, RenderScene, RenderedPicture, render_scene};

/// Pixels of a frame.
const PIXELS: f64 = 640.0 * 480.0;

#[test]
fn every_frame_of_habitat_is_drawn_the_same() {
    let Some(folder) = crate::oracles::folder() else { return };
    let folder = folder.join("habitat_frames");
    for (name, stage) in [("traj_flat_a", "flat.glb"), ("traj_simple_room", "simple_room.stage_config.json")] {
        let mut model = SceneModel::from_stage(&HabitatStage::from_file(&folder.join(stage)).unwrap()).unwrap();
        // Habitat lights surfaces without a material with the image of a studio, which is not available: they are
        // counted apart.
        for mesh in model.meshes.iter_mut().filter(|mesh| !mesh.colours.is_empty()) {
            mesh.id = 1;
        }
        let scene = RenderScene::new(model.meshes, model.materials, model.textures).unwrap();
        let trajectory = crate::oracles::json(&folder.join(name).join("trajectory.json"));
        for frame in trajectory["frames"].as_array().unwrap() {
            let ours = draw(&scene, frame);
            let open = |file: &str| image::open(folder.join(name).join(frame[file].as_str().unwrap())).unwrap();
            let theirs = open("rgb").into_rgb8();
            let off: Vec<u8> = ours.rgb.iter().zip(theirs.as_raw()).map(|(a, b)| a.abs_diff(*b)).collect();
            let mean = off.iter().map(|each| f64::from(*each)).sum::<f64>() / off.len() as f64;
            let far = |id: u32| {
                let pixels = off.chunks(3).zip(&ours.ids);
                pixels.filter(|(pixel, at)| **at == id && pixel.iter().any(|each| *each > 8)).count()
            };
            let (far, in_studio, studio) = (far(0), far(1), ours.ids.iter().filter(|id| **id == 1).count());
            let (median_mm, beyond) = depths(&ours.depth_m, open("depth").into_luma16().as_raw());
            println!(
                "{name} {}: mean {mean:.4}, {far} off by more than 8 (and {in_studio} of {studio} lit by the studio), depth: median \
                 {median_mm:.2} mm, {beyond} beyond 2 mm",
                frame["i"],
            );
            assert!(mean <= 0.1, "{name} {}: mean difference {mean}", frame["i"]);
            assert!(far as f64 <= 1e-4 * PIXELS, "{name} {}: {far} pixels off by more than 8", frame["i"]);
            assert!(
                in_studio as f64 <= 2e-3 * PIXELS,
                "{name} {}: {in_studio} of the studio off by more than 8",
                frame["i"]
            );
            assert!(beyond as f64 <= 1e-4 * PIXELS, "{name} {}: {beyond} depths off by more than 2 mm", frame["i"]);
        }
    }
}

fn draw(scene: &RenderScene, frame: &serde_json::Value) -> RenderedPicture {
    let number = |field: &str, at: usize| frame[field][at].as_f64().unwrap();
    let eye = crate::oracles::place(&frame["agent_position"]) + DVec3::Z * EYE_M;
    let forward = forward_from_habitat_rotation(std::array::from_fn(|at| number("rotation_wxyz", at)));
    // 90 degrees wide.
    let vertical_fov_rad = 2.0 * libm::atan(0.75);
    render_scene(scene, &PinholeCamera::looking_along(eye, forward, vertical_fov_rad, 640, 480)).unwrap()
}

/// The median difference in millimetres, and the number of pixels with a difference of more than 2 mm. A pixel that
/// shows no surface has depth 0.
fn depths(ours_m: &[f32], theirs_mm: &[u16]) -> (f64, usize) {
    let ours_mm = ours_m.iter().map(|metres| if metres.is_finite() { f64::from(*metres) * 1000.0 } else { 0.0 });
    let mut apart: Vec<f64> = ours_mm.zip(theirs_mm).map(|(ours, theirs)| (ours - f64::from(*theirs)).abs()).collect();
    apart.sort_by(f64::total_cmp);
    (apart[apart.len() / 2], apart.iter().filter(|mm| **mm > 2.0).count())
}

#[test]
fn a_baked_navmesh_has_the_area_of_habitats_own() {
    let Some(folder) = crate::oracles::folder() else { return };
    let folder = folder.join("habitat_frames");
    for (name, stage) in [("traj_flat_a", "flat.glb"), ("traj_simple_room", "simple_room.stage_config.json")] {
        let theirs = NavMesh::from_bytes(&std::fs::read(folder.join(name).join("scene.navmesh")).unwrap()).unwrap();
        let model = SceneModel::from_stage(&HabitatStage::from_file(&folder.join(stage)).unwrap()).unwrap();
        let ours = bake_navmesh(&model, theirs.settings().unwrap()).unwrap();
        assert_eq!(NavMesh::from_bytes(&ours.to_bytes()).unwrap(), ours);
        let areas = [&ours, &theirs].map(|mesh| NavMeshGround::new(mesh).islands_m2().collect::<Vec<_>>());
        println!(
            "{name}: {} polygons of {}, islands {:?} of {:?}",
            ours.polygon_count(),
            theirs.polygon_count(),
            areas[0],
            areas[1]
        );
        let whole = |areas: &[f64]| areas.iter().sum::<f64>();
        assert!((whole(&areas[0]) / whole(&areas[1]) - 1.0).abs() < 0.03);
        assert!((areas[0][0] / areas[1][0] - 1.0).abs() < 0.03);
    }
}
