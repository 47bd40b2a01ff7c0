//! Writes trajectories for training policies: the walks of a run as single actions (forward, left, right, stop), with the picture
//! that the agent sees before each. The command can be repeated after an interruption: it keeps the walks that are done.

mod instruction_parts;
mod replay;
mod settings;
mod store;
mod walks;

pub use replay::{TrajectoryReplay, replay_export};

use super::{items, splits, tell_terms};
use crate::{
    export::args::{ExportArgs, ExportFormat},
    walking::WalkingScenes,
};
use serde::Serialize;
use settings::StepExportSettings;
use sha2::{Digest, Sha256};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use store::{TrajectoryMaker, TrajectoryStore};
use walks::{ExportedWalk, walks_from_records};
use wayword_core::hex_text;
use wayword_formats::{
    DatasetFormat,
    jsonl::InstructionRecord,
    trajectories::{ActionTrajectory, read_trajectories},
    vlnce_actions::{self, EpisodeActions},
};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    in_order::{core_count, in_order},
    interrupt,
    output::CommandOutput,
    run_folder::{keep_config, lock_folder, read_run_settings},
};

/// Result of an export of trajectories.
#[derive(Debug, Serialize)]
struct WrittenTrajectories {
    folder: PathBuf,
    walks: usize,
    instructions: usize,
    pictures: usize,
    /// Walks that cannot be taken; `errors.jsonl` has the reasons.
    failed: usize,
    /// The largest distance between the last place of an agent and the end of its walk, metres.
    farthest_off_m: f64,
}

pub(super) fn write_steps(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    items::refuse_without_poses(ExportFormat::Steps, records)?;
    let splits = splits::splits_of_records(args, records)?;
    let steps = StepExportSettings::from_flags(&args.steps, hash_texts(records, &splits))?;
    let [run] = args.run.as_slice() else { return Err(CommandError::usage("--run is missing", "give one run")) };
    let scenes = WalkingScenes::open_run(&read_run_settings(run)?, [steps.width_px, steps.height_px])?;
    fs::create_dir_all(out).map_err(CommandError::io(out, "make the folder"))?;
    let _folder_lock = lock_folder(out)?;
    keep_config(out, &steps)?;
    let mut store = TrajectoryStore::open(out)?;
    let walks = walks_from_records(records, &splits);
    take_walks(
        &walks,
        &TrajectoryMaker { folder: out, scenes: &scenes, steps: &steps, done: store.finished_ids() },
        &mut store,
        output,
    )?;
    store.sort_and_sync(&walks)?;
    // Reads the file back, so that the reported figures are those of the file.
    let trajectories = read_trajectories(&store.trajectories_file())?;
    write_episodes(args, out, &walks, &trajectories, output)?;
    tell_terms(records, output);
    report_written(out, &trajectories, store.failed_count(), output)
}

/// Takes all walks that are not done yet, several at the same time.
fn take_walks(
    walks: &[ExportedWalk<'_>],
    maker: &TrajectoryMaker<'_>,
    store: &mut TrajectoryStore,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    // A unit is written as a whole: the walks of one shard, or a single walk.
    let numbers: Vec<usize> = (0..walks.len()).collect();
    let units: Vec<&[usize]> = numbers.chunks(maker.steps.shard.unwrap_or(1)).collect();
    let bar = output.progress_bar(walks.len(), "walks");
    let _interrupt_guard = interrupt::finish_items_first(None);
    let make = |unit: &&[usize]| {
        interrupt::check_interrupt()?;
        maker.make_unit(walks, unit)
    };
    let kept = in_order(&units, core_count(), make, |unit, batch| {
        store.keep_batch(&batch?)?;
        bar.inc(unit.len() as u64);
        Ok::<bool, CommandError>(true)
    });
    bar.finish_and_clear();
    kept
}

/// Adds VLN-CE's files to the folder: the episodes of each split, and their actions.
fn write_episodes(
    args: &ExportArgs,
    out: &Path,
    walks: &[ExportedWalk<'_>],
    taken: &[ActionTrajectory],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let by_id: BTreeMap<&str, &ActionTrajectory> = taken.iter().map(|taken| (taken.id.as_str(), taken)).collect();
    let splits: BTreeSet<&str> = taken.iter().map(|taken| taken.split.as_str()).collect();
    for split in splits {
        let (mut records, mut names, mut actions) = (Vec::new(), Vec::new(), BTreeMap::new());
        let of_split = walks.iter().filter(|walk| walk.split == split);
        for (walk, taken) in of_split.filter_map(|walk| Some((walk, by_id.get(walk.path.id.as_str())?))) {
            for (name, record) in &walk.texts {
                records.push((*record).clone());
                names.push(name.clone());
                actions.insert(name.clone(), EpisodeActions::from_positions(&taken.actions, &taken.positions));
            }
        }
        let mut episodes = items::episodes_from_records(DatasetFormat::Vlnce, &args.run, &records, output);
        for (episode, name) in episodes.iter_mut().zip(names) {
            episode.id = name;
        }
        items::write_items(DatasetFormat::Vlnce, &out.join(format!("{split}.json.gz")), &records, episodes)?;
        vlnce_actions::write_actions(&out.join(format!("{split}_gt.json.gz")), &actions)?;
    }
    Ok(())
}

fn report_written(
    out: &Path,
    trajectories: &[ActionTrajectory],
    failed: usize,
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    let written = WrittenTrajectories {
        folder: out.to_owned(),
        walks: trajectories.len(),
        instructions: trajectories.iter().map(|trajectory| trajectory.instructions.len()).sum(),
        pictures: trajectories.iter().map(|trajectory| trajectory.actions.len()).sum(),
        failed,
        farthest_off_m: trajectories.iter().map(|trajectory| trajectory.off_m).fold(0.0, f64::max),
    };
    let failures = match failed {
        0 => String::new(),
        _ => format!("; {} cannot be taken, and errors.jsonl says why", count_phrase(failed, "walk")),
    };
    output.print_result(
        &written,
        format_args!(
            "{} with {} and {} in {}, each ends within {:.2} m of its walk's end{failures}",
            count_phrase(written.walks, "walk"),
            count_phrase(written.instructions, "instruction"),
            count_phrase(written.pictures, "picture"),
            out.display(),
            written.farthest_off_m
        ),
    );
    Ok(if failed > 0 { Exit::WithLoss } else { Exit::Done })
}

/// SHA-256 of the texts, their paths and their splits.
fn hash_texts(records: &[InstructionRecord], splits: &[String]) -> String {
    let mut hash = Sha256::new();
    for (record, split) in records.iter().zip(splits) {
        // A record that was read can be written.
        hash.update(serde_json::to_vec(&(record, split)).unwrap_or_default());
    }
    hex_text(hash.finalize())
}
