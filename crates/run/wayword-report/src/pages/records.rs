//! Reads a run for the report: loads the items that are shown, and only counts the others.
//!
//! The files are read twice: first for what speaks against each text, then for the content of the shown items. The most
//! suspicious texts come first, because readers open a report to see those.

use super::{
    item_order::{ItemOrder, ItemScores, PathIdField, PathLine, take_bytes},
    item_record::{AcceptedText, ItemRecord, TextState},
    suspicion::TextSuspicion,
};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{CheckFinding, FailureKind, TextAmbiguity, TextProvenance, Verdict};
use wayword_run::{
    check::CheckedAgain,
    error::CommandError,
    item::planned_item_count,
    run_folder::{
        FailedItem, RejectedText, TextCost, WalkRecord, file,
        lines::{self, RecordLine},
        read_run_settings, refuse_repeated_lines,
    },
    settings::RunSettings,
};

/// Most bytes of lines in memory, 128 MiB, however many items the user wants to see. Items beyond are only counted.
const MAX_LOADED_BYTES: usize = 128 << 20;
/// Most different sets of roles that are shown.
const MAX_ROLE_SETS: usize = 16;
/// Most styles that are counted.
const MAX_COUNTED_STYLES: usize = 64;

/// A run as far as the page shows it.
pub(super) struct ReportRecords<'a> {
    pub(super) settings: RunSettings,
    /// The items that are shown, those with the most suspicious texts first, and else in the order of the run.
    pub(super) items: Vec<ItemRecord>,
    /// Items with a path that are not shown.
    pub(super) left_out: usize,
    /// The first items that failed.
    pub(super) failed: Vec<FailedItem>,
    /// Failed items that are not shown.
    pub(super) failed_left_out: usize,
    /// Counts of all items, by style.
    pub(super) counts: BTreeMap<String, StyleCounts>,
    /// Items that have a path but no text.
    pub(super) unwritten: usize,
    /// Items that the run is to have, if that is known.
    pub(super) planned: Option<usize>,
    /// US dollars for the answers of models that all items used.
    pub(super) usd: f64,
    /// The second check of the texts.
    pub(super) again: &'a CheckedAgain,
    /// The different sets of roles of all accepted instructions.
    pub(super) roles: BTreeSet<RolesPlayed>,
}

/// Number of a style's instructions by verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct StyleCounts {
    pub(super) passed: usize,
    pub(super) unverified: usize,
    pub(super) rejected: usize,
    /// Accepted texts that fail a check.
    pub(super) wrong: usize,
    /// Accepted texts that may mean several places or objects.
    pub(super) ambiguous: usize,
    /// Accepted texts with words that the follower doubts.
    pub(super) doubtful: usize,
    /// Claims of accepted texts that nothing decides.
    pub(super) claims: usize,
    /// Texts that a person should look at.
    pub(super) look: usize,
}

/// Who asked, answered, wrote and checked.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct RolesPlayed {
    pub(super) asker: String,
    pub(super) answerer: String,
    pub(super) summariser: String,
    pub(super) writer: String,
    /// The first writer, if all its texts failed their checks and `writer` finished for it.
    pub(super) finished_for: Option<String>,
    pub(super) checked_against: String,
    pub(super) wayword: String,
}

/// The fields of an instruction's line that name and count it.
#[derive(Deserialize)]
struct InstructionHeader {
    path: PathIdField,
    style: String,
    text: String,
    verdict: Verdict,
    findings: Vec<CheckFinding>,
    provenance: TextProvenance,
    #[serde(default)]
    ambiguity: Option<TextAmbiguity>,
}

/// The field of an instruction's line with its cost.
#[derive(Deserialize)]
struct TextDetailLine {
    #[serde(default)]
    cost: Option<TextCost>,
    #[serde(default)]
    number: usize,
}

impl<'a> ReportRecords<'a> {
    /// Reads a run folder, at most `most_items` of its items whole.
    ///
    /// # Errors
    /// When it is not a run folder, a file cannot be read, or a line is not of its kind.
    pub(super) fn read_run(run: &Path, most_items: usize, again: &'a CheckedAgain) -> Result<Self, CommandError> {
        let settings = read_run_settings(run)?;
        refuse_repeated_lines(run)?;
        let mut records = Self {
            planned: planned_item_count(&settings),
            settings,
            items: Vec::new(),
            left_out: 0,
            failed: Vec::new(),
            failed_left_out: 0,
            counts: BTreeMap::new(),
            roles: BTreeSet::new(),
            unwritten: 0,
            usd: 0.0,
            again,
        };
        let mut scores = ItemScores::default();
        lines::each_line(&run.join(file::INSTRUCTIONS), |line| records.count_accepted(&line, &mut scores))?;
        lines::each_line(&run.join(file::REJECTED), |line| records.count_rejected(&line, most_items, &mut scores))?;
        lines::each_line(&run.join(file::ERRORS), |line| {
            records.note_failed(line.parse()?, most_items);
            Ok(())
        })?;
        let order = ItemOrder::from_walks(&run.join(file::WALKS), most_items, MAX_LOADED_BYTES, &scores)?;
        (records.unwritten, records.usd) = (order.unwritten, order.usd);
        records.left_out = order.items;
        records.take_items(run, &order)?;
        Ok(records)
    }

    fn count_accepted(&mut self, line: &RecordLine<'_>, scores: &mut ItemScores) -> Result<(), CommandError> {
        let InstructionHeader { path, style, text, verdict, findings, provenance, ambiguity } = line.parse()?;
        let second = self.again.of_line(line.number());
        let suspicion = TextSuspicion::of_accepted((&text, verdict, &findings), ambiguity.as_ref(), second);
        if let Some(counts) = self.counts_of(&style) {
            counts.count_text(&suspicion);
        }
        if self.roles.len() < MAX_ROLE_SETS {
            self.roles.insert(provenance.into());
        }
        scores.note_score(path.id, suspicion.score);
        Ok(())
    }

    fn count_rejected(
        &mut self,
        line: &RecordLine<'_>,
        most_items: usize,
        scores: &mut ItemScores,
    ) -> Result<(), CommandError> {
        let rejected: RejectedText = line.parse()?;
        if rejected.style.is_empty() {
            // A whole item, as older versions wrote it.
            let RejectedText { item, reason, .. } = rejected;
            self.note_failed(FailedItem { item, failure: FailureKind::Broken, reason }, most_items);
            return Ok(());
        }
        let suspicion = TextSuspicion::of_rejected(&rejected);
        if let Some(counts) = self.counts_of(&rejected.style) {
            counts.count_text(&suspicion);
        }
        scores.note_score(rejected.item, suspicion.score);
        Ok(())
    }

    fn note_failed(&mut self, failed: FailedItem, most_items: usize) {
        if self.failed.len() < most_items {
            self.failed.push(failed);
        } else {
            self.failed_left_out += 1;
        }
    }

    /// The counts of a style; `None` for a new style beyond the limit.
    fn counts_of(&mut self, style: &str) -> Option<&mut StyleCounts> {
        if !self.counts.contains_key(style) && self.counts.len() >= MAX_COUNTED_STYLES {
            return None;
        }
        Some(self.counts.entry(style.to_owned()).or_default())
    }

    /// Loads the items that are shown.
    fn take_items(&mut self, run: &Path, order: &ItemOrder) -> Result<(), CommandError> {
        let mut walks: BTreeMap<usize, (usize, WalkRecord)> = BTreeMap::new();
        let mut number = 0;
        lines::each_line(&run.join(file::WALKS), |line| {
            if let Some(place) = order.place_of_line(number) {
                walks.insert(place, (number, line.parse()?));
            }
            number += 1;
            Ok(())
        })?;
        let whole = |(place, walk)| ItemRecord { place, walk, accepted: Vec::new(), rejected: Vec::new() };
        self.items = walks.into_values().map(whole).collect();
        self.left_out -= self.items.len();
        let mut places = BTreeMap::new();
        for (place, item) in self.items.iter().enumerate() {
            places.entry(item.walk.path.id.clone()).or_insert(place);
        }
        let mut left_bytes = order.left_bytes();
        lines::each_line(&run.join(file::INSTRUCTIONS), |line| {
            let named: PathLine = line.parse()?;
            if let Some(item) =
                self.item_by_id(&places, &named.path.id).filter(|_| take_bytes(&mut left_bytes, line.byte_count()))
            {
                let TextDetailLine { cost, number } = line.parse()?;
                item.accepted.push(AcceptedText { line: line.number(), instruction: line.parse()?, number, cost });
            }
            Ok(())
        })?;
        lines::each_line(&run.join(file::REJECTED), |line| {
            let rejected: RejectedText = line.parse()?;
            let is_text = !rejected.style.is_empty();
            let item = self
                .item_by_id(&places, &rejected.item)
                .filter(|_| is_text && take_bytes(&mut left_bytes, line.byte_count()));
            if let Some(item) = item {
                item.rejected.push(rejected);
            }
            Ok(())
        })
    }

    fn item_by_id(&mut self, places: &BTreeMap<String, usize>, id: &str) -> Option<&mut ItemRecord> {
        self.items.get_mut(*places.get(id)?)
    }
}

impl StyleCounts {
    fn count_text(&mut self, suspicion: &TextSuspicion) {
        *match suspicion.state {
            TextState::Wrong => &mut self.wrong,
            TextState::Rejected => &mut self.rejected,
            TextState::Unverified => &mut self.unverified,
            TextState::Passed => &mut self.passed,
        } += 1;
        self.ambiguous += usize::from(suspicion.is_ambiguous);
        self.doubtful += usize::from(suspicion.is_doubtful);
        self.look += usize::from(suspicion.needs_look());
        self.claims += suspicion.unverified;
    }

    /// All texts of several styles together.
    pub(super) fn of_all<'c>(counts: impl Iterator<Item = &'c Self>) -> Self {
        counts.fold(Self::default(), |all, one| Self {
            passed: all.passed + one.passed,
            unverified: all.unverified + one.unverified,
            rejected: all.rejected + one.rejected,
            wrong: all.wrong + one.wrong,
            ambiguous: all.ambiguous + one.ambiguous,
            doubtful: all.doubtful + one.doubtful,
            claims: all.claims + one.claims,
            look: all.look + one.look,
        })
    }
}

impl From<TextProvenance> for RolesPlayed {
    fn from(provenance: TextProvenance) -> Self {
        let TextProvenance { asker, answerer, summariser, writer, finished_for, checked_against, wayword, .. } =
            provenance;
        Self { asker, answerer, summariser, writer, finished_for, checked_against, wayword }
    }
}
