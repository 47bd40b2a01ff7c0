//! Compares each stage with PyTorch (`fixtures/make_dino.py`), and the operators with each other.

use super::{
    model::GroundingDino,
    prompt::{DinoPrompt, build_prompts},
};
use crate::{ModelDevice, WeightPrecision, tokenizer::TextTokenizer};
use candle_core::{DType, Tensor};
use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};
use wayword_core::Image;

const PHRASES: [&str; 4] = ["red door", "Stairs", "a kitchen tables lamp", "sink"];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn load(folder: &Path) -> GroundingDino {
    GroundingDino::load("hf/test/dino", folder, &ModelDevice::cpu(), WeightPrecision::F32).unwrap()
}

/// The same formula as in `fixtures/make_dino.py`.
fn drawn(width: u32, height: u32) -> Image {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
}

fn numbers(x: &Tensor) -> Vec<f32> {
    x.to_dtype(DType::F32).unwrap().flatten_all().unwrap().to_vec1().unwrap()
}

fn off(ours: &[f32], theirs: &[f32]) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[track_caller]
fn near(ours: &Tensor, theirs: &Tensor, most: f32, what: &str) {
    let off = off(&numbers(ours), &numbers(theirs));
    assert!(off < most, "{what}: {off}");
}

#[test]
fn every_stage_agrees_with_pytorch() {
    for name in ["dino_mm", "dino"] {
        let dino = load(&folder(name));
        let file = folder(name).join("stages.safetensors");
        let stages: HashMap<String, Tensor> = candle_core::safetensors::load(file, &candle_core::Device::Cpu).unwrap();
        let (_, text) = dino.encode_prompts(&PHRASES).unwrap().remove(0);
        near(&text.states, &stages["0.text"], 1e-5, "text");
        for (number, (width, height)) in [(0, (75, 50)), (1, (59, 70))] {
            let stage = |stage: &str| &stages[&format!("{number}.{stage}")];
            let image = drawn(width, height);
            let features = dino.picture_features(&image).unwrap();
            if number == 0 {
                near(&dino.pixels(&image), stage("pixels"), 1e-6, "pixels");
                near(&features.cells, stage("tokens"), 2e-5, "cells before fusion");
                let (cells, read) = dino.encode_states(&features, &text).unwrap();
                near(&cells, stage("encoded"), 5e-5, "cells");
                near(&read, stage("encoded_text"), 5e-5, "text after fusion");
            }
            let candidates = dino.candidates(&features, &text).unwrap();
            assert!(off(&candidates, &numbers(stage("candidates"))) < 1e-4, "candidates");
            let mut order = Vec::new();
            let seen = dino.predict_with_candidates(&features, &text, |best| {
                order.clone_from(&best);
                best
            });
            let seen = seen.unwrap();
            let expected: Vec<u32> = numbers(stage("picked")).iter().map(|&at| at as u32).collect();
            assert_eq!(order, expected);
            near(&seen.logits, stage("logits"), 1e-4, "logits");
            assert!(off(&seen.boxes.concat(), &numbers(stage("boxes"))) < 1e-5, "boxes");
        }
    }
}

#[test]
fn phrases_are_put_into_as_few_prompts_as_possible() {
    let tokenizer = TextTokenizer::load(&folder("dino")).unwrap();
    let made = build_prompts("hf/test/dino", &tokenizer, &["Red  door", " ?. ", "stairs. lamp", "sinks"], 9).unwrap();
    let expected = [
        DinoPrompt { ids: vec![101, 1, 2, 1012, 3, 8, 1012, 102], phrases: vec![(0, 1..3), (2, 4..6)] },
        DinoPrompt { ids: vec![101, 6, 48, 1012, 102], phrases: vec![(3, 1..3)] },
    ];
    assert_eq!(made, expected);
    assert_eq!(made[0].token_places(), [0, 0, 1, 2, 0, 1, 2, 0]);
    let mask = made[0].attention_mask(&candle_core::Device::Cpu).unwrap().to_vec2::<f32>().unwrap();
    let seen = |at: usize| (0..8).filter(|&to| mask[at][to] == 0.0).collect::<Vec<_>>();
    assert_eq!(
        (seen(0), seen(1), seen(3), seen(6), seen(7)),
        (vec![0], vec![1, 2, 3], vec![1, 2, 3], vec![4, 5, 6], vec![7])
    );
    assert!(build_prompts("hf/test/dino", &tokenizer, &[], 9).unwrap().is_empty());
    let error =
        build_prompts("hf/test/dino", &tokenizer, &["a red door a red door a red door"], 9).unwrap_err().to_string();
    assert!(error.contains("9 tokens") && error.contains("6 are the most"), "{error}");
}

#[test]
fn a_picture_gets_the_size_that_transformers_gives_it() {
    // By `get_size_with_aspect_ratio` of transformers, with edges of 72 and 97 pixels.
    let dino = load(&folder("dino"));
    for ((width, height), size) in [
        ((75, 50), (65, 97)),
        ((59, 70), (85, 72)),
        ((72, 90), (90, 72)),
        ((50, 50), (72, 72)),
        ((640, 480), (72, 96)),
        ((97, 72), (72, 97)),
        ((100, 300), (97, 32)),
    ] {
        let pixels = dino.pixels(&drawn(width, height));
        assert_eq!(pixels.dims(), [1, 3, size.0, size.1], "{width} x {height}");
    }
}
