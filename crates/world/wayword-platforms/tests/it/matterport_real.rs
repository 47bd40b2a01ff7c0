//! Tests with the real buildings, if they are available: `WAYWORD_DATA` names their folder. Without it, the folder
//! `../shared/data` next to the repository is tried.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or counted"
)]

use serde_json::Value;
use std::path::PathBuf;
use wayword_core::{Heading, ObjectId, Path, PathRequest, Platform, SceneId, Side, ViewGaze, ViewpointId};
use wayword_platforms::MatterportPlatform;
use wayword_world::{labels_around, path_over_viewpoints};

fn data() -> Option<PathBuf> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data"));
    let folder = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from);
    let there = folder.join("matterport/connectivity").is_dir();
    if !there {
        println!("SKIPPED: no Matterport3D data in {}; set WAYWORD_DATA to its folder", folder.display());
    }
    there.then_some(folder)
}

fn items(split: &str) -> Option<(MatterportPlatform, Vec<Value>)> {
    let folder = data()?;
    let bytes = std::fs::read(folder.join(format!("reverie/REVERIE_{split}.json"))).unwrap();
    Some((MatterportPlatform::open(&folder).unwrap(), serde_json::from_slice(&bytes).unwrap()))
}

fn scene_of(item: &Value) -> SceneId {
    SceneId::new(item["scan"].as_str().unwrap()).unwrap()
}

fn path(platform: &MatterportPlatform, item: &Value) -> Path {
    let viewpoints: Vec<ViewpointId> =
        item["path"].as_array().unwrap().iter().map(|id| ViewpointId::new(id.as_str().unwrap()).unwrap()).collect();
    let heading = Heading::new(item["heading"].as_f64().unwrap()).unwrap();
    let object = ObjectId::new(item["objId"].to_string()).unwrap();
    let id = item["id"].as_str().unwrap();
    path_over_viewpoints(platform, id, &scene_of(item), &viewpoints, Some(heading), Some(&object)).unwrap()
}

#[test]
fn all_buildings_load() {
    let Some(folder) = data() else { return };
    let platform = MatterportPlatform::open(&folder).unwrap();
    let scenes = platform.list_scenes().unwrap();
    assert_eq!(scenes.len(), 60);
    let viewpoints: usize = scenes.iter().map(|scene| platform.graph_for_scene(scene).unwrap().len()).sum();
    assert_eq!(viewpoints, 7633, "as many as REVERIE has files of boxes");
}

#[test]
fn every_episode_gives_a_path_with_a_named_target_which_is_nearly_always_visible() {
    let Some((platform, items)) = items("val_seen") else { return };
    let (mut visible, mut ahead, mut namesakes, mut rooms) = (0, 0, 0, 0);
    for item in &items {
        let path = path(&platform, item);
        let target = path.target.as_ref().unwrap();
        let last = path.frames.last().unwrap();
        let sees = |gaze: ViewGaze| {
            let view = platform.look_from(&path.scene, last, gaze).unwrap();
            view.ground_truth()
                .unwrap()
                .labels
                .iter()
                .any(|label| label.object == target.object && label.name == target.name)
        };
        let views = ViewGaze::around_heading(last.pose.heading).map(sees);
        assert!(views.iter().filter(|sees| **sees).count() <= 1, "a label belongs to one view");
        visible += usize::from(views.contains(&true));
        ahead += usize::from(views[Side::Ahead as usize]);
        namesakes += usize::from(target.has_namesake);
        let view = platform.look_from(&path.scene, last, ViewGaze::quarter_view(last.pose.heading)).unwrap();
        rooms += usize::from(view.ground_truth().unwrap().room.is_some());
    }
    println!(
        "{} items: target visible {visible}, ahead {ahead}, with namesake {namesakes}, room known {rooms}",
        items.len()
    );
    assert_eq!((items.len(), visible), (501, 498));
    assert!(rooms >= 480);
}

#[test]
fn levels_agree_with_what_people_wrote() {
    let (mut agreeing, mut said) = (0, 0);
    for split in ["train", "val_seen"] {
        let Some((platform, items)) = items(split) else { return };
        for item in &items {
            let goal = item["path"].as_array().unwrap().last().unwrap().as_str().unwrap();
            let level =
                platform.graph_for_scene(&scene_of(item)).unwrap().level_of(&ViewpointId::new(goal).unwrap()).unwrap();
            for text in item["instructions"].as_array().unwrap() {
                if let Some(written) = written_level(text.as_str().unwrap()) {
                    said += 1;
                    agreeing += usize::from(written == level);
                }
            }
        }
    }
    println!("levels: {agreeing} of {said} texts agree");
    assert!(agreeing * 100 >= said * 94, "{agreeing} of {said}");
}

/// The one storey that a text names ("level 2", "second floor"); `None` if it names none or several.
fn written_level(text: &str) -> Option<u32> {
    let number = |word: &str| match word {
        "1" | "one" | "first" | "1st" | "ground" => Some(1),
        "2" | "two" | "second" | "2nd" => Some(2),
        "3" | "three" | "third" | "3rd" => Some(3),
        "4" | "four" | "fourth" | "4th" => Some(4),
        _ => None,
    };
    let lower = text.to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    let mut levels: Vec<u32> = words
        .windows(2)
        .filter_map(|pair| match pair {
            ["level" | "floor", which @ ("1" | "2" | "3" | "4" | "one" | "two" | "three" | "four")] => number(which),
            [which, "level" | "floor"] if !matches!(*which, "one" | "two" | "three" | "four") => number(which),
            _ => None,
        })
        .collect();
    levels.sort_unstable();
    levels.dedup();
    if let [only] = levels[..] { Some(only) } else { None }
}

#[test]
fn directions_of_boxes_agree_with_object_centres() {
    let Some(folder) = data() else { return };
    let platform = MatterportPlatform::open(&folder).unwrap();
    let (mut labels, mut within_10, mut within_45) = (0, 0, 0);
    for scene in platform.list_scenes().unwrap() {
        let graph = platform.graph_for_scene(&scene).unwrap();
        for viewpoint in graph.viewpoints() {
            let frame = graph.path_frames(std::slice::from_ref(viewpoint), None).unwrap().remove(0);
            for label in labels_around(&platform, &scene, &frame).unwrap() {
                let centre = Heading::towards(frame.pose.position, label.position.unwrap()).unwrap();
                let off_deg = label.heading.turn_to(centre).abs().to_degrees();
                labels += 1;
                within_10 += usize::from(off_deg < 10.0);
                within_45 += usize::from(off_deg < 45.0);
            }
        }
    }
    println!("{labels} labels: direction within 10 degrees of the centre's {within_10}, within 45 {within_45}");
    assert!(labels > 19_000);
    assert!(within_10 * 100 >= labels * 95 && within_45 * 1000 >= labels * 990);
}

#[test]
fn random_paths_end_at_a_visible_target() {
    let Some(folder) = data() else { return };
    let platform = MatterportPlatform::open(&folder).unwrap();
    let mut targets = 0;
    let scenes = platform.list_scenes().unwrap();
    for (seed, scene) in scenes.iter().enumerate() {
        let path = match platform.sample_path(scene, &PathRequest::default(), seed as u64) {
            Ok(path) => path,
            // Some buildings are too small for four hops.
            Err(error) => {
                println!("{error}");
                continue;
            }
        };
        assert!((4..=7).contains(&path.moves().len()) && (5.0..=20.0).contains(&path.length_m().unwrap()));
        let around = labels_around(&platform, scene, path.frames.last().unwrap()).unwrap();
        targets +=
            usize::from(path.target.is_some_and(|target| around.iter().any(|label| label.object == target.object)));
    }
    println!("{targets} of {} random paths have a visible target", scenes.len());
    assert!(targets >= 55);
}
