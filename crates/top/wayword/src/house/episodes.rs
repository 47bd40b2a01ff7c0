//! The episodes of a set of houses: VLN-CE's files, with the actions of each, and habitat-lab's configuration.

use super::{Episodes, SCENE_SET};
use crate::house::args::House;
use std::{collections::BTreeMap, fs, path::Path};
use wayword_core::{DVec3, Heading};
use wayword_formats::{
    Episode, Format, InHabitat,
    jsonl::{self, Record},
    vlnce_actions::{self, Acted},
};
use wayword_habitat::walk::{Gait, follow};
use wayword_house::scene_name;
use wayword_report::{export::items, walking::Scenes};
use wayword_run::{
    error::{Error, Exit},
    generate::generate_into,
    output::Output,
    run_folder::file,
    settings::{Asked, Draw, Walks, Writing},
};

/// The split of all episodes.
const SPLIT: &str = "train";
/// Folder of the episodes.
const FOLDER: &str = "episodes";
/// The run that makes the instructions.
const RUN: &str = "run";
/// How far a step may end off the walk, metres.
const TOLERANCE_M: f64 = 0.25;
/// Size of the pictures that agents see.
const PICTURE_PX: [u32; 2] = [224, 224];
/// habitat-lab's configuration.
const CONFIG: &str = "vln.yaml";

/// Instructions for random paths through the houses, by labels and rules: a run in the folder `run`. A summary is printed if
/// items are lost.
pub(super) fn made(args: &House, seeds: &[u64], output: &Output) -> Result<(Vec<Record>, Exit), Error> {
    let scan = seeds.iter().map(|seed| scene_name(*seed)).collect();
    let asked = Asked {
        walks: Walks { scan: Some(scan), paths: Some(args.paths), ..Walks::default() },
        writing: Writing {
            style: Some(vec![args.style.clone().unwrap_or_else(|| "r2r".to_owned())]),
            ..Writing::default()
        },
        draw: Draw { seed: Some(args.seed), ..Draw::default() },
        ..Asked::default()
    };
    let folder = args.out.join(RUN);
    let summary = generate_into(&folder, &asked.job()?, output)?;
    if summary.exit != Exit::Done {
        output.say(&summary);
    }
    Ok((jsonl::read(&folder.join(file::INSTRUCTIONS))?, summary.exit))
}

/// Writes the episodes of records, the actions of an agent in each, and habitat-lab's configuration.
pub(super) fn write(out: &Path, records: &[Record], output: &Output) -> Result<Episodes, Error> {
    let scenes = Scenes::houses(PICTURE_PX);
    let (mut kept, mut episodes, mut acted, mut failed) = (Vec::new(), Vec::new(), BTreeMap::new(), Vec::new());
    let names = items::episode_names(records);
    for ((record, mut episode), name) in
        records.iter().zip(items::episodes(Format::Vlnce, &[], records, output)).zip(names)
    {
        episode.id = name;
        match taken(record, &scenes)? {
            Ok(actions) => {
                acted.insert(episode.id.clone(), actions);
                episodes.push(in_this_set(episode, record, &scenes)?);
                kept.push(record.clone());
            }
            Err(reason) => failed.push(format!("{}: {reason}", record.path.id)),
        }
    }
    let folder = out.join(FOLDER);
    fs::create_dir_all(&folder).map_err(Error::io(&folder, "make the folder"))?;
    let files = ["", "_gt"].map(|what| folder.join(format!("{SPLIT}{what}.json.gz")));
    let count = episodes.len();
    items::write(Format::Vlnce, &files[0], &kept, episodes)?;
    vlnce_actions::write(&files[1], &acted)?;
    let config = out.join(CONFIG);
    fs::write(&config, configuration()).map_err(Error::io(&config, "write"))?;
    Ok(Episodes { episodes: count, files, config, failed })
}

/// The actions of an agent along the path of a record, or the reason why it cannot walk there.
fn taken(record: &Record, scenes: &Scenes) -> Result<Result<Acted, String>, Error> {
    let ground = scenes.ground(&record.path.scene)?;
    let feet = wayword_report::walking::feet(&record.path);
    let heading = record.path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading);
    let walked = follow(&ground, &feet, heading, Gait::default(), TOLERANCE_M);
    Ok(walked.map_err(|astray| astray.to_string()).map(|walked| {
        let positions: Vec<DVec3> = walked.stances.iter().map(|stance| stance.foothold.place).collect();
        Acted::of(&walked.actions, &positions)
    }))
}

/// Sets the scene of an episode relative to the folder of the set, and the distance over the house's navmesh.
fn in_this_set(mut episode: Episode, record: &Record, scenes: &Scenes) -> Result<Episode, Error> {
    let scene = &record.path.scene;
    let ground = scenes.ground(scene)?;
    let ends = episode.floor_positions.first().zip(episode.floor_positions.last());
    let way = ends.and_then(|(from, to)| ground.geodesic(*from, *to).ok());
    episode.in_habitat = InHabitat {
        scene_id: Some(format!("{scene}/{scene}.glb")),
        scene_needs: None,
        geodesic_m: way.map(|way| way.length_m),
    };
    Ok(episode)
}

/// habitat-lab's configuration, as Hydra reads it. The camera has the same position as in this program.
fn configuration() -> String {
    let [width, height] = PICTURE_PX;
    format!(
        "\
# @package _global_
# habitat-lab walks the episodes with this configuration, from within this folder:
#   python -c \"import habitat, os; env = habitat.Env(habitat.get_config(os.path.abspath('{CONFIG}'))); print(env.reset())\"
defaults:
  - /benchmark/nav/vln_r2r
  - _self_

habitat:
  simulator:
    scene_dataset: {SCENE_SET}
    agents:
      main_agent:
        height: 1.5
        radius: 0.1
        sim_sensors:
          rgb_sensor: {{width: {width}, height: {height}, hfov: 90, position: [0, 1.5, 0]}}
          depth_sensor: {{width: {width}, height: {height}, hfov: 90, position: [0, 1.5, 0]}}
    forward_step_size: 0.25
    turn_angle: 15
  task:
    measurements:
      success:
        success_distance: 3.0
  dataset:
    type: R2RVLN-v1
    split: {SPLIT}
    data_path: \"{FOLDER}/{{split}}.json.gz\"
    scenes_dir: .
"
    )
}
