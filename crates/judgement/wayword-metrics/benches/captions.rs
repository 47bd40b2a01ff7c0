//! BLEU, ROUGE-L and CIDEr-D of the made corpora as one, from tokens. `fixtures/make_captions.py --time` times `pycocoevalcap` on the
//! same tokens.

#![allow(clippy::unwrap_used, reason = "a bench fails by panicking")]

use criterion::{Criterion, criterion_group, criterion_main};
use serde_json::Value;
use std::hint::black_box;
use wayword_metrics::captions::{CaptionRow, CaptionVocabulary, NumberedText, score_rows};

/// For each item the tokens of its text, and of its references after it.
fn items() -> Vec<Vec<Vec<String>>> {
    let file = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/captions.json")).unwrap();
    let corpora: Vec<Value> = serde_json::from_str(&file).unwrap();
    let tokens = |line: &Value| line.as_str().unwrap().split_whitespace().map(str::to_owned).collect();
    let of_item = |item: &Value| {
        std::iter::once(&item["text"]).chain(item["references"].as_array().unwrap()).map(tokens).collect()
    };
    corpora.iter().flat_map(|corpus| corpus["ptb"]["tokens"].as_array().unwrap().iter().map(of_item)).collect()
}

fn captions(criterion: &mut Criterion) {
    let items = items();
    criterion.bench_function("captions", |bencher| {
        bencher.iter(|| {
            let mut vocabulary = CaptionVocabulary::default();
            let texts: Vec<Vec<NumberedText>> =
                items.iter().map(|item| item.iter().map(|tokens| vocabulary.number_text(tokens)).collect()).collect();
            let rows: Vec<CaptionRow<'_>> = texts
                .iter()
                .map(|texts| CaptionRow { text: &texts[0], references: texts[1..].iter().collect() })
                .collect();
            black_box(score_rows(&rows))
        });
    });
}

criterion_group!(benches, captions);
criterion_main!(benches);
