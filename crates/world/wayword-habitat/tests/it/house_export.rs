//! Exports of generated houses: compared with pictures and depths that habitat-sim drew of one, which needs the oracle data (without
//! it those tests print that they are skipped), and with what the platform `house` itself draws.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests may fail and tell as tests do")]

use std::{path::Path, sync::Arc};
use wayword_core::{DVec3, Frame, Heading, PathRequest, Platform, Pose, SceneId, ViewGaze};
use wayword_habitat::{
    HabitatOptions, HabitatPlatform,
    axes::{EYE_M, forward_from_habitat_rotation},
    scene::{HabitatStage, SceneModel},
};
use wayword_house::{HouseOptions, HousePlatform, generate_house, save_house, scene_name};
use wayword_render::{PinholeCamera, RenderScene, render_scene};

/// Largest mean difference of two pictures, of 255.
const MAX_MEAN: f64 = 1.0;
/// Largest difference at the 99th percentile, of 255.
const MAX_99TH: u8 = 5;
/// Largest difference of two depths, metres.
const MAX_DEPTH_M: f64 = 0.01;

/// Mean difference of two pictures, and the difference that 99 % of their channels do not exceed.
fn picture_difference(ours: &[u8], theirs: &[u8]) -> (f64, u8) {
    assert_eq!(ours.len(), theirs.len());
    let mut off: Vec<u8> = ours.iter().zip(theirs).map(|(a, b)| a.abs_diff(*b)).collect();
    off.sort_unstable();
    (off.iter().map(|each| f64::from(*each)).sum::<f64>() / off.len() as f64, off[off.len() * 99 / 100])
}

/// Compares a house's files with the pictures and depths that habitat-sim drew of it.
fn compare_with_habitat(stage: &Path, folder: &Path) {
    let stage = HabitatStage::from_file(stage).unwrap();
    let scene: RenderScene = SceneModel::from_stage(&stage).unwrap().into_drawable().unwrap();
    let answers = crate::oracles::json(&folder.join("answers.json"));
    for view in answers["house"].as_array().unwrap() {
        let open = |field: &str| image::open(folder.join(view[field].as_str().unwrap())).unwrap();
        let eye = crate::oracles::place(&view["position"]) + DVec3::Z * EYE_M;
        let half_yaw = view["yaw_rad"].as_f64().unwrap() / 2.0;
        let forward = forward_from_habitat_rotation([half_yaw.cos(), 0.0, half_yaw.sin(), 0.0]);
        let theirs = open("picture").into_rgb8();
        // 90 degrees wide and high.
        let camera = PinholeCamera::looking_along(eye, forward, 90.0_f64.to_radians(), theirs.width(), theirs.height());
        let ours = render_scene(&scene, &camera).unwrap();
        let (mean, most) = picture_difference(&ours.rgb, theirs.as_raw());
        let depths = open("depth_mm").into_luma16();
        let off_m = ours.depth_m.iter().zip(depths.as_raw()).map(|(ours, theirs)| {
            let ours_m = if ours.is_finite() { f64::from(*ours) } else { 0.0 };
            (ours_m - f64::from(*theirs) / 1000.0).abs()
        });
        let mut off_m: Vec<f64> = off_m.collect();
        off_m.sort_by(f64::total_cmp);
        let beyond = off_m.iter().filter(|off| **off > MAX_DEPTH_M).count();
        println!(
            "{}: mean {mean:.3}, 99th percentile {most}, depth: median {:.2} mm, {beyond} of {} beyond 1 cm",
            view["picture"],
            1000.0 * off_m[off_m.len() / 2],
            off_m.len()
        );
        assert!(mean <= MAX_MEAN && most <= MAX_99TH, "{}: mean {mean}, 99th percentile {most}", view["picture"]);
        assert!(beyond * 1000 <= off_m.len(), "{}: {beyond} depths beyond 1 cm", view["picture"]);
    }
}

#[test]
fn an_export_is_drawn_as_habitat_draws_it() {
    let Some(oracles) = crate::oracles::folder() else { return };
    let folder = oracles.join("habitat_export");
    compare_with_habitat(&folder.join("scene/house2-0.stage_config.json"), &folder);
}

#[test]
fn an_exported_house_looks_like_the_house() {
    let size = [224, 224];
    let houses = HousePlatform::new(HouseOptions { width_px: size[0], height_px: size[1], ..HouseOptions::default() });
    let options = HabitatOptions { width_px: size[0], height_px: size[1], ..HabitatOptions::default() };
    let folder = tempfile::tempdir().unwrap();
    let (mut labels, mut shared, mut foreign, mut worst) = (0, 0, 0, 0.0_f64);
    for seed in [0, 3] {
        let scene = SceneId::new(scene_name(seed)).unwrap();
        save_house(&generate_house(seed), folder.path(), None).unwrap();
        let exported =
            HabitatPlatform::open(folder.path(), options.clone(), Arc::new(|line| panic!("{line}"))).unwrap();
        let path = houses.sample_path(&scene, &PathRequest::default(), seed).unwrap();
        for frame in path.frames.iter().take(4) {
            let here =
                Frame { pose: Pose::looking_level(frame.pose.position, Heading::NORTH), viewpoint: None, level: None };
            for gaze in ViewGaze::around_heading(Heading::NORTH) {
                let [ours, saved] =
                    [&houses as &dyn Platform, &exported].map(|it| it.look_from(&scene, &here, gaze).unwrap());
                let pixels = |view: &wayword_core::View| view.image.as_ref().unwrap().rgb_bytes().to_vec();
                let (mean, most) = picture_difference(&pixels(&ours), &pixels(&saved));
                assert!(mean <= MAX_MEAN && most <= MAX_99TH, "mean {mean}, 99th percentile {most}");
                worst = mean.max(worst);
                let names = |view: &wayword_core::View| -> Vec<(String, String)> {
                    let truth = view.ground_truth().unwrap();
                    assert!(truth.lists_objects);
                    truth.labels.iter().map(|label| (label.object.to_string(), label.name.clone())).collect()
                };
                let (mut ours, saved) = (names(&ours), names(&saved));
                // Platform habitat counts doors as parts of the building.
                ours.retain(|(_, name)| !name.contains("door"));
                labels += ours.len();
                foreign += saved.iter().filter(|label| !ours.contains(label)).count();
                shared += ours.iter().filter(|label| saved.contains(label)).count();
            }
        }
    }
    println!("{shared} of {labels} labels of the house are those of its export, mean difference up to {worst:.3}");
    // The two platforms measure the boxes of things from different triangles, which decides for slivers.
    assert!(labels > 100 && shared * 100 >= labels * 97, "{shared} of {labels}");
    assert!(foreign * 100 <= labels, "{foreign} labels of the export are not the house's");
}
