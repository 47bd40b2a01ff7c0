//! The genuine Python client drives the stand-in of VirtualHome. `WAYWORD_VIRTUALHOME_PYTHON` names a Python that has
//! the package `virtualhome` and a `numpy` before 2. Without it the test is skipped.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::Value;
use std::{collections::BTreeSet, path::Path, process::Command};
use wayword_core::DVec3;
use wayword_house::{HouseScene, ObjectRole, generate_house};
use wayword_live::virtualhome::stand_in::VirtualHomeStandIn;
use wayword_render::PinholeCamera;

#[test]
fn the_genuine_client_reads_everything_that_the_stand_in_sends() {
    let Ok(python) = std::env::var("WAYWORD_VIRTUALHOME_PYTHON") else {
        println!(
            "SKIPPED: set WAYWORD_VIRTUALHOME_PYTHON to a Python with the package virtualhome \
             (pip install virtualhome==2.3.0 'numpy<2')"
        );
        return;
    };
    let simulator = VirtualHomeStandIn::start(([127, 0, 0, 1], 0).into()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/drive_virtualhome.py");
    let driven = Command::new(&python).arg(script).arg(simulator.port().to_string()).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&driven.stdout), String::from_utf8_lossy(&driven.stderr));
    assert!(driven.status.success(), "{python}: {out}{err}");
    let told: Value = serde_json::from_str(out.lines().last().unwrap_or_default()).unwrap();
    holds(&told);
    let count = |name: &str| told[name].as_array().map_or(0, Vec::len);
    println!(
        "virtualhome drove the stand-in: {} nodes, {} seen",
        told["nodes"].as_object().unwrap().len(),
        count("seen")
    );
}

fn holds(told: &Value) {
    let scene = HouseScene::new((1..).map(generate_house).find(|house| house.storeys == 1).unwrap()).unwrap();
    for done in ["connected", "reset", "character", "added", "moved"] {
        assert_eq!(told[done], true, "{done}");
    }
    assert_eq!(told["unknown_action"], false);
    let objects: Vec<_> = scene.objects.iter().filter(|(_, object)| object.role != ObjectRole::Shell).collect();
    assert_eq!(told["nodes"].as_object().unwrap().len(), objects.len() + scene.house.rooms.len());
    assert_eq!(told["inside"], objects.len());
    for (id, object) in &objects {
        let centre = &told["nodes"][id.to_string()][2]["center"];
        let expected = object.centre_m();
        let expected = [expected.x, expected.z, expected.y];
        let off = (0..3).map(|n| (centre[n].as_f64().unwrap() - expected[n]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9);
    }
    assert_eq!(told["cameras"], serde_json::json!([0, 1]));
    assert_eq!(told["shape"], serde_json::json!([[120, 160, 3], [120, 160, 3]]));
    // The client decoded what our renderer draws from the same place, looking east.
    let at = |n: usize| told["at"][n].as_f64().unwrap();
    let picture = scene
        .render_picture(&PinholeCamera {
            position: DVec3::new(at(0), at(1), 1.5),
            heading_rad: std::f64::consts::FRAC_PI_2,
            elevation_rad: 0.0,
            vertical_fov_rad: 70f64.to_radians(),
            width: 160,
            height: 120,
        })
        .unwrap();
    for channel in 0..3 {
        let sum: u64 = picture.rgb.iter().skip(channel).step_by(3).map(|value| u64::from(*value)).sum();
        assert!((sum as f64 / 19_200.0 - told["mean"][channel].as_f64().unwrap()).abs() < 0.01);
    }
    let drawn: BTreeSet<u32> = picture
        .ids
        .iter()
        .copied()
        .filter(|id| scene.objects.get(id).is_some_and(|object| object.role != ObjectRole::Shell))
        .collect();
    let seen: BTreeSet<u32> = told["seen"].as_array().unwrap().iter().map(|id| id.as_u64().unwrap() as u32).collect();
    assert_eq!(seen, drawn);
    assert!(told["unknown_colours"].as_u64().unwrap() <= 1, "walls are black, and nothing else is unknown");
}
