//! The genuine Python client drives the stand-in build. `WAYWORD_TDW_PYTHON` names a Python that has the package `tdw`,
//! or several with commas between them. Without it the tests are skipped.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::Value;
use std::{
    net::{SocketAddr, TcpListener},
    path::{Path, PathBuf},
    process::Command,
};
use wayword_core::Platform;
use wayword_house::{HouseScene, ObjectRole, generate_house};
use wayword_live::tdw::{
    BuildCommand as TdwCommand, ControllerOptions, SendFrequency, TdwController, TdwOptions, TdwPlatform,
    stand_in::{StandInOptions, TdwStandIn},
};

fn drive(python: &str, version: &'static str) -> (Value, Vec<String>) {
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let build = TdwStandIn::start(
        SocketAddr::from(([127, 0, 0, 1], port)),
        StandInOptions { version, ..StandInOptions::default() },
    );
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/drive_tdw.py");
    let driven = Command::new(python).arg(script).arg(port.to_string()).arg(folder.path()).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&driven.stdout), String::from_utf8_lossy(&driven.stderr));
    assert!(driven.status.success(), "{python}: {out}{err}");
    build.join();
    let told = out.lines().last().unwrap_or_default();
    let saved = std::fs::read_dir(folder.path().join("a")).unwrap();
    let mut names: Vec<String> = saved.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    (serde_json::from_str(told).unwrap(), names)
}

fn near(told: &Value, expected: [f64; 3]) -> bool {
    (0..3).all(|axis| (told[axis].as_f64().unwrap() - expected[axis]).abs() < 1e-4)
}

#[test]
fn the_genuine_client_reads_everything_that_the_stand_in_sends() {
    let Ok(pythons) = std::env::var("WAYWORD_TDW_PYTHON") else {
        println!(
            "SKIPPED: set WAYWORD_TDW_PYTHON to a Python with the package tdw (pip install tdw==1.13.0.0, or 1.12.27)"
        );
        return;
    };
    for python in pythons.split(',') {
        for version in ["1.13.0.0", "1.12.27"] {
            let client = Command::new(python).args(["-c", "import tdw.version as v; print(v.__version__)"]).output();
            let client = String::from_utf8_lossy(&client.unwrap().stdout).trim().to_owned();
            // The client knows only the layout of its own version.
            if client.starts_with("1.13") == version.starts_with("1.13") {
                let (told, saved) = drive(python, version);
                holds(&told, &saved, version);
                println!(
                    "tdw {client} drove the stand-in {version}: {} objects, {} seen",
                    told["objects"].as_object().unwrap().len(),
                    told["seen"].as_array().unwrap().len()
                );
            }
        }
    }
}

/// Loads every floor plan with every layout from the package's own lists.
#[test]
fn furniture_of_the_genuine_package_can_be_placed() {
    let Ok(pythons) = std::env::var("WAYWORD_TDW_PYTHON") else {
        println!("SKIPPED: set WAYWORD_TDW_PYTHON to a Python with the package tdw");
        return;
    };
    for python in pythons.split(',') {
        let folder = "import tdw, os; print(os.path.dirname(tdw.__file__))";
        let folder = Command::new(python).args(["-c", folder]).output().unwrap().stdout;
        let package = Some(PathBuf::from(String::from_utf8(folder).unwrap().trim()));
        let controller =
            ControllerOptions { address: SocketAddr::from(([127, 0, 0, 1], 0)), ..ControllerOptions::default() };
        let platform = TdwPlatform::new(TdwOptions { controller, package, ..TdwOptions::default() }).unwrap();
        let address = platform.waits_at().trim_start_matches("tcp://").parse().unwrap();
        let _build = TdwStandIn::start(address, StandInOptions::default());
        let scenes = platform.list_scenes().unwrap();
        assert_eq!(scenes.len(), 12 * 3 + 1);
        for scene in &scenes {
            assert!(platform.graph_for_scene(scene).unwrap().len() > 20, "{scene}");
        }
    }
}

/// libzmq, the implementation that most programs use, plays the build.
#[test]
fn libzmq_agrees_about_the_bytes() {
    let Ok(pythons) = std::env::var("WAYWORD_TDW_PYTHON") else {
        println!("SKIPPED: set WAYWORD_TDW_PYTHON to a Python with the package pyzmq");
        return;
    };
    let python = pythons.split(',').next().unwrap_or_default().to_owned();
    let options = ControllerOptions { address: SocketAddr::from(([127, 0, 0, 1], 0)), ..ControllerOptions::default() };
    let mut controller = TdwController::bind(options).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/pretend_build.py");
    let port = controller.address().port().to_string();
    let build = std::thread::spawn(move || Command::new(python).arg(script).arg(port).output().unwrap());
    // Its first answer is `ftre` (not received), its second has a megabyte, its third follows a long list.
    assert_eq!(controller.connect().unwrap().tdw, "1.13.0.0");
    let many = vec![TdwCommand::SendSceneRegions { frequency: SendFrequency::Once }; 10_000];
    assert_eq!(controller.communicate(&many).unwrap().frame_number, 2);
    let told = String::from_utf8(build.join().unwrap().stdout).unwrap();
    let told: Vec<(usize, Vec<String>)> = told.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(told.len(), 3);
    assert_eq!(told[0], told[1], "the same commands again");
    assert_eq!(told[1].1, ["set_error_handling", "send_version"]);
    assert!(told[2].0 > 500_000 && told[2].1[0] == "send_scene_regions");
}

fn holds(told: &Value, saved: &[String], version: &str) {
    let house = (1..).map(generate_house).find(|house| house.storeys == 1).unwrap();
    let scene = HouseScene::new(house).unwrap();
    let objects: Vec<_> = scene.objects.iter().filter(|(_, object)| object.role != ObjectRole::Shell).collect();
    assert_eq!((&told["build"], &told["unity"]), (&version.into(), &"2020.3.24f1".into()));
    assert_eq!(told["size"], serde_json::json!([160, 120]));
    assert_eq!(told["passes"], serde_json::json!(["_img", "_id", "_depth"]));
    assert!(
        ["img_0000.png", "id_0000.png", "depth_0000.png"].iter().all(|name| saved.contains(&(*name).to_owned())),
        "{saved:?}"
    );
    assert_eq!(told["objects"].as_object().unwrap().len(), objects.len());
    for (id, object) in objects {
        assert_eq!(told["objects"][id.to_string()][1], object.name.as_str());
        let (centre, low) = (object.centre_m(), object.bounds_m.0);
        assert!(near(&told["bounds"][id.to_string()], [centre.x, centre.z, centre.y]));
        assert!(near(&told["transforms"][id.to_string()], [centre.x, low.z, centre.y]));
    }
    assert!(!told["seen"].as_array().unwrap().is_empty());
    assert!(told["unknown_colours"].as_u64().unwrap() <= 1, "walls are black, and nothing else is unknown");
    assert_eq!(told["rooms"], scene.house.rooms.len());
    let depth_m = told["depth"][1].as_f64().unwrap();
    assert!((0.1..20.0).contains(&depth_m), "{depth_m} m ahead");
    assert!(near(&told["avatar"][1], [3.0, 1.5, 3.0]));
    // Looks from (3, 3) to (4, 7).
    let slope = told["avatar"][2][0].as_f64().unwrap() / told["avatar"][2][2].as_f64().unwrap();
    assert!((slope - 0.25).abs() < 1e-5 && (told["sensor"][1].as_f64().unwrap() - 60.0).abs() < 1e-4);
    // World to camera, row by row: the eye is at the camera's origin.
    let row = |n: usize| -> f64 {
        [3.0, 1.5, 3.0, 1.0].iter().enumerate().map(|(i, x)| told["camera"][4 * n + i].as_f64().unwrap() * x).sum()
    };
    assert!((0..3).all(|n| row(n).abs() < 1e-4));
    assert!(told["occupancy"]["0"].as_u64().unwrap() > 50 && told["occupancy"]["1"].as_u64().unwrap() > 20);
    assert_eq!(told["on_nav_mesh"][0], true);
    assert_eq!((&told["path"][0], &told["path"][1]), (&7.into(), &"complete".into()));
    let (last, end) = (&told["path"][3], &told["path"][4]);
    assert!(
        ["x", "y", "z"]
            .iter()
            .enumerate()
            .all(|(n, axis)| (last[n].as_f64().unwrap() - end[axis].as_f64().unwrap()).abs() < 0.06)
    );
    assert_eq!(told["quit"], true);
}
