//! Measures how well the names agree with the plans of generated houses. The houses are saved with numbered rooms and
//! read back. `WAYWORD_ROOM_HOUSES=40` measures more houses, and `--nocapture` prints the figures.

use super::super::super::{SceneSemantics, SemanticFiles, load_semantics};
use crate::scene::HabitatStage;
use std::collections::BTreeMap;
use wayword_core::{DVec3, Frame, Heading, Platform, Pose, ViewGaze};
use wayword_house::{EYE_M, HouseGround, HouseOptions, HousePlatform, generate_house, save_house, viewpoint_graph};

/// Distance of the places at which rooms are compared, metres.
const APART_M: f64 = 0.6;

/// How often rooms of one kind got a name, and the right one.
#[derive(Debug, Default)]
struct Count {
    all: usize,
    named: usize,
    right: usize,
    /// Wrong names where the eye is not in an opening between two rooms.
    wrong_inside: usize,
}

fn read_back(seed: u64) -> SceneSemantics {
    let folder = tempfile::tempdir().unwrap();
    let saved = save_house(&generate_house(seed), folder.path(), None).unwrap();
    let [mesh, text] = saved.semantics;
    let files = SemanticFiles { painted: Some((mesh, text)), numbered: None };
    load_semantics(&files, HabitatStage::from_file(&saved.stage).unwrap().habitat_from_asset).unwrap().unwrap()
}

/// Eyes at the viewpoints of a house, and at regular places over the ground of all storeys.
fn eyes(seed: u64) -> Vec<DVec3> {
    let house = generate_house(seed);
    let ground = HouseGround::for_house(&house);
    let graph = viewpoint_graph(&house, &ground).unwrap();
    let mut eyes: Vec<DVec3> = graph.viewpoints().filter_map(|id| graph.position_of(id)).collect();
    for room in &house.rooms {
        let area = room.outline;
        let [x0, y0, x1, y1, z] = [area.x0, area.y0, area.x1, area.y1, room.base_cm()].map(|cm| f64::from(cm) / 100.0);
        let count = |from: f64, to: f64| ((to - from) / APART_M) as usize + 1;
        let places = (0..count(x0, x1)).flat_map(|column| (0..count(y0, y1)).map(move |row| (column, row)));
        let places = places.map(|(column, row)| DVec3::new(x0 + column as f64 * APART_M, y0 + row as f64 * APART_M, z));
        eyes.extend(places.filter(|place| ground.is_walkable(*place)).map(|place| place + DVec3::Z * EYE_M));
    }
    eyes
}

/// The counts over some houses, by the house's own name of the room.
fn counted(seeds: std::ops::Range<u64>) -> BTreeMap<String, Count> {
    let options = HouseOptions { width_px: 8, height_px: 6, ..HouseOptions::default() };
    let (platform, mut counts) = (HousePlatform::new(options), BTreeMap::<String, Count>::new());
    for seed in seeds {
        let (semantics, scene) = (read_back(seed), HousePlatform::scene_of(seed).unwrap());
        for eye in eyes(seed) {
            let headings = [0.0, 0.5, 1.0, 1.5].map(|turns| Heading::new(turns * std::f64::consts::PI).unwrap());
            let told = headings.map(|heading| {
                let frame = Frame { pose: Pose::looking_level(eye, heading), viewpoint: None, level: None };
                let view = platform.look_without_picture(&scene, &frame, ViewGaze::quarter_view(heading)).unwrap();
                let room = view.ground_truth().unwrap().room.clone().unwrap();
                // The house has another word for the same thing.
                if room == "staircase" { "stairs".to_owned() } else { room }
            });
            // In an opening the house names the room ahead.
            let is_inside = told.iter().all(|room| *room == told[0]);
            for (heading, room) in headings.into_iter().zip(told) {
                let (named, count) = (semantics.room_at(eye, heading), counts.entry(room.clone()).or_default());
                let is_right = named == Some(room.as_str());
                count.all += 1;
                count.named += usize::from(named.is_some());
                count.right += usize::from(is_right);
                count.wrong_inside += usize::from(named.is_some() && !is_right && is_inside);
            }
        }
    }
    counts
}

/// Near an opening the names may differ, because a sill belongs to one of the two rooms.
#[test]
fn rooms_of_houses_are_named_as_in_their_plans() {
    let houses = std::env::var("WAYWORD_ROOM_HOUSES").ok().and_then(|houses| houses.parse().ok());
    let counts = counted(0..houses.unwrap_or(10));
    let sum = |of: fn(&Count) -> usize| counts.values().map(of).sum::<usize>() as f64;
    let (all, named, right) = (sum(|count| count.all), sum(|count| count.named), sum(|count| count.right));
    let (precision, recall, wrong_inside) = (right / named, right / all, sum(|count| count.wrong_inside) / named);
    println!("{counts:#?}\n{all} views: precision {precision:.4}, recall {recall:.4}, wrong inside {wrong_inside:.4}");
    assert!(
        precision >= 0.98 && recall >= 0.9 && wrong_inside <= 0.005,
        "{precision} {recall} {wrong_inside}: {counts:?}"
    );
}
