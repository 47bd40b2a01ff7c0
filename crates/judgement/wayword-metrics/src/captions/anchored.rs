//! Compares a set of texts with people's texts. BLEU and its like have no meaning by themselves, so the same figures are
//! computed for two anchors: another person's text about the item, and a person's text about another path.

use super::{BleuCounts, CaptionRow, CaptionScores, NumberedText, score_rows};
use crate::{MeanEstimate, ResamplingOptions, bootstrap::resampled_intervals};
use rand::Rng;
use serde::Serialize;
use std::collections::BTreeMap;
use wayword_core::seeded_rng;

/// The texts about one item.
#[derive(Debug, Clone)]
pub struct CaptionItem<'a> {
    /// The item's id. Draws for the item depend only on it and the seed.
    pub id: &'a str,
    /// The path that it is about: items of one path are not independent.
    pub cluster: &'a str,
    /// The text that is judged.
    pub text: &'a NumberedText,
    /// People's texts.
    pub references: Vec<&'a NumberedText>,
}

/// BLEU, ROUGE-L and CIDEr-D of a set of texts, each with its interval.
///
/// Intervals draw paths. BLEU is computed anew from the counts of each draw; CIDEr-D and ROUGE-L are means of the texts' own
/// figures, where CIDEr-D keeps the weights of n-grams that it has from all references.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaptionFigures {
    /// BLEU-1 to BLEU-4.
    pub bleu: [MeanEstimate; 4],
    /// ROUGE-L.
    pub rouge_l: MeanEstimate,
    /// CIDEr-D; often printed times 100. `None` for one text: how rare a word is cannot be told from one item, and the measure is 0 for
    /// every text.
    pub cider_d: Option<MeanEstimate>,
}

/// Figures of a set of texts and of the two anchors. `rest`, `person` and `other_path` can be compared with each other: all three
/// use the items with at least two references, and each item's references without the first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnchoredCaptionFigures {
    /// The texts against all references, as papers report it.
    pub all: Option<CaptionFigures>,
    /// The texts against all references but the first.
    pub rest: Option<CaptionFigures>,
    /// The first reference against the others: another person's text.
    pub person: Option<CaptionFigures>,
    /// The first reference of an item of another path, drawn at random, against the others. `None` where there is
    /// a single path.
    pub other_path: Option<CaptionFigures>,
    /// Items with a single reference, which are only in the first figures.
    pub single: usize,
}

/// The texts of all items and of the anchors, each with the references that it is compared with.
#[derive(Debug, Clone)]
pub struct CaptionRowSets<'a> {
    /// The texts against all references.
    pub all: Vec<CaptionRow<'a>>,
    /// The texts against all references but the first, of the items that have several. The rows of the anchors are of the same
    /// items, in the same order.
    pub rest: Vec<CaptionRow<'a>>,
    /// The first reference against the others.
    pub person: Vec<CaptionRow<'a>>,
    /// The first reference of another path against the others. `None` where there is a single path.
    pub other_path: Option<Vec<CaptionRow<'a>>>,
    /// The path of each item.
    clusters: Vec<&'a str>,
    /// The path of each item that has several references.
    clusters_of_several: Vec<&'a str>,
}

impl<'a> CaptionRowSets<'a> {
    /// The sets of items. Other paths are drawn by the seed.
    #[must_use]
    pub fn from_items(items: &[CaptionItem<'a>], seed: u64) -> Self {
        let items: Vec<&CaptionItem<'a>> = items.iter().filter(|item| !item.references.is_empty()).collect();
        let several: Vec<&CaptionItem<'a>> = items.iter().copied().filter(|item| item.references.len() > 1).collect();
        let against_rest = |texts: Vec<&'a NumberedText>| -> Vec<CaptionRow<'a>> {
            let rows = several.iter().zip(texts);
            rows.map(|(item, text)| CaptionRow { text, references: item.references[1..].to_vec() }).collect()
        };
        let all = items.iter().map(|item| CaptionRow { text: item.text, references: item.references.clone() });
        let clusters = |items: &[&CaptionItem<'a>]| items.iter().map(|item| item.cluster).collect();
        Self {
            all: all.collect(),
            rest: against_rest(several.iter().map(|item| item.text).collect()),
            person: against_rest(several.iter().map(|item| item.references[0]).collect()),
            other_path: other_path_texts(&several, seed).map(against_rest),
            clusters: clusters(&items),
            clusters_of_several: clusters(&several),
        }
    }
}

/// The figures of items' texts, and of the anchors.
#[must_use]
pub fn anchored_caption_figures(sets: &CaptionRowSets<'_>, drawing: &ResamplingOptions) -> AnchoredCaptionFigures {
    let figures_of_several =
        |rows: &[CaptionRow<'_>]| CaptionFigures::from_scores(&sets.clusters_of_several, &score_rows(rows), drawing);
    AnchoredCaptionFigures {
        all: CaptionFigures::from_scores(&sets.clusters, &score_rows(&sets.all), drawing),
        rest: figures_of_several(&sets.rest),
        person: figures_of_several(&sets.person),
        other_path: sets.other_path.as_deref().and_then(figures_of_several),
        single: sets.all.len() - sets.rest.len(),
    }
}

/// For each item, the first reference of an item of another path.
fn other_path_texts<'a>(items: &[&CaptionItem<'a>], seed: u64) -> Option<Vec<&'a NumberedText>> {
    let names: Vec<(&str, &str)> = items.iter().map(|item| (item.id, item.cluster)).collect();
    Some(draw_other_paths(&names, seed)?.into_iter().map(|at| items[at].references[0]).collect())
}

/// For each item, given by its id and its path, the number of an item of another path, drawn by the seed; `None` where there is
/// a single path.
#[must_use]
pub fn draw_other_paths(items: &[(&str, &str)], seed: u64) -> Option<Vec<usize>> {
    let mut by_path: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (at, (_, path)) in items.iter().enumerate() {
        by_path.entry(path).or_default().push(at);
    }
    // In the order of their paths, an item of another path is before the first or after the last of its own path.
    let mut ordered = Vec::with_capacity(items.len());
    let mut start = BTreeMap::new();
    for (path, path_items) in &by_path {
        start.insert(*path, ordered.len());
        ordered.extend(path_items);
    }
    let draw = |(id, path): &(&str, &str)| {
        let (first, count) = (start[path], by_path[path].len());
        let others = ordered.len() - count;
        let at = (others > 0).then(|| seeded_rng(seed, &["another path", id]).random_range(0..others))?;
        Some(ordered[if at < first { at } else { at + count }])
    };
    items.iter().map(draw).collect()
}

/// Sums over the texts of one path.
#[derive(Debug, Clone, Copy, Default)]
struct CaptionSum {
    counts: BleuCounts,
    rouge_l: f64,
    cider_d: f64,
    texts: usize,
}

impl CaptionSum {
    fn plus(mut self, other: Self) -> Self {
        self.counts += other.counts;
        self.rouge_l += other.rouge_l;
        self.cider_d += other.cider_d;
        self.texts += other.texts;
        self
    }

    /// BLEU-1 to BLEU-4, ROUGE-L and CIDEr-D.
    fn mean_figures(&self) -> [f64; 6] {
        let [one, two, three, four] = self.counts.bleu_scores();
        [one, two, three, four, self.rouge_l / self.texts as f64, self.cider_d / self.texts as f64]
    }
}

impl CaptionFigures {
    /// The figures of texts, each with the path that it is about; `None` without a text.
    #[must_use]
    pub fn from_scores(clusters: &[&str], scores: &[CaptionScores], drawing: &ResamplingOptions) -> Option<Self> {
        let mut sums: BTreeMap<&str, CaptionSum> = BTreeMap::new();
        for (cluster, score) in clusters.iter().zip(scores) {
            let text_sum =
                CaptionSum { counts: score.counts, rouge_l: score.rouge_l, cider_d: score.cider_d, texts: 1 };
            let sum = sums.entry(cluster).or_default();
            *sum = sum.plus(text_sum);
        }
        let sums: Vec<CaptionSum> = sums.into_values().collect();
        let total = |parts: &mut dyn Iterator<Item = CaptionSum>| parts.fold(CaptionSum::default(), CaptionSum::plus);
        let means = total(&mut sums.iter().copied());
        if means.texts == 0 {
            return None;
        }
        let figures = |drawn: &[usize]| total(&mut drawn.iter().map(|at| sums[*at])).mean_figures();
        let intervals = resampled_intervals(sums.len(), drawing, figures);
        let estimate = |at: usize| MeanEstimate {
            mean: means.mean_figures()[at],
            low: intervals[at].0,
            high: intervals[at].1,
            values: means.texts,
            clusters: sums.len(),
        };
        Some(Self {
            bleu: std::array::from_fn(estimate),
            rouge_l: estimate(4),
            cider_d: (means.texts > 1).then(|| estimate(5)),
        })
    }
}
