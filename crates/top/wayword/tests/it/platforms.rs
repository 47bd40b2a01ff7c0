//! Platforms by name: they are listed, and refused with the missing data; and whole runs on stand-ins of live simulators.

#![cfg(feature = "live")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran, free_port};
use wayword_live::{tdw, virtualhome};

/// Instructions for two random paths, all of which pass their checks.
fn generate(building: &Building, platform: &str, scene: &str, at: &str) -> Ran {
    let world = ["generate", "--platform", platform, "--at", at, "--scan", scene];
    let ran = building.wayword(&[&world[..], &["--paths", "2", "--style", "r2r", "--out", platform]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert_eq!(building.records(platform).len(), 2);
    ran
}

#[test]
fn every_world_is_listed_with_what_it_needs() {
    let listed = Building::new().wayword(&["platforms", "--json"]).json();
    let names: Vec<&str> = listed.as_array().unwrap().iter().map(|world| world["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["house", "matterport", "process", "habitat", "tdw", "virtualhome", "recording"]);
    for world in listed.as_array().unwrap() {
        assert!(world["is_here"] == true && !world["needs"].as_str().unwrap().is_empty(), "{world}");
    }
}

#[test]
fn missing_data_of_a_platform_is_reported() {
    let building = Building::new();
    for (args, told) in [
        (&["--platform", "habitat"][..], "needs --data"),
        (&["--platform", "process"], "needs --data\nhint: give --data FILE"),
        (&["--platform", "process", "--data", "nothing.json"], "nothing.json"),
        (&["--platform", "habitat", "--data", "nowhere"], "nowhere"),
        (&["--platform", "recording"], "needs --data"),
        (&["--platform", "recording", "--data", "nowhere"], "nowhere"),
        (&["--platform", "tdw", "--at", "here"], "--at here"),
        (&["--platform", "virtualhome", "--at", "here"], "--at here"),
        (&["--platform", "virtualhome", "--at", "http://127.0.0.1:9"], "nothing listens at http://127.0.0.1:9"),
        (&["--platform", "virtualhome", "--at", "http://127.0.0.1:9"], "-http-port=9, or give its address"),
        (&["--data", "data"], "platform house, the default, takes no --data"),
        (&["--platform", "virtualhome", "--data", "data"], "platform virtualhome takes no --data"),
        (&["--at", "127.0.0.1:1071"], "as in --platform tdw"),
    ] {
        let ran = building.wayword(&[&["generate", "--paths", "1", "--out", "run"], args].concat());
        assert!(ran.refused().contains(told), "{args:?}: {ran:?}");
        assert!(!building.path("run").exists(), "{args:?}");
    }
}

#[test]
fn a_build_that_connects_can_be_walked_through() {
    let (building, address) = (Building::new(), free_port());
    let _build = tdw::stand_in::TdwStandIn::start(address, tdw::stand_in::StandInOptions::default());
    generate(&building, "tdw", "floorplan_1a", &address.to_string());
}

#[test]
fn an_executable_that_answers_can_be_walked_through() {
    let (building, address) = (Building::new(), free_port());
    let _executable = virtualhome::stand_in::VirtualHomeStandIn::start(address).unwrap();
    generate(&building, "virtualhome", "home_0", &format!("http://{address}"));
}

/// From a scene's files to checked instructions, in Habitat's own formats: stage configuration, GLB and HM3D's
/// semantics.
#[test]
fn a_house_saved_for_habitat_can_be_walked_through_as_one_of_its_scenes() {
    let building = Building::new();
    let saved = building.wayword(&["house", "--seed", "2", "--paths", "0", "--out", "houses", "--json"]).json();
    let stage = saved["houses"][0]["stage"].as_str().unwrap();
    let world =
        ["generate", "--platform", "habitat", "--data", stage, "--paths", "2", "--style", "r2r", "--out", "run"];
    let ran = building.wayword(&world);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let records = building.records("run");
    assert_eq!(records.len(), 2);
    assert!(records.iter().all(|record| record.instruction.provenance.answerer == "labels"));
}
