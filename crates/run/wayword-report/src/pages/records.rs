//! Reads a run for the report: loads the items that are shown, and only counts the others.
//!
//! The files are read twice: first for the verdicts of each item, then for the content of the shown items. Rejected
//! and unverified texts come first, because readers open a report to see those.

use super::{
    order::{Order, Worst},
    texts::{TextState, state},
};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{Ambiguity, Failure, Instruction, Provenance, Verdict};
use wayword_run::{
    error::Error,
    run_folder::{
        FailedItem, Rejected, WalkRecord, file,
        lines::{self, Line},
        settings_of,
    },
    settings::Settings,
};

/// Most bytes of lines in memory, however many items the user wants to see.
const MOST_BYTES: usize = 128 << 20;
/// Most different sets of roles that are shown.
const MOST_ROLES: usize = 16;
/// Most styles that are counted.
const MOST_STYLES: usize = 64;

/// A run as far as the page shows it.
pub(super) struct Records {
    pub(super) settings: Settings,
    /// The items that are shown: those with a rejected text, those with an unverified one, then the others; each of
    /// these in the order of the run.
    pub(super) items: Vec<ItemRecord>,
    /// Items with a path that are not shown.
    pub(super) left_out: usize,
    /// The first items that failed.
    pub(super) failed: Vec<FailedItem>,
    /// Failed items that are not shown.
    pub(super) failed_left_out: usize,
    /// Counts of all items, by style.
    pub(super) counts: BTreeMap<String, Counts>,
    /// The different sets of roles of all accepted instructions.
    pub(super) roles: BTreeSet<RolesPlayed>,
}

/// One item.
pub(super) struct ItemRecord {
    pub(super) walk: WalkRecord,
    pub(super) accepted: Vec<Instruction>,
    pub(super) rejected: Vec<Rejected>,
}

/// Number of a style's instructions by verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) passed: usize,
    pub(super) unverified: usize,
    pub(super) rejected: usize,
    /// Accepted texts that may mean several places or objects.
    pub(super) ambiguous: usize,
}

/// Who asked, answered, wrote and checked.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct RolesPlayed {
    pub(super) asker: String,
    pub(super) answerer: String,
    pub(super) summariser: String,
    pub(super) writer: String,
    pub(super) finished_for: Option<String>,
    pub(super) checked_against: String,
    pub(super) wayword: String,
}

/// The fields of an instruction's line that name and count it.
#[derive(Deserialize)]
struct Named {
    path: Id,
    style: String,
    verdict: Verdict,
    provenance: Provenance,
    #[serde(default)]
    ambiguity: Option<Ambiguity>,
}

#[derive(Deserialize)]
pub(super) struct Id {
    pub(super) id: String,
}

impl Records {
    /// Reads a run folder, at most `most_items` of its items whole.
    ///
    /// # Errors
    /// When it is not a run folder, a file cannot be read, or a line is not of its kind.
    pub(super) fn read(run: &Path, most_items: usize) -> Result<Self, Error> {
        let mut records = Self {
            settings: settings_of(run)?,
            items: Vec::new(),
            left_out: 0,
            failed: Vec::new(),
            failed_left_out: 0,
            counts: BTreeMap::new(),
            roles: BTreeSet::new(),
        };
        let mut worst = Worst::default();
        lines::each(&run.join(file::INSTRUCTIONS), |line| records.count_accepted(&line, &mut worst))?;
        lines::each(&run.join(file::REJECTED), |line| records.count_rejected(&line, most_items, &mut worst))?;
        lines::each(&run.join(file::ERRORS), |line| {
            records.fail(line.parse()?, most_items);
            Ok(())
        })?;
        let order = Order::of(&run.join(file::WALKS), most_items, MOST_BYTES, &worst)?;
        records.take(run, &order)?;
        Ok(records)
    }

    fn count_accepted(&mut self, line: &Line<'_>, worst: &mut Worst) -> Result<(), Error> {
        let named: Named = line.parse()?;
        if let Some(counts) = self.counts_of(&named.style) {
            *match named.verdict {
                Verdict::Pass => &mut counts.passed,
                Verdict::Unverified => &mut counts.unverified,
                Verdict::Fail => &mut counts.rejected,
            } += 1;
            counts.ambiguous += usize::from(named.ambiguity.is_some_and(|ambiguity| ambiguity.is_ambiguous()));
        }
        if self.roles.len() < MOST_ROLES {
            self.roles.insert(named.provenance.into());
        }
        worst.take(named.path.id, state(named.verdict));
        Ok(())
    }

    fn count_rejected(&mut self, line: &Line<'_>, most_items: usize, worst: &mut Worst) -> Result<(), Error> {
        let rejected: Rejected = line.parse()?;
        if rejected.style.is_empty() {
            // A whole item, as older versions wrote it.
            let Rejected { item, reason, .. } = rejected;
            self.fail(FailedItem { item, failure: Failure::Broken, reason }, most_items);
            return Ok(());
        }
        if let Some(counts) = self.counts_of(&rejected.style) {
            counts.rejected += 1;
        }
        worst.take(rejected.item, TextState::Rejected);
        Ok(())
    }

    fn fail(&mut self, failed: FailedItem, most_items: usize) {
        if self.failed.len() < most_items {
            self.failed.push(failed);
        } else {
            self.failed_left_out += 1;
        }
    }

    fn counts_of(&mut self, style: &str) -> Option<&mut Counts> {
        if !self.counts.contains_key(style) && self.counts.len() >= MOST_STYLES {
            return None;
        }
        Some(self.counts.entry(style.to_owned()).or_default())
    }

    /// Loads the items that are shown.
    fn take(&mut self, run: &Path, order: &Order) -> Result<(), Error> {
        let mut walks: BTreeMap<usize, WalkRecord> = BTreeMap::new();
        let mut number = 0;
        lines::each(&run.join(file::WALKS), |line| {
            if let Some(place) = order.place(number) {
                walks.insert(place, line.parse()?);
            }
            number += 1;
            Ok(())
        })?;
        let whole = |walk| ItemRecord { walk, accepted: Vec::new(), rejected: Vec::new() };
        self.items = walks.into_values().map(whole).collect();
        self.left_out = number - self.items.len();
        let mut places = BTreeMap::new();
        for (place, item) in self.items.iter().enumerate() {
            places.entry(item.walk.path.id.clone()).or_insert(place);
        }
        let mut left_bytes = order.left_bytes();
        lines::each(&run.join(file::INSTRUCTIONS), |line| {
            let named: PathOf = line.parse()?;
            if let Some(item) = self.at(&places, &named.path.id).filter(|_| take(&mut left_bytes, line.len())) {
                item.accepted.push(line.parse()?);
            }
            Ok(())
        })?;
        lines::each(&run.join(file::REJECTED), |line| {
            let rejected: Rejected = line.parse()?;
            let is_text = !rejected.style.is_empty();
            let item = self.at(&places, &rejected.item).filter(|_| is_text && take(&mut left_bytes, line.len()));
            if let Some(item) = item {
                item.rejected.push(rejected);
            }
            Ok(())
        })
    }

    fn at(&mut self, places: &BTreeMap<String, usize>, id: &str) -> Option<&mut ItemRecord> {
        self.items.get_mut(*places.get(id)?)
    }
}

/// The field of a line that names its path.
#[derive(Deserialize)]
pub(super) struct PathOf {
    pub(super) path: Id,
}

/// Subtracts `bytes` from `left_bytes` if so many are left. Returns whether it did.
pub(super) fn take(left_bytes: &mut usize, bytes: usize) -> bool {
    let left = left_bytes.checked_sub(bytes);
    *left_bytes = left.unwrap_or(*left_bytes);
    left.is_some()
}

impl From<Provenance> for RolesPlayed {
    fn from(provenance: Provenance) -> Self {
        let Provenance { asker, answerer, summariser, writer, finished_for, checked_against, wayword, .. } = provenance;
        Self { asker, answerer, summariser, writer, finished_for, checked_against, wayword }
    }
}
