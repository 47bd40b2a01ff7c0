//! `wayword robustness` between a generated house and stand-ins of simulators that show the same house.

#![cfg(feature = "live")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran, free_port};
use serde_json::Value;
use std::fs;
use wayword_live::{StandInHouses, tdw, virtualhome};

fn robustness(building: &Building, args: &[&str]) -> Ran {
    building.wayword(&[&["robustness", "--run", "run", "--out", "robust", "--resamples", "100"], args].concat())
}

/// A generated house with one storey, which the stand-ins of simulators show too: the first from a seed on.
fn with_one_storey(seed: u64) -> u64 {
    (seed..).find(|seed| wayword_house::generate_house(*seed).storeys == 1).unwrap()
}

/// The texts of a run of two paths through a house, as another platform shows the same house.
fn elsewhere(seed: u64, platform: &str, name: &str) -> (Building, Ran) {
    let (building, scene) = (Building::new(), format!("house2-{seed}"));
    let ran = building.wayword(&["generate", "--scan", &scene, "--paths", "2", "--style", "r2r", "--out", "run"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let (change, called) = (format!("platform={platform}"), format!("{scene}={name}"));
    let ran = robustness(&building, &["--change", &change, "--scene-name", &called]);
    (building, ran)
}

/// A text was written of what the other platform shows, and speaks of a thing that both have.
fn told_elsewhere(building: &Building) {
    let texts = fs::read_to_string(building.path("robust/texts.jsonl")).unwrap();
    let lines: Vec<Value> = texts.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let of_arm = |begins: &str| {
        let arm = |line: &&Value| line["arm"].as_str().unwrap().starts_with(begins);
        lines.iter().filter(arm).cloned().collect::<Vec<Value>>()
    };
    let landmarks = |line: &Value| -> Vec<String> {
        let told = &line["texts"][0];
        let text = told["text"].as_str().unwrap();
        let mentions = told["mentions"].as_array().unwrap().iter().filter(|mention| mention["kind"] == "landmark");
        let span = |mention: &Value, end: usize| mention["span"][end].as_u64().unwrap() as usize;
        mentions.map(|mention| text[span(mention, 0)..span(mention, 1)].to_lowercase()).collect()
    };
    let (here, there) = (of_arm("unchanged"), of_arm("platform-"));
    assert_eq!((here.len(), there.len()), (2, 2), "{lines:?}");
    let shared = |(one, other): (&Value, &Value)| landmarks(one).iter().any(|name| landmarks(other).contains(name));
    assert!(here.iter().zip(&there).any(shared), "{here:?} {there:?}");
}

#[test]
fn the_stand_in_for_virtualhome_shows_the_same_house() {
    let address = free_port();
    let _executable = virtualhome::stand_in::VirtualHomeStandIn::start(address).unwrap();
    let platform = format!("virtualhome@http://{address}");
    let (building, ran) = elsewhere(with_one_storey(1), &platform, "home_0");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    told_elsewhere(&building);
    let other = robustness(&building, &["--change", &format!("platform={platform}"), "--scene-name", "home_0"]);
    assert!(other.code == Some(1) && other.err.contains("there is no SCENE=NAME"), "{}", other.err);
}

#[test]
fn the_stand_in_for_threedworld_shows_the_same_house() {
    let (address, seed) = (free_port(), with_one_storey(1));
    let options =
        tdw::stand_in::StandInOptions { houses: StandInHouses::with_one_storey(seed, 1), ..Default::default() };
    let _build = tdw::stand_in::TdwStandIn::start(address, options);
    let platform = format!("tdw@{address}");
    let (building, ran) = elsewhere(seed, &platform, "floorplan_1a");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    told_elsewhere(&building);
}
