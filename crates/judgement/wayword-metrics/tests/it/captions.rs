//! Tokens and figures against those of `pycocoevalcap` (`fixtures/make_captions.py`): on made corpora, which are in the
//! repository; on more of them, where `WAYWORD_CAPTIONS` names a file that the script made; and on real texts, where
//! `WAYWORD_CAPTIONS_REAL` names the figures and `WAYWORD_DATA` the folder of the data.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or measured"
)]

use serde_json::Value;
use std::path::{Path, PathBuf};
use wayword_metrics::captions::{
    BleuCounts, CaptionRow, CaptionVocabulary, NumberedText, ptb_tokens, score_rows, split_tokens,
};

/// Makes words of a text.
type Tokenizer = fn(&str) -> Vec<String>;

const TOKENIZERS: [(&str, Tokenizer); 2] = [("ptb", ptb_tokens), ("split", split_tokens)];

/// How far figures may differ from those of the reference, which adds numbers in another order.
const TOLERANCE: f64 = 1e-9;

fn json(file: impl AsRef<Path>) -> Value {
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn strings(value: &Value) -> Vec<&str> {
    value.as_array().unwrap().iter().map(|text| text.as_str().unwrap()).collect()
}

/// An item's text, and its references after it.
fn all_of(item: &Value) -> Vec<&str> {
    [vec![item["text"].as_str().unwrap()], strings(&item["references"])].concat()
}

/// The greatest difference to the expected figures, of BLEU, ROUGE-L and CIDEr-D, over the corpus and its items.
fn differences(items: &[Vec<Vec<String>>], expected: &Value) -> [f64; 3] {
    let mut vocabulary = CaptionVocabulary::default();
    let texts: Vec<Vec<NumberedText>> =
        items.iter().map(|item| item.iter().map(|tokens| vocabulary.number_text(tokens)).collect()).collect();
    let row = |texts: &'static [NumberedText]| CaptionRow { text: &texts[0], references: texts[1..].iter().collect() };
    let rows: Vec<CaptionRow<'_>> = texts.leak().iter().map(|texts| row(texts)).collect();
    let found = score_rows(&rows);
    let mut worst = [0.0; 3];
    let mut compare = |at: usize, found: f64, expected: &Value| {
        worst[at] = f64::max(worst[at], (found - expected.as_f64().unwrap()).abs());
    };
    let counts = found.iter().map(|score| score.counts).fold(BleuCounts::default(), |sum, counts| sum + counts);
    counts
        .bleu_scores()
        .iter()
        .zip(expected["bleu"].as_array().unwrap())
        .for_each(|(bleu, value)| compare(0, *bleu, value));
    let mean = |of: fn(&wayword_metrics::captions::CaptionScores) -> f64| {
        found.iter().map(of).sum::<f64>() / found.len() as f64
    };
    compare(1, mean(|score| score.rouge_l), &expected["rouge_l"]);
    compare(2, mean(|score| score.cider_d), &expected["cider_d"]);
    for (score, expected) in found.iter().zip(expected["of_items"].as_array().unwrap()) {
        compare(0, score.counts.bleu_scores()[3], &expected[0]);
        compare(1, score.rouge_l, &expected[1]);
        compare(2, score.cider_d, &expected[2]);
    }
    worst
}

fn greatest(all: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    all.fold([0.0; 3], |worst, one| std::array::from_fn(|at| f64::max(worst[at], one[at])))
}

fn assert_made_corpora_agree(corpora: &Value) {
    for (name, tokenize) in TOKENIZERS {
        for is_latin in [false, true] {
            let of_kind = corpora.as_array().unwrap().iter().filter(|corpus| corpus["is_latin"] == is_latin);
            let mut texts = 0;
            let worst = greatest(of_kind.clone().map(|corpus| {
                let mut items = Vec::new();
                let tokens = corpus[name]["tokens"].as_array().unwrap();
                for (item, expected) in corpus["items"].as_array().unwrap().iter().zip(tokens) {
                    let (said, expected) = (all_of(item), all_of(expected));
                    let found: Vec<Vec<String>> = said.iter().map(|text| tokenize(text)).collect();
                    for ((said, found), expected) in said.iter().zip(&found).zip(expected) {
                        assert_eq!(found.join(" "), expected, "{name} of {said:?}");
                        texts += 1;
                    }
                    items.push(found);
                }
                differences(&items, &corpus[name])
            }));
            let kind = if is_latin { "Latin-1" } else { "ASCII" };
            println!("{name}, {kind}: {texts} texts, BLEU, ROUGE-L, CIDEr-D differ by at most {worst:?}");
            assert!(worst.iter().all(|one| *one < TOLERANCE), "{name} {kind} {worst:?}");
        }
    }
}

#[test]
fn made_corpora_have_the_tokens_and_figures_of_the_reference() {
    assert_made_corpora_agree(&json(concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/captions.json")));
}

#[test]
fn more_made_corpora_do_too() {
    match std::env::var_os("WAYWORD_CAPTIONS") {
        Some(file) => assert_made_corpora_agree(&json(file)),
        None => println!("SKIPPED: set WAYWORD_CAPTIONS to a file of fixtures/make_captions.py --corpora 200"),
    }
}

/// FNV-1a in 64 bits, as in the script: the file of the reference holds no real text.
fn hash(line: &str) -> String {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", line.bytes().fold(0xcbf2_9ce4_8422_2325, step))
}

#[test]
fn real_texts_have_the_tokens_and_figures_of_the_reference() {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data"));
    let data = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from);
    let Some(figures) = std::env::var_os("WAYWORD_CAPTIONS_REAL").filter(|_| data.join("r2r").is_dir()) else {
        println!("SKIPPED: set WAYWORD_DATA, and WAYWORD_CAPTIONS_REAL to a file of fixtures/make_captions.py --real");
        return;
    };
    for (dataset, expected) in json(figures).as_object().unwrap() {
        let items = json(data.join(format!("{dataset}.json")));
        let said: Vec<Vec<&str>> =
            items.as_array().unwrap().iter().map(|item| strings(&item["instructions"])).collect();
        for (name, tokenize) in TOKENIZERS {
            let several = said.iter().filter(|said| said.len() > 1);
            let found: Vec<Vec<Vec<String>>> =
                several.map(|said| said.iter().map(|text| tokenize(text)).collect()).collect();
            let hashes: Vec<String> = found.iter().flatten().map(|tokens| hash(&tokens.join(" "))).collect();
            let apart = hashes.iter().zip(strings(&expected[name]["hashes"])).filter(|(a, b)| a != b).count();
            assert_eq!(apart, 0, "{dataset}, {name}: texts with other tokens");
            let worst = differences(&found, &expected[name]);
            println!("{dataset}, {name}: {} texts, BLEU, ROUGE-L, CIDEr-D differ by at most {worst:?}", hashes.len());
            assert!(worst.iter().all(|one| *one < TOLERANCE), "{dataset} {name} {worst:?}");
        }
    }
}
