//! Compares the Grounding DINO family with PyTorch: `fixtures/make_dino.py` made the numbers.

use crate::common::{copy, damaged_files_are_named, drawn, fixture, refused, set, view};
use std::{collections::BTreeMap, path::Path};
use wayword_core::{DetectedBox, Image, ModelError, ObjectDetector, View};
use wayword_local::{GroundingDino, LocalError, ModelDevice, WeightPrecision};

/// The fixtures: one with separate heads for the two layers of the decoder, and one with shared heads.
const MODELS: [&str; 2] = ["dino_mm", "dino"];

fn load(folder: &Path) -> Result<GroundingDino, LocalError> {
    GroundingDino::load("hf/test/dino", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Expected {
    phrases: Vec<String>,
    pictures: Vec<OfPicture>,
    /// What comes out for the last picture if one thing is done wrongly.
    wrong: BTreeMap<String, Seen>,
}

#[derive(serde::Deserialize)]
struct OfPicture {
    size: (u32, u32),
    #[serde(flatten)]
    seen: Seen,
}

#[derive(serde::Deserialize)]
struct Seen {
    /// For each phrase the score of each query.
    scores: Vec<Vec<f32>>,
    /// Of each query.
    boxes: Vec<[f32; 4]>,
}

impl Seen {
    /// For each phrase what was found, the best first.
    fn found(&self) -> Vec<Vec<DetectedBox>> {
        let of_phrase = |scores: &Vec<f32>| {
            let mut found: Vec<DetectedBox> =
                scores.iter().zip(&self.boxes).map(|(&score, &box_px)| DetectedBox { box_px, score }).collect();
            found.sort_by(|a, b| b.score.total_cmp(&a.score));
            found
        };
        self.scores.iter().map(of_phrase).collect()
    }
}

fn expected(name: &str) -> Expected {
    serde_json::from_str(&std::fs::read_to_string(fixture(name).join("expected.json")).unwrap()).unwrap()
}

/// The largest differences of scores, and of boxes in pixels.
#[track_caller]
fn off(ours: &[Vec<DetectedBox>], theirs: &[Vec<DetectedBox>]) -> (f32, f32) {
    let counts = |found: &[Vec<DetectedBox>]| found.iter().map(Vec::len).collect::<Vec<_>>();
    assert_eq!(counts(ours), counts(theirs));
    let both = || ours.iter().flatten().zip(theirs.iter().flatten());
    let scores = both().map(|(a, b)| (a.score - b.score).abs()).fold(0.0, f32::max);
    let edges = both().flat_map(|(a, b)| a.box_px.into_iter().zip(b.box_px));
    (scores, edges.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max))
}

#[track_caller]
fn agree(ours: &[Vec<DetectedBox>], theirs: &[Vec<DetectedBox>], what: &str) {
    let (scores, boxes) = off(ours, theirs);
    assert!(scores < 1e-5 && boxes < 1e-3, "{what}: {scores}, {boxes} px");
}

fn detected(dino: &GroundingDino, size: (u32, u32), phrases: &[String]) -> Vec<Vec<DetectedBox>> {
    let phrases: Vec<&str> = phrases.iter().map(|phrase| &phrase[..]).collect();
    dino.detect_phrases(&[&view(Some(drawn(size)))], &phrases).remove(0).unwrap()
}

#[test]
fn scores_and_boxes_agree_with_pytorch() {
    for name in MODELS {
        let (dino, expected) = (load(&fixture(name)).unwrap(), expected(name));
        let views: Vec<View> = expected.pictures.iter().map(|one| view(Some(drawn(one.size)))).collect();
        let phrases: Vec<&str> = expected.phrases.iter().map(|phrase| &phrase[..]).collect();
        // Twice, because the second time the features are kept ones.
        for time in ["first", "second"] {
            let found = dino.detect_phrases(&views.iter().collect::<Vec<_>>(), &phrases);
            for (found, theirs) in found.iter().zip(&expected.pictures) {
                agree(found.as_ref().unwrap(), &theirs.seen.found(), &format!("{name} {time}"));
            }
        }
    }
}

#[test]
fn outputs_differ_from_those_of_likely_mistakes() {
    let mut traps = Vec::new();
    for name in MODELS {
        let (dino, expected) = (load(&fixture(name)).unwrap(), expected(name));
        let ours = detected(&dino, expected.pictures.last().unwrap().size, &expected.phrases);
        for (trap, wrong) in expected.wrong {
            let (scores, boxes) = off(&ours, &wrong.found());
            assert!(scores > 0.1 || boxes > 0.1, "{name} with the wrong {trap}: {scores}, {boxes} px");
            traps.push(trap);
        }
    }
    traps.sort();
    traps.dedup();
    assert_eq!(traps, ["bias", "corners", "mask", "positions", "residual", "scale", "shared"]);
}

#[test]
fn the_configuration_switches_heads_and_the_dot_product() {
    let expected = expected("dino_mm");
    let size = expected.pictures.last().unwrap().size;
    let with = |changes: &[(&str, serde_json::Value)]| {
        let folder = copy("dino_mm");
        for (place, value) in changes {
            set(folder.path(), "config.json", place, value.clone());
        }
        detected(&load(folder.path()).unwrap(), size, &expected.phrases)
    };
    let shared = with(&[("/decoder_bbox_embed_share", true.into()), ("/decoder_cls_embed_share", true.into())]);
    agree(&shared, &expected.wrong["shared"].found(), "shared heads");
    // The last layer's heads have the same names in both families.
    let plain = with(&[("/model_type", "grounding-dino".into())]);
    agree(&plain, &expected.wrong["scale"].found(), "plain dot product");
}

#[test]
fn heads_are_also_found_in_the_decoder() {
    let (folder, expected) = (copy("dino"), expected("dino"));
    let file = folder.path().join("model.safetensors");
    let tensors = candle_core::safetensors::load(&file, &candle_core::Device::Cpu).unwrap();
    let renamed = |name: String| match name.strip_prefix("bbox_embed.") {
        Some(rest) => format!("model.decoder.bbox_embed.{rest}"),
        None => name,
    };
    let tensors = tensors.into_iter().map(|(name, tensor)| (renamed(name), tensor)).collect();
    candle_core::safetensors::save(&tensors, &file).unwrap();
    let ours = detected(&load(folder.path()).unwrap(), expected.pictures[0].size, &expected.phrases);
    agree(&ours, &expected.pictures[0].seen.found(), "renamed");
}

#[test]
fn phrases_of_more_than_a_prompt_are_looked_for_in_several() {
    let dino = load(&fixture("dino")).unwrap();
    let view = view(Some(drawn((75, 50))));
    let detect = |phrases: &[&str]| dino.detect_phrases(&[&view], phrases).remove(0).unwrap();
    // 24 tokens are the most: the first six phrases have as many, with their dots and both ends.
    let phrases =
        ["a white wooden door", "a red lamp", "the kitchen table", "a plant", "bed", "a wooden chair", "...", "sink"];
    let (together, first, second) = (detect(&phrases), detect(&phrases[..6]), detect(&phrases[6..]));
    assert_eq!(together[..6], first);
    assert_eq!(together[6..], second);
    assert!(together[6].is_empty() && together[7].len() == 20);
    assert_eq!(detect(&[]), Vec::<Vec<DetectedBox>>::new());
    let long = dino.detect_phrases(&[&view], &["bed", &"red ".repeat(30)]).remove(0).unwrap_err().to_string();
    assert!(long.contains("30 tokens") && long.contains("21 are the most"), "{long}");
}

#[test]
fn a_view_without_a_picture_does_not_fail_the_others() {
    let dino = load(&fixture("dino_mm")).unwrap();
    let (shown, blank, empty) =
        (view(Some(drawn((75, 50)))), view(None), view(Some(Image::new(0, 3, Vec::new()).unwrap())));
    let found = dino.detect_phrases(&[&blank, &shown, &empty], &["sink"]);
    for at in [0, 2] {
        assert!(matches!(&found[at], Err(ModelError::NothingToSee { name, .. }) if name == "hf/test/dino"));
    }
    assert_eq!(found[1].as_ref().unwrap()[0].len(), 20);
    let scoring = dino.scoring();
    assert!(scoring.phrases_interact && scoring.means.starts_with("MM Grounding DINO"));
}

#[test]
fn boxes_lie_within_pictures_of_any_shape() {
    let dino = load(&fixture("dino")).unwrap();
    for (width, height) in [(1, 1), (3, 400), (700, 2), (97, 72)] {
        let found = dino.detect_phrases(&[&view(Some(drawn((width, height))))], &["sink"]).remove(0).unwrap();
        assert!(!found[0].is_empty());
        for DetectedBox { box_px: [left, top, right, bottom], score } in &found[0] {
            assert!(0.0 <= *left && left <= right && *right <= width as f32, "{found:?}");
            assert!(0.0 <= *top && top <= bottom && *bottom <= height as f32, "{found:?}");
            assert!((0.0..=1.0).contains(score));
        }
    }
}

#[test]
fn sixteen_bits_come_near() {
    let expected = expected("dino");
    let half =
        GroundingDino::load("hf/test/dino", &fixture("dino"), &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
    let best = |found: &[Vec<DetectedBox>]| found.iter().map(|found| found[0].score).collect::<Vec<_>>();
    let ours = best(&detected(&half, expected.pictures[0].size, &expected.phrases));
    let off = ours.iter().zip(best(&expected.pictures[0].seen.found())).map(|(a, b)| (a - b).abs());
    let off = off.fold(0.0, f32::max);
    assert!((1e-6..0.1).contains(&off), "{off}");
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    let mut untold = Vec::new();
    let huge = serde_json::Value::from(1_u64 << 60);
    for (file, place, value, told) in [
        ("config.json", "/model_type", "detr".into(), vec!["config.json", "detr is neither"]),
        ("config.json", "/d_model", 64.into(), vec!["input_proj_vision.0.0.weight", "not [64, 8, 1, 1]"]),
        ("config.json", "/d_model", 48.into(), vec!["d_model", "32 groups"]),
        ("config.json", "/d_model", huge.clone(), vec!["d_model"]),
        ("config.json", "/num_queries", 21.into(), vec!["query_position_embeddings.weight", "[20, 32], not [21, 32]"]),
        ("config.json", "/num_queries", 0.into(), vec!["num_queries"]),
        ("config.json", "/encoder_layers", 3.into(), vec!["encoder.layers.2.fusion_layer", "missing"]),
        ("config.json", "/decoder_layers", huge.clone(), vec!["decoder_layers"]),
        ("config.json", "/encoder_attention_heads", 3.into(), vec!["encoder_attention_heads", "odd"]),
        ("config.json", "/decoder_attention_heads", 5.into(), vec!["decoder_attention_heads", "divide"]),
        ("config.json", "/decoder_n_points", 2.into(), vec!["encoder_attn.sampling_offsets.weight", "[96, 32]"]),
        ("config.json", "/encoder_ffn_dim", 64.into(), vec!["vision_proj.weight", "[24, 32], not [32, 32]"]),
        ("config.json", "/num_feature_levels", 2.into(), vec!["num_feature_levels", "fewer than the backbone's 3"]),
        ("config.json", "/num_feature_levels", huge.clone(), vec!["num_feature_levels"]),
        ("config.json", "/num_feature_levels", 5.into(), vec!["input_proj_vision.4.0.weight", "missing"]),
        ("config.json", "/two_stage", false.into(), vec!["two_stage"]),
        ("config.json", "/position_embedding_type", "learned".into(), vec!["position_embedding_type"]),
        ("config.json", "/max_text_len", 2.into(), vec!["max_text_len"]),
        ("config.json", "/text_config/hidden_size", 17.into(), vec!["text_config.num_attention_heads"]),
        ("config.json", "/text_config/hidden_size", 32.into(), vec!["text_backbone.embeddings.", "not [2, 32]"]),
        ("config.json", "/text_config/model_type", "roberta".into(), vec!["text_config.model_type", "roberta"]),
        ("config.json", "/backbone_config/embed_dim", 8.into(), vec!["patch_embeddings", "[4, 3, 4, 4]"]),
        ("config.json", "/backbone_config/embed_dim", huge.clone(), vec!["backbone_config.width"]),
        ("config.json", "/backbone_config/num_heads", serde_json::json!([1, 0, 2, 2]), vec!["backbone_config.heads"]),
        ("config.json", "/backbone_config/depths", serde_json::json!([]), vec!["backbone_config.depths"]),
        ("config.json", "/backbone_config/model_type", "resnet".into(), vec!["backbone_config.model_type", "resnet"]),
        ("config.json", "/backbone_config/mlp_ratio", 0.5.into(), vec!["backbone_config.mlp_ratio"]),
        ("config.json", "/backbone_config/out_indices", serde_json::json!([0, 2]), vec!["backbone_config.out_indices"]),
        (
            "config.json",
            "/backbone_config/out_indices",
            serde_json::json!([2, 9]),
            vec!["backbone_config.outputs", "8"],
        ),
        ("config.json", "/backbone_config/patch_size", 2.into(), vec!["backbone_config.patch_size"]),
        ("preprocessor_config.json", "/image_processor_type", "CLIPImageProcessor".into(), vec!["CLIPImageProcessor"]),
        ("preprocessor_config.json", "/size/longest_edge", huge, vec!["size: edges of 72"]),
        ("preprocessor_config.json", "/size/shortest_edge", 0.into(), vec!["size: edges of 0"]),
        ("preprocessor_config.json", "/resample", 3.into(), vec!["resample: 3"]),
        ("preprocessor_config.json", "/image_std", serde_json::json!([1.0, 0.0, 1.0]), vec!["image_std"]),
    ] {
        let folder = copy("dino_mm");
        set(folder.path(), file, place, value);
        let error = load(folder.path()).err().map_or_else(String::new, |error| error.to_string());
        let names_file = error.contains(file) || error.contains("model.safetensors");
        if !(names_file && told.iter().all(|told| error.contains(told))) {
            untold.push(format!("{place}: {error}"));
        }
    }
    assert!(untold.is_empty(), "{untold:#?}");
}

#[test]
fn a_file_that_is_cut_off_or_missing_is_named() {
    damaged_files_are_named("dino_mm", load);
}

#[test]
fn a_checkpoint_of_another_model_names_the_first_tensor_that_it_lacks() {
    let folder = copy("dino_mm");
    for other in ["dino", "bert"] {
        std::fs::copy(fixture(other).join("model.safetensors"), folder.path().join("model.safetensors")).unwrap();
        let error = refused(load(folder.path()));
        assert!(error.contains("model.safetensors: tensor model."), "{error}");
    }
}
