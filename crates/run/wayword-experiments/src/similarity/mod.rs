//! `wayword similarity`: how similar two sets of instructions are, by the cosine of sentence vectors or by text metrics.

pub mod args;
mod java;
mod metrics;
mod pictures;

use crate::{
    encoder,
    similarity::args::Similarity as Args,
    texts::{self, Items},
};
use serde::Serialize;
use std::{collections::BTreeMap, fmt};
use wayword_metrics::{Drawing, Estimate, Said, Similarity, similarity};
use wayword_run::{
    count::count,
    error::{Error, Exit},
    output::Output,
};

/// Confidence level of the intervals.
const LEVEL: f64 = 0.95;

pub fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let sides = [&args.a, &args.b].map(|name| texts::set(name, args.style.as_deref(), args.by));
    let [a, b] = sides;
    let (a, b) = (a?, b?);
    if !a.keys().any(|item| b.contains_key(item)) {
        let problem = format!("{} and {} have no item in common", args.a, args.b);
        return Err(Error::usage(problem, "items are matched by id; --by path matches them by scene and path"));
    }
    if args.pictured.clip.is_some() && !args.metrics {
        return Err(Error::usage("--clip is a metric, and none are asked for", "give --metrics too"));
    }
    if args.metrics {
        let report = metrics::of(args, (&a, &b), output)?;
        output.data(&report, &report);
        return Ok(Exit::Done);
    }
    let encoder = encoder::encoder(&args.encoder)?;
    let all = a.values().chain(b.values()).flat_map(|item| item.texts.iter().map(String::as_str));
    let vectors = encoder::vectors(encoder.as_ref(), all, output)?;
    let drawing = Drawing { resamples: args.resamples as usize, level: LEVEL, seed: args.seed };
    let report = Report {
        encoder: encoder.name().to_owned(),
        a: Compared::of(&args.a, &a),
        b: Compared::of(&args.b, &b),
        level: LEVEL,
        similarity: similarity(&said(&a, &vectors), &said(&b, &vectors), &drawing),
    };
    output.data(&report, &report);
    Ok(Exit::Done)
}

fn said<'a>(items: &'a Items, vectors: &'a BTreeMap<&str, Vec<f32>>) -> BTreeMap<String, Said<'a>> {
    let of = |item: &'a texts::Texts| Said {
        cluster: item.path.clone(),
        vectors: item.texts.iter().filter_map(|text| vectors.get(text.as_str()).map(Vec::as_slice)).collect(),
    };
    items.iter().map(|(id, item)| (id.clone(), of(item))).collect()
}

/// The similarity of two sets of texts.
#[derive(Serialize)]
struct Report {
    encoder: String,
    a: Compared,
    b: Compared,
    /// Confidence level of the intervals.
    level: f64,
    #[serde(flatten)]
    similarity: Similarity,
}

/// One of the two sets, with its size.
#[derive(Serialize)]
struct Compared {
    name: String,
    items: usize,
    texts: usize,
}

impl Compared {
    fn of(name: &str, items: &Items) -> Self {
        let texts = items.values().map(|item| item.texts.len()).sum();
        Self { name: name.to_owned(), items: items.len(), texts }
    }
}

fn sides(f: &mut fmt::Formatter<'_>, [a, b]: [&Compared; 2]) -> fmt::Result {
    for (letter, side) in [("A", a), ("B", b)] {
        writeln!(f, "{letter}: {}, {}, {}", side.name, count(side.items, "item"), count(side.texts, "text"))?;
    }
    Ok(())
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        sides(f, [&self.a, &self.b])?;
        let is_model = self.encoder != "words";
        writeln!(f, "encoder: {}{}", self.encoder, if is_model { "" } else { " (word counts, no model)" })?;
        let Similarity { figure, same_item, random_pairs, only_in_a, only_in_b, single_in_b } = &self.similarity;
        let interval = format!("{:.0} % interval", self.level * 100.0);
        writeln!(f, "{:<38} {:>6}   {interval:<15} {:>6} {:>6}", "mean cosine", "mean", "items", "paths")?;
        row(f, "A against B, same item", figure.as_ref())?;
        row(f, "B: two texts of an item", same_item.as_ref())?;
        row(f, "B: texts of two paths, at random", random_pairs.as_ref())?;
        writeln!(f, "only in A: {}; only in B: {only_in_b}", count(*only_in_a, "item"))?;
        write!(f, "left out of the second row, because B has one text for them: {}", count(*single_in_b, "item"))
    }
}

fn row(f: &mut fmt::Formatter<'_>, name: &str, estimate: Option<&Estimate>) -> fmt::Result {
    match estimate {
        Some(Estimate { mean, low, high, values, clusters }) => {
            writeln!(f, "{name:<38} {mean:>6.3}   {low:.3} to {high:.3}  {values:>6} {clusters:>6}")
        }
        None => writeln!(f, "{name:<38} {:>6}   nothing to measure", "-"),
    }
}
