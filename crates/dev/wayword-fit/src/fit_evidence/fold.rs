//! Fits the weights of claims by cross-validation over buildings, and chooses the likelihood ratio at which a claim fails so that only a
//! small share of people's true texts fails.

use super::logistic::{self, Sample};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::open::{Case, Missed, Table, Weights};
use wayword_run::people::{Held, belongs, is_known};

/// How strongly the weights of a case are pulled to zero. Objects have many classes, and few claims of each.
fn ridge(case: Case) -> f64 {
    match case {
        Case::Thing | Case::ThingAtStop => 20.0,
        Case::Room | Case::RoomAtStop | Case::RoomLacking => 6.0,
    }
}

/// Parts of the buildings that are left out in turn.
const FOLDS: usize = 5;
/// A ratio below which no claim fails.
const LEAST_RATIO: f64 = 3.0;

/// The kinds of claims that share a ratio: a text fails where any of them reaches it.
pub(crate) struct Group {
    /// The group's name.
    pub(crate) name: &'static str,
    /// The kinds of claims.
    pub(crate) cases: &'static [Case],
    /// The share of people's texts that may fail by it.
    pub(crate) budget: f64,
}

/// All groups.
pub(crate) const GROUPS: [Group; 2] = [
    Group { name: "objects", cases: &[Case::Thing, Case::ThingAtStop], budget: 0.005 },
    Group { name: "rooms", cases: &[Case::Room, Case::RoomAtStop, Case::RoomLacking], budget: 0.011 },
];

/// The tables of a group: weights from all claims, and the ratio that the budget allows on buildings that are left out in
/// turn. `building` is the number of a walk's building.
pub(crate) fn tables(
    held: &[Held],
    group: &Group,
    building: &dyn Fn(usize) -> usize,
    texts: usize,
) -> Vec<(Case, Table)> {
    // The highest ratio of each true text, over the folds.
    let mut highest: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for case in group.cases {
        let of_case: Vec<&Held> = of(held, *case);
        for fold in 0..FOLDS {
            let (out, rest): (Vec<&Held>, Vec<&Held>) =
                of_case.iter().partition(|held| building(held.walk) % FOLDS == fold);
            let weights = alone(*case, fitted(&rest, *case));
            for held in out.iter().filter(|held| !held.wrong) {
                let Some(ratio) = missed(held, *case).and_then(|missed| weights.log_ratio(missed)) else { continue };
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
    let table = |case: &Case| (*case, Table { fails_at, weights: fitted(&of(held, *case), *case) });
    group.cases.iter().map(table).collect()
}

/// The claims that belong to a case.
pub(crate) fn of(held: &[Held], of: Case) -> Vec<&Held> {
    held.iter().filter(|held| belongs(&held.claim, of) && is_known(&held.claim)).collect()
}

/// The things that the evidence lacks for a claim, if the claim belongs to the case and can fail.
pub(crate) fn missed(held: &Held, of: Case) -> Option<&Missed> {
    held.missed().filter(|missed| missed.case == of && missed.can_fail())
}

/// Weights with the table of only one case.
pub(crate) fn alone(case: Case, weights: BTreeMap<String, f64>) -> Weights {
    let table = Table { fails_at: LEAST_RATIO, weights };
    Weights { cases: [(case.name().to_owned(), table)].into(), ..Weights::default() }
}

fn fitted(of_case: &[&Held], case: Case) -> BTreeMap<String, f64> {
    let count = |wrong: bool| of_case.iter().filter(|held| held.wrong == wrong).count().max(1) as f64;
    // Wrong claims are weighted as if there were as many as true ones. The odds are then the likelihood ratio.
    let wrong_weight = count(false) / count(true);
    let sample = |held: &&Held| {
        let features = missed(held, case)?.features.clone();
        Some(Sample { features, wrong: held.wrong, weight: if held.wrong { wrong_weight } else { 1.0 } })
    };
    let samples: Vec<Sample> = of_case.iter().filter_map(sample).collect();
    let weights = logistic::fit(&samples, ridge(case));
    weights.into_iter().map(|(name, weight)| (name, (weight * 1e3).round() / 1e3)).collect()
}

/// The number of each walk's building.
pub(crate) fn buildings<'a>(scenes: impl Iterator<Item = &'a str>) -> Vec<usize> {
    let scenes: Vec<&str> = scenes.collect();
    let all: BTreeSet<&str> = scenes.iter().copied().collect();
    let numbers: BTreeMap<&str, usize> = all.into_iter().enumerate().map(|(at, scene)| (scene, at)).collect();
    scenes.iter().map(|scene| numbers[scene]).collect()
}
