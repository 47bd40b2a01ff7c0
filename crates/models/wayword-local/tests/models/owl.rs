//! Compares OWLv2 with PyTorch (`fixtures/make_owl.py` made the numbers), and tries it as a detector in process.

use crate::common::{copy, damaged_files_are_named, drawn, fixture, refused, set, view};
use std::{collections::BTreeMap, path::Path};
use wayword_core::{DetectorGrounder, MAX_BOXES_PER_PHRASE, ModelError, ObjectDetector, PhraseGrounder};
use wayword_local::{LocalError, ModelDevice, OwlDetector, OwlOutputs, WeightPrecision};

fn load(folder: &Path) -> Result<OwlDetector, LocalError> {
    OwlDetector::load("hf/test/owl", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Expected {
    texts: Vec<String>,
    pictures: Vec<OfPicture>,
    /// What comes of each mistake, for the second picture.
    traps: BTreeMap<String, Numbers>,
}

#[derive(serde::Deserialize)]
struct OfPicture {
    size: (u32, u32),
    #[serde(flatten)]
    numbers: Numbers,
}

#[derive(serde::Deserialize)]
struct Numbers {
    logits: Vec<Vec<f32>>,
    boxes: Vec<[f32; 4]>,
}

impl Expected {
    fn read(folder: &Path) -> Self {
        serde_json::from_str(&std::fs::read_to_string(folder.join("expected.json")).unwrap()).unwrap()
    }

    fn texts(&self) -> Vec<&str> {
        self.texts.iter().map(String::as_str).collect()
    }
}

/// The largest difference of logits and of boxes.
#[track_caller]
fn off(ours: &OwlOutputs, theirs: &Numbers) -> (f32, f32) {
    assert_eq!((ours.logits.len(), ours.boxes.len()), (theirs.logits.len(), theirs.boxes.len()));
    let largest = |ours: &mut dyn Iterator<Item = &f32>, theirs: &mut dyn Iterator<Item = &f32>| {
        ours.zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    (
        largest(&mut ours.logits.iter().flatten(), &mut theirs.logits.iter().flatten()),
        largest(&mut ours.boxes.iter().flatten(), &mut theirs.boxes.iter().flatten()),
    )
}

#[test]
fn logits_and_boxes_agree_with_pytorch() {
    let (owl, expected) = (load(&fixture("owl")).unwrap(), Expected::read(&fixture("owl")));
    assert_eq!(owl.edge_px(), 48);
    for OfPicture { size, numbers } in &expected.pictures {
        let ours = owl.raw_outputs(&drawn(*size), &expected.texts()).unwrap();
        let (logits, boxes) = off(&ours, numbers);
        assert!(logits < 1e-4 && boxes < 2e-6, "{size:?}: {logits}, {boxes}");
    }
}

#[test]
fn outputs_differ_from_those_of_known_mistakes() {
    let (owl, expected) = (load(&fixture("owl")).unwrap(), Expected::read(&fixture("owl")));
    let ours = owl.raw_outputs(&drawn(expected.pictures[1].size), &expected.texts()).unwrap();
    assert_eq!(expected.traps.len(), 8);
    for (mistake, numbers) in &expected.traps {
        let (logits, boxes) = off(&ours, numbers);
        assert!(logits > 0.1 || boxes > 0.1, "{mistake}: {logits}, {boxes}");
    }
}

#[test]
fn a_text_scores_the_same_alone_and_among_others() {
    let (owl, expected) = (load(&fixture("owl")).unwrap(), Expected::read(&fixture("owl")));
    let OfPicture { size, numbers } = &expected.pictures[0];
    for (text, logits) in expected.texts.iter().zip(&numbers.logits).rev() {
        // Another instance, which has no kept vectors.
        let alone = load(&fixture("owl")).unwrap().raw_outputs(&drawn(*size), &[text]).unwrap();
        let kept = owl.raw_outputs(&drawn(*size), &[text]).unwrap();
        for ours in [alone, kept] {
            let off = ours.logits[0].iter().zip(logits).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(off < 1e-4, "{text}: {off}");
        }
    }
    assert!(owl.raw_outputs(&drawn(*size), &[]).unwrap().logits.is_empty());
}

#[test]
fn finds_have_a_score_and_a_box_in_picture_pixels() {
    let (owl, expected) = (load(&fixture("owl")).unwrap(), Expected::read(&fixture("owl")));
    let OfPicture { size: (width, height), numbers } = &expected.pictures[1];
    let shown = view(Some(drawn((*width, *height))));
    let found = owl.detect_phrases(&[&shown], &["the red door", "sink"]).remove(0).unwrap();
    assert_eq!(found.len(), 2);
    // The first of the texts is the prompt for this phrase; its best patch within the picture is the best find.
    let edge = (*width).max(*height) as f32;
    let is_within = |[x, y, across, down]: &[f32; 4]| {
        (x - across / 2.0) * edge < *width as f32 && (y - down / 2.0) * edge < *height as f32
    };
    let patches = numbers.logits[0].iter().zip(&numbers.boxes).filter(|(_, place)| is_within(place));
    let (logit, [x, y, across, down]) = patches.max_by(|a, b| a.0.total_cmp(b.0)).unwrap();
    let best = found[0][0];
    assert!((best.score - 1.0 / (1.0 + (-logit).exp())).abs() < 1e-5, "{best:?}");
    let (width, height) = (*width as f32, *height as f32);
    let corners = [x - across / 2.0, y - down / 2.0, x + across / 2.0, y + down / 2.0].map(|share| share * edge);
    for ((ours, theirs), most) in best.box_px.iter().zip(corners).zip([width, height, width, height]) {
        assert!((ours - theirs.clamp(0.0, most)).abs() < 1e-3, "{best:?}: {corners:?}");
    }
    for places in &found {
        assert!(places.len() <= MAX_BOXES_PER_PHRASE && places.is_sorted_by(|a, b| a.score >= b.score));
    }
    let scores = DetectorGrounder::new(owl).score_phrases(&[&shown], &["the red door", "sink"]).remove(0).unwrap();
    assert_eq!(scores, [best.score, found[1].first().map_or(0.0, |found| found.score)]);
}

#[test]
fn a_view_without_a_picture_does_not_fail_the_others() {
    let owl = load(&fixture("owl")).unwrap();
    let (blank, shown) = (view(None), view(Some(drawn((40, 30)))));
    let found = owl.detect_phrases(&[&blank, &shown], &["stairs"]);
    assert!(matches!(&found[0], Err(ModelError::NothingToSee { name, .. }) if name == "hf/test/owl"));
    assert_eq!(found[1].as_ref().unwrap().len(), 1);
    let scoring = owl.scoring();
    assert!(!scoring.phrases_interact && scoring.means.contains("a photo of a"));
}

#[test]
fn sixteen_bits_come_near() {
    let half = OwlDetector::load("hf/test/owl", &fixture("owl"), &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
    let expected = Expected::read(&fixture("owl"));
    let OfPicture { size, numbers } = &expected.pictures[0];
    let (logits, boxes) = off(&half.raw_outputs(&drawn(*size), &expected.texts()).unwrap(), numbers);
    assert!((1e-4..1.0).contains(&logits) && (1e-6..0.05).contains(&boxes), "{logits}, {boxes}");
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    let weights = "model.safetensors";
    for (file, place, value, told) in [
        ("config.json", "/model_type", "clip".into(), vec!["config.json", "clip is not owlv2"]),
        ("config.json", "/projection_dim", 21.into(), vec!["config.json", "projection_dim: 21"]),
        ("config.json", "/vision_config/hidden_size", 27.into(), vec![weights, "owlv2.vision_model.embeddings.", "27"]),
        (
            "config.json",
            "/vision_config/patch_size",
            6.into(),
            vec![weights, "patch_embedding.weight", "[24, 3, 8, 8]"],
        ),
        ("config.json", "/vision_config/num_hidden_layers", 3.into(), vec![weights, "layers.2.layer_norm1", "missing"]),
        ("config.json", "/vision_config/image_size", (1_u64 << 60).into(), vec!["config.json", "pixels"]),
        ("config.json", "/text_config/vocab_size", (1_u64 << 40).into(), vec![weights, "token_embedding.weight"]),
        ("preprocessor_config.json", "/size/height", 40.into(), vec!["preprocessor_config.json", "sees 48 x 48"]),
        ("preprocessor_config.json", "/do_pad", false.into(), vec!["preprocessor_config.json", "do_pad"]),
    ] {
        let folder = copy("owl");
        set(folder.path(), file, place, value);
        let error = refused(load(folder.path()));
        assert!(told.iter().all(|told| error.contains(told)), "{error}");
    }
}

#[test]
fn a_tensor_that_is_missing_or_swapped_is_named() {
    for (from, to, told) in [
        (
            "class_head.logit_shift.weight",
            "class_head.logit_shift.wrongs",
            "class_head.logit_shift.weight: it is missing",
        ),
        ("box_head.dense2.weight", "box_head.dense9.weight", "box_head.dense2.weight: it is missing"),
        ("owlv2.vision_model.pre_layernorm.bias", "owlv2.vision_model.pre_layernorm.bios", "pre_layernorm.bias"),
    ] {
        let folder = copy("owl");
        let path = folder.path().join("model.safetensors");
        let mut bytes = std::fs::read(&path).unwrap();
        let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        std::fs::write(&path, bytes).unwrap();
        let error = refused(load(folder.path()));
        assert!(error.contains("model.safetensors") && error.contains(told), "{error}");
    }
}

#[test]
fn a_file_that_is_cut_off_or_missing_is_named() {
    damaged_files_are_named("owl", load);
}
