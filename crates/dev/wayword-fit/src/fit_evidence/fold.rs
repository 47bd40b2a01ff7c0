//! Fits the weights of claims by cross-validation over buildings, and chooses the likelihood ratio at which a claim fails so that only a
//! small share of people's true texts fails.

use crate::logistic::{self, WeighedSample};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::open::{ClaimCase, MissedClaim, SilenceWeights, WeightTable};
use wayword_run::people::{ClaimSample, belongs_to_case, is_known};

/// How strongly the weights of a case are pulled to zero. Objects have many classes, and few claims of each.
fn ridge_for_case(case: ClaimCase) -> f64 {
    match case {
        ClaimCase::Thing | ClaimCase::ThingAtStop => 20.0,
        ClaimCase::Room | ClaimCase::RoomAtStop | ClaimCase::RoomLacking => 6.0,
    }
}

/// The buildings are split into this many parts. For each part, the weights are fitted on the other parts and tried on this one.
const FOLD_COUNT: usize = 5;
/// A likelihood ratio below which no claim fails, however many true texts the budget would allow to fail.
const MIN_FAILING_RATIO: f64 = 3.0;

/// The kinds of claims that share a ratio: a text fails where any of them reaches it.
pub(crate) struct ClaimCaseGroup {
    /// The group's name.
    pub(crate) name: &'static str,
    /// The kinds of claims.
    pub(crate) cases: &'static [ClaimCase],
    /// The share of people's true texts that may fail by a claim of this group, as 0.005 for half a percent.
    pub(crate) budget: f64,
}

/// All groups.
pub(crate) const CASE_GROUPS: [ClaimCaseGroup; 2] = [
    ClaimCaseGroup { name: "objects", cases: &[ClaimCase::Thing, ClaimCase::ThingAtStop], budget: 0.005 },
    ClaimCaseGroup {
        name: "rooms",
        cases: &[ClaimCase::Room, ClaimCase::RoomAtStop, ClaimCase::RoomLacking],
        budget: 0.015,
    },
];

/// The tables of a group: weights from all claims, and the ratio that the budget allows on buildings that are left out in
/// turn. `building` gives the number of a walk's building, and `text_count` texts made the samples.
pub(crate) fn fit_tables(
    samples: &[ClaimSample],
    group: &ClaimCaseGroup,
    building: &dyn Fn(usize) -> usize,
    text_count: usize,
) -> Vec<(ClaimCase, WeightTable)> {
    // By walk and text: the highest logarithm of a ratio among the text's true claims.
    let mut highest: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for case in group.cases {
        let case_samples: Vec<&ClaimSample> = claims_for_case(samples, *case);
        for fold in 0..FOLD_COUNT {
            let (left_out, fitted): (Vec<&ClaimSample>, Vec<&ClaimSample>) =
                case_samples.iter().partition(|sample| building(sample.walk) % FOLD_COUNT == fold);
            let weights = weights_with_table(*case, fit_case(&fitted, *case));
            for sample in left_out.iter().filter(|sample| !sample.wrong) {
                let Some(log_ratio) = failing_miss(sample, *case).and_then(|missed| weights.log_ratio(missed)) else {
                    continue;
                };
                let text_highest = highest.entry((sample.walk, sample.text)).or_insert(f64::NEG_INFINITY);
                *text_highest = text_highest.max(log_ratio);
            }
        }
    }
    let mut log_ratios: Vec<f64> = highest.into_values().collect();
    log_ratios.sort_by(|a, b| b.total_cmp(a));
    let allowed = (group.budget * text_count as f64) as usize;
    let fails_at =
        log_ratios.get(allowed).map_or(MIN_FAILING_RATIO, |log_ratio| log_ratio.exp()).max(MIN_FAILING_RATIO);
    // Rounded up to one digit after the point.
    let fails_at = (fails_at * 10.0).ceil() / 10.0;
    let table = |case: &ClaimCase| {
        (*case, WeightTable { fails_at, weights: fit_case(&claims_for_case(samples, *case), *case) })
    };
    group.cases.iter().map(table).collect()
}

/// The claims that belong to a case and name a thing or room that the program knows.
pub(crate) fn claims_for_case(samples: &[ClaimSample], case: ClaimCase) -> Vec<&ClaimSample> {
    samples.iter().filter(|sample| belongs_to_case(&sample.claim, case) && is_known(&sample.claim)).collect()
}

/// The things that the evidence lacks for a claim, if the claim belongs to the case and can fail.
pub(crate) fn failing_miss(sample: &ClaimSample, case: ClaimCase) -> Option<&MissedClaim> {
    sample.missed_evidence().filter(|missed| missed.case == case && missed.can_fail())
}

/// Weights with the table of only one case.
pub(crate) fn weights_with_table(case: ClaimCase, weights: BTreeMap<String, f64>) -> SilenceWeights {
    let table = WeightTable { fails_at: MIN_FAILING_RATIO, weights };
    SilenceWeights { cases: [(case.name().to_owned(), table)].into(), ..SilenceWeights::default() }
}

/// Fits the weight of each feature to the claims of one case, rounded to three digits after the point.
fn fit_case(case_samples: &[&ClaimSample], case: ClaimCase) -> BTreeMap<String, f64> {
    let count = |wrong: bool| case_samples.iter().filter(|sample| sample.wrong == wrong).count().max(1) as f64;
    // Wrong claims are weighted as if there were as many as true ones. The odds are then the likelihood ratio.
    let wrong_weight = count(false) / count(true);
    let weigh = |sample: &&ClaimSample| {
        let features = failing_miss(sample, case)?.features.clone();
        let weight = if sample.wrong { wrong_weight } else { 1.0 };
        Some(WeighedSample { features, wrong: sample.wrong, weight })
    };
    let weighed: Vec<WeighedSample> = case_samples.iter().filter_map(weigh).collect();
    let weights = logistic::fit_weights(&weighed, ridge_for_case(case));
    weights.into_iter().map(|(name, weight)| (name, (weight * 1e3).round() / 1e3)).collect()
}

/// The number of each walk's building, from the scenes of the walks. Buildings are numbered by name.
pub(crate) fn building_numbers<'a>(scenes: impl Iterator<Item = &'a str>) -> Vec<usize> {
    let scenes: Vec<&str> = scenes.collect();
    let distinct: BTreeSet<&str> = scenes.iter().copied().collect();
    let numbers: BTreeMap<&str, usize> = distinct.into_iter().enumerate().map(|(at, scene)| (scene, at)).collect();
    scenes.iter().map(|scene| numbers[scene]).collect()
}
