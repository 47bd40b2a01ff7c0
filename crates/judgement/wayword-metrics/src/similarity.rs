//! How alike two sets of instructions are, by the cosines of their text vectors. A cosine has no meaning by itself, so two
//! anchors come with it: two people's texts about the same item, and texts about different paths.

use crate::{MeanEstimate, ResamplingOptions, clustered_interval};
use rand::Rng;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::seeded_rng;

/// How many random items of other paths each item is compared with, for the anchor of random pairs.
const RANDOM_PAIRS_PER_ITEM: usize = 10;

/// The text vectors of one item.
#[derive(Debug, Clone, PartialEq)]
pub struct ItemVectors<'a> {
    /// The path that it is about: items of one path are not independent.
    pub cluster: String,
    /// A vector per text. All vectors of a comparison have the same length.
    pub vectors: Vec<&'a [f32]>,
}

/// How alike two sets are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetSimilarity {
    /// A against B: over items, the mean cosine of a text in A and a text in B of the same item. `None` without a common item.
    pub figure: Option<MeanEstimate>,
    /// The same between two texts of B on one item: the similarity that two people reach. `None` where no item has two.
    pub same_item: Option<MeanEstimate>,
    /// The same between a text of B on the item and one on an item of another path, drawn at random: the similarity that an
    /// author reaches without having seen the path. Its interval takes only the path of the first text into account. `None`
    /// where there is a single path.
    pub random_pairs: Option<MeanEstimate>,
    /// Items that A alone has.
    pub only_in_a: usize,
    /// Items that B alone has.
    pub only_in_b: usize,
    /// Common items of which B has one text only: they are not in `same_item`.
    pub single_in_b: usize,
}

/// Compares A with B, item by item. Both anchors are taken over the common items, so that all three figures are about
/// the same items.
///
/// An item's figure is the mean cosine over all pairs of texts, the set's the mean over items (the average pairwise cosine of
/// arXiv 2403.11487). Intervals draw paths. Items without a text count as absent.
#[must_use]
pub fn compare_sets(
    a: &BTreeMap<String, ItemVectors<'_>>,
    b: &BTreeMap<String, ItemVectors<'_>>,
    drawing: &ResamplingOptions,
) -> SetSimilarity {
    let ids = |set: &BTreeMap<String, ItemVectors<'_>>| -> BTreeSet<String> {
        set.iter().filter(|(_, item)| !item.vectors.is_empty()).map(|(id, _)| id.clone()).collect()
    };
    let (in_a, in_b) = (ids(a), ids(b));
    let common: Vec<(&str, &ItemVectors<'_>, &ItemVectors<'_>)> =
        in_a.intersection(&in_b).map(|id| (id.as_str(), &a[id], &b[id])).collect();
    let b_items: Vec<(&str, &ItemVectors<'_>)> = common.iter().map(|(id, _, b)| (*id, *b)).collect();
    let estimate = |values: &[(&str, f64)]| clustered_interval(values, drawing.resamples, drawing.level, drawing.seed);
    let figures: Vec<(&str, f64)> =
        common.iter().filter_map(|(_, a, b)| Some((b.cluster.as_str(), mean_cosine_between(a, b)?))).collect();
    let same: Vec<(&str, f64)> =
        b_items.iter().filter_map(|(_, item)| Some((item.cluster.as_str(), mean_cosine_within(item)?))).collect();
    SetSimilarity {
        figure: estimate(&figures),
        same_item: estimate(&same),
        random_pairs: estimate(&random_pair_cosines(&b_items, drawing.seed)),
        only_in_a: in_a.difference(&in_b).count(),
        only_in_b: in_b.difference(&in_a).count(),
        single_in_b: b_items.len() - same.len(),
    }
}

/// The mean cosine over all pairs of a text of `a` and one of `b`.
fn mean_cosine_between(a: &ItemVectors<'_>, b: &ItemVectors<'_>) -> Option<f64> {
    mean(a.vectors.iter().flat_map(|a| b.vectors.iter().map(move |b| cosine(a, b))))
}

/// The mean cosine over all unordered pairs of one item's texts; `None` for fewer than two.
fn mean_cosine_within(item: &ItemVectors<'_>) -> Option<f64> {
    let texts = item.vectors.iter().enumerate();
    mean(texts.flat_map(|(at, a)| item.vectors[at + 1..].iter().map(move |b| cosine(a, b))))
}

/// The mean cosine of each item with items of other paths, drawn with replacement; with the path of the item.
fn random_pair_cosines<'a>(items: &[(&str, &'a ItemVectors<'_>)], seed: u64) -> Vec<(&'a str, f64)> {
    let mut paths: BTreeMap<&str, Vec<&ItemVectors<'_>>> = BTreeMap::new();
    for (_, item) in items {
        paths.entry(&item.cluster).or_default().push(item);
    }
    // Items are in the order of their paths, so an item of another path is before the first or after the last of its
    // own path.
    let mut first = BTreeMap::new();
    let mut ordered: Vec<&ItemVectors<'_>> = Vec::with_capacity(items.len());
    for (path, path_items) in &paths {
        first.insert(*path, ordered.len());
        ordered.extend(path_items);
    }
    let random_similarity = |(id, item): &(&str, &'a ItemVectors<'_>)| {
        let (first, count) = (first[&*item.cluster], paths[&*item.cluster].len());
        let others = ordered.len() - count;
        let mut rng = seeded_rng(seed, &["random pairs", id]);
        let drawn = (0..if others == 0 { 0 } else { RANDOM_PAIRS_PER_ITEM }).filter_map(|_| {
            let at = rng.random_range(0..others);
            mean_cosine_between(item, ordered[if at < first { at } else { at + count }])
        });
        Some((item.cluster.as_str(), mean(drawn)?))
    };
    items.iter().filter_map(random_similarity).collect()
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (total, count) = values.fold((0.0, 0usize), |(total, count), value| (total + value, count + 1));
    (count > 0).then(|| total / count as f64)
}

/// Cosine of the angle between two vectors; 0 where one has no direction.
fn cosine(a: &[f32], b: &[f32]) -> f64 {
    let dot = |a: &[f32], b: &[f32]| -> f64 { a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum() };
    let lengths = (dot(a, a) * dot(b, b)).sqrt();
    if lengths > 0.0 { (dot(a, b) / lengths).clamp(-1.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests;
