//! Compares CLIP with PyTorch: `fixtures/make_clip.py` made the numbers.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]

use std::{
    f64::consts::FRAC_PI_2,
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{DVec3, Grounder, Heading, Image, ModelError, Pose, View};
use wayword_local::{Clip, ClipGrounder, Device, LocalError, Precision};

fn fixture() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/clip")
}

fn load(folder: &Path) -> Result<Clip, LocalError> {
    Clip::load("hf/test/clip", folder, &Device::cpu(), Precision::F32)
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
    serde_json::from_str(&std::fs::read_to_string(fixture().join("expected.json")).unwrap()).unwrap()
}

/// The same formula as in `fixtures/make_clip.py`.
fn drawn((width, height): (u32, u32)) -> Image {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
}

#[track_caller]
fn near(ours: &[f32], theirs: &[f32], what: &str) {
    let off = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(ours.len() == theirs.len() && off < 1e-5, "{what}: {off}");
}

#[track_caller]
fn texts_agree(clip: &Clip, expected: &[OfText]) {
    let texts: Vec<&str> = expected.iter().map(|one| &one.text[..]).collect();
    for (ours, one) in clip.text_features(&texts).unwrap().iter().zip(expected) {
        near(ours, &one.vector, &one.text);
        near(&clip.text_features(&[&one.text]).unwrap()[0], &one.vector, &one.text);
    }
}

#[test]
fn pictures_agree_with_pytorch_alone_and_among_others() {
    let (clip, expected) = (load(&fixture()).unwrap(), expected().images);
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
    texts_agree(&load(&fixture()).unwrap(), &expected().texts);
}

#[test]
fn texts_agree_where_the_configuration_names_the_wrong_end() {
    let folder = copy();
    change(folder.path(), "config.json", |text| {
        let mut config: serde_json::Value = serde_json::from_str(&text).unwrap();
        config["text_config"]["eos_token_id"] = 2.into();
        config.to_string()
    });
    let clip = load(folder.path()).unwrap();
    texts_agree(&clip, &expected().legacy);
    // The two rules differ for a text with a token whose id is higher than the end token's.
    let (now, then) = (expected().texts.pop().unwrap().vector, expected().legacy.pop().unwrap().vector);
    assert!(now.iter().zip(&then).any(|(a, b)| (a - b).abs() > 1e-3));
}

#[test]
fn sixteen_bits_come_near() {
    let half = Clip::load("hf/test/clip", &fixture(), &Device::cpu(), Precision::Bf16).unwrap();
    let expected = expected();
    let image = half.image_features(&[&drawn(expected.images[0].size)]).unwrap().remove(0);
    let text = half.text_features(&[&expected.texts[0].text]).unwrap().remove(0);
    for (half, whole) in [(image, &expected.images[0].vector), (text, &expected.texts[0].vector)] {
        let cosine: f32 = half.iter().zip(whole).map(|(a, b)| a * b).sum();
        assert!((0.99..0.999_999).contains(&cosine), "{cosine}");
    }
}

fn view(image: Option<Image>) -> View {
    let pose = Pose::level(DVec3::ZERO, Heading::NORTH);
    View::new(pose, FRAC_PI_2, image.map(Arc::new), None)
}

#[test]
fn a_score_is_the_cosine_of_picture_and_phrase() {
    let (grounder, expected) = (ClipGrounder::new(load(&fixture()).unwrap()), expected());
    assert_eq!(grounder.name(), "hf/test/clip");
    let views: Vec<View> = expected.images.iter().map(|one| view(Some(drawn(one.size)))).collect();
    let phrases: Vec<&str> = expected.texts.iter().map(|one| &one.text[..]).collect();
    // Twice, because the second time the vectors are kept ones.
    for _ in 0..2 {
        let scores = grounder.ground(&views.iter().collect::<Vec<_>>(), &phrases);
        for (scores, image) in scores.into_iter().zip(&expected.images) {
            let cosine = |text: &OfText| image.vector.iter().zip(&text.vector).map(|(a, b)| a * b).sum();
            near(&scores.unwrap(), &expected.texts.iter().map(cosine).collect::<Vec<f32>>(), "scores");
        }
    }
}

#[test]
fn a_view_without_a_picture_does_not_fail_the_others() {
    let (grounder, expected) = (ClipGrounder::new(load(&fixture()).unwrap()), expected());
    let drawn = |at: usize| view(Some(drawn(expected.images[at].size)));
    let (blank, empty) = (view(None), view(Some(Image::new(0, 3, Vec::new()).unwrap())));
    let (first, last) = (drawn(0), drawn(1));
    let scores = grounder.ground(&[&first, &blank, &first, &empty, &last], &["stairs"]);
    for at in [1, 3] {
        assert!(matches!(&scores[at], Err(ModelError::NothingToSee { name, .. }) if name == "hf/test/clip"));
    }
    let alone = |view: &View| ClipGrounder::new(load(&fixture()).unwrap()).ground(&[view], &["stairs"]).remove(0);
    for (at, view) in [(0, &first), (2, &first), (4, &last)] {
        near(scores[at].as_ref().unwrap(), &alone(view).unwrap(), "a score among others");
    }
    assert_eq!(grounder.ground(&[&first], &[]), [Ok(Vec::new())]);
    assert!(grounder.ground(&[], &["stairs"]).is_empty());
}

/// A copy of the fixture.
fn copy() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(fixture()).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    folder
}

fn change(folder: &Path, file: &str, change: impl FnOnce(String) -> String) {
    let path = folder.join(file);
    std::fs::write(&path, change(std::fs::read_to_string(&path).unwrap())).unwrap();
}

/// The error of loading after one value of a JSON file was changed.
#[track_caller]
fn refused(file: &str, place: &str, value: serde_json::Value) -> String {
    let folder = copy();
    change(folder.path(), file, |text| {
        let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
        *json.pointer_mut(place).unwrap() = value;
        json.to_string()
    });
    load(folder.path()).err().expect("it is refused").to_string()
}

#[test]
fn damage_is_told_by_file_and_tensor() {
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
        let error = refused(file, place, value);
        assert!(
            told.iter().all(|told| error.contains(told)) && error.contains(".json") | error.contains("safetensors"),
            "{error}"
        );
    }
}

#[test]
fn a_file_that_is_cut_off_or_missing_is_named() {
    for file in ["model.safetensors", "config.json", "preprocessor_config.json", "tokenizer.json"] {
        let folder = copy();
        let path = folder.path().join(file);
        let whole = std::fs::read(&path).unwrap();
        for length in [0, 7, whole.len() / 2, whole.len() - 1] {
            std::fs::write(&path, &whole[..length]).unwrap();
            let error = load(folder.path()).err().expect("it is refused").to_string();
            assert!(error.contains(file), "{error}");
        }
        std::fs::remove_file(&path).unwrap();
        let error = load(folder.path()).err().expect("it is refused").to_string();
        assert!(error.contains(file) && error.contains("missing"), "{error}");
    }
}
