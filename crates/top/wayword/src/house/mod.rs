//! `wayword house`: generated houses as a set of scenes that Habitat reads, with episodes that its agents walk.

pub mod args;
#[cfg(feature = "habitat")]
mod episodes;

use crate::house::args::House;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};
use wayword_formats::jsonl::{self, Record};
use wayword_house::{Saved, generate, save, scene_name, seed_of};
use wayword_run::{
    count::count,
    error::{Error, Exit},
    interrupt,
    output::Output,
    run_folder::{file, hold},
};

/// The file that lists the scenes, which Habitat takes as its scene dataset.
const SCENE_SET: &str = "houses.scene_dataset_config.json";

/// Most houses of one set.
const MOST_HOUSES: u64 = 100_000;

/// The files that were written.
#[derive(Debug, Serialize)]
struct Written {
    /// The files of each house.
    houses: Vec<Saved>,
    scene_set: PathBuf,
    /// VLN-CE's files and habitat-lab's configuration, if there are episodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    episodes: Option<Episodes>,
}

/// The episodes of a set of houses.
#[derive(Debug, Serialize)]
struct Episodes {
    episodes: usize,
    /// VLN-CE's episodes, and the file with an agent's actions in each.
    files: [PathBuf; 2],
    /// habitat-lab's configuration, which walks them.
    config: PathBuf,
    /// Walks that cannot be taken in VLN-CE's actions, with the reason.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    failed: Vec<String>,
}

pub fn run(args: &House, output: &Output) -> Result<Exit, Error> {
    let given = args.run.as_deref().map(|run| records(run, args.style.as_deref())).transpose()?;
    let seeds = match &given {
        Some(records) => seeds_of(records)?,
        None => seeds(args)?,
    };
    fs::create_dir_all(&args.out).map_err(Error::io(&args.out, "make the folder"))?;
    let _held = hold(&args.out)?;
    // Texts are made before houses, so that a run that cannot continue ends the command early.
    let (told, exit) = match given {
        Some(records) => (Some(records), Exit::Done),
        None => made(args, &seeds, output)?,
    };
    if matches!(exit, Exit::Interrupted | Exit::Stopped | Exit::Lost) {
        return Ok(exit);
    }
    let bar = output.progress(seeds.len(), "houses");
    let mut houses = Vec::with_capacity(seeds.len());
    for seed in &seeds {
        interrupt::check()?;
        houses.push(house(*seed, &args.out)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let scene_set = args.out.join(SCENE_SET);
    let folders = format!("{}*", scene_name(0).trim_end_matches('0'));
    let set = serde_json::json!({ "stages": { "paths": { ".json": [folders] } } });
    fs::write(&scene_set, format!("{set:#}\n")).map_err(Error::io(&scene_set, "write"))?;
    let episodes = told.map(|records| written(&args.out, &records, output)).transpose()?.flatten();
    let has_loss = episodes.as_ref().is_some_and(|episodes| !episodes.failed.is_empty());
    let written = Written { houses, scene_set, episodes };
    output.data(&written, text(&written, &args.out));
    Ok(if has_loss { Exit::WithLoss } else { exit })
}

/// The seeds that the user asks for.
fn seeds(args: &House) -> Result<Vec<u64>, Error> {
    if !(1..=MOST_HOUSES).contains(&args.houses) {
        let hint = format!("give the number of houses, from 1 to {MOST_HOUSES}, as in --houses 20");
        return Err(Error::usage(format!("--houses {}", args.houses), hint));
    }
    let last = args.seed.checked_add(args.houses - 1).ok_or_else(|| {
        Error::usage(format!("--seed {}: there are not so many seeds after it", args.seed), "give a lower --seed")
    })?;
    Ok((args.seed..=last).collect())
}

/// Writes the files of a house into a folder of its own.
fn house(seed: u64, out: &Path) -> Result<Saved, Error> {
    let (house, folder) = (generate(seed), out.join(scene_name(seed)));
    fs::create_dir_all(&folder).map_err(Error::io(&folder, "make the folder"))?;
    Ok(save(&house, &folder, navmesh(&house)?.as_deref())?)
}

#[cfg(feature = "habitat")]
fn navmesh(house: &wayword_house::House) -> Result<Option<Vec<u8>>, Error> {
    let baked = wayword_report::walking::navmesh(house);
    let baked =
        baked.map_err(|reason| Error::usage(format!("house {}: {reason}", house.seed), "report this as a bug"))?;
    Ok(Some(baked.to_bytes()))
}

#[cfg(not(feature = "habitat"))]
fn navmesh(_house: &wayword_house::House) -> Result<Option<Vec<u8>>, Error> {
    Ok(None)
}

/// The records of a run, of one style.
fn records(run: &Path, style: Option<&str>) -> Result<Vec<Record>, Error> {
    let mut records = jsonl::read(&run.join(file::INSTRUCTIONS))?;
    let styles: BTreeSet<String> = records.iter().map(|record| record.instruction.style.clone()).collect();
    records.retain(|record| style.is_none_or(|style| record.instruction.style == style));
    let listed = styles.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
    match (records.is_empty(), style) {
        (true, _) => {
            Err(Error::usage(format!("{}: no such instruction", run.display()), format!("its styles: {listed}")))
        }
        (false, None) if styles.len() > 1 => {
            let problem = format!("{} has texts of several styles, and an episode has one text", run.display());
            Err(Error::usage(problem, format!("choose one with --style: {listed}")))
        }
        _ => Ok(records),
    }
}

/// The seeds of the houses in records.
fn seeds_of(records: &[Record]) -> Result<Vec<u64>, Error> {
    let seeds = records.iter().map(|record| {
        seed_of(record.path.scene.as_str()).ok_or_else(|| {
            let problem = format!("scene {} is no generated house", record.path.scene);
            Error::usage(problem, "give a run of platform house")
        })
    });
    Ok(seeds.collect::<Result<BTreeSet<_>, _>>()?.into_iter().collect())
}

/// Instructions for random paths through the houses, if there are to be any, and the exit code of making them.
#[cfg(feature = "habitat")]
fn made(args: &House, seeds: &[u64], output: &Output) -> Result<(Option<Vec<Record>>, Exit), Error> {
    if args.paths == 0 {
        return Ok((None, Exit::Done));
    }
    episodes::made(args, seeds, output).map(|(records, exit)| (Some(records), exit))
}

#[cfg(not(feature = "habitat"))]
fn made(args: &House, _seeds: &[u64], output: &Output) -> Result<(Option<Vec<Record>>, Exit), Error> {
    if args.paths > 0 {
        output.say("no navmeshes and no episodes are written, because this build has no platform habitat");
    }
    Ok((None, Exit::Done))
}

#[cfg(feature = "habitat")]
fn written(out: &Path, records: &[Record], output: &Output) -> Result<Option<Episodes>, Error> {
    episodes::write(out, records, output).map(Some)
}

#[cfg(not(feature = "habitat"))]
fn written(_out: &Path, _records: &[Record], output: &Output) -> Result<Option<Episodes>, Error> {
    output.say("no episodes are written, because this build has no platform habitat");
    Ok(None)
}

fn text(written: &Written, out: &Path) -> String {
    let houses = format!("{} in {}, listed in {SCENE_SET}", count(written.houses.len(), "house"), out.display());
    let Some(episodes) = &written.episodes else { return houses };
    let mut text = format!(
        "{houses}\n{} in {}, their actions in {}\nhabitat-lab walks them with {}",
        count(episodes.episodes, "episode"),
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
