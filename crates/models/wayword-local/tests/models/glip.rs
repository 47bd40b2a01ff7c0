//! Compares GLIP with an oracle in PyTorch: `fixtures/make_glip.py` made the numbers.

use crate::common::{copy, drawn, fixture, refused, set, view};
use candle_core::{Device as On, Tensor, safetensors};
use std::{collections::HashMap, path::Path};
use wayword_core::{DetectorGrounder, ModelError, ObjectDetector, PhraseGrounder};
use wayword_local::{
    DownloadProgress, GlipDetector, GlipFiles, HubConfig, LocalError, ModelDevice, ModelHub, ModelName, WeightPrecision,
};

fn load_from(folder: &Path, short: usize) -> Result<GlipDetector, LocalError> {
    let files = GlipFiles { weights: folder.join("glip.pth"), tokenizer: folder.to_owned(), identity: String::new() };
    GlipDetector::load("hf/test/glip:glip.pth", &files, short, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Case {
    size: (u32, u32),
    short: usize,
    phrases: Vec<String>,
    boxes: Vec<Vec<[f32; 5]>>,
}

impl Case {
    fn phrases(&self) -> Vec<&str> {
        self.phrases.iter().map(String::as_str).collect()
    }
}

fn cases() -> Vec<Case> {
    serde_json::from_str(&std::fs::read_to_string(fixture("glip").join("expected.json")).unwrap()).unwrap()
}

fn expected() -> HashMap<String, Tensor> {
    safetensors::load(fixture("glip").join("expected.safetensors"), &On::Cpu).unwrap()
}

fn numbers(tensor: &Tensor) -> Vec<f32> {
    tensor.flatten_all().unwrap().to_vec1().unwrap()
}

fn off(ours: &[f32], theirs: &[f32]) -> f32 {
    assert_eq!(ours.len(), theirs.len());
    ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[track_caller]
fn agrees(glip: &GlipDetector, case: &Case, expected: &HashMap<String, Tensor>, at: &str) {
    let (logits, boxes) = glip.raw_outputs(&drawn(case.size), &case.phrases()).unwrap();
    let column = |from: usize, to: usize| boxes.chunks(5).flat_map(|row| row[from..to].to_vec()).collect::<Vec<f32>>();
    for (name, ours) in [("logits", logits), ("deltas", column(0, 4)), ("centres", column(4, 5))] {
        let off = off(&ours, &numbers(&expected[&format!("{name}{at}")]));
        assert!(off < 2e-5, "{name}{at}: {off}");
    }
}

#[test]
fn head_outputs_agree_with_the_oracle() {
    let expected = expected();
    for (at, case) in cases().iter().enumerate() {
        agrees(&load_from(&fixture("glip"), case.short).unwrap(), case, &expected, &at.to_string());
    }
}

#[test]
fn outputs_differ_from_those_of_likely_mistakes() {
    // The oracle with each trap gives other logits, from which we are far.
    let expected = expected();
    for (at, case) in cases().iter().enumerate() {
        let (logits, _) =
            load_from(&fixture("glip"), case.short).unwrap().raw_outputs(&drawn(case.size), &case.phrases()).unwrap();
        for trap in ["offsets", "corners", "residual"] {
            let off = off(&logits, &numbers(&expected[&format!("{trap}{at}")]));
            assert!(off > 0.1, "{trap}{at}: {off}");
        }
    }
}

#[test]
fn boxes_and_scores_agree_with_the_oracle() {
    for case in cases() {
        let glip = load_from(&fixture("glip"), case.short).unwrap();
        let found = glip.find_phrases(&drawn(case.size), &case.phrases()).unwrap();
        assert_eq!(found.len(), case.boxes.len());
        for (found, expected) in found.iter().zip(&case.boxes) {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                let off = off(&found.box_px, &expected[..4]);
                assert!(off < 1e-3 && (found.score - expected[4]).abs() < 2e-5, "{found:?} for {expected:?}");
            }
        }
    }
}

/// Collects the notes for the user.
#[derive(Default)]
struct Notes(std::sync::Mutex<Vec<String>>);

impl DownloadProgress for Notes {
    fn bytes_arrived(&self, _: &str, _: u64, _: Option<u64>) {}

    fn show_note(&self, note: &str) {
        self.0.lock().unwrap().push(note.to_owned());
    }
}

#[test]
fn files_are_found_by_name_and_the_licence_is_noted() {
    let cache = tempfile::tempdir().unwrap();
    let mut config = HubConfig::new(cache.path().to_owned());
    config.offline = true;
    let hub = ModelHub::new(config).unwrap();
    let name = |file: &str| ModelName::parse(&format!("hf/{}", fixture("glip").join(file).display())).unwrap();
    let notes = Notes::default();
    let files = GlipFiles::find_files(&hub, &name("glip.pth"), &notes).unwrap();
    assert_eq!((files.weights, files.tokenizer), (fixture("glip").join("glip.pth"), fixture("glip")));
    let notes = notes.0.into_inner().unwrap();
    assert!(notes.len() == 2 && notes[0].contains("SHA-256") && notes[1] == wayword_local::GLIP_LICENCE, "{notes:?}");
    let error = GlipFiles::find_files(&hub, &name(""), &()).unwrap_err().to_string();
    assert!(error.contains("GLIPModel/GLIP:glip_tiny"), "{error}");
}

#[test]
fn a_view_without_a_picture_does_not_fail_the_others() {
    let (glip, case) = (load_from(&fixture("glip"), 96).unwrap(), &cases()[0]);
    let (shown, blank) = (view(Some(drawn(case.size))), view(None));
    let found = glip.detect_phrases(&[&shown, &blank, &shown], &["blue chair", "", "sink"]);
    assert!(matches!(&found[1], Err(ModelError::NothingToSee { name, .. }) if name == glip.name()));
    let of_shown = found[0].as_ref().unwrap();
    assert_eq!(Ok(of_shown), found[2].as_ref());
    // A phrase without words is found nowhere; scores are sorted, and boxes lie in the picture.
    assert_eq!(of_shown.iter().map(Vec::is_empty).collect::<Vec<_>>(), [false, true, false]);
    for found in of_shown {
        assert!(found.is_sorted_by(|a, b| a.score >= b.score) && found.len() <= wayword_core::MAX_BOXES_PER_PHRASE);
        let inside =
            |[left, top, right, bottom]: [f32; 4]| left >= 0.0 && top >= 0.0 && right <= 160.0 && bottom <= 96.0;
        assert!(found.iter().all(|found| inside(found.box_px) && (0.0..=1.0).contains(&found.score)));
    }
    assert_eq!(glip.detect_phrases(&[&shown], &[]), [Ok(Vec::new())]);
}

#[test]
fn a_phrase_is_grounded_by_itself() {
    let (glip, case) = (load_from(&fixture("glip"), 96).unwrap(), &cases()[0]);
    assert!(glip.scoring().phrases_interact);
    let alone = glip.find_phrases(&drawn(case.size), &["sink"]).unwrap()[0][0].score;
    let together = glip.find_phrases(&drawn(case.size), &["blue chair", "sink"]).unwrap()[1][0].score;
    let shown = view(Some(drawn(case.size)));
    let scores = DetectorGrounder::new(glip).score_phrases(&[&shown], &["blue chair", "sink"]).remove(0).unwrap();
    assert_eq!(scores[1], alone);
    assert!((alone - together).abs() > 1e-4);
}

#[test]
fn many_phrases_go_into_several_prompts() {
    // The fixture's texts have at most 64 tokens.
    let (glip, case) = (load_from(&fixture("glip"), 96).unwrap(), &cases()[0]);
    let phrases = vec!["wooden door"; 50];
    let found = glip.find_phrases(&drawn(case.size), &phrases).unwrap();
    assert!(found.len() == 50 && found.iter().all(|found| !found.is_empty()));
    let long = vec!["lamp"; 70].join(" ");
    let error = glip.find_phrases(&drawn(case.size), &["sink", &long]).unwrap_err().to_string();
    assert!(error.contains("lamp lamp") && error.contains("64 tokens"), "{error}");
    let shown = view(Some(drawn(case.size)));
    assert!(matches!(&glip.detect_phrases(&[&shown], &[&long])[0], Err(ModelError::Failed { .. })));
}

#[test]
fn sixteen_bits_come_near() {
    let case = &cases()[0];
    let files =
        GlipFiles { weights: fixture("glip").join("glip.pth"), tokenizer: fixture("glip"), identity: String::new() };
    let half = GlipDetector::load("half", &files, 96, &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
    let (logits, _) = half.raw_outputs(&drawn(case.size), &case.phrases()).unwrap();
    let expected = numbers(&expected()["logits0"]);
    let mean = logits.iter().zip(&expected).map(|(a, b)| (a - b).abs()).sum::<f32>() / logits.len() as f32;
    assert!((1e-5..0.2).contains(&mean), "{mean}");
}

/// A copy of the fixture in which one value of the configuration was changed.
fn changed(place: &str, value: serde_json::Value) -> tempfile::TempDir {
    let folder = copy("glip");
    set(folder.path(), "config.json", place, value);
    folder
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    for (place, value, told) in [
        ("/model_type", "blip".into(), vec!["config.json", "blip is not glip"]),
        (
            "/swin/width",
            8.into(),
            vec!["glip.pth", "backbone.body.patch_embed.proj.weight", "[4, 3, 4, 4], not [8, 3, 4, 4]"],
        ),
        ("/swin/depths", serde_json::json!([1, 2, 1]), vec!["config.json", "4 stages"]),
        ("/swin/depths/1", 3.into(), vec!["backbone.body.layers.1.blocks.2.", "missing"]),
        ("/swin/window", (1_u64 << 40).into(), vec!["config.json", "swin.window"]),
        ("/text/num_hidden_layers", 3.into(), vec!["language_backbone.body.model.encoder.layer.2.", "missing"]),
        ("/text/num_attention_heads", 3.into(), vec!["config.json", "text.num_attention_heads"]),
        ("/text/vocab_size", 14.into(), vec!["tokenizer.json", "knows 14"]),
        ("/head/rounds", 3.into(), vec!["rpn.head.dyhead_tower.6.", "missing"]),
        ("/head/rounds", 17.into(), vec!["config.json", "head.rounds"]),
        ("/head/groups", 5.into(), vec!["config.json", "head.groups"]),
        ("/head/groups", 0.into(), vec!["config.json", "head.groups"]),
        ("/head/fusion_width", 4.into(), vec!["b_attn.attn.v_proj.weight", "[32, 16], not [16, 16]"]),
    ] {
        let folder = changed(place, value);
        let error = refused(load_from(folder.path(), 96));
        assert!(told.iter().all(|told| error.contains(told)), "{place}: {error}");
    }
    // Without a configuration the sizes are those of GLIP-T.
    let folder = changed("/model_type", "glip".into());
    std::fs::remove_file(folder.path().join("config.json")).unwrap();
    let error = refused(load_from(folder.path(), 800));
    assert!(error.contains("[4, 3, 4, 4], not [96, 3, 4, 4]"), "{error}");
    assert!(load_from(&fixture("glip"), 0).is_err());
}
