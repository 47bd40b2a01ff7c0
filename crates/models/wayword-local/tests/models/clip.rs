//! Compares CLIP with PyTorch: `fixtures/make_clip.py` made the numbers.

use crate::common::{copy, damaged_files_are_named, drawn, fixture, refused, set, view};
use std::path::Path;
use wayword_core::{Image, ModelError, PhraseGrounder, View};
use wayword_local::{ClipGrounder, ClipModel, LocalError, ModelDevice, WeightPrecision};

fn load(folder: &Path) -> Result<ClipModel, LocalError> {
    ClipModel::load("hf/test/clip", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Expected {
    images: Vec<OfImage>,
    texts: Vec<OfText>,
    legacy: Vec<OfText>,
}

#[derive(serde::Deserialize)]
struct OfImage {
    size: (u32, u32),
    vector: Vec<f32>,
}

#[derive(serde::Deserialize)]
struct OfText {
    text: String,
    vector: Vec<f32>,
}

fn expected() -> Expected {
    serde_json::from_str(&std::fs::read_to_string(fixture("clip").join("expected.json")).unwrap()).unwrap()
}

#[track_caller]
fn near(ours: &[f32], theirs: &[f32], what: &str) {
    let off = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(ours.len() == theirs.len() && off < 1e-5, "{what}: {off}");
}

#[track_caller]
fn texts_agree(clip: &ClipModel, expected: &[OfText]) {
    let texts: Vec<&str> = expected.iter().map(|one| &one.text[..]).collect();
    for (ours, one) in clip.text_features(&texts).unwrap().iter().zip(expected) {
        near(ours, &one.vector, &one.text);
        near(&clip.text_features(&[&one.text]).unwrap()[0], &one.vector, &one.text);
    }
}

#[test]
fn pictures_agree_with_pytorch_alone_and_among_others() {
    let (clip, expected) = (load(&fixture("clip")).unwrap(), expected().images);
    let images: Vec<Image> = expected.iter().map(|one| drawn(one.size)).collect();
    let together = clip.image_features(&images.iter().collect::<Vec<_>>()).unwrap();
    for ((image, ours), one) in images.iter().zip(&together).zip(&expected) {
        near(ours, &one.vector, &format!("{image:?}"));
        near(&clip.image_features(&[image]).unwrap()[0], &one.vector, &format!("{image:?} alone"));
    }
    // More pictures than one batch.
    let many: Vec<&Image> = images.iter().cycle().take(70).collect();
    let many = clip.image_features(&many).unwrap();
    assert_eq!(many.len(), 70);
    near(&many[69], &expected[69 % images.len()].vector, "the last of many");
}

#[test]
fn texts_agree_with_pytorch() {
    texts_agree(&load(&fixture("clip")).unwrap(), &expected().texts);
}

#[test]
fn texts_agree_where_the_configuration_names_the_wrong_end() {
    let folder = copy("clip");
    set(folder.path(), "config.json", "/text_config/eos_token_id", 2.into());
    let clip = load(folder.path()).unwrap();
    texts_agree(&clip, &expected().legacy);
    // The two rules differ for a text with a token that has a higher id than the end token.
    let (now, then) = (expected().texts.pop().unwrap().vector, expected().legacy.pop().unwrap().vector);
    assert!(now.iter().zip(&then).any(|(a, b)| (a - b).abs() > 1e-3));
}

#[test]
fn sixteen_bits_come_near() {
    let half = ClipModel::load("hf/test/clip", &fixture("clip"), &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
    let expected = expected();
    let image = half.image_features(&[&drawn(expected.images[0].size)]).unwrap().remove(0);
    let text = half.text_features(&[&expected.texts[0].text]).unwrap().remove(0);
    for (half, whole) in [(image, &expected.images[0].vector), (text, &expected.texts[0].vector)] {
        let cosine: f32 = half.iter().zip(whole).map(|(a, b)| a * b).sum();
        assert!((0.99..0.999_999).contains(&cosine), "{cosine}");
    }
}

#[test]
fn a_score_is_the_cosine_of_picture_and_phrase() {
    let (grounder, expected) = (ClipGrounder::new(load(&fixture("clip")).unwrap()), expected());
    assert_eq!(grounder.name(), "hf/test/clip");
    let views: Vec<View> = expected.images.iter().map(|one| view(Some(drawn(one.size)))).collect();
    let phrases: Vec<&str> = expected.texts.iter().map(|one| &one.text[..]).collect();
    // Twice, because the second time the vectors are kept ones.
    for _ in 0..2 {
        let scores = grounder.score_phrases(&views.iter().collect::<Vec<_>>(), &phrases);
        for (scores, image) in scores.into_iter().zip(&expected.images) {
            let cosine = |text: &OfText| image.vector.iter().zip(&text.vector).map(|(a, b)| a * b).sum();
            near(&scores.unwrap(), &expected.texts.iter().map(cosine).collect::<Vec<f32>>(), "scores");
        }
    }
}

#[test]
fn grounder_knows_which_texts_are_cut_off() {
    let grounder = ClipGrounder::new(load(&fixture("clip")).unwrap());
    // The model reads 18 tokens, of which two are the ends; a letter is a token here.
    let held = ["a b c d e f g h i j k l m n o p", "a b c d e f g h i j k l m n o p q"];
    assert_eq!(held.map(|text| grounder.reads_whole_phrase(text).unwrap()), [true, false]);
}

#[test]
fn a_view_without_a_picture_does_not_fail_the_others() {
    let (grounder, expected) = (ClipGrounder::new(load(&fixture("clip")).unwrap()), expected());
    let drawn = |at: usize| view(Some(drawn(expected.images[at].size)));
    let (blank, empty) = (view(None), view(Some(Image::new(0, 3, Vec::new()).unwrap())));
    let (first, last) = (drawn(0), drawn(1));
    let scores = grounder.score_phrases(&[&first, &blank, &first, &empty, &last], &["stairs"]);
    for at in [1, 3] {
        assert!(matches!(&scores[at], Err(ModelError::NothingToSee { name, .. }) if name == "hf/test/clip"));
    }
    let alone =
        |view: &View| ClipGrounder::new(load(&fixture("clip")).unwrap()).score_phrases(&[view], &["stairs"]).remove(0);
    for (at, view) in [(0, &first), (2, &first), (4, &last)] {
        near(scores[at].as_ref().unwrap(), &alone(view).unwrap(), "a score among others");
    }
    assert_eq!(grounder.score_phrases(&[&first], &[]), [Ok(Vec::new())]);
    assert!(grounder.score_phrases(&[], &["stairs"]).is_empty());
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    for (file, place, value, told) in [
        ("config.json", "/model_type", "blip".into(), vec!["config.json", "blip is not clip"]),
        ("config.json", "/vision_config/hidden_size", 27.into(), vec!["vision_model.embeddings.", "[24, 3, 8, 8]"]),
        (
            "config.json",
            "/text_config/hidden_size",
            24.into(),
            vec!["text_model.embeddings.", "[63, 20], not [63, 24]"],
        ),
        ("config.json", "/projection_dim", 17.into(), vec!["visual_projection.weight", "[16, 24], not [17, 24]"]),
        ("config.json", "/vision_config/num_hidden_layers", 3.into(), vec!["layers.2.layer_norm1.weight", "missing"]),
        ("config.json", "/vision_config/num_hidden_layers", (1_u64 << 60).into(), vec!["layers.2.", "missing"]),
        ("config.json", "/text_config/num_attention_heads", 0.into(), vec!["text_config.num_attention_heads"]),
        ("config.json", "/text_config/num_hidden_layers", 0.into(), vec!["text_config.num_hidden_layers"]),
        ("config.json", "/vision_config/patch_size", 0.into(), vec!["patches of 0"]),
        ("config.json", "/vision_config/patch_size", 5.into(), vec!["patches of 5"]),
        ("config.json", "/vision_config/image_size", (1_u64 << 60).into(), vec!["config.json", "pixels"]),
        ("config.json", "/vision_config/hidden_act", "mish".into(), vec!["vision_config", "mish"]),
        ("preprocessor_config.json", "/crop_size", 24.into(), vec!["24 x 24 pixels", "sees 32 x 32"]),
    ] {
        let folder = copy("clip");
        set(folder.path(), file, place, value);
        let error = refused(load(folder.path()));
        assert!(
            told.iter().all(|told| error.contains(told)) && error.contains(".json") | error.contains("safetensors"),
            "{error}"
        );
    }
}

#[test]
fn a_file_that_is_cut_off_or_missing_is_named() {
    damaged_files_are_named("clip", load);
}
