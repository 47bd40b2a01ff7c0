//! What the page needs of a run: its first items whole, the rest only counted.

use crate::{
    error::Error,
    run::{
        Rejected, WalkRecord, file,
        lines::{self, Line},
        settings_of,
    },
    settings::Settings,
};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{Instruction, Provenance, Verdict};

/// Most bytes of lines that are held, whatever the number of items asked for.
const MOST_BYTES: usize = 128 << 20;
/// Most different minds that are told.
const MOST_MINDS: usize = 16;
/// Most styles that are counted.
const MOST_STYLES: usize = 64;

/// A run as far as the page shows it.
pub(super) struct Records {
    pub(super) settings: Settings,
    /// The first items, in the order of the run.
    pub(super) items: Vec<ItemRecord>,
    /// Items that were walked and are not shown.
    pub(super) left_out: usize,
    /// The first items of which nothing could be written.
    pub(super) failed: Vec<Rejected>,
    /// Those that are not shown.
    pub(super) failed_left_out: usize,
    /// Of all items, by style.
    pub(super) counts: BTreeMap<String, Counts>,
    /// Of all accepted instructions, without what differs from one to the next.
    pub(super) minds: BTreeSet<Minds>,
}

/// One item.
pub(super) struct ItemRecord {
    pub(super) walk: WalkRecord,
    pub(super) accepted: Vec<Instruction>,
    pub(super) rejected: Vec<Rejected>,
}

/// What became of a style's instructions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Counts {
    pub(super) passed: usize,
    pub(super) unverified: usize,
    pub(super) rejected: usize,
}

/// Who perceived, wrote and checked.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Minds {
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
}

#[derive(Deserialize)]
struct Id {
    id: String,
}

impl Records {
    /// Reads a run folder, its first `most_items` items whole.
    ///
    /// # Errors
    /// When it is no run folder, a file cannot be read, or a line is not of its kind.
    pub(super) fn read(run: &Path, most_items: usize) -> Result<Self, Error> {
        let mut records = Self {
            settings: settings_of(run)?,
            items: Vec::new(),
            left_out: 0,
            failed: Vec::new(),
            failed_left_out: 0,
            counts: BTreeMap::new(),
            minds: BTreeSet::new(),
        };
        let mut left_bytes = MOST_BYTES;
        let mut places = BTreeMap::new();
        lines::each(&run.join(file::WALKS), |line| records.walk(&line, most_items, &mut left_bytes, &mut places))?;
        lines::each(&run.join(file::INSTRUCTIONS), |line| records.instruction(&line, &mut left_bytes, &places))?;
        lines::each(&run.join(file::REJECTED), |line| records.rejected(&line, most_items, &mut left_bytes, &places))?;
        lines::each(&run.join(file::ERRORS), |line| records.rejected(&line, most_items, &mut left_bytes, &places))?;
        Ok(records)
    }

    fn walk(
        &mut self,
        line: &Line<'_>,
        most_items: usize,
        left_bytes: &mut usize,
        places: &mut Places,
    ) -> Result<(), Error> {
        // Once one is left out, so are all after it: the page shows the first items, not those that happen to be small.
        if self.left_out > 0 || self.items.len() >= most_items || !take(left_bytes, line) {
            self.left_out += 1;
            return Ok(());
        }
        let walk: WalkRecord = line.parse()?;
        places.entry(walk.path.id.clone()).or_insert(self.items.len());
        self.items.push(ItemRecord { walk, accepted: Vec::new(), rejected: Vec::new() });
        Ok(())
    }

    fn instruction(&mut self, line: &Line<'_>, left_bytes: &mut usize, places: &Places) -> Result<(), Error> {
        let named: Named = line.parse()?;
        if let Some(counts) = self.counts_of(&named.style) {
            *match named.verdict {
                Verdict::Pass => &mut counts.passed,
                Verdict::Unverified => &mut counts.unverified,
                Verdict::Fail => &mut counts.rejected,
            } += 1;
        }
        if self.minds.len() < MOST_MINDS {
            self.minds.insert(named.provenance.into());
        }
        if let Some(item) = places.get(&named.path.id).and_then(|place| self.items.get_mut(*place))
            && take(left_bytes, line)
        {
            item.accepted.push(line.parse()?);
        }
        Ok(())
    }

    fn rejected(
        &mut self,
        line: &Line<'_>,
        most_items: usize,
        left_bytes: &mut usize,
        places: &Places,
    ) -> Result<(), Error> {
        let rejected: Rejected = line.parse()?;
        if rejected.style.is_empty() {
            if self.failed.len() < most_items && take(left_bytes, line) {
                self.failed.push(rejected);
            } else {
                self.failed_left_out += 1;
            }
            return Ok(());
        }
        if let Some(counts) = self.counts_of(&rejected.style) {
            counts.rejected += 1;
        }
        if let Some(item) = places.get(&rejected.item).and_then(|place| self.items.get_mut(*place))
            && take(left_bytes, line)
        {
            item.rejected.push(rejected);
        }
        Ok(())
    }

    fn counts_of(&mut self, style: &str) -> Option<&mut Counts> {
        if !self.counts.contains_key(style) && self.counts.len() >= MOST_STYLES {
            return None;
        }
        Some(self.counts.entry(style.to_owned()).or_default())
    }
}

/// Where each shown item stands.
type Places = BTreeMap<String, usize>;

/// Whether a line can be held too.
fn take(left_bytes: &mut usize, line: &Line<'_>) -> bool {
    let left = left_bytes.checked_sub(line.len());
    *left_bytes = left.unwrap_or(*left_bytes);
    left.is_some()
}

impl From<Provenance> for Minds {
    fn from(provenance: Provenance) -> Self {
        let Provenance { asker, answerer, summariser, writer, finished_for, checked_against, wayword, .. } = provenance;
        Self { asker, answerer, summariser, writer, finished_for, checked_against, wayword }
    }
}
