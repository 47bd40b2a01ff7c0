//! Writes trajectories for training policies: the walks of a run as single actions (forward, left, right, stop), with the picture
//! that the agent sees before each. The command can be repeated after an interruption: it keeps the walks that are done.

mod parts;
mod replay;
mod settings;
mod store;
mod walks;

pub use replay::{Replayed, replayed};

use super::{items, splits, tell_terms};
use crate::{
    export::args::{Export, ExportFormat},
    walking::Scenes,
};
use serde::Serialize;
use settings::Steps;
use sha2::{Digest, Sha256};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use store::{Maker, Store};
use walks::{Walk, walks};
use wayword_formats::{
    Format,
    jsonl::Record,
    trajectories::{Trajectory, read},
    vlnce_actions::{self, Acted},
};
use wayword_run::{
    count::count,
    error::{Error, Exit},
    in_order::{cores, in_order},
    interrupt,
    output::Output,
    run_folder::{hold, keep_config, settings_of},
};

/// Result of an export of trajectories.
#[derive(Debug, Serialize)]
struct Written {
    folder: PathBuf,
    walks: usize,
    instructions: usize,
    pictures: usize,
    /// Walks that cannot be taken; `errors.jsonl` has the reasons.
    failed: usize,
    /// The largest distance between the last place of an agent and the end of its walk, metres.
    farthest_off_m: f64,
}

pub(super) fn write(args: &Export, out: &Path, records: &[Record], output: &Output) -> Result<Exit, Error> {
    items::refuse_without_poses(ExportFormat::Steps, records)?;
    let splits = splits::of_records(args, records)?;
    let steps = Steps::of(&args.steps, hash(records, &splits))?;
    let [run] = args.run.as_slice() else { return Err(Error::usage("--run is missing", "give one run")) };
    let scenes = Scenes::open(&settings_of(run)?, [steps.width_px, steps.height_px])?;
    fs::create_dir_all(out).map_err(Error::io(out, "make the folder"))?;
    let _held = hold(out)?;
    keep_config(out, &steps)?;
    let mut store = Store::open(out)?;
    let walks = walks(records, &splits);
    take(&walks, &Maker { folder: out, scenes: &scenes, steps: &steps, done: store.done() }, &mut store, output)?;
    store.finish(&walks)?;
    // Reads the file back, so that the reported figures are those of the file.
    let taken = read(&store.file())?;
    write_episodes(args, out, &walks, &taken, output)?;
    tell_terms(records, output);
    tell(out, &taken, store.failed(), output)
}

/// Takes all walks that are not done yet, several at the same time.
fn take(walks: &[Walk<'_>], maker: &Maker<'_>, store: &mut Store, output: &Output) -> Result<(), Error> {
    let numbers: Vec<usize> = (0..walks.len()).collect();
    let units: Vec<&[usize]> = numbers.chunks(maker.steps.shard.unwrap_or(1)).collect();
    let bar = output.progress(walks.len(), "walks");
    let _graceful = interrupt::finish_first(None);
    let made = |unit: &&[usize]| {
        interrupt::check()?;
        maker.make(walks, unit)
    };
    let kept = in_order(&units, cores(), made, |unit, made| {
        store.keep(&made?)?;
        bar.inc(unit.len() as u64);
        Ok::<bool, Error>(true)
    });
    bar.finish_and_clear();
    kept
}

/// Adds VLN-CE's files to the folder: the episodes of each split, and their actions.
fn write_episodes(
    args: &Export,
    out: &Path,
    walks: &[Walk<'_>],
    taken: &[Trajectory],
    output: &Output,
) -> Result<(), Error> {
    let by_id: BTreeMap<&str, &Trajectory> = taken.iter().map(|taken| (taken.id.as_str(), taken)).collect();
    let splits: BTreeSet<&str> = taken.iter().map(|taken| taken.split.as_str()).collect();
    for split in splits {
        let (mut records, mut names, mut acted) = (Vec::new(), Vec::new(), BTreeMap::new());
        let of_split = walks.iter().filter(|walk| walk.split == split);
        for (walk, taken) in of_split.filter_map(|walk| Some((walk, by_id.get(walk.path.id.as_str())?))) {
            for (name, record) in &walk.texts {
                records.push((*record).clone());
                names.push(name.clone());
                acted.insert(name.clone(), Acted::of(&taken.actions, &taken.positions));
            }
        }
        let mut episodes = items::episodes(Format::Vlnce, &args.run, &records, output);
        for (episode, name) in episodes.iter_mut().zip(names) {
            episode.id = name;
        }
        items::write(Format::Vlnce, &out.join(format!("{split}.json.gz")), &records, episodes)?;
        vlnce_actions::write(&out.join(format!("{split}_gt.json.gz")), &acted)?;
    }
    Ok(())
}

fn tell(out: &Path, taken: &[Trajectory], failed: usize, output: &Output) -> Result<Exit, Error> {
    let written = Written {
        folder: out.to_owned(),
        walks: taken.len(),
        instructions: taken.iter().map(|taken| taken.instructions.len()).sum(),
        pictures: taken.iter().map(|taken| taken.actions.len()).sum(),
        failed,
        farthest_off_m: taken.iter().map(|taken| taken.off_m).fold(0.0, f64::max),
    };
    let failures = match failed {
        0 => String::new(),
        _ => format!("; {} cannot be taken, and errors.jsonl says why", count(failed, "walk")),
    };
    output.data(
        &written,
        format_args!(
            "{} with {} and {} in {}, each ends within {:.2} m of its walk's end{failures}",
            count(written.walks, "walk"),
            count(written.instructions, "instruction"),
            count(written.pictures, "picture"),
            out.display(),
            written.farthest_off_m
        ),
    );
    Ok(if failed > 0 { Exit::WithLoss } else { Exit::Done })
}

/// SHA-256 of the texts, their paths and their splits.
fn hash(records: &[Record], splits: &[String]) -> String {
    let mut hash = Sha256::new();
    for (record, split) in records.iter().zip(splits) {
        // A record that was read can be written.
        hash.update(serde_json::to_vec(&(record, split)).unwrap_or_default());
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
