//! `wayword similarity --metrics --clip`: texts against the pictures of a run or a platform.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, Ran, run};

/// A building with pictures.
fn building() -> Building {
    let building = Building::new();
    wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
    building
}

fn metrics(building: &Building, a: &str, args: &[&str]) -> Ran {
    let all = ["similarity", a, EPISODES, "--metrics", "--resamples", "100", "--json"];
    run(building.command(&[&all[..], args].concat()).env("WAYWORD_OFFLINE", "1"))
}

#[cfg(not(feature = "local"))]
#[test]
fn clip_metric_in_a_build_without_models_hints_at_the_feature() {
    let ran = metrics(&building(), EPISODES, &["--clip", "hf/org/clip", "--platform", "matterport", "--data", "data"]);
    assert!(ran.refused().contains("hf/org/clip") && ran.err.contains("--features full"), "{ran:?}");
}

#[cfg(feature = "local")]
mod with_clip {
    use super::{building, metrics};
    use crate::common::{Building, EPISODES};
    use serde_json::{Value, json};
    use std::{fs, path::Path};
    use tempfile::TempDir;
    use wayword_core::Image;
    use wayword_local::{ClipModel, ModelDevice, WeightPrecision};

    /// The path of a fixture of `wayword-local`.
    fn fixture(name: &str) -> String {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/wayword-local/fixtures");
        folder.join(name).canonicalize().unwrap().display().to_string()
    }

    /// The tiny random CLIP with its text vectors turned round: the cosines of our pictures and texts are below zero in it, so
    /// all scores would be 0.
    struct Turned(TempDir);

    impl Turned {
        fn new() -> Self {
            let folder = tempfile::tempdir().unwrap();
            for file in fs::read_dir(fixture("clip")).unwrap() {
                let file = file.unwrap();
                fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
            }
            let weights = folder.path().join("model.safetensors");
            let mut bytes = fs::read(&weights).unwrap();
            let start = 8 + u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
            let header: Value = serde_json::from_slice(&bytes[8..start]).unwrap();
            let projection = &header["text_projection.weight"];
            assert_eq!(projection["dtype"], "F32");
            let [from, to] = [0, 1].map(|end| start + projection["data_offsets"][end].as_u64().unwrap() as usize);
            // The sign is the highest bit of a number's last byte.
            bytes[from..to].iter_mut().skip(3).step_by(4).for_each(|byte| *byte ^= 0x80);
            fs::write(&weights, bytes).unwrap();
            Self(folder)
        }

        fn name(&self) -> String {
            format!("hf/{}", self.0.path().display())
        }
    }

    fn clip() -> String {
        format!("hf/{}", fixture("clip"))
    }

    /// The items of the episodes, each with these texts.
    fn items(building: &Building, texts: impl Fn(usize, &Value) -> Value) -> Value {
        let mut items: Vec<Value> = serde_json::from_slice(&fs::read(building.reverie()).unwrap()).unwrap();
        for (at, item) in items.iter_mut().enumerate() {
            item["instructions"] = texts(at, &item["instructions"]);
        }
        items.into()
    }

    /// The vectors of a run's pictures of an item.
    fn pictures(clip: &ClipModel, folder: &Path, item: &str) -> Vec<Vec<f32>> {
        let file = |frame: usize| folder.join(format!("{item}_{frame}.jpg"));
        let frames = (0..).map(file).take_while(|file| file.exists());
        let decoded = frames.map(|file| image::open(file).unwrap().into_rgb8());
        let images: Vec<Image> =
            decoded.map(|image| Image::new(image.width(), image.height(), image.into_raw()).unwrap()).collect();
        assert!(images.len() > 1);
        clip.image_features(&images.iter().collect::<Vec<_>>()).unwrap()
    }

    /// By CLIPScore's formula, of each picture.
    fn scores(clip: &ClipModel, pictures: &[Vec<f32>], text: &str) -> Vec<f64> {
        let text = &clip.text_features(&[&format!("A photo depicts {text}")]).unwrap()[0];
        let cosine = |picture: &Vec<f32>| -> f32 { picture.iter().zip(text).map(|(a, b)| a * b).sum() };
        pictures.iter().map(|picture| 2.5 * f64::from(cosine(picture)).max(0.0)).collect()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn figures_are_those_of_the_models_own_vectors() {
        let building = building();
        building.run_over_episodes("run");
        let (whole, sentences) = ("Red door. The door.", ["Red door.", "The door."]);
        let odd = "The red.";
        let texts = |at: usize, _: &Value| json!([if at.is_multiple_of(2) { whole } else { odd }]);
        let mine = items(&building, texts);
        building.write("mine.json", mine.to_string());
        let turned = Turned::new();
        let ran = metrics(&building, "mine.json", &["--clip", &turned.name(), "--pictures", "run"]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let found = &ran.json()["pictures"];

        let model = ClipModel::load("hf/x/clip", turned.0.path(), &ModelDevice::cpu(), WeightPrecision::F32).unwrap();
        let (mut of_parts, mut of_whole) = (Vec::new(), Vec::new());
        let records = building.records("run");
        let mut ids: Vec<&str> = records.iter().map(|record| record.path.id.as_str()).collect();
        ids.dedup();
        let all = mine.as_array().unwrap();
        for (at, item) in all.iter().enumerate() {
            // The run's items have REVERIE's names.
            let Some(id) = ids.iter().find(|id| **id == item["id"].as_str().unwrap()) else { continue };
            let pictures = pictures(&model, &building.path("run/frames"), id);
            let best = |text: &str| scores(&model, &pictures, text).into_iter().fold(0.0, f64::max);
            let is_whole = at.is_multiple_of(2);
            of_parts.push(if is_whole { mean(&sentences.map(best)) } else { best(odd) });
            of_whole.push(mean(&scores(&model, &pictures, if is_whole { whole } else { odd })));
        }
        assert!(of_parts.len() > 2 && mean(&of_parts) > 0.0, "{of_parts:?}");
        assert_eq!(found["text"]["parts"]["values"], of_parts.len(), "{found}");
        for (name, values) in [("parts", &of_parts), ("whole", &of_whole)] {
            let figure = found["text"][name]["mean"].as_f64().unwrap();
            assert!((figure - mean(values)).abs() < 1e-5, "{name}: {figure} for {}", mean(values));
        }
        assert_eq!(found["prefix"], "A photo depicts ");
        assert_eq!(found["clip"], turned.name());
    }

    #[test]
    fn anchors_are_another_persons_text_and_another_paths() {
        let building = building();
        building.run_over_episodes("run");
        // Of each item only the second person's text.
        building.write("second.json", items(&building, |_, texts| json!([texts[1]])).to_string());
        let turned = Turned::new();
        let of = |a: &str| {
            metrics(&building, a, &["--clip", &turned.name(), "--pictures", "run"]).json()["pictures"].clone()
        };
        let (first, second) = (of(EPISODES), of("second.json"));
        assert_eq!(first["person"], second["text"], "{first} {second}");
        assert_ne!(first["text"], first["other_path"]);
        assert_eq!(first["other_path"], second["other_path"], "the same paths are drawn");
        assert_eq!(first["without_person"], 0);
    }

    #[test]
    fn pictures_come_from_the_run_that_is_judged_or_are_drawn_anew() {
        let building = building();
        building.run_over_episodes("run");
        let turned = Turned::new();
        let figure = |args: &[&str], a: &str| {
            let ran = metrics(&building, a, &[&["--clip", &turned.name()], args].concat());
            assert_eq!(ran.code, Some(0), "{ran:?}");
            ran.json()["pictures"]["text"]["parts"].clone()
        };
        let own = figure(&[], "run#reverie");
        assert!(own["mean"].as_f64() > Some(0.0), "{own}");
        assert_eq!(own, figure(&["--pictures", "run"], "run#reverie"));
        assert!(figure(&["--by", "path"], "run#reverie")["clusters"] == own["clusters"]);
        let drawn = figure(&["--platform", "matterport", "--data", "data"], "run#reverie");
        // A run keeps JPEG files.
        let off = own["mean"].as_f64().unwrap() - drawn["mean"].as_f64().unwrap();
        assert!(off.abs() < 0.05 && own["values"] == drawn["values"], "{own} {drawn}");
        let of_episodes = figure(&["--platform", "matterport", "--data", "data"], EPISODES);
        assert!(of_episodes["values"].as_u64() > Some(2), "{of_episodes}");
        let told = building.wayword(&["similarity", "run#reverie", EPISODES, "--metrics", "--clip", &clip()]);
        assert!(told.out.contains("with pictures, by hf/") && told.out.contains("left from right"), "{told:?}");
    }

    #[test]
    fn similarity_reports_items_without_pictures() {
        let blind = Building::new();
        blind.run_over_episodes("run");
        let with = |building: &Building, args: &[&str]| {
            let ran = metrics(building, EPISODES, &[&["--clip", &clip()], args].concat());
            ran.refused().to_owned()
        };
        assert!(with(&blind, &[]).contains("--pictures RUN"));
        assert!(with(&blind, &["--pictures", "run"]).contains("this run has no pictures"));
        assert!(with(&blind, &["--pictures", "data"]).contains("there is no run in it"));
        let drawn = with(&blind, &["--platform", "matterport", "--data", "data"]);
        assert!(drawn.contains("there is no picture of any of"), "{drawn}");

        let building = building();
        building.run_over_episodes("run");
        let bert = format!("hf/{}", fixture("bert"));
        let ran = metrics(&building, "run#reverie", &["--clip", &bert]);
        assert!(ran.refused().contains("choose a CLIP model"), "{ran:?}");
        let none = metrics(&building, "run#reverie", &["--clip", "labels"]);
        assert!(none.refused().contains("labels"), "{none:?}");
        let alone = building.wayword(&["similarity", "run#reverie", EPISODES, "--clip", &clip()]);
        assert!(alone.refused().contains("--metrics"), "{alone:?}");
        let frame = fs::read_dir(building.path("run/frames")).unwrap().next().unwrap().unwrap().path();
        fs::write(&frame, "no picture").unwrap();
        let damaged = metrics(&building, "run#reverie", &["--clip", &clip()]);
        let name = frame.file_name().unwrap().to_str().unwrap();
        assert!(damaged.refused().contains(name) && damaged.err.contains("missing or damaged"), "{damaged:?}");
    }
}
