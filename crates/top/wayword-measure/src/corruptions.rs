//! How many corruptions the checks catch.

use crate::corrupt::{Kind, corrupt};
use rand::seq::IndexedRandom;
use std::{
    collections::BTreeMap,
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use wayword::{
    error::Error,
    output::Output,
    pipeline::panoramas,
    run::{file, settings_of},
    settings::Settings,
    styles,
    world::{self, Remembering},
};
use wayword_core::{Platform, Style, Verdict, rng};
use wayword_formats::jsonl::{self, Record};
use wayword_synthesis::{
    checks::{Subject, check},
    evidence::Evidence,
    lexicon::thing,
};

/// A run's records with what is needed to check them again.
struct Run {
    platform: Box<dyn Platform>,
    styles: Vec<Style>,
    records: Vec<Record>,
}

pub(super) fn measure(folders: &[PathBuf], count: usize, seed: u64, show: usize, output: &Output) -> Result<(), Error> {
    let runs = folders.iter().map(|folder| open(folder)).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<(&Run, &Record)> =
        runs.iter().flat_map(|run| run.records.iter().map(move |record| (run, record))).collect();
    let mut rng = rng(seed, &["corruptions"]);
    let mut counts: BTreeMap<Kind, (usize, usize)> = BTreeMap::new();
    let mut missed = Vec::new();
    for kind in Kind::ALL {
        let mut tries = 0;
        while counts.entry(kind).or_default().1 < count / Kind::ALL.len() && tries < 100 * count {
            tries += 1;
            let Some((run, record)) = all.choose(&mut rng) else { break };
            let Some(style) = run.styles.iter().find(|style| style.name == record.instruction.style) else { continue };
            let world = Remembering::new(run.platform.as_ref());
            let views = panoramas(&world, &record.path)?;
            let Some(evidence) = Evidence::from_labels(&record.path, &views) else { continue };
            let others = nameable(run, record)?;
            let Some(text) = corrupt(kind, record, &evidence, &others, style, &mut rng) else { continue };
            let verdict =
                check(&text, Subject { evidence: &evidence, style, target: record.path.target.as_ref() }).verdict();
            let (caught, total) = counts.entry(kind).or_default();
            *total += 1;
            *caught += usize::from(verdict == Verdict::Fail);
            if verdict != Verdict::Fail {
                missed.push(format!(
                    "{} [{}] {:?}: {text}\n    was: {}",
                    kind.name(),
                    record.path.id,
                    verdict,
                    record.instruction.text
                ));
            }
        }
    }
    for line in missed.iter().take(show) {
        output.say(line);
    }
    let (caught, total) = counts.values().fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let line = |name: &str, caught: usize, total: usize| {
        format!("{name:<36} {caught:>5} of {total:>5}  {:>5.1} %", 100.0 * caught as f64 / total.max(1) as f64)
    };
    let mut lines: Vec<String> =
        counts.iter().map(|(kind, (caught, total))| line(kind.name(), *caught, *total)).collect();
    lines.push(line("all", caught, total));
    output.data(&(), lines.join("\n"));
    Ok(())
}

fn open(folder: &Path) -> Result<Run, Error> {
    let settings: Settings = settings_of(folder)?;
    let styles = styles::find(&settings.style, settings.seed)?.into_iter().map(|measured| measured.style).collect();
    let records = jsonl::read(&folder.join(file::INSTRUCTIONS))?;
    let good = records.into_iter().filter(|record| record.instruction.verdict == Verdict::Pass);
    Ok(Run { platform: world::open(&settings)?, styles, records: good.collect() })
}

/// Plain names of objects that are seen along other paths of the same scene.
fn nameable(run: &Run, record: &Record) -> Result<BTreeSet<String>, Error> {
    let mut names = BTreeSet::new();
    for other in run.records.iter().filter(|other| other.path.scene == record.path.scene).take(8) {
        for view in panoramas(run.platform.as_ref(), &other.path)?.into_iter().flatten() {
            names.extend(
                view.ground_truth().into_iter().flat_map(|truth| truth.labels.iter().map(|label| label.name.clone())),
            );
        }
    }
    names.retain(|name| thing(name).is_some());
    Ok(names)
}
