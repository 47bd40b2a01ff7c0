//! How many faults the checks find, by kind, and how many of the original texts they refuse.

use super::kind::HouseFaultKind;
use crate::share::{ClusteredShare, aligned_table, share_cell};
use serde::Serialize;
use std::fmt;
use wayword_core::Verdict;

/// A text by the name of its path, with its verdict.
pub(super) type TextVerdict<'t> = (&'t str, Verdict);

/// The figures of one kind of fault.
#[derive(Debug, PartialEq, Serialize)]
struct HouseFaultRow {
    /// The name of the kind.
    kind: &'static str,
    /// How many texts have a fault of this kind: fewer than were asked for where the run has no more.
    texts: usize,
    /// Of these texts, those that fail.
    found: Option<ClusteredShare>,
    /// Of these texts, those that fail or are unverified.
    not_passed: Option<ClusteredShare>,
}

/// The figures of the original texts of all faults, each counted once.
#[derive(Debug, PartialEq, Serialize)]
struct OriginalTextsRow {
    /// How many there are.
    texts: usize,
    /// Those that fail.
    failed: Option<ClusteredShare>,
    /// Those that are unverified.
    unverified: Option<ClusteredShare>,
}

/// The figures that are printed.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct HouseFaultReport {
    /// The seed of the choice of texts.
    seed: u64,
    /// Most texts of each kind.
    per_kind: usize,
    /// How many texts the run has in the style.
    run_texts: usize,
    /// How many of them the generator could place on their walks: only these get faults.
    placed_texts: usize,
    /// One row for each kind.
    kinds: Vec<HouseFaultRow>,
    /// The original texts.
    originals: OriginalTextsRow,
}

/// How the texts were chosen.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaultChoice {
    /// The seed.
    pub(super) seed: u64,
    /// Most texts of each kind.
    pub(super) per_kind: usize,
    /// How many texts the run has in the style.
    pub(super) run_texts: usize,
    /// How many of them the generator could place on their walks.
    pub(super) placed_texts: usize,
}

impl HouseFaultReport {
    /// The figures of texts with faults, by kind, and of their original texts.
    pub(super) fn from_verdicts(
        choice: FaultChoice,
        faults: &[(HouseFaultKind, TextVerdict<'_>)],
        originals: &[TextVerdict<'_>],
    ) -> Self {
        let FaultChoice { seed, per_kind, run_texts, placed_texts } = choice;
        let row = |kind: HouseFaultKind| {
            let of_kind = faults.iter().filter(|(other, _)| *other == kind).map(|(_, verdict)| *verdict);
            let verdicts: Vec<TextVerdict<'_>> = of_kind.collect();
            HouseFaultRow {
                kind: kind.name(),
                texts: verdicts.len(),
                found: count_share(&verdicts, &[Verdict::Fail], seed),
                not_passed: count_share(&verdicts, &[Verdict::Fail, Verdict::Unverified], seed),
            }
        };
        let originals = OriginalTextsRow {
            texts: originals.len(),
            failed: count_share(originals, &[Verdict::Fail], seed),
            unverified: count_share(originals, &[Verdict::Unverified], seed),
        };
        let kinds = HouseFaultKind::ALL.into_iter().map(row).collect();
        Self { seed, per_kind, run_texts, placed_texts, kinds, originals }
    }
}

/// The share of texts with one of some verdicts; `None` where there are no texts.
fn count_share(texts: &[TextVerdict<'_>], wanted: &[Verdict], seed: u64) -> Option<ClusteredShare> {
    ClusteredShare::from_cases(texts.iter().map(|(path, verdict)| (*path, wanted.contains(verdict))), seed)
}

impl fmt::Display for HouseFaultReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = ["", "texts", "found (fail)", "not passed (fail or unverified)"].map(str::to_owned).to_vec();
        let cells = |row: &HouseFaultRow| {
            let shares = [&row.found, &row.not_passed].map(|share| share_cell(share.as_ref()));
            [row.kind.to_owned(), row.texts.to_string()].into_iter().chain(shares).collect()
        };
        let rows: Vec<Vec<String>> = [head].into_iter().chain(self.kinds.iter().map(cells)).collect();
        writeln!(f, "{}", aligned_table(&rows))?;
        let OriginalTextsRow { texts, failed, unverified } = &self.originals;
        let (failed, unverified) = (share_cell(failed.as_ref()), share_cell(unverified.as_ref()));
        writeln!(f, "their {texts} original texts: failed {failed}; unverified {unverified}")?;
        let (placed, all) = (self.placed_texts, self.run_texts);
        write!(f, "texts of the run that the generator could place on their walks: {placed} of {all}")?;
        let few = self.kinds.iter().filter(|row| row.texts < self.per_kind);
        let few: Vec<String> = few.map(|row| format!("{} ({})", row.kind, row.texts)).collect();
        if !few.is_empty() {
            write!(f, "\nfewer than the {} texts that were asked for: {}", self.per_kind, few.join(", "))?;
        }
        write!(f, "\nseed: {}; intervals of 95 %, clustered by path", self.seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> HouseFaultReport {
        let choice = FaultChoice { seed: 1, per_kind: 2, run_texts: 9, placed_texts: 5 };
        let flipped = |path, verdict| (HouseFaultKind::TurnFlipped, (path, verdict));
        let faults = [flipped("a", Verdict::Fail), flipped("b", Verdict::Unverified)];
        HouseFaultReport::from_verdicts(choice, &faults, &[("a", Verdict::Pass), ("b", Verdict::Unverified)])
    }

    #[test]
    fn from_verdicts_counts_by_kind_and_keeps_kinds_without_texts() {
        let report = report();
        assert_eq!(report.kinds.len(), HouseFaultKind::ALL.len());
        let counts = |share: &Option<ClusteredShare>| share.map(|share| (share.count, share.of));
        let row = &report.kinds[0];
        assert_eq!((row.texts, counts(&row.found), counts(&row.not_passed)), (2, Some((1, 2)), Some((2, 2))));
        assert_eq!((report.kinds[1].texts, counts(&report.kinds[1].found)), (0, None));
        assert_eq!(counts(&report.originals.failed), Some((0, 2)));
        assert_eq!(counts(&report.originals.unverified), Some((1, 2)));
    }

    #[test]
    fn the_table_names_the_kinds_with_fewer_texts_than_asked_for() {
        let text = report().to_string();
        assert!(text.contains("turn_early (0)") && !text.contains("turn_flipped (2)"), "{text}");
        assert!(text.contains("5 of 9"), "{text}");
    }
}
