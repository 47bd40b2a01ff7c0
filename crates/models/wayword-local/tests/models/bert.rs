//! Compares sentence encoders with PyTorch: `fixtures/make_bert.py` made the numbers.

use crate::common::{self, copy, fixture, refused};
use std::path::{Path, PathBuf};
use wayword_local::{ModelDevice, SentenceEncoder, WeightPrecision};

fn load(folder: &Path) -> Result<SentenceEncoder, wayword_local::LocalError> {
    SentenceEncoder::load("hf/test/bert", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Expected {
    text: String,
    vector: Vec<f32>,
}

#[track_caller]
fn agrees(encoder: &SentenceEncoder, expected: &Path) {
    let expected: Vec<Expected> = serde_json::from_str(&std::fs::read_to_string(expected).unwrap()).unwrap();
    let texts: Vec<&str> = expected.iter().map(|one| &one.text[..]).collect();
    let ours = encoder.unit_vectors(&texts).unwrap();
    for (ours, theirs) in ours.iter().zip(&expected) {
        let off = ours.iter().zip(&theirs.vector).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(ours.len() == theirs.vector.len() && off < 1e-5, "{:?}: {off}", theirs.text);
    }
    // A text has the same vector alone and among others.
    for (text, among) in texts.iter().zip(&ours) {
        let alone = encoder.unit_vectors(&[text]).unwrap().remove(0);
        assert!(alone.iter().zip(among).all(|(a, b)| (a - b).abs() < 1e-5), "{text:?}");
    }
}

#[test]
fn vectors_agree_with_pytorch() {
    agrees(&load(&fixture("bert")).unwrap(), &fixture("bert").join("expected.json"));
}

/// Real sentences with the real weights: needs a folder with all-MiniLM-L6-v2 and the `expected.json` of `make_bert.py
/// --expect`.
#[test]
fn real_weights_agree_with_pytorch() {
    let Some(folder) = std::env::var_os("WAYWORD_MINILM").map(PathBuf::from) else {
        eprintln!(
            "skipped: set WAYWORD_MINILM to a folder with all-MiniLM-L6-v2 and expected.json (fixtures/make_bert.py --expect)"
        );
        return;
    };
    agrees(&load(&folder).unwrap(), &folder.join("expected.json"));
}

#[test]
fn sixteen_bits_come_near() {
    let whole = load(&fixture("bert")).unwrap();
    let half =
        SentenceEncoder::load("hf/test/bert", &fixture("bert"), &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
    let text = "Go past the table and stop at the sink.";
    let (whole, half) = (whole.unit_vectors(&[text]).unwrap(), half.unit_vectors(&[text]).unwrap());
    let cosine: f32 = whole[0].iter().zip(&half[0]).map(|(a, b)| a * b).sum();
    assert!((0.99..0.999_999).contains(&cosine), "{cosine}");
}

/// The error of loading a copy of the fixture with one file changed.
fn damaged(file: &str, change: impl FnOnce(Vec<u8>) -> Vec<u8>) -> String {
    let folder = copy("bert");
    common::change(folder.path(), file, change);
    refused(load(folder.path()))
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    let cut = damaged("model.safetensors", |bytes| bytes[..bytes.len() / 2].to_vec());
    assert!(cut.contains("model.safetensors") && cut.contains("bytes"), "{cut}");
    let resized = damaged("config.json", |bytes| {
        String::from_utf8(bytes).unwrap().replace("\"hidden_size\": 24", "\"hidden_size\": 27").into_bytes()
    });
    assert!(resized.contains("embeddings.") && resized.contains("[2, 24], not [2, 27]"), "{resized}");
    let other = damaged("config.json", |bytes| {
        String::from_utf8(bytes).unwrap().replace("\"model_type\": \"bert\"", "\"model_type\": \"t5\"").into_bytes()
    });
    assert!(other.contains("config.json") && other.contains("t5 is not bert"), "{other}");
}
