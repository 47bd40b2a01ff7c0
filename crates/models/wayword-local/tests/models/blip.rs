//! Compares BLIP with PyTorch: `fixtures/make_blip.py` made the numbers.

use crate::common::{self, copy, drawn, fixture, refused};
use std::path::Path;
use wayword_local::{BlipCaptioner, BlipVqa, LocalError, ModelDevice, WeightPrecision};

fn captioner(folder: &Path) -> Result<BlipCaptioner, LocalError> {
    BlipCaptioner::load("hf/test/blip", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

fn vqa(folder: &Path) -> Result<BlipVqa, LocalError> {
    BlipVqa::load("hf/test/blip", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

fn expected<T: serde::de::DeserializeOwned>(name: &str) -> T {
    serde_json::from_str(&std::fs::read_to_string(fixture(name).join("expected.json")).unwrap()).unwrap()
}

#[track_caller]
fn near(ours: &[f32], theirs: &[f32], what: &str) {
    let off = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(ours.len() >= theirs.len() && off < 1e-5, "{what}: {off}");
}

#[derive(serde::Deserialize)]
struct Captions {
    size: (u32, u32),
    /// The first three states of the vision model.
    vision: Vec<f32>,
    free: Vec<u32>,
    free_text: String,
    begun: Vec<u32>,
    begun_text: String,
}

#[test]
fn captions_agree_with_pytorch_token_for_token() {
    let expected: Captions = expected("blip_caption");
    let (blip, picture) = (captioner(&fixture("blip_caption")).unwrap(), drawn(expected.size));
    near(&blip.picture_states(&picture).unwrap(), &expected.vision, "states of the picture");
    let free = blip.description_tokens(&picture, "", 12).unwrap();
    // PyTorch's list includes the tokens that begin and end a caption.
    assert_eq!(free, expected.free[1..expected.free.len() - 1]);
    assert_eq!(blip.describe_picture(&picture, "", 12).unwrap(), expected.free_text);
    let begun = blip.description_tokens(&picture, "a photo of", 8).unwrap();
    assert_eq!(begun, expected.begun[1..expected.begun.len() - 1]);
    assert_eq!(blip.describe_picture(&picture, "a photo of", 8).unwrap(), expected.begun_text);
}

#[test]
fn a_caption_ends_at_the_requested_length() {
    let expected: Captions = expected("blip_caption");
    let blip = captioner(&fixture("blip_caption")).unwrap();
    let cut = blip.description_tokens(&drawn(expected.size), "", 2).unwrap();
    assert_eq!(cut, expected.free[1..3]);
    assert_eq!(blip.description_tokens(&drawn(expected.size), "", 0).unwrap(), [0_u32; 0]);
}

#[derive(serde::Deserialize)]
struct Answers {
    size: (u32, u32),
    answers: Vec<Answer>,
}

#[derive(serde::Deserialize)]
struct Answer {
    question: String,
    /// The encoder's states.
    states: Vec<f32>,
    text: String,
}

#[test]
fn answers_agree_with_pytorch_in_whatever_order_they_are_asked_for() {
    let expected: Answers = expected("blip_vqa");
    let (blip, picture) = (vqa(&fixture("blip_vqa")).unwrap(), drawn(expected.size));
    for answer in expected.answers.iter().chain(expected.answers.iter().rev()) {
        near(&blip.question_states(&picture, &answer.question).unwrap(), &answer.states, &answer.question);
        assert_eq!(blip.answer_question(&picture, &answer.question, 10).unwrap(), answer.text, "{}", answer.question);
    }
}

#[test]
fn sixteen_bits_load_and_answer() {
    let expected: Captions = expected("blip_caption");
    for precision in [WeightPrecision::Bf16, WeightPrecision::F16] {
        let blip =
            BlipCaptioner::load("hf/test/blip", &fixture("blip_caption"), &ModelDevice::cpu(), precision).unwrap();
        let states = blip.picture_states(&drawn(expected.size)).unwrap();
        let off = states.iter().zip(&expected.vision).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off > 0.0 && off < 0.2, "{off}");
    }
}

/// Loads a copy of a fixture with one file changed.
fn changed<T>(
    name: &str,
    file: &str,
    change: impl FnOnce(Vec<u8>) -> Vec<u8>,
    load: impl FnOnce(&Path) -> Result<T, LocalError>,
) -> Result<T, LocalError> {
    let folder = copy(name);
    common::change(folder.path(), file, change);
    load(folder.path())
}

fn damaged<T>(
    name: &str,
    file: &str,
    change: impl FnOnce(Vec<u8>) -> Vec<u8>,
    load: impl FnOnce(&Path) -> Result<T, LocalError>,
) -> String {
    refused(changed(name, file, change, load))
}

fn replaced(from: &'static str, to: &'static str) -> impl FnOnce(Vec<u8>) -> Vec<u8> {
    move |bytes| {
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(from), "{from}");
        text.replace(from, to).into_bytes()
    }
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    let cut = damaged("blip_vqa", "model.safetensors", |bytes| bytes[..bytes.len() / 2].to_vec(), vqa);
    assert!(cut.contains("model.safetensors") && cut.contains("bytes"), "{cut}");
    let wider = damaged("blip_vqa", "config.json", replaced("\"patch_size\": 8", "\"patch_size\": 4"), vqa);
    assert!(wider.contains("vision_model.embeddings.patch_embedding.weight"), "{wider}");
    let deeper = replaced("\"num_hidden_layers\": 2", "\"num_hidden_layers\": 3");
    let deeper = damaged("blip_caption", "config.json", deeper, captioner);
    assert!(deeper.contains("vision_model.encoder.layers.2.") && deeper.contains("missing"), "{deeper}");
    let other = damaged(
        "blip_caption",
        "config.json",
        replaced("\"model_type\": \"blip\"", "\"model_type\": \"t5\""),
        captioner,
    );
    assert!(other.contains("config.json") && other.contains("model_type"), "{other}");
}

#[test]
fn text_config_cannot_change_the_width_of_vision_states() {
    let expected: Captions = expected("blip_caption");
    for said in ["\"encoder_hidden_size\": 768", "\"encoder_hidden_width\": 30"] {
        let change = replaced("\"encoder_hidden_size\": 30", said);
        let blip = changed("blip_caption", "config.json", change, captioner).unwrap();
        assert_eq!(blip.describe_picture(&drawn(expected.size), "", 12).unwrap(), expected.free_text);
    }
}

#[test]
fn a_describing_checkpoint_does_not_load_as_an_answering_one() {
    let error = refused(vqa(&fixture("blip_caption")));
    assert!(error.contains("text_encoder.") && error.contains("missing"), "{error}");
}
