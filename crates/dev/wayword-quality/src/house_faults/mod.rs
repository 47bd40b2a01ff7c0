//! Plants faults into the program's own texts about generated houses, and measures how many the checks find.
//!
//! The plan of the house and the places of the walk decide whether an edited text is wrong; a text that may be right
//! after all is left out. Invariant: this folder uses neither the program's reader nor its lexicon, its writer or its
//! checks, except that it runs the finished check (`check`). What they get wrong together, it could not find.

mod check;
mod claims;
mod counts;
mod edit;
mod extents;
mod flights;
mod kind;
mod landmarks;
mod locate;
mod order;
mod plan;
mod planned_walk;
mod repeats;
mod report;
mod stops;
mod subject;
#[cfg(test)]
mod test_plan;
mod turns;
mod word_lists;
mod words;

use crate::eye_check::{EyeErrors, EyeWitness};
use check::check_house_texts;
use clap::Args;
pub(crate) use kind::HouseFaultKind;
use plan::HousePlan;
use rand::seq::{IndexedRandom, SliceRandom};
use rayon::prelude::*;
use report::{FaultChoice, HouseFaultReport, TextVerdict};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use subject::FaultSubject;
use wayword_core::{Verdict, seeded_rng};
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_house::{generate_house, seed_of};
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    run_folder::{file, read_run_settings},
};

/// The style of the texts that get faults.
const STYLE: &str = "r2r";

/// The flags of `house-faults`.
#[derive(Debug, Args)]
pub struct HouseFaultsArgs {
    /// Folder of a finished run over generated houses, with texts in the style r2r.
    run: PathBuf,
    /// Most texts with each kind of fault.
    #[arg(long, default_value_t = 100)]
    per_kind: usize,
    /// Seed of the choice.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Show this many faults of each kind that the checks missed.
    #[arg(long, default_value_t = 0)]
    show: usize,
    /// Check by what a scripted eye says about the pictures instead of by labels. It is unsure of 10 % of the things, misses 15 %
    /// and invents none.
    #[arg(long)]
    eye: bool,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// The errors of the eye of `--eye`.
const EYE_ERRORS: EyeErrors = EyeErrors { missed: 0.15, hedged: 0.1 };

/// A text with a fault.
#[derive(Debug, Clone, PartialEq, Eq)]
struct HouseFault {
    /// The kind of its fault.
    kind: HouseFaultKind,
    /// The number of the record of its original text.
    record: usize,
    /// The text.
    text: String,
}

/// Plants faults into the texts of a run, and prints how many of them the checks find, by kind.
///
/// # Errors
/// When the run cannot be read or has no such texts, and as `wayword check`.
pub fn measure_house_faults(flags: &HouseFaultsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let settings = read_run_settings(&flags.run)?;
    let records = read_house_records(&flags.run)?;
    let plans = make_plans(&records);
    let subjects = place_texts(&records, &plans);
    let choice = FaultChoice {
        seed: flags.seed,
        per_kind: flags.per_kind,
        run_texts: records.len(),
        placed_texts: subjects.len(),
    };
    let placed: Vec<(&InstructionRecord, &str)> =
        subjects.iter().filter_map(|(number, _)| record_text(&records, *number)).collect();
    let look = || EyeWitness::look(placed.iter().map(|(record, _)| *record), EYE_ERRORS, flags.seed, output);
    let eye = flags.eye.then(look).transpose()?;
    let check = |texts: &[(&InstructionRecord, &str)]| match &eye {
        Some(eye) => Ok(eye.check(texts)),
        None => check_house_texts(texts, &settings, output),
    };
    let old_verdicts = check(&placed)?;
    let old: Vec<TextVerdict<'_>> = name_verdicts(&placed, &old_verdicts);
    // A text that fails as it is would be found for its own faults.
    let right = subjects.into_iter().zip(&old_verdicts).filter(|(_, verdict)| **verdict != Verdict::Fail);
    let right: Vec<(usize, FaultSubject<'_>)> = right.map(|(subject, _)| subject).collect();
    let faults = plant_faults(&right, flags.per_kind, flags.seed);
    let edited = faults.iter().filter_map(|fault| Some((records.get(fault.record)?, fault.text.as_str())));
    let edited: Vec<(&InstructionRecord, &str)> = edited.collect();
    let verdicts = check(&edited)?;
    show_misses(&faults, &verdicts, &records, flags.show, output);
    let new: Vec<_> = faults.iter().map(|fault| fault.kind).zip(name_verdicts(&edited, &verdicts)).collect();
    let report = HouseFaultReport::from_verdicts(choice, &new, &old);
    output.print_result(&report, &report);
    Ok(())
}

/// A record with its text.
fn record_text(records: &[InstructionRecord], number: usize) -> Option<(&InstructionRecord, &str)> {
    records.get(number).map(|record| (record, record.instruction.text.as_str()))
}

/// Verdicts with the names of the paths of their texts.
fn name_verdicts<'r>(texts: &[(&'r InstructionRecord, &str)], verdicts: &[Verdict]) -> Vec<TextVerdict<'r>> {
    texts.iter().map(|(record, _)| record.path.id.as_str()).zip(verdicts.iter().copied()).collect()
}

/// The records of a run in the style [`STYLE`] over generated houses.
fn read_house_records(run: &Path) -> Result<Vec<InstructionRecord>, CommandError> {
    let mut records = jsonl::read_records(&run.join(file::INSTRUCTIONS))?;
    records.retain(|record| record.instruction.style == STYLE && seed_of(record.path.scene.as_str()).is_some());
    if records.is_empty() {
        let problem = format!("{}: it has no texts in style {STYLE} about generated houses", run.display());
        return Err(CommandError::usage(problem, "give a run of `wayword generate --platform house --style r2r`"));
    }
    Ok(records)
}

/// The plans of all houses of the records, by their seeds.
fn make_plans(records: &[InstructionRecord]) -> BTreeMap<u64, HousePlan> {
    let seeds: BTreeSet<u64> = records.iter().filter_map(|record| seed_of(record.path.scene.as_str())).collect();
    seeds.into_par_iter().map(|seed| (seed, HousePlan::new(generate_house(seed)))).collect()
}

/// The texts that have a place on their walks, each with the number of its record.
fn place_texts<'p>(
    records: &[InstructionRecord],
    plans: &'p BTreeMap<u64, HousePlan>,
) -> Vec<(usize, FaultSubject<'p>)> {
    let place = |(number, record): (usize, &InstructionRecord)| {
        let plan = plans.get(&seed_of(record.path.scene.as_str())?)?;
        Some((number, FaultSubject::new(plan, &record.path.frames, &record.instruction.text)?))
    };
    records.par_iter().enumerate().filter_map(place).collect()
}

/// Faults of all kinds, at most `per_kind` of each. The texts of a kind do not depend on the other kinds.
fn plant_faults(subjects: &[(usize, FaultSubject<'_>)], per_kind: usize, seed: u64) -> Vec<HouseFault> {
    let mut faults = Vec::new();
    for kind in HouseFaultKind::ALL {
        let mut rng = seeded_rng(seed, &["house faults", kind.name()]);
        let mut drawn: Vec<&(usize, FaultSubject<'_>)> = subjects.iter().collect();
        drawn.shuffle(&mut rng);
        let planted = drawn.into_iter().filter_map(|(record, subject)| {
            let text = kind.list_edits(subject).choose(&mut rng)?.clone();
            Some(HouseFault { kind, record: *record, text })
        });
        faults.extend(planted.take(per_kind));
    }
    faults
}

/// A text about a walk through a generated house with one fault of a kind, drawn from a seed; `None` where none can be planted.
pub(crate) fn plant_fault(walk: &wayword_core::Path, text: &str, kind: HouseFaultKind, seed: u64) -> Option<String> {
    let plan = HousePlan::new(generate_house(seed_of(walk.scene.as_str())?));
    let subject = FaultSubject::new(&plan, &walk.frames, text)?;
    kind.list_edits(&subject).choose(&mut seeded_rng(seed, &["house faults", kind.name()])).cloned()
}

/// Shows texts with faults that did not fail, with their original texts.
fn show_misses(
    faults: &[HouseFault],
    verdicts: &[Verdict],
    records: &[InstructionRecord],
    most: usize,
    output: &CommandOutput,
) {
    for kind in HouseFaultKind::ALL {
        let of_kind = faults.iter().zip(verdicts).filter(|(fault, _)| fault.kind == kind);
        let missed = of_kind.filter(|(_, verdict)| **verdict != Verdict::Fail);
        for (fault, verdict) in missed.take(most) {
            let Some(record) = records.get(fault.record) else { continue };
            let (path, before) = (&record.path.id, &record.instruction.text);
            let after = &fault.text;
            output.say(format!("{} [{path}] {verdict:?}\n    before: {before}\n    after:  {after}", kind.name()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        test_plan::{hallway_house, hallway_subject},
        *,
    };
    use std::fs;

    const TEXTS: [&str; 3] = [
        "Walk past the bookshelf. Turn left and enter the bedroom. Stop by the bed.",
        "Walk past the plant. Turn left. Stop.",
        "Walk straight. Turn left into the bedroom. Wait near the bed.",
    ];

    #[test]
    fn plant_faults_makes_the_same_faults_for_a_seed_and_at_most_so_many() {
        let plan = HousePlan::new(hallway_house());
        let subjects: Vec<(usize, FaultSubject<'_>)> =
            TEXTS.iter().map(|text| hallway_subject(&plan, text)).enumerate().collect();
        let faults = plant_faults(&subjects, 2, 1);
        assert_eq!(faults, plant_faults(&subjects, 2, 1));
        for kind in HouseFaultKind::ALL {
            let of_kind = faults.iter().filter(|fault| fault.kind == kind).count();
            assert!(of_kind <= 2, "{kind:?}: {of_kind}");
        }
        let flipped = faults.iter().filter(|fault| fault.kind == HouseFaultKind::TurnFlipped);
        assert_eq!(flipped.count(), 2);
        assert!(faults.iter().all(|fault| TEXTS[fault.record] != fault.text));
        assert!(plant_faults(&subjects, 0, 1).is_empty());
    }

    #[test]
    fn read_house_records_refuses_a_run_without_such_texts() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(file::INSTRUCTIONS), "").unwrap();
        let refusal = read_house_records(folder.path()).unwrap_err().to_string();
        assert!(refusal.contains("no texts in style r2r"), "{refusal}");
    }

    /// A generator with the reader's or the checks' own code could never make a fault that they do not see.
    #[test]
    fn this_generator_shares_no_code_with_reader_writer_and_checks() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/house_faults");
        let shared = ["language", "checks", "synthesis", "follower"].map(|name| format!("wayword_{name}"));
        let mut files = 0;
        for entry in fs::read_dir(folder).unwrap() {
            let file = entry.unwrap().path();
            let text = fs::read_to_string(&file).unwrap();
            assert!(!shared.iter().any(|name| text.contains(name)), "{}", file.display());
            files += 1;
        }
        assert!(files > 15, "{files}");
    }
}
