//! `wayword similarity`: how similar two sets of instructions are, by the cosine of sentence vectors or by text metrics.

pub mod args;
mod java;
mod language;
mod metrics;
mod pictures;

use crate::{
    encoder::{self, WORD_ENCODER},
    similarity::args::{MetricTokens, SimilarityArgs as Args, TextPairing},
    text_sets::{self, TextSet},
};
use serde::Serialize;
use std::{collections::BTreeMap, fmt};
use wayword_metrics::{ItemVectors, MeanEstimate, ResamplingOptions, SetSimilarity, compare_sets};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
};

/// Confidence level of the intervals.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// Runs `wayword similarity`: compares two sets of texts item by item, and prints the report.
///
/// # Errors
/// When a set cannot be read, the sets have no item in common, the flags do not fit together, or the encoder fails.
pub fn run_similarity(args: &Args, output: &CommandOutput) -> Result<Exit, CommandError> {
    let sides = [&args.a, &args.b].map(|name| text_sets::read_text_set(name, args.style.as_deref(), args.by));
    let [a, b] = sides;
    let (a, b) = (a?, b?);
    if !a.keys().any(|item| b.contains_key(item)) {
        let problem = format!("{} and {} have no item in common", args.a, args.b);
        let hint = match args.by {
            TextPairing::Item => "items are matched by id; --by path matches them by scene and path",
            TextPairing::Path => "they are matched by scene and path id: give texts about the same paths",
        };
        return Err(CommandError::usage(problem, hint));
    }
    if args.pictured.clip.is_some() && !args.metrics {
        return Err(CommandError::usage("--clip is a metric, and none are asked for", "give --metrics too"));
    }
    let sides = [(args.a.as_str(), &a), (args.b.as_str(), &b)];
    if args.metrics {
        let language = language::refuse_other_languages(sides, true, output)?;
        let tokens = args.tokens.unwrap_or_else(|| MetricTokens::for_language(language));
        if tokens != MetricTokens::Characters {
            language::warn_of_english_rules(language, output);
        }
        let report = metrics::measure_texts(args, tokens, (&a, &b), output)?;
        warn_of_same_texts(&a, &b, output);
        output.print_result(&report, &report);
        return Ok(Exit::Done);
    }
    let encoder = encoder::open_encoder(&args.encoder)?;
    let language = language::refuse_other_languages(sides, encoder.name() == WORD_ENCODER, output)?;
    language::warn_of_english_rules(language, output);
    let all = a.values().chain(b.values()).flat_map(|item| item.texts.iter().map(String::as_str));
    let vectors = encoder::encode_texts(encoder.as_ref(), all, output)?;
    let drawing = ResamplingOptions { resamples: args.resamples as usize, level: CONFIDENCE_LEVEL, seed: args.seed };
    let report = SimilarityReport {
        encoder: encoder.name().to_owned(),
        a: SimilaritySide::from_items(&args.a, &a),
        b: SimilaritySide::from_items(&args.b, &b),
        level: CONFIDENCE_LEVEL,
        similarity: compare_sets(&vectors_by_item(&a, &vectors), &vectors_by_item(&b, &vectors), &drawing),
    };
    warn_of_same_texts(&a, &b, output);
    output.print_result(&report, &report);
    Ok(Exit::Done)
}

/// Warns of a set that is compared with itself.
fn warn_of_same_texts(a: &TextSet, b: &TextSet, output: &CommandOutput) {
    if a.values().map(|item| &item.texts).eq(b.values().map(|item| &item.texts)) {
        output.say("warning: A and B are the same texts, so the figures are as high as they can be");
    }
}

fn vectors_by_item<'a>(items: &'a TextSet, vectors: &'a BTreeMap<&str, Vec<f32>>) -> BTreeMap<String, ItemVectors<'a>> {
    let item_vectors = |item: &'a text_sets::ItemTexts| ItemVectors {
        cluster: item.path.clone(),
        vectors: item.texts.iter().filter_map(|text| vectors.get(text.as_str()).map(Vec::as_slice)).collect(),
    };
    items.iter().map(|(id, item)| (id.clone(), item_vectors(item))).collect()
}

/// The similarity of two sets of texts.
#[derive(Serialize)]
struct SimilarityReport {
    encoder: String,
    a: SimilaritySide,
    b: SimilaritySide,
    /// Confidence level of the intervals.
    level: f64,
    #[serde(flatten)]
    similarity: SetSimilarity,
}

/// One of the two sets, with its size.
#[derive(Serialize)]
struct SimilaritySide {
    name: String,
    items: usize,
    texts: usize,
}

impl SimilaritySide {
    fn from_items(name: &str, items: &TextSet) -> Self {
        let texts = items.values().map(|item| item.texts.len()).sum();
        Self { name: name.to_owned(), items: items.len(), texts }
    }
}

fn write_sides(f: &mut fmt::Formatter<'_>, [a, b]: [&SimilaritySide; 2]) -> fmt::Result {
    for (letter, side) in [("A", a), ("B", b)] {
        writeln!(
            f,
            "{letter}: {}, {}, {}",
            side.name,
            count_phrase(side.items, "item"),
            count_phrase(side.texts, "text")
        )?;
    }
    Ok(())
}

/// A share and its interval in percent.
fn format_percent(estimate: &MeanEstimate) -> String {
    let percent = |value: f64| format!("{:.1}", value * 100.0);
    let interval = estimate.interval().map(|[low, high]| format!(" ({} to {})", percent(low), percent(high)));
    percent(estimate.mean) + &interval.unwrap_or_default()
}

impl fmt::Display for SimilarityReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_sides(f, [&self.a, &self.b])?;
        let is_model = self.encoder != WORD_ENCODER;
        writeln!(f, "encoder: {}{}", self.encoder, if is_model { "" } else { " (word counts, no model)" })?;
        let SetSimilarity { figure, same_item, random_pairs, only_in_a, only_in_b, single_in_b } = &self.similarity;
        let interval = format!("{:.0} % interval", self.level * 100.0);
        writeln!(f, "{:<38} {:>6}   {interval:<15} {:>6} {:>6}", "mean cosine", "mean", "items", "paths")?;
        write_cosine_row(f, "A against B, same item", figure.as_ref())?;
        write_cosine_row(f, "B: two texts of an item", same_item.as_ref())?;
        write_cosine_row(f, "B: texts of two paths, at random", random_pairs.as_ref())?;
        writeln!(f, "only in A: {}; only in B: {only_in_b}", count_phrase(*only_in_a, "item"))?;
        write!(f, "left out of the second row, because B has one text for them: {}", count_phrase(*single_in_b, "item"))
    }
}

fn write_cosine_row(f: &mut fmt::Formatter<'_>, name: &str, estimate: Option<&MeanEstimate>) -> fmt::Result {
    match estimate {
        Some(estimate) => {
            let interval = estimate.interval().map(|[low, high]| format!("{low:.3} to {high:.3}"));
            let MeanEstimate { mean, values, clusters, .. } = estimate;
            let interval = interval.unwrap_or_else(|| "one path".to_owned());
            writeln!(f, "{name:<38} {mean:>6.3}   {interval:<14}  {values:>6} {clusters:>6}")
        }
        None => writeln!(f, "{name:<38} {:>6}   nothing to measure", "-"),
    }
}
