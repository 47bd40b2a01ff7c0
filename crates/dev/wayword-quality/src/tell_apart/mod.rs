//! Measures how well a plain classifier separates generated texts from people's. If it can do no better than chance, the texts are alike in
//! their words.
//!
//! The classifier is a logistic regression on runs of words and the length. It is cross-validated by building: it judges texts of
//! buildings that were not in its training data. It shares no code with the writer or the checks.

mod grams;
mod logistic;

use crate::share::{ClusteredShare, area_under_curve};
use clap::Args;
use grams::{GramFeatures, to_plain, word_grams};
use logistic::{LogisticModel, SparseRow};
use rand::seq::IndexedRandom;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};
use wayword_core::seeded_rng;
use wayword_formats::Episode;
use wayword_run::{error::CommandError, output::CommandOutput};

/// The cost of errors relative to the ridge penalty: scikit-learn's C.
const ERROR_COST: f64 = 0.3;

/// The flags of `tell-apart`.
#[derive(Debug, Args)]
#[command(after_help = "\
Accuracy 50 % means that the texts cannot be told apart. Read it beside a figure of content (`texts`, `wayword check`):
a text about nothing cannot be told from a person's either. \"people\" compares the people's first texts with their
second ones, by the same classifier.")]
pub struct TellApartArgs {
    /// People's texts: a dataset file of any format.
    people: PathBuf,
    /// Generated texts of the same items.
    generated: PathBuf,
    /// Seed of the choice of one text of each side per item, and of the interval.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Parts that the buildings are left out in.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u64).range(2..=100))]
    folds: u64,
    /// Show this many runs of words that give the generated texts away, and as many that give people's away.
    #[arg(long, default_value_t = 0)]
    show: usize,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// How well the classifier separates two sides.
#[derive(Debug, Serialize)]
struct SideSeparation {
    /// The items with a text on each side.
    items: usize,
    /// The buildings of these items.
    buildings: usize,
    /// The share of texts that the classifier puts on the right side, with an interval over buildings.
    accuracy: Option<ClusteredShare>,
    /// The chance that a generated text scores higher than a person's.
    auc: f64,
}

/// The figures that are printed.
#[derive(Debug, Serialize)]
struct TellApartReport {
    /// Generated texts against people's.
    apart: SideSeparation,
    /// People's first texts against their second ones, where items have two.
    people: Option<SideSeparation>,
    /// The runs of words that separate the sides best: those of generated texts first, then those of people's.
    tells: Vec<TellingGram>,
}

/// A run of words that is much more frequent on one side.
#[derive(Debug, Clone, Serialize)]
struct TellingGram {
    words: String,
    /// Its weight, above 0 for generated texts.
    weight: f64,
    /// Share of the generated texts that have it.
    generated: f64,
    /// Share of the people's texts that have it.
    people: f64,
}

/// Tells generated texts from people's, and prints how well that works and by which words.
///
/// # Errors
/// When a file cannot be read, or no item has texts in both.
pub fn measure_tell_apart(flags: &TellApartArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let people = group_by_item(wayword_formats::read_any_format(&flags.people)?);
    let generated = group_by_item(wayword_formats::read_any_format(&flags.generated)?);
    let texts = draw_sides(&people, &generated, flags.seed);
    if texts.is_empty() {
        return Err(CommandError::usage("no item has texts in both files", "give files of the same items"));
    }
    let folds = flags.folds as usize;
    let pairs = pair_people_texts(&people);
    let measured = TellApartReport {
        apart: separate_sides(&texts, folds, flags.seed),
        people: (!pairs.is_empty()).then(|| separate_sides(&pairs, folds, flags.seed)),
        tells: telling_grams(&texts, flags.show),
    };
    output.print_result(&measured, report_lines(&measured).join("\n"));
    Ok(())
}

/// The texts of an item, and its building.
struct SideItem {
    building: String,
    /// Its texts in plain words ([`to_plain`]).
    texts: Vec<String>,
}

/// The texts of a file by the id of their item.
fn group_by_item(episodes: Vec<Episode>) -> BTreeMap<String, SideItem> {
    let mut items: BTreeMap<String, SideItem> = BTreeMap::new();
    for Episode { id, scene, instructions, .. } in episodes {
        let item = items.entry(id).or_insert_with(|| SideItem { building: scene.to_string(), texts: Vec::new() });
        item.texts.extend(instructions.iter().map(|text| to_plain(text)));
    }
    items
}

/// A text of one side.
#[derive(Debug, Clone)]
struct SideText {
    /// The text in plain words ([`to_plain`]).
    plain: String,
    building: String,
    is_generated: bool,
}

/// One text of each side for each item that both have.
fn draw_sides(people: &BTreeMap<String, SideItem>, generated: &BTreeMap<String, SideItem>, seed: u64) -> Vec<SideText> {
    let pair = |(id, item): (&String, &SideItem)| {
        let draw_text =
            |texts: &[String], side: &str| texts.choose(&mut seeded_rng(seed, &["tell-apart", side, id])).cloned();
        let other = draw_text(&generated.get(id)?.texts, "generated")?;
        Some(pair_texts(item, draw_text(&item.texts, "people")?, other))
    };
    people.iter().filter_map(pair).flatten().collect()
}

/// People's first texts, and their second ones in the place of generated texts.
fn pair_people_texts(people: &BTreeMap<String, SideItem>) -> Vec<SideText> {
    let pair = |item: &SideItem| Some(pair_texts(item, item.texts.first()?.clone(), item.texts.get(1)?.clone()));
    people.values().filter_map(pair).flatten().collect()
}

fn pair_texts(item: &SideItem, person: String, other: String) -> [SideText; 2] {
    let text = |plain, is_generated| SideText { plain, building: item.building.clone(), is_generated };
    [text(person, false), text(other, true)]
}

/// How well the classifier separates two sides, cross-validated by building.
fn separate_sides(texts: &[SideText], folds: usize, seed: u64) -> SideSeparation {
    let scores = cross_validated_scores(texts, folds);
    let right = texts.iter().zip(&scores).map(|(text, score)| (&text.building, (*score > 0.0) == text.is_generated));
    let buildings: BTreeSet<&String> = texts.iter().map(|text| &text.building).collect();
    SideSeparation {
        items: texts.len() / 2,
        buildings: buildings.len(),
        accuracy: ClusteredShare::from_cases(right, seed),
        auc: area_under_curve(texts.iter().map(|text| text.is_generated).zip(scores.iter().copied()).collect()),
    }
}

/// The score of each text by a classifier that never saw its building.
fn cross_validated_scores(texts: &[SideText], folds: usize) -> Vec<f64> {
    let runs: Vec<BTreeSet<String>> = texts.iter().map(|text| word_grams(&text.plain)).collect();
    let folds_by_building = assign_folds(texts, folds);
    let mut scores = vec![0.0; texts.len()];
    for fold in 0..folds {
        let (left_out, rest): (Vec<usize>, Vec<usize>) =
            (0..texts.len()).partition(|at| folds_by_building[&texts[*at].building] == fold);
        let (features, model) = fit_classifier(texts, &runs, &rest);
        for at in left_out {
            scores[at] = model.score_row(&features.feature_row(&texts[at].plain, &runs[at]));
        }
    }
    scores
}

/// The features and the classifier of some of the texts. `runs`: the runs of words of all texts; `chosen`: the numbers
/// of the texts to learn from.
fn fit_classifier(texts: &[SideText], runs: &[BTreeSet<String>], chosen: &[usize]) -> (GramFeatures, LogisticModel) {
    let features = GramFeatures::from_texts(chosen.iter().map(|at| &runs[*at]));
    let rows: Vec<SparseRow> = chosen.iter().map(|at| features.feature_row(&texts[*at].plain, &runs[*at])).collect();
    let classes: Vec<bool> = chosen.iter().map(|at| texts[*at].is_generated).collect();
    let model = LogisticModel::fit_rows(&rows.iter().collect::<Vec<_>>(), &classes, features.len(), ERROR_COST);
    (features, model)
}

/// The part of each building: the largest buildings first, each into the part with the fewest texts.
fn assign_folds(texts: &[SideText], folds: usize) -> BTreeMap<String, usize> {
    let mut sizes: BTreeMap<&String, usize> = BTreeMap::new();
    texts.iter().for_each(|text| *sizes.entry(&text.building).or_default() += 1);
    let mut sizes: Vec<(&String, usize)> = sizes.into_iter().collect();
    sizes.sort_by_key(|(_, size)| std::cmp::Reverse(*size));
    let mut filled = vec![0; folds];
    let place = |(building, size): (&String, usize)| {
        let least = (0..folds).min_by_key(|fold| filled[*fold]).unwrap_or(0);
        filled[least] += size;
        (building.clone(), least)
    };
    sizes.into_iter().map(place).collect()
}

/// The runs of words with the greatest weights, of a classifier that saw all texts.
fn telling_grams(texts: &[SideText], show: usize) -> Vec<TellingGram> {
    if show == 0 {
        return Vec::new();
    }
    let runs: Vec<BTreeSet<String>> = texts.iter().map(|text| word_grams(&text.plain)).collect();
    let (features, model) = fit_classifier(texts, &runs, &(0..texts.len()).collect::<Vec<_>>());
    let mut places: Vec<(&str, f64)> = features.gram_places().map(|(words, at)| (words, model.weights[at])).collect();
    places.sort_by(|a, b| b.1.total_cmp(&a.1));
    let share = |words: &str, is_generated: bool| {
        let of_side = || texts.iter().zip(&runs).filter(|(text, _)| text.is_generated == is_generated);
        of_side().filter(|(_, runs)| runs.contains(words)).count() as f64 / of_side().count().max(1) as f64
    };
    let tell = |(words, weight): &(&str, f64)| TellingGram {
        words: (*words).to_owned(),
        weight: (weight * 1e3).round() / 1e3,
        generated: share(words, true),
        people: share(words, false),
    };
    let last = places.iter().rev().take(show);
    places.iter().take(show).chain(last).map(tell).collect()
}

fn report_lines(measured: &TellApartReport) -> Vec<String> {
    let line = |name: &str, apart: &SideSeparation| {
        let accuracy = apart.accuracy.as_ref().map(ClusteredShare::to_string).unwrap_or_default();
        let SideSeparation { items, buildings, auc, .. } = apart;
        format!("{name:<10} told apart {accuracy}, AUC {auc:.3}, {items} items in {buildings} buildings")
    };
    let tell = |tell: &TellingGram| {
        let [generated, people] = [tell.generated, tell.people].map(|share| 100.0 * share);
        format!("{:>7.3}  generated {generated:>5.1} %  people {people:>5.1} %  {}", tell.weight, tell.words)
    };
    let mut lines = vec![line("generated", &measured.apart)];
    lines.extend(measured.people.as_ref().map(|people| line("people", people)));
    lines.extend(measured.tells.iter().map(tell));
    lines
}

#[cfg(test)]
mod tests;
