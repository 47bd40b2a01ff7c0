//! Fits the weights of claims by cross-validation over buildings, and chooses the likelihood ratio at which a claim fails so that only a
//! small share of people's true texts fails.

use super::logistic::{self, WeighedClaimSample};
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

/// Parts of the buildings that are left out in turn.
const FOLD_COUNT: usize = 5;
/// A ratio below which no claim fails.
const LEAST_RATIO: f64 = 3.0;

/// The kinds of claims that share a ratio: a text fails where any of them reaches it.
pub(crate) struct ClaimCaseGroup {
    /// The group's name.
    pub(crate) name: &'static str,
    /// The kinds of claims.
    pub(crate) cases: &'static [ClaimCase],
    /// The share of people's texts that may fail by it.
    pub(crate) budget: f64,
}

/// All groups.
pub(crate) const CASE_GROUPS: [ClaimCaseGroup; 2] = [
    ClaimCaseGroup { name: "objects", cases: &[ClaimCase::Thing, ClaimCase::ThingAtStop], budget: 0.005 },
    ClaimCaseGroup {
        name: "rooms",
        cases: &[ClaimCase::Room, ClaimCase::RoomAtStop, ClaimCase::RoomLacking],
        budget: 0.011,
    },
];

/// The tables of a group: weights from all claims, and the ratio that the budget allows on buildings that are left out in
/// turn. `building` is the number of a walk's building.
pub(crate) fn fit_tables(
    held: &[ClaimSample],
    group: &ClaimCaseGroup,
    building: &dyn Fn(usize) -> usize,
    texts: usize,
) -> Vec<(ClaimCase, WeightTable)> {
    // The highest ratio of each true text, over the folds.
    let mut highest: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for case in group.cases {
        let of_case: Vec<&ClaimSample> = claims_for_case(held, *case);
        for fold in 0..FOLD_COUNT {
            let (out, rest): (Vec<&ClaimSample>, Vec<&ClaimSample>) =
                of_case.iter().partition(|held| building(held.walk) % FOLD_COUNT == fold);
            let weights = weights_with_table(*case, fit_case(&rest, *case));
            for held in out.iter().filter(|held| !held.wrong) {
                let Some(ratio) = failing_miss(held, *case).and_then(|missed| weights.log_ratio(missed)) else {
                    continue;
                };
                let most = highest.entry((held.walk, held.text)).or_insert(f64::NEG_INFINITY);
                *most = most.max(ratio);
            }
        }
    }
    let mut ratios: Vec<f64> = highest.into_values().collect();
    ratios.sort_by(|a, b| b.total_cmp(a));
    let allowed = (group.budget * texts as f64) as usize;
    let fails_at = ratios.get(allowed).map_or(LEAST_RATIO, |ratio| ratio.exp()).max(LEAST_RATIO);
    let fails_at = (fails_at * 10.0).ceil() / 10.0;
    let table =
        |case: &ClaimCase| (*case, WeightTable { fails_at, weights: fit_case(&claims_for_case(held, *case), *case) });
    group.cases.iter().map(table).collect()
}

/// The claims that belong to a case.
pub(crate) fn claims_for_case(held: &[ClaimSample], of: ClaimCase) -> Vec<&ClaimSample> {
    held.iter().filter(|held| belongs_to_case(&held.claim, of) && is_known(&held.claim)).collect()
}

/// The things that the evidence lacks for a claim, if the claim belongs to the case and can fail.
pub(crate) fn failing_miss(held: &ClaimSample, of: ClaimCase) -> Option<&MissedClaim> {
    held.missed_evidence().filter(|missed| missed.case == of && missed.can_fail())
}

/// Weights with the table of only one case.
pub(crate) fn weights_with_table(case: ClaimCase, weights: BTreeMap<String, f64>) -> SilenceWeights {
    let table = WeightTable { fails_at: LEAST_RATIO, weights };
    SilenceWeights { cases: [(case.name().to_owned(), table)].into(), ..SilenceWeights::default() }
}

fn fit_case(of_case: &[&ClaimSample], case: ClaimCase) -> BTreeMap<String, f64> {
    let count = |wrong: bool| of_case.iter().filter(|held| held.wrong == wrong).count().max(1) as f64;
    // Wrong claims are weighted as if there were as many as true ones. The odds are then the likelihood ratio.
    let wrong_weight = count(false) / count(true);
    let sample = |held: &&ClaimSample| {
        let features = failing_miss(held, case)?.features.clone();
        Some(WeighedClaimSample { features, wrong: held.wrong, weight: if held.wrong { wrong_weight } else { 1.0 } })
    };
    let samples: Vec<WeighedClaimSample> = of_case.iter().filter_map(sample).collect();
    let weights = logistic::fit_weights(&samples, ridge_for_case(case));
    weights.into_iter().map(|(name, weight)| (name, (weight * 1e3).round() / 1e3)).collect()
}

/// The number of each walk's building.
pub(crate) fn building_numbers<'a>(scenes: impl Iterator<Item = &'a str>) -> Vec<usize> {
    let scenes: Vec<&str> = scenes.collect();
    let all: BTreeSet<&str> = scenes.iter().copied().collect();
    let numbers: BTreeMap<&str, usize> = all.into_iter().enumerate().map(|(at, scene)| (scene, at)).collect();
    scenes.iter().map(|scene| numbers[scene]).collect()
}
