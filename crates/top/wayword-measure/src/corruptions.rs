//! How many corruptions the checks catch.

use crate::corrupt::{Corruption, corrupt};
use rand::seq::IndexedRandom;
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword::{
    error::Error,
    output::Output,
    pipeline::panoramas,
    run::{file, settings_of},
    styles,
    world::{self, Remembering},
};
use wayword_checks::{Evidence, Subject, check};
use wayword_core::{Platform, SceneId, Style, Verdict, rng};
use wayword_formats::jsonl::{self, Record};
use wayword_language::lexicon::thing;

/// A run's good records with what is needed to check them again.
struct Run {
    styles: Vec<Style>,
    records: Vec<Record>,
    /// By path.
    evidence: BTreeMap<String, Evidence>,
    /// Names of what is seen along the paths of each scene.
    names: BTreeMap<SceneId, BTreeSet<String>>,
}

pub(super) fn measure(folders: &[PathBuf], count: usize, seed: u64, show: usize, output: &Output) -> Result<(), Error> {
    let runs = folders.iter().map(|folder| open(folder, output)).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<(&Run, &Record)> =
        runs.iter().flat_map(|run| run.records.iter().map(move |record| (run, record))).collect();
    let mut rng = rng(seed, &["corruptions"]);
    let mut counts: BTreeMap<Corruption, (usize, usize)> = BTreeMap::new();
    let mut missed = Vec::new();
    for kind in Corruption::ALL {
        let mut tries = 0;
        while counts.entry(kind).or_default().1 < count / Corruption::ALL.len() && tries < 100 * count {
            tries += 1;
            let Some((run, record)) = all.choose(&mut rng) else { break };
            let Some((evidence, style, others)) = run.needed_for(record) else { continue };
            let Some(text) = corrupt(kind, record, evidence, others, style, &mut rng) else { continue };
            let verdict = check(&text, Subject { evidence, style, target: record.path.target.as_ref() }).verdict();
            let (caught, total) = counts.entry(kind).or_default();
            *total += 1;
            *caught += usize::from(verdict == Verdict::Fail);
            if verdict != Verdict::Fail {
                let was = &record.instruction.text;
                missed.push(format!("{} [{}] {verdict:?}: {text}\n    was: {was}", kind.name(), record.path.id));
            }
        }
    }
    for line in missed.iter().take(show) {
        output.say(line);
    }
    output.data(&(), table(&counts));
    Ok(())
}

fn table(counts: &BTreeMap<Corruption, (usize, usize)>) -> String {
    let line = |name: &str, (caught, total): (usize, usize)| {
        format!("{name:<39} {caught:>5} of {total:>5}  {:>5.1} %", 100.0 * caught as f64 / total.max(1) as f64)
    };
    let sum = counts.values().fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let kinds = counts.iter().map(|(kind, count)| line(kind.name(), *count));
    kinds.chain([line("all", sum)]).collect::<Vec<_>>().join("\n")
}

fn open(folder: &Path, output: &Output) -> Result<Run, Error> {
    let settings = settings_of(folder)?;
    let platform = world::open(&settings)?;
    let styles = styles::find(&settings.style, settings.seed)?.into_iter().map(|measured| measured.style).collect();
    let mut records = jsonl::read(&folder.join(file::INSTRUCTIONS))?;
    records.retain(|record| record.instruction.verdict == Verdict::Pass);
    let mut paths: Vec<_> = records.iter().map(|record| &record.path).collect();
    paths.dedup_by_key(|path| &path.id);
    let bar = output.progress(paths.len(), "paths seen again");
    let seen: Vec<(String, SceneId, Evidence)> = paths
        .par_iter()
        .filter_map(|path| {
            bar.inc(1);
            let evidence = labels(platform.as_ref(), path).transpose()?;
            Some(evidence.map(|evidence| (path.id.clone(), path.scene.clone(), evidence)))
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let mut names: BTreeMap<SceneId, BTreeSet<String>> = BTreeMap::new();
    for (_, scene, evidence) in &seen {
        let things = evidence.frames.iter().flat_map(|frame| &frame.things).map(|thing| thing.name.clone());
        names.entry(scene.clone()).or_default().extend(things.filter(|name| thing(name).is_some()));
    }
    let evidence = seen.into_iter().map(|(id, _, evidence)| (id, evidence)).collect();
    Ok(Run { styles, records, evidence, names })
}

fn labels(platform: &dyn Platform, path: &wayword_core::Path) -> Result<Option<Evidence>, Error> {
    let world = Remembering::new(platform);
    Ok(Evidence::from_labels(path, &panoramas(&world, path)?))
}

impl Run {
    fn needed_for(&self, record: &Record) -> Option<(&Evidence, &Style, &BTreeSet<String>)> {
        let style = self.styles.iter().find(|style| style.name == record.instruction.style)?;
        Some((self.evidence.get(&record.path.id)?, style, self.names.get(&record.path.scene)?))
    }
}
