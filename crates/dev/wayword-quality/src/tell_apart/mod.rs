//! Measures how well a plain classifier separates generated texts from people's. If it can do no better than chance, the texts are alike in
//! their words.
//!
//! The classifier is a logistic regression on runs of words and the length. It is cross-validated by building: it judges texts of
//! buildings that were not in its training data. It shares no code with the writer or the checks.

mod grams;
mod logistic;

use crate::share::Share;
use clap::Args;
use grams::{Features, grams, plain};
use logistic::{Model, Row};
use rand::seq::IndexedRandom;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};
use wayword_core::rng;
use wayword_formats::Episode;
use wayword_run::{error::Error, output::Output};

/// The cost of errors relative to the ridge penalty: scikit-learn's C.
const COST: f64 = 0.3;

/// The flags of `tell-apart`.
#[derive(Debug, Args)]
#[command(after_help = "\
Accuracy 50 % means that the texts cannot be told apart. Read it beside a figure of content (`texts`, `wayword check`):
a text about nothing cannot be told from a person's either. \"people\" compares the people's first texts with their
second ones, by the same classifier.")]
pub struct Flags {
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
struct Apart {
    items: usize,
    buildings: usize,
    /// The share of texts that the classifier puts on the right side, with an interval over buildings.
    accuracy: Option<Share>,
    /// The chance that a generated text scores higher than a person's.
    auc: f64,
}

#[derive(Debug, Serialize)]
struct Measured {
    apart: Apart,
    /// People's first texts against their second ones, where items have two.
    people: Option<Apart>,
    /// The runs of words that separate the sides best: those of generated texts first, then those of people's.
    tells: Vec<Tell>,
}

/// A run of words that is much more frequent on one side.
#[derive(Debug, Clone, Serialize)]
struct Tell {
    words: String,
    /// Its weight, above 0 for generated texts.
    weight: f64,
    /// Share of the generated texts that have it.
    generated: f64,
    /// Share of the people's texts that have it.
    people: f64,
}

pub fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let people = by_item(wayword_formats::read(&flags.people)?);
    let generated = by_item(wayword_formats::read(&flags.generated)?);
    let texts = drawn(&people, &generated, flags.seed);
    if texts.is_empty() {
        return Err(Error::usage("no item has texts in both files", "give files of the same items"));
    }
    let folds = flags.folds as usize;
    let pairs = first_and_second(&people);
    let measured = Measured {
        apart: apart(&texts, folds, flags.seed),
        people: (!pairs.is_empty()).then(|| apart(&pairs, folds, flags.seed)),
        tells: tells(&texts, flags.show),
    };
    output.data(&measured, lines(&measured).join("\n"));
    Ok(())
}

/// The texts of an item, and its building.
struct Item {
    building: String,
    texts: Vec<String>,
}

fn by_item(episodes: Vec<Episode>) -> BTreeMap<String, Item> {
    let mut items: BTreeMap<String, Item> = BTreeMap::new();
    for Episode { id, scene, instructions, .. } in episodes {
        let item = items.entry(id).or_insert_with(|| Item { building: scene.to_string(), texts: Vec::new() });
        item.texts.extend(instructions.iter().map(|text| plain(text)));
    }
    items
}

/// A text of one side.
#[derive(Debug, Clone)]
struct Text {
    plain: String,
    building: String,
    is_generated: bool,
}

/// One text of each side for each item that both have.
fn drawn(people: &BTreeMap<String, Item>, generated: &BTreeMap<String, Item>, seed: u64) -> Vec<Text> {
    let pair = |(id, item): (&String, &Item)| {
        let one = |texts: &[String], side: &str| texts.choose(&mut rng(seed, &["tell-apart", side, id])).cloned();
        let other = one(&generated.get(id)?.texts, "generated")?;
        Some(sides(item, one(&item.texts, "people")?, other))
    };
    people.iter().filter_map(pair).flatten().collect()
}

/// People's first texts, and their second ones in the place of generated texts.
fn first_and_second(people: &BTreeMap<String, Item>) -> Vec<Text> {
    let pair = |item: &Item| Some(sides(item, item.texts.first()?.clone(), item.texts.get(1)?.clone()));
    people.values().filter_map(pair).flatten().collect()
}

fn sides(item: &Item, person: String, other: String) -> [Text; 2] {
    let text = |plain, is_generated| Text { plain, building: item.building.clone(), is_generated };
    [text(person, false), text(other, true)]
}

fn apart(texts: &[Text], folds: usize, seed: u64) -> Apart {
    let scores = scores(texts, folds);
    let right = texts.iter().zip(&scores).map(|(text, score)| (&text.building, (*score > 0.0) == text.is_generated));
    let buildings: BTreeSet<&String> = texts.iter().map(|text| &text.building).collect();
    Apart {
        items: texts.len() / 2,
        buildings: buildings.len(),
        accuracy: Share::of(right, seed),
        auc: auc(texts.iter().map(|text| text.is_generated).zip(scores.iter().copied()).collect()),
    }
}

/// The score of each text by a classifier that never saw its building.
fn scores(texts: &[Text], folds: usize) -> Vec<f64> {
    let runs: Vec<BTreeSet<String>> = texts.iter().map(|text| grams(&text.plain)).collect();
    let fold_of = fold_of(texts, folds);
    let mut scores = vec![0.0; texts.len()];
    for fold in 0..folds {
        let (out, rest): (Vec<usize>, Vec<usize>) =
            (0..texts.len()).partition(|at| fold_of[&texts[*at].building] == fold);
        let (features, model) = fit(texts, &runs, &rest);
        for at in out {
            scores[at] = model.score(&features.row(&texts[at].plain, &runs[at]));
        }
    }
    scores
}

fn fit(texts: &[Text], runs: &[BTreeSet<String>], on: &[usize]) -> (Features, Model) {
    let features = Features::of(on.iter().map(|at| &runs[*at]));
    let rows: Vec<Row> = on.iter().map(|at| features.row(&texts[*at].plain, &runs[*at])).collect();
    let classes: Vec<bool> = on.iter().map(|at| texts[*at].is_generated).collect();
    let model = Model::fit(&rows.iter().collect::<Vec<_>>(), &classes, features.len(), COST);
    (features, model)
}

/// The part of each building: the largest buildings first, each into the part with the fewest texts.
fn fold_of(texts: &[Text], folds: usize) -> BTreeMap<String, usize> {
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

/// The area under the curve of hits over false alarms; 0.5 where one side is empty.
fn auc(mut scored: Vec<(bool, f64)>) -> f64 {
    scored.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (mut below, mut won) = (0.0, 0.0);
    for same in scored.chunk_by(|a, b| a.1 == b.1) {
        let positive = same.iter().filter(|(is_generated, _)| *is_generated).count() as f64;
        let negative = same.len() as f64 - positive;
        won += positive * (below + negative / 2.0);
        below += negative;
    }
    let positive = scored.len() as f64 - below;
    if positive * below > 0.0 { won / (positive * below) } else { 0.5 }
}

/// The runs of words with the greatest weights, of a classifier that saw all texts.
fn tells(texts: &[Text], show: usize) -> Vec<Tell> {
    if show == 0 {
        return Vec::new();
    }
    let runs: Vec<BTreeSet<String>> = texts.iter().map(|text| grams(&text.plain)).collect();
    let (features, model) = fit(texts, &runs, &(0..texts.len()).collect::<Vec<_>>());
    let mut places: Vec<(&str, f64)> = features.places().map(|(words, at)| (words, model.weights[at])).collect();
    places.sort_by(|a, b| b.1.total_cmp(&a.1));
    let share = |words: &str, is_generated: bool| {
        let of_side = || texts.iter().zip(&runs).filter(|(text, _)| text.is_generated == is_generated);
        of_side().filter(|(_, runs)| runs.contains(words)).count() as f64 / of_side().count().max(1) as f64
    };
    let tell = |(words, weight): &(&str, f64)| Tell {
        words: (*words).to_owned(),
        weight: (weight * 1e3).round() / 1e3,
        generated: share(words, true),
        people: share(words, false),
    };
    let last = places.iter().rev().take(show);
    places.iter().take(show).chain(last).map(tell).collect()
}

fn lines(measured: &Measured) -> Vec<String> {
    let line = |name: &str, apart: &Apart| {
        let accuracy = apart.accuracy.as_ref().map(Share::to_string).unwrap_or_default();
        let Apart { items, buildings, auc, .. } = apart;
        format!("{name:<10} told apart {accuracy}, AUC {auc:.3}, {items} items in {buildings} buildings")
    };
    let tell = |tell: &Tell| {
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
