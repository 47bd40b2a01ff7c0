//! `wayword house`: generated houses as a set of scenes that Habitat reads, with episodes that its agents walk.

pub(crate) mod args;
#[cfg(feature = "habitat")]
mod episodes;

use crate::house::args::HouseArgs;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_house::{HouseFiles, generate_house, save_house, scene_name, seed_of};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    interrupt,
    output::CommandOutput,
    run_folder::{expect_texts, file, lock_folder},
    written_files::{expect_own_folder, write_file},
};

/// The file that lists the scenes, which Habitat takes as its scene dataset.
const SCENE_SET: &str = "houses.scene_dataset_config.json";
/// The folder of the episodes, within that of the set.
const EPISODES_FOLDER: &str = "episodes";
/// The folder of the run that writes the instructions, within that of the set.
const RUN_FOLDER: &str = "run";
/// The file with habitat-lab's configuration, within the folder of the set.
const CONFIG_FILE: &str = "vln.yaml";

/// Most houses of one set. A larger number is refused.
const MAX_HOUSES: u64 = 100_000;

/// The files that were written.
#[derive(Debug, Serialize)]
struct WrittenHouses {
    /// The files of each house.
    houses: Vec<HouseFiles>,
    /// The file that lists the scenes.
    scene_set: PathBuf,
    /// VLN-CE's files and habitat-lab's configuration, if there are episodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    episodes: Option<WrittenEpisodes>,
}

/// The episodes of a set of houses.
#[derive(Debug, Serialize)]
struct WrittenEpisodes {
    episodes: usize,
    /// VLN-CE's episodes, and the file with an agent's actions in each.
    files: [PathBuf; 2],
    /// habitat-lab's configuration, which walks them.
    config: PathBuf,
    /// Walks that cannot be taken in VLN-CE's actions, with the reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    failed: Vec<String>,
}

/// Runs `wayword house`: makes the instructions (or takes those of a run), then the houses, the list of scenes, and the
/// episodes.
pub(crate) fn run_house(args: &HouseArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let given = args.run.as_deref().map(|run| read_records(run, args.style.as_deref())).transpose()?;
    let seeds = match &given {
        Some(records) => record_seeds(records)?,
        None => house_seeds(args)?,
    };
    if args.paths == 0 && args.run.is_none() && args.style.is_some() {
        return Err(CommandError::usage("--style has no effect with --paths 0", "leave it out, or ask for a path"));
    }
    expect_own_folder(&args.out, is_file_of_set)?;
    fs::create_dir_all(&args.out).map_err(CommandError::io(&args.out, "make the folder"))?;
    let _held = lock_folder(&args.out)?;
    // Texts are made before houses, so that a run that cannot continue ends the command early.
    let (records, exit) = match given {
        Some(records) => (Some(records), Exit::Done),
        None => make_records(args, &seeds, output)?,
    };
    if matches!(exit, Exit::Interrupted | Exit::Stopped | Exit::Lost) {
        return Ok(exit);
    }
    let bar = output.progress_bar(seeds.len(), "houses");
    let mut houses = Vec::with_capacity(seeds.len());
    for seed in &seeds {
        interrupt::check_interrupt()?;
        houses.push(write_house(*seed, &args.out)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let scene_set = args.out.join(SCENE_SET);
    let folders = format!("{}*", scene_name(0).trim_end_matches('0'));
    let set = serde_json::json!({ "stages": { "paths": { ".json": [folders] } } });
    write_file(&scene_set, format!("{set:#}\n"))?;
    let episodes = records.map(|records| write_records(&args.out, &records, output)).transpose()?.flatten();
    let has_loss = episodes.as_ref().is_some_and(|episodes| !episodes.failed.is_empty());
    let written = WrittenHouses { houses, scene_set, episodes };
    output.print_result(&written, summary_text(&written, &args.out));
    Ok(if has_loss { Exit::WithLoss } else { exit })
}

/// Whether a file's name is one of those in the folder of a set.
fn is_file_of_set(name: &str) -> bool {
    let others = [SCENE_SET, RUN_FOLDER, EPISODES_FOLDER, CONFIG_FILE, file::LOCK, file::OWNER];
    seed_of(name).is_some() || others.contains(&name)
}

/// The seeds that the user asks for.
fn house_seeds(args: &HouseArgs) -> Result<Vec<u64>, CommandError> {
    if !(1..=MAX_HOUSES).contains(&args.houses) {
        let hint = format!("give the number of houses, from 1 to {MAX_HOUSES}, as in --houses 20");
        return Err(CommandError::usage(format!("--houses {}", args.houses), hint));
    }
    let last = args.seed.checked_add(args.houses - 1).ok_or_else(|| {
        CommandError::usage(
            format!("--seed {}: there are not so many seeds after it", args.seed),
            "give a lower --seed",
        )
    })?;
    Ok((args.seed..=last).collect())
}

/// Writes the files of a house into a folder of its own.
fn write_house(seed: u64, out: &Path) -> Result<HouseFiles, CommandError> {
    let (house, folder) = (generate_house(seed), out.join(scene_name(seed)));
    fs::create_dir_all(&folder).map_err(CommandError::io(&folder, "make the folder"))?;
    Ok(save_house(&house, &folder, bake_navmesh(&house)?.as_deref())?)
}

#[cfg(feature = "habitat")]
fn bake_navmesh(house: &wayword_house::House) -> Result<Option<Vec<u8>>, CommandError> {
    let baked = wayword_report::walking::bake_house_navmesh(house);
    let baked = baked
        .map_err(|reason| CommandError::usage(format!("house {}: {reason}", house.seed), "report this as a bug"))?;
    Ok(Some(baked.to_bytes()))
}

#[cfg(not(feature = "habitat"))]
fn bake_navmesh(_house: &wayword_house::House) -> Result<Option<Vec<u8>>, CommandError> {
    Ok(None)
}

/// The records of a run, of one style.
fn read_records(run: &Path, style: Option<&str>) -> Result<Vec<InstructionRecord>, CommandError> {
    expect_texts(run)?;
    let mut records = jsonl::read_records(&run.join(file::INSTRUCTIONS))?;
    let styles: BTreeSet<String> = records.iter().map(|record| record.instruction.style.clone()).collect();
    records.retain(|record| style.is_none_or(|style| record.instruction.style == style));
    let listed = styles.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
    match (records.is_empty(), style) {
        (true, Some(style)) if !styles.is_empty() => {
            let problem = format!("{}: it has no instruction of style {style}", run.display());
            Err(CommandError::usage(problem, format!("it has these styles: {listed}")))
        }
        (true, _) => {
            let problem = format!("{}: it has no instruction", run.display());
            Err(CommandError::usage(problem, "see errors.jsonl and rejected.jsonl of the run"))
        }
        (false, None) if styles.len() > 1 => {
            let problem = format!("{} has texts of several styles, and an episode has one text", run.display());
            Err(CommandError::usage(problem, format!("choose one with --style: {listed}")))
        }
        _ => Ok(records),
    }
}

/// The seeds of the houses in records.
fn record_seeds(records: &[InstructionRecord]) -> Result<Vec<u64>, CommandError> {
    let seeds = records.iter().map(|record| {
        seed_of(record.path.scene.as_str()).ok_or_else(|| {
            let problem = format!("scene {} is no generated house", record.path.scene);
            CommandError::usage(problem, "give a run of platform house")
        })
    });
    Ok(seeds.collect::<Result<BTreeSet<_>, _>>()?.into_iter().collect())
}

/// Instructions for random paths through the houses, if there are to be any, and the exit code of making them.
#[cfg(feature = "habitat")]
fn make_records(
    args: &HouseArgs,
    seeds: &[u64],
    output: &CommandOutput,
) -> Result<(Option<Vec<InstructionRecord>>, Exit), CommandError> {
    if args.paths == 0 {
        return Ok((None, Exit::Done));
    }
    episodes::make_run(args, seeds, output).map(|(records, exit)| (Some(records), exit))
}

#[cfg(not(feature = "habitat"))]
fn make_records(
    args: &HouseArgs,
    _seeds: &[u64],
    output: &CommandOutput,
) -> Result<(Option<Vec<InstructionRecord>>, Exit), CommandError> {
    if args.paths > 0 {
        output.say("no navmeshes and no episodes are written, because this build has no platform habitat");
    }
    Ok((None, Exit::Done))
}

#[cfg(feature = "habitat")]
fn write_records(
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Option<WrittenEpisodes>, CommandError> {
    episodes::write_episodes(out, records, output).map(Some)
}

#[cfg(not(feature = "habitat"))]
fn write_records(
    _out: &Path,
    _records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Option<WrittenEpisodes>, CommandError> {
    output.say("no episodes are written, because this build has no platform habitat");
    Ok(None)
}

fn summary_text(written: &WrittenHouses, out: &Path) -> String {
    let houses = format!("{} in {}, listed in {SCENE_SET}", count_phrase(written.houses.len(), "house"), out.display());
    let Some(episodes) = &written.episodes else { return houses };
    let mut text = format!(
        "{houses}\n{} in {}, their actions in {}\nhabitat-lab walks them with {}",
        count_phrase(episodes.episodes, "episode"),
        episodes.files[0].display(),
        episodes.files[1].display(),
        episodes.config.display()
    );
    for failed in &episodes.failed {
        text.push_str("\nleft out: ");
        text.push_str(failed);
    }
    text
}
