//! Writes the dataset card, the `README.md` of a published folder: who wrote the texts, the evidence that they were checked against,
//! and the terms of the scenes that they describe. All of it comes from the provenance of the records.

mod escape;

use crate::export::args::{ExportArgs, ExportFormat};
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{CheckKind, SceneId, TextAmbiguity, Verdict};
use wayword_formats::jsonl::InstructionRecord;
use wayword_language::Language;
use wayword_run::{
    count::count_phrase,
    error::CommandError,
    run_folder::{RejectedText, file, read_lines},
    settings::RolePlayer,
    terms,
};

/// The template of the card, in Markdown with a YAML head.
const CARD_TEMPLATE: &str = include_str!("card.md");
/// The classes of size of the Hugging Face hub, each with its upper limit in texts.
const HUB_SIZE_CLASSES: [(usize, &str); 4] =
    [(1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M")];

/// The values that the template of the card shows.
#[derive(Debug, Serialize)]
struct DatasetCard {
    name: String,
    /// The layout for training, if the folder is no folder of tables.
    layout: Option<String>,
    version: &'static str,
    size: &'static str,
    instructions: usize,
    paths: usize,
    scenes: usize,
    splits: Vec<SplitLine>,
    roles: Vec<RoleLine>,
    /// Number of texts with ground-truth labels as their source, and of texts that rules wrote.
    labels: usize,
    rules: usize,
    styles: BTreeSet<String>,
    languages: BTreeSet<&'static str>,
    seeds: BTreeSet<String>,
    repaired: usize,
    #[serde(flatten)]
    outcome: CardVerdictCounts,
    rejected: usize,
    checks: Vec<CheckLine>,
    /// Texts that may mean several places or objects, among those that were checked for that (`looked_at`).
    ambiguous: usize,
    looked_at: usize,
    platforms: Vec<PlatformLine>,
    /// Whether the scenes of a platform belong to somebody, so that their terms apply.
    is_somebodys: bool,
}

/// A split with its file and its size.
#[derive(Debug, Serialize)]
struct SplitLine {
    name: String,
    file: String,
    instructions: usize,
    paths: usize,
    scenes: usize,
}

/// The models and rules that wrote texts together, with the number of these texts.
#[derive(Debug, Serialize)]
struct RoleLine {
    instructions: usize,
    #[serde(flatten)]
    roles: CardRoles,
}

/// The names of the models and rules that played the roles, as the provenance of a text has them.
#[derive(Debug, Serialize, PartialEq, Eq, PartialOrd, Ord)]
struct CardRoles {
    asker: String,
    answerer: String,
    summariser: String,
    writer: String,
    checked_against: String,
    version: String,
}

/// How many texts got each verdict.
#[derive(Debug, Default, Serialize)]
struct CardVerdictCounts {
    passed: usize,
    unverified: usize,
    failed: usize,
}

/// A check with its verdicts.
#[derive(Debug, Serialize)]
struct CheckLine {
    name: &'static str,
    #[serde(flatten)]
    outcome: CardVerdictCounts,
}

/// A platform with the terms of its scenes.
#[derive(Debug, Serialize)]
struct PlatformLine {
    name: String,
    instructions: usize,
    scenes: usize,
    terms: &'static str,
}

/// The file name of a split, in the form that the loaders of the Hugging Face hub recognise.
pub(super) fn file_name(split: &str) -> String {
    format!("{split}-00000-of-00001.parquet")
}

/// The text of the card for the records of an export; `splits` has the split of each record. A layout for training is named; else the
/// folder holds tables.
///
/// # Errors
/// When the runs' rejected texts cannot be read.
pub(super) fn card_text(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    splits: &[String],
    layout: Option<ExportFormat>,
) -> Result<String, CommandError> {
    let name = out.file_name().map_or_else(|| "Wayword".to_owned(), |name| name.to_string_lossy().into_owned());
    let layout = layout.map(|layout| layout.to_string());
    let card = DatasetCard { layout, ..DatasetCard::new(name, records, splits, count_rejected(args)?) };
    render_card(&card).map_err(|error| {
        CommandError::usage(format!("the dataset card cannot be written: {error:#}"), "report this as a bug")
    })
}

fn render_card(card: &DatasetCard) -> Result<String, minijinja::Error> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.set_keep_trailing_newline(true);
    templates.set_formatter(escape::write_card_value);
    templates.add_function("count", |number: u64, of: &str| count_phrase(number, of));
    templates.add_filter("yaml", escape::yaml_filter);
    templates.add_filter("plain", escape::plain_filter);
    templates.add_filter("join", escape::join_filter);
    templates.add_template("card.md", CARD_TEMPLATE)?;
    templates.get_template("card.md")?.render(card)
}

/// How many texts the runs rejected, of the style that is exported.
fn count_rejected(args: &ExportArgs) -> Result<usize, CommandError> {
    let mut rejected = 0;
    for run in &args.run {
        let rejected_texts: Vec<RejectedText> = read_lines(&run.join(file::REJECTED))?;
        let has_style = |text: &&RejectedText| args.style.as_ref().is_none_or(|style| *style == text.style);
        rejected += rejected_texts.iter().filter(has_style).count();
    }
    Ok(rejected)
}

impl DatasetCard {
    fn new(name: String, records: &[InstructionRecord], splits: &[String], rejected: usize) -> Self {
        let count =
            |is_counted: fn(&InstructionRecord) -> bool| records.iter().filter(|record| is_counted(record)).count();
        let looked_at = records.iter().filter_map(|record| record.instruction.ambiguity.as_ref());
        let largest = "1M<n<10M";
        let all: Vec<&InstructionRecord> = records.iter().collect();
        Self {
            name,
            layout: None,
            version: env!("CARGO_PKG_VERSION"),
            size: HUB_SIZE_CLASSES.iter().find(|(most, _)| records.len() < *most).map_or(largest, |(_, size)| size),
            instructions: records.len(),
            paths: count_paths(&all),
            scenes: count_scenes(&all),
            splits: split_lines(records, splits),
            roles: role_lines(records),
            labels: count(|record| RolePlayer::Labels.is_named(&record.instruction.provenance.answerer)),
            rules: count(|record| RolePlayer::Rules.is_named(&record.instruction.provenance.writer)),
            styles: records.iter().map(|record| record.instruction.style.clone()).collect(),
            languages: records.iter().map(|record| Language::tag_of_text(&record.instruction.text)).collect(),
            seeds: records.iter().map(|record| record.instruction.provenance.seed.to_string()).collect(),
            repaired: count(|record| record.instruction.provenance.repairs > 0),
            outcome: CardVerdictCounts::from_verdicts(records.iter().map(|record| record.instruction.verdict)),
            rejected,
            checks: check_lines(records),
            ambiguous: looked_at.clone().filter(|ambiguity| TextAmbiguity::is_ambiguous(ambiguity)).count(),
            looked_at: looked_at.count(),
            platforms: platform_lines(records),
            is_somebodys: records.iter().any(|record| terms::belong_to_others(&record.platform)),
        }
    }
}

impl CardVerdictCounts {
    fn from_verdicts(verdicts: impl Iterator<Item = Verdict>) -> Self {
        let mut outcome = Self::default();
        for verdict in verdicts {
            match verdict {
                Verdict::Pass => outcome.passed += 1,
                Verdict::Unverified => outcome.unverified += 1,
                Verdict::Fail => outcome.failed += 1,
            }
        }
        outcome
    }
}

/// The number of different paths.
fn count_paths(records: &[&InstructionRecord]) -> usize {
    let name = |record: &&InstructionRecord| (record.platform.clone(), record.path.scene.clone(), record.path_id());
    records.iter().map(name).collect::<BTreeSet<_>>().len()
}

/// The number of different scenes.
fn count_scenes(records: &[&InstructionRecord]) -> usize {
    let name =
        |record: &&InstructionRecord| -> (String, SceneId) { (record.platform.clone(), record.path.scene.clone()) };
    records.iter().map(name).collect::<BTreeSet<_>>().len()
}

/// Groups records by a key that is computed from the index and the record.
fn group_records<K: Ord>(
    records: &[InstructionRecord],
    key: impl Fn(usize, &InstructionRecord) -> K,
) -> BTreeMap<K, Vec<&InstructionRecord>> {
    let mut parts: BTreeMap<K, Vec<&InstructionRecord>> = BTreeMap::new();
    for (index, record) in records.iter().enumerate() {
        parts.entry(key(index, record)).or_default().push(record);
    }
    parts
}

fn split_lines(records: &[InstructionRecord], splits: &[String]) -> Vec<SplitLine> {
    let line = |(split, split_records): (&str, Vec<&InstructionRecord>)| SplitLine {
        name: split.to_owned(),
        file: file_name(split),
        instructions: split_records.len(),
        paths: count_paths(&split_records),
        scenes: count_scenes(&split_records),
    };
    group_records(records, |index, _| splits.get(index).map_or("", String::as_str)).into_iter().map(line).collect()
}

fn role_lines(records: &[InstructionRecord]) -> Vec<RoleLine> {
    let roles = |_: usize, record: &InstructionRecord| {
        let provenance = record.instruction.provenance.clone();
        let seen_by = match provenance.detector {
            Some(detector) => format!("{}, with the detector {detector}", provenance.answerer),
            None => provenance.answerer,
        };
        let written_by = match provenance.finished_for {
            Some(other) => format!("{}, where {other} failed", provenance.writer),
            None => provenance.writer,
        };
        CardRoles {
            asker: provenance.asker,
            answerer: seen_by,
            summariser: provenance.summariser,
            writer: written_by,
            checked_against: provenance.checked_against,
            version: provenance.wayword,
        }
    };
    group_records(records, roles)
        .into_iter()
        .map(|(roles, texts)| RoleLine { instructions: texts.len(), roles })
        .collect()
}

fn check_lines(records: &[InstructionRecord]) -> Vec<CheckLine> {
    let findings = || records.iter().flat_map(|record| &record.instruction.findings);
    let line = |check: CheckKind| {
        let of_check = findings().filter(|finding| finding.check == check).map(|finding| finding.verdict);
        CheckLine { name: check.name(), outcome: CardVerdictCounts::from_verdicts(of_check) }
    };
    CheckKind::ALL.into_iter().map(line).collect()
}

fn platform_lines(records: &[InstructionRecord]) -> Vec<PlatformLine> {
    let line = |(platform, platform_records): (String, Vec<&InstructionRecord>)| PlatformLine {
        instructions: platform_records.len(),
        scenes: count_scenes(&platform_records),
        terms: terms::scene_terms(&platform),
        name: platform,
    };
    group_records(records, |_, record| record.platform.clone()).into_iter().map(line).collect()
}

#[cfg(test)]
mod tests;
