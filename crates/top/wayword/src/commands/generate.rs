//! `wayword generate`.

use crate::{
    cli::Generate,
    error::{Error, Exit},
    item::{Item, check_names, items},
    output::Output,
    pictures,
    pipeline::{Made, make},
    run::{Map, Rejected, RunFolder, WalkRecord, extra},
    settings::{Asked, Settings},
    styles::{self, Measured},
    text_file, world,
};
use rayon::prelude::*;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::{collections::BTreeMap, fmt, fs::File, path::Path};
use wayword_core::{Platform, Verdict};
use wayword_formats::jsonl::Record;
use wayword_synthesis::{repair::Outcome, style};

/// Items that are made at a time: enough for every core, few enough to lose little when killed.
const BATCH: usize = 16;

pub(super) fn run(args: &Generate, output: &Output) -> Result<Exit, Error> {
    let file = args.config.as_deref().map(read_config).transpose()?.unwrap_or_default();
    let settings = args.asked().or(file).resolve()?;
    let summary = generate_into(&args.out, &settings, output)?;
    output.data(&summary, &summary);
    Ok(if summary.rejected == 0 { Exit::Done } else { Exit::WithLoss })
}

fn read_config(path: &Path) -> Result<Asked, Error> {
    let text = text_file::read(path, "read the settings")?;
    toml::from_str(&text).map_err(|error| {
        Error::usage(
            format!("{}: {}", path.display(), error.to_string().trim()),
            "see wayword generate --help for the names",
        )
    })
}

/// What a run came to.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// The run folder.
    pub run: String,
    /// Items of the run.
    pub items: usize,
    /// Instructions that passed every check.
    pub passed: usize,
    /// Instructions for which something could not be checked.
    pub unverified: usize,
    /// Instructions, or whole items, that were rejected.
    pub rejected: usize,
    /// Who perceived and wrote.
    pub minds: String,
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} items: {} instructions passed every check, {} unverified, {} rejected",
            self.items, self.passed, self.unverified, self.rejected
        )?;
        if !self.minds.is_empty() {
            writeln!(f, "minds: {}", self.minds)?;
        }
        write!(f, "run folder: {}", self.run)
    }
}

/// Makes or continues a run.
///
/// # Errors
/// When the settings, the world, the styles or the folder are wrong. An item that fails is a line of `rejected.jsonl`.
pub fn generate_into(folder: &Path, settings: &Settings, output: &Output) -> Result<Summary, Error> {
    let platform = world::open(settings)?;
    let styles = styles::find(&settings.style, settings.seed)?;
    let items = items(settings, platform.as_ref())?;
    check_names(&items)?;
    let settings = &Settings { inputs: inputs(settings, &styles)?, ..settings.clone() };
    let mut run = RunFolder::open(folder, settings)?;
    let names: Vec<String> = styles.iter().map(|measured| measured.style.name.clone()).collect();
    let left: Vec<&Item> = items.iter().filter(|item| !run.is_done(&item.id(), &names)).collect();
    if left.len() < items.len() {
        output.say(format_args!("continuing: {} of {} items are done", items.len() - left.len(), items.len()));
    }
    let bar = output.progress(items.len(), "items");
    bar.set_position((items.len() - left.len()) as u64);
    for batch in left.chunks(BATCH) {
        let made: Vec<_> =
            batch.par_iter().map(|item| (*item, make(item, settings, platform.as_ref(), &styles))).collect();
        for (item, made) in made {
            keep(&mut run, platform.as_ref(), item, made, &styles)?;
            bar.inc(1);
        }
        run.sync()?;
        bar.set_message(format!("{} written, {} rejected", run.instructions.len(), run.rejected.len()));
    }
    bar.finish_and_clear();
    summary(folder, &run, items.len())
}

/// Hashes of what the settings only name, so that a run is not continued with other episodes or styles.
fn inputs(settings: &Settings, styles: &[Measured]) -> Result<BTreeMap<String, String>, Error> {
    let mut inputs: BTreeMap<String, String> =
        styles.iter().map(|Measured { style, .. }| (format!("style {}", style.name), style::hash(style))).collect();
    if let Some(file) = &settings.episodes {
        let mut hash = Sha256::new();
        let copied = File::open(file).and_then(|mut file| std::io::copy(&mut file, &mut hash));
        copied.map_err(Error::io(file, "read the episodes"))?;
        inputs.insert("episodes".into(), hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect());
    }
    Ok(inputs)
}

/// Writes what became of an item: pictures and walk first, so that an instruction never stands without its evidence.
fn keep(
    run: &mut RunFolder,
    platform: &dyn Platform,
    item: &Item,
    made: Result<Made, Error>,
    styles: &[Measured],
) -> Result<(), Error> {
    let reject =
        |style: &str, reason: String, last| Rejected { item: item.id(), style: style.to_owned(), reason, last };
    let made = match made {
        Ok(made) => made,
        Err(error) => return run.rejected.append(&reject("", error.to_string(), None)),
    };
    let has_pictures = pictures::keep(&run.frames(), &item.id(), &made.pictures)?;
    run.walks.append(&WalkRecord {
        platform: platform.name().to_owned(),
        map: Map::around(&made.walk.path, platform)?,
        path: made.walk.path.clone(),
        observations: made.walk.observations,
        originals: item.originals().to_vec(),
        has_pictures,
    })?;
    for (outcome, Measured { style, .. }) in made.outcomes.into_iter().zip(styles) {
        match outcome {
            Outcome::Accepted(instruction) => {
                let mut record = Record::new(platform.name(), made.walk.path.clone(), instruction);
                record.extra = extra(&item.path_id());
                run.instructions.append(&record)?;
            }
            Outcome::Rejected { last, reason } => run.rejected.append(&reject(&style.name, reason, last))?,
        }
    }
    Ok(())
}

fn summary(folder: &Path, run: &RunFolder, items: usize) -> Result<Summary, Error> {
    let records = wayword_formats::jsonl::read(&folder.join(crate::run::file::INSTRUCTIONS))?;
    let count = |verdict| records.iter().filter(|record| record.instruction.verdict == verdict).count();
    let minds = records.first().map_or_else(String::new, |record| {
        let provenance = &record.instruction.provenance;
        format!(
            "{} asked, {} answered, {} wrote, checked against {}",
            provenance.asker, provenance.answerer, provenance.writer, provenance.checked_against
        )
    });
    Ok(Summary {
        run: folder.display().to_string(),
        items,
        passed: count(Verdict::Pass),
        unverified: count(Verdict::Unverified),
        rejected: run.rejected.len(),
        minds,
    })
}
