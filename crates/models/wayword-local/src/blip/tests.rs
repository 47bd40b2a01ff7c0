//! Compares the writing model's logits with PyTorch's (`fixtures/make_blip.py` made the numbers), because a small
//! mistake may not change the words.

use super::{BlipCaptioner, BlipVqa, decoder::BlipDecoder, text::BlipKeysValues};
use crate::{ModelDevice, WeightPrecision};
use candle_core::{Result, Tensor};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use wayword_core::Image;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn expected<T: DeserializeOwned>(name: &str) -> T {
    serde_json::from_str(&std::fs::read_to_string(fixture(name).join("expected.json")).unwrap()).unwrap()
}

/// The same formula as in `fixtures/make_blip.py`.
fn drawn((width, height): (u32, u32)) -> Image {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
}

/// Logits after each of these tokens. `parts` are the lengths of the parts in which the decoder gets them.
fn logits(decoder: &BlipDecoder, ids: &[u32], attended: &BlipKeysValues, parts: &[usize]) -> Result<Vec<f32>> {
    let (mut past, mut ids, mut all) = (decoder.text.empty_past(), ids, Vec::new());
    for &length in parts {
        let (now, later) = ids.split_at(length);
        let states = decoder.text.continue_text(
            &Tensor::new(now, &candle_core::Device::Cpu)?.unsqueeze(0)?,
            attended,
            &mut past,
        )?;
        all.extend(decoder.token_logits(&states)?.flatten_all()?.to_vec1::<f32>()?);
        ids = later;
    }
    Ok(all)
}

#[track_caller]
fn near_in_parts(decoder: &BlipDecoder, ids: &[u32], attended: &BlipKeysValues, theirs: &[f32]) {
    let singly = vec![1; ids.len()];
    for parts in [vec![ids.len()], singly, vec![3, ids.len() - 3]] {
        let ours = logits(decoder, ids, attended, &parts).unwrap();
        assert_eq!(ours.len(), theirs.len());
        let off = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-5, "{parts:?}: {off}");
    }
}

#[derive(serde::Deserialize)]
struct Caption {
    size: (u32, u32),
    begun: Vec<u32>,
    logits: Vec<f32>,
}

#[test]
fn logits_of_a_caption_agree_with_pytorch_however_the_tokens_come() {
    let expected: Caption = expected("blip_caption");
    let blip = BlipCaptioner::load("hf/test/blip", &fixture("blip_caption"), &ModelDevice::cpu(), WeightPrecision::F32)
        .unwrap();
    let pixels = blip.processor.to_tensor(&[&drawn(expected.size)], &blip.device).unwrap();
    let attended = blip.decoder.text.cross_keys_values(&blip.vision.encode_pictures(&pixels).unwrap()).unwrap();
    near_in_parts(&blip.decoder, &expected.begun, &attended, &expected.logits);
}

#[derive(serde::Deserialize)]
struct Answers {
    size: (u32, u32),
    answers: Vec<Answer>,
}

#[derive(serde::Deserialize)]
struct Answer {
    question: String,
    said: Vec<u32>,
    logits: Vec<f32>,
}

#[test]
fn logits_of_answers_agree_with_pytorch_however_the_tokens_come() {
    let expected: Answers = expected("blip_vqa");
    let blip = BlipVqa::load("hf/test/blip", &fixture("blip_vqa"), &ModelDevice::cpu(), WeightPrecision::F32).unwrap();
    for answer in &expected.answers {
        let read = blip.encode_question(&drawn(expected.size), &answer.question).unwrap();
        let attended = blip.decoder.text.cross_keys_values(&read).unwrap();
        near_in_parts(&blip.decoder, &answer.said, &attended, &answer.logits);
    }
}
