//! Measures how many known corruptions `wayword check` finds, and how often it reports an error at the same words of the original text.

use crate::{
    checked_texts::{CheckedTexts, JudgingArgs, check_in_memory, is_about, report_words},
    corrupt_people::clauses_around,
    key::{CorruptionKey, TextCorruption, undo_changes},
    share::{ClusteredShare, aligned_table, share_cell},
};
use clap::Args;
use serde::Serialize;
use serde_json::json;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::{CheckFinding, Verdict};
use wayword_formats::Episode;
use wayword_run::{error::CommandError, output::CommandOutput};

/// The flags of `found`.
#[derive(Debug, Args)]
pub struct CorruptionFindingArgs {
    /// How the file is checked.
    #[command(flatten)]
    pub judging: JudgingArgs,
    /// The key of the file. [default: FILE.key.json next to FILE.json]
    #[arg(long)]
    key: Option<PathBuf>,
}

/// A corrupted text and the text that it was made from.
struct CorruptedPair<'k> {
    /// The entry of the key.
    corruption: &'k TextCorruption,
    /// The item of the corrupted text.
    episode: Episode,
    /// The corrupted text.
    now: String,
    /// The original text.
    was: String,
    /// The clauses of the changed words, and one on each side of them.
    near_now: Vec<[usize; 2]>,
    /// The same clauses of the original text.
    near_was: Vec<[usize; 2]>,
}

/// The findings in both texts of a pair.
struct PairFindings<'p> {
    pair: &'p CorruptedPair<'p>,
    /// In the corrupted text.
    now: &'p [CheckFinding],
    /// In the original text.
    was: &'p [CheckFinding],
}

/// The figures of one kind of corruption, or of all.
#[derive(Debug, PartialEq, Serialize)]
struct CorruptionRow {
    kind: String,
    /// Of the corrupted texts, those with a "fail" at the changed words.
    found: Option<ClusteredShare>,
    /// Of their original texts, those with a "fail" at the words that were changed.
    before: Option<ClusteredShare>,
    /// The share found among those with no "fail" there in the original text.
    found_anew: Option<ClusteredShare>,
    /// Of the corrupted texts, those with a "fail" or an "unverified" about the changed words themselves.
    doubted: Option<ClusteredShare>,
    /// Of the corrupted texts, those that fail anywhere.
    fails: Option<ClusteredShare>,
    /// Of their original texts, those that fail anywhere.
    fails_before: Option<ClusteredShare>,
}

/// Checks corrupted texts and their originals, and prints how many corruptions were found, by kind.
///
/// # Errors
/// When the texts or their key cannot be read or do not belong together, and as `wayword check`.
pub fn measure_corruption_findings(flags: CorruptionFindingArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let file = flags.judging.check.file.clone();
    let key = CorruptionKey::read(&flags.key.unwrap_or_else(|| CorruptionKey::path_for_texts(&file)))?;
    let pairs = read_pairs(&file, &key)?;
    let (seed, show, is_json) =
        (flags.judging.seed, flags.judging.check.show.how_many(usize::MAX, 0)[0], flags.judging.json);
    let texts = PairTexts::from_pairs(&pairs);
    let CheckedTexts { findings, report, .. } = check_in_memory(&texts.all, flags.judging.check, output)?;
    let outcome = |(at, pair): (usize, _)| PairFindings { pair, now: &findings[at], was: &findings[texts.old[at]] };
    let outcomes: Vec<PairFindings<'_>> = pairs.iter().enumerate().map(outcome).collect();
    for line in
        outcomes.iter().filter(|outcome| !outcome.is_found()).map(describe_miss).take(if is_json { 0 } else { show })
    {
        output.say(line);
    }
    let rows = kind_rows(&outcomes, seed);
    let notes = [format!("seed of the corruptions: {}; intervals of 95 %, clustered by path", key.seed)];
    let lines =
        [rows_table(&rows)].into_iter().chain(notes).chain(report_words(&report)).collect::<Vec<_>>().join("\n");
    output.print_result(&json!({ "seed": key.seed, "rows": rows, "check": report }), lines);
    Ok(())
}

/// Reads the corrupted texts of a file, and undoes the changes of the key to get their originals.
fn read_pairs<'k>(file: &Path, key: &'k CorruptionKey) -> Result<Vec<CorruptedPair<'k>>, CommandError> {
    let episodes = wayword_formats::read_any_format(file)?;
    let episodes: BTreeMap<&str, &Episode> = episodes.iter().map(|episode| (episode.id.as_str(), episode)).collect();
    let pair = |corruption: &'k TextCorruption| {
        let wrong = |problem: &str| {
            let problem = format!("{}: item {}: {problem}", file.display(), corruption.item);
            CommandError::usage(problem, "give the key that was written with this file")
        };
        let episode =
            episodes.get(corruption.item.as_str()).ok_or_else(|| wrong("the key names it, but it is not there"))?;
        let [now] = episode.instructions.as_slice() else { return Err(wrong("it has not exactly one instruction")) };
        let (was, old) = undo_changes(now, &corruption.changes)
            .ok_or_else(|| wrong("its text does not have the words of the key"))?;
        let near_now = corruption.changes.iter().map(|change| clauses_around(now, change.span)).collect();
        let near_was = old.into_iter().map(|span| clauses_around(&was, span)).collect();
        Ok(CorruptedPair { corruption, episode: (*episode).clone(), now: now.clone(), was, near_now, near_was })
    };
    key.corruptions.iter().map(pair).collect()
}

/// The corrupted texts, and each original text once.
struct PairTexts<'p> {
    /// All texts with their items: the corrupted ones in the order of the pairs, then the originals.
    all: Vec<(&'p Episode, &'p str)>,
    /// For each pair, the place of its original text in `all`.
    old: Vec<usize>,
}

impl<'p> PairTexts<'p> {
    fn from_pairs(pairs: &'p [CorruptedPair<'p>]) -> Self {
        let mut all: Vec<_> = pairs.iter().map(|pair| (&pair.episode, pair.now.as_str())).collect();
        let mut known = BTreeMap::new();
        let old = pairs.iter().map(|pair| {
            *known.entry((&pair.corruption.of, &pair.corruption.path, &pair.was)).or_insert_with(|| {
                all.push((&pair.episode, pair.was.as_str()));
                all.len() - 1
            })
        });
        let old = old.collect();
        Self { all, old }
    }
}

impl PairFindings<'_> {
    /// Whether the corrupted text fails at the changed words or next to them.
    fn is_found(&self) -> bool {
        fails_at(self.now, &self.pair.near_now)
    }

    /// Whether a finding is about the changed words themselves.
    fn is_doubted(&self) -> bool {
        let changes = &self.pair.corruption.changes;
        self.now.iter().any(|finding| changes.iter().any(|change| is_about(finding, change.span)))
    }

    /// Whether the original text fails at the words that were changed, or next to them.
    fn is_found_before(&self) -> bool {
        fails_at(self.was, &self.pair.near_was)
    }
}

fn has_failure(findings: &[CheckFinding]) -> bool {
    findings.iter().any(|finding| finding.verdict == Verdict::Fail)
}

fn fails_at(findings: &[CheckFinding], places: &[[usize; 2]]) -> bool {
    let is_there = |finding: &CheckFinding| places.iter().any(|place| is_about(finding, *place));
    findings.iter().any(|finding| finding.verdict == Verdict::Fail && is_there(finding))
}

/// A row for each kind, in the order of the key, and one for all.
fn kind_rows<'k>(outcomes: &[PairFindings<'k>], seed: u64) -> Vec<CorruptionRow> {
    let mut kinds: Vec<&str> = Vec::new();
    for outcome in outcomes {
        let kind = outcome.pair.corruption.kind.as_str();
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let row = |name: &str, kind: Option<&str>| {
        let of_kind = || outcomes.iter().filter(|outcome| kind.is_none_or(|kind| kind == outcome.pair.corruption.kind));
        let case = |outcome: &PairFindings<'k>, counts| (&outcome.pair.corruption.path, counts);
        let share = |counts: fn(&PairFindings<'_>) -> bool| {
            ClusteredShare::from_cases(of_kind().map(|outcome| case(outcome, counts(outcome))), seed)
        };
        let quiet_before = of_kind().filter(|outcome| !outcome.is_found_before());
        CorruptionRow {
            kind: name.to_owned(),
            found: share(|outcome| outcome.is_found()),
            before: share(|outcome| outcome.is_found_before()),
            found_anew: ClusteredShare::from_cases(quiet_before.map(|outcome| case(outcome, outcome.is_found())), seed),
            doubted: share(|outcome| outcome.is_doubted()),
            fails: share(|outcome| has_failure(outcome.now)),
            fails_before: share(|outcome| has_failure(outcome.was)),
        }
    };
    let of_kinds = kinds.iter().map(|kind| row(kind, Some(kind)));
    of_kinds.chain([row("all", None)]).collect()
}

/// A line for a corruption that the check missed.
fn describe_miss(outcome: &PairFindings<'_>) -> String {
    let TextCorruption { item, kind, changes, .. } = outcome.pair.corruption;
    let changes = changes.iter().map(|change| format!("{:?} was {:?}", change.now, change.was));
    format!("{item} {kind}: {}\n    {}", changes.collect::<Vec<_>>().join(", "), outcome.pair.now)
}

fn rows_table(rows: &[CorruptionRow]) -> String {
    let head = ["", "found there", "fail there before", "found anew", "doubted", "fail at all", "fail at all before"];
    let head = head.map(str::to_owned).to_vec();
    let cells = |row: &CorruptionRow| {
        let shares = [&row.found, &row.before, &row.found_anew, &row.doubted, &row.fails, &row.fails_before];
        let shares = shares.map(|share| share_cell(share.as_ref()));
        [row.kind.clone()].into_iter().chain(shares).collect()
    };
    let rows: Vec<Vec<String>> = [head].into_iter().chain(rows.iter().map(cells)).collect();
    aligned_table(&rows)
}

#[cfg(test)]
mod tests;
