//! Compares BLIP-2 with PyTorch: `fixtures/make_blip2.py` made the numbers.

use crate::common::{self, copy, drawn, fixture, refused};
use std::path::Path;
use wayword_local::{Blip2Model, LocalError, ModelDevice, WeightPrecision};

const BOTH: [&str; 2] = ["blip2_t5", "blip2_opt"];

fn load(folder: &Path) -> Result<Blip2Model, LocalError> {
    Blip2Model::load("hf/test/blip2", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Expected {
    size: (u32, u32),
    /// The states of the picture's tokens, before the words.
    projected: Vec<f32>,
    most: usize,
    answers: Vec<Answer>,
}

#[derive(serde::Deserialize)]
struct Answer {
    prompt: String,
    said: Vec<u32>,
    text: String,
}

fn expected(name: &str) -> Expected {
    serde_json::from_str(&std::fs::read_to_string(fixture(name).join("expected.json")).unwrap()).unwrap()
}

#[test]
fn queries_and_answers_agree_with_pytorch() {
    for name in BOTH {
        let (blip2, expected) = (load(&fixture(name)).unwrap(), expected(name));
        let picture = drawn(expected.size);
        let seen = blip2.query_states(&picture).unwrap();
        let largest = expected.projected.iter().copied().map(f32::abs).fold(1.0, f32::max);
        let off = seen.iter().zip(&expected.projected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(seen.len() == expected.projected.len() && off < 1e-5 * largest, "{name}: {off}");
        for answer in expected.answers.iter().chain(expected.answers.iter().rev()) {
            let said = blip2.answer_tokens(&picture, &answer.prompt, expected.most).unwrap();
            assert_eq!(said, answer.said, "{name}: {}", answer.prompt);
            assert_eq!(blip2.continue_prompt(&picture, &answer.prompt, expected.most).unwrap(), answer.text);
        }
    }
}

#[test]
fn sixteen_bits_come_near() {
    for name in BOTH {
        let blip2 =
            Blip2Model::load("hf/test/blip2", &fixture(name), &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
        let expected = expected(name);
        let picture = drawn(expected.size);
        let seen = blip2.query_states(&picture).unwrap();
        let dot = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        let cosine = dot(&seen, &expected.projected)
            / (dot(&seen, &seen) * dot(&expected.projected, &expected.projected)).sqrt();
        assert!((0.99..0.999_999).contains(&cosine), "{name}: {cosine}");
        blip2.continue_prompt(&picture, "a photo of", 5).unwrap();
    }
}

/// The error of loading the fixture with its configuration changed.
fn changed(name: &str, from: &str, to: &str) -> String {
    let folder = copy(name);
    common::change(folder.path(), "config.json", |bytes| {
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(from), "{from}");
        text.replace(from, to).into_bytes()
    });
    refused(load(folder.path()))
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    for (name, from, to, told) in [
        (
            "blip2_t5",
            "\"d_ff\": 32",
            "\"d_ff\": 33",
            "language_model.encoder.block.0.layer.1.DenseReluDense.wi_0.weight",
        ),
        ("blip2_t5", "gated-gelu", "relu", "feed_forward_proj"),
        ("blip2_opt", "\"ffn_dim\": 40", "\"ffn_dim\": 43", "language_model.model.decoder.layers.0.fc1.weight"),
        ("blip2_opt", "\"num_query_tokens\": 5", "\"num_query_tokens\": 6", "query_tokens"),
        ("blip2_opt", "\"model_type\": \"opt\"", "\"model_type\": \"gpt2\"", "gpt2"),
        (
            "blip2_opt",
            "\"cross_attention_frequency\": 2",
            "\"cross_attention_frequency\": 0",
            "cross_attention_frequency",
        ),
    ] {
        let error = changed(name, from, to);
        assert!(error.contains(told), "{told}: {error}");
    }
}
