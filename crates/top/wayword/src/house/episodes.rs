//! The episodes of a set of houses: VLN-CE's files, with the actions of each, and habitat-lab's configuration.

use super::{CONFIG_FILE, EPISODES_FOLDER, RUN_FOLDER, SCENE_SET, WrittenEpisodes};
use crate::house::args::HouseArgs;
use std::{collections::BTreeMap, fs, path::Path};
use wayword_core::{DVec3, Heading};
use wayword_formats::{
    DatasetFormat, Episode, InHabitat,
    jsonl::{self, InstructionRecord},
    vlnce_actions::{self, EpisodeActions},
};
use wayword_habitat::walk::{AgentGait, follow_places};
use wayword_house::scene_name;
use wayword_report::{
    export::{items, lay_on_navmesh},
    walking::WalkingScenes,
};
use wayword_run::{
    error::{CommandError, Exit},
    generate::generate_into,
    output::CommandOutput,
    run_folder::file,
    settings::{AskedSettings, Draw, Walks, Writing},
    written_files::write_file,
};

/// The name of the split that all episodes are in.
const EPISODE_SPLIT: &str = "train";
/// How far a step may end off the walk, metres.
const TOLERANCE_M: f64 = 0.25;
/// Width and height of the pictures that agents see, pixels.
const PICTURE_PX: [u32; 2] = [224, 224];

/// Instructions for random paths through the houses, by labels and rules: a run in the folder `run`. A summary is printed if
/// items are lost.
pub(super) fn make_run(
    args: &HouseArgs,
    seeds: &[u64],
    output: &CommandOutput,
) -> Result<(Vec<InstructionRecord>, Exit), CommandError> {
    let scan = seeds.iter().map(|seed| scene_name(*seed)).collect();
    let asked = AskedSettings {
        walks: Walks { scan: Some(scan), paths: Some(args.paths), ..Walks::default() },
        writing: Writing {
            style: Some(vec![args.style.clone().unwrap_or_else(|| "r2r".to_owned())]),
            ..Writing::default()
        },
        draw: Draw { seed: Some(args.seed), ..Draw::default() },
        ..AskedSettings::default()
    };
    let folder = args.out.join(RUN_FOLDER);
    let summary = generate_into(&folder, &asked.into_job()?, output)?;
    if summary.exit != Exit::Done {
        output.say(&summary);
    }
    Ok((jsonl::read_records(&folder.join(file::INSTRUCTIONS))?, summary.exit))
}

/// Writes the episodes of records, the actions of an agent in each, and habitat-lab's configuration.
pub(super) fn write_episodes(
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<WrittenEpisodes, CommandError> {
    let scenes = WalkingScenes::generated_houses(PICTURE_PX);
    let (mut kept, mut episodes, mut acted, mut failed) = (Vec::new(), Vec::new(), BTreeMap::new(), Vec::new());
    let names = items::episode_names(records);
    for ((record, mut episode), name) in
        records.iter().zip(items::episodes_from_records(DatasetFormat::Vlnce, &[], records, output)).zip(names)
    {
        episode.id = name;
        match act_record(record, &scenes)? {
            Ok(actions) => {
                acted.insert(episode.id.clone(), actions);
                episodes.push(place_in_set(episode, record, &scenes)?);
                kept.push(record.clone());
            }
            Err(reason) => failed.push(format!("{}: {reason}", record.path.id)),
        }
    }
    let folder = out.join(EPISODES_FOLDER);
    fs::create_dir_all(&folder).map_err(CommandError::io(&folder, "make the folder"))?;
    let files = ["", "_gt"].map(|what| folder.join(format!("{EPISODE_SPLIT}{what}.json.gz")));
    let count = episodes.len();
    items::write_items(DatasetFormat::Vlnce, &files[0], &kept, episodes)?;
    vlnce_actions::write_actions(&files[1], &acted)?;
    let config = out.join(CONFIG_FILE);
    write_file(&config, config_text())?;
    Ok(WrittenEpisodes { episodes: count, files, config, failed })
}

/// The actions of an agent along the path of a record, or the reason why it cannot walk there.
fn act_record(
    record: &InstructionRecord,
    scenes: &WalkingScenes,
) -> Result<Result<EpisodeActions, String>, CommandError> {
    let ground = scenes.ground(&record.path.scene)?;
    let feet = wayword_report::walking::floor_positions(&record.path);
    let heading = record.path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading);
    let walked = follow_places(&ground, &feet, heading, AgentGait::default(), TOLERANCE_M);
    Ok(walked.map_err(|astray| astray.to_string()).map(|walked| {
        let positions: Vec<DVec3> = walked.stances.iter().map(|stance| stance.foothold.place).collect();
        EpisodeActions::from_positions(&walked.actions, &positions)
    }))
}

/// Sets the scene of an episode relative to the folder of the set, and lays its path on the house's navmesh.
fn place_in_set(
    mut episode: Episode,
    record: &InstructionRecord,
    scenes: &WalkingScenes,
) -> Result<Episode, CommandError> {
    let scene = &record.path.scene;
    episode.in_habitat =
        InHabitat { scene_id: Some(format!("{scene}/{scene}.glb")), scene_needs: None, geodesic_m: None };
    let ground = scenes.ground(scene)?;
    lay_on_navmesh(&ground, &mut episode);
    Ok(episode)
}

/// habitat-lab's configuration, as Hydra reads it. The camera has the same position as in this program.
fn config_text() -> String {
    let [width, height] = PICTURE_PX;
    format!(
        "\
# @package _global_
# habitat-lab walks the episodes with this configuration, from within this folder:
#   python -c \"import habitat, os; env = habitat.Env(habitat.get_config(os.path.abspath('{CONFIG_FILE}'))); print(env.reset())\"
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
    split: {EPISODE_SPLIT}
    data_path: \"{EPISODES_FOLDER}/{{split}}.json.gz\"
    scenes_dir: .
"
    )
}
