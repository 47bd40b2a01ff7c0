//! Generated instructions for paths of any platform, written in each format. Where Python is available, copies of the
//! field's own loaders read them back.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and says what it skipped")]

use serde_json::{Value, json};
use std::{path::Path, process::Command};
use wayword_core::{DVec3, Heading, ObjectId, PathMotion, PathTarget, SceneId, ViewpointId, path::PathStop};
use wayword_formats::{DatasetFormat, Episode, r2r, read_any_format, reverie, rxr, vlnce, write_sidecar};

const EYE_HEIGHT_M: f64 = 1.5;

fn path(id: &str, object: Option<&str>) -> wayword_core::Path {
    let stop = |(n, (x, y)): (usize, (f64, f64))| PathStop {
        position: DVec3::new(x, y, EYE_HEIGHT_M),
        viewpoint: Some(ViewpointId::new(format!("v{n}")).unwrap()),
        level: Some(1),
    };
    let stops = [(0.0, 0.0), (0.0, 2.0), (3.0, 2.0)].into_iter().enumerate().map(stop).collect();
    let object = object.map(|id| ObjectId::new(id).unwrap());
    wayword_core::Path {
        id: id.to_owned(),
        scene: SceneId::new("house1").unwrap(),
        frames: wayword_core::Path::frames_along(stops, Some(Heading::new(1.0).unwrap())),
        motion: PathMotion::Known,
        target: object.map(|object| PathTarget {
            object,
            name: "plant".into(),
            told_by: Vec::new(),
            has_namesake: false,
            descriptions: Vec::new(),
            hangs: false,
            storeys: 0,
        }),
    }
}

fn episode(id: &str, object: Option<&str>, texts: &[&str]) -> Episode {
    let path = path(id, object);
    Episode::from_path(&path, texts.iter().map(|text| (*text).to_owned()).collect())
        .with_floor_positions(&path, EYE_HEIGHT_M)
}

/// A path with a number as its name, as in Matterport3D, and two with other names, as in a house; four instructions
/// together.
fn episodes() -> Vec<Episode> {
    let mut plain = episode("0", Some("66"), &["Turn left and walk to the plant.", "Go on, then stop by the plant."]);
    plain.extra.insert("provenance".into(), json!({"writer": "rules"}));
    vec![plain, episode("house2-3-17", Some("12"), &["Walk on."]), episode("house2-3-18", None, &["Stop."])]
}

fn write(format: DatasetFormat, file: &Path, episodes: &[Episode]) {
    match format {
        DatasetFormat::R2r => r2r::write_r2r_file(file, episodes),
        DatasetFormat::Reverie => reverie::write_reverie_file(file, episodes),
        DatasetFormat::Rxr => rxr::write_rxr_file(file, episodes),
        DatasetFormat::Vlnce => vlnce::write_vlnce_file(file, &vlnce::VlnceDataset::from_episodes(episodes.to_vec())),
        other => unreachable!("{other} is not written from episodes"),
    }
    .unwrap();
}

fn written(format: DatasetFormat, episodes: &[Episode]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("export.json");
    write(format, &file, episodes);
    let text = std::fs::read_to_string(&file).unwrap();
    serde_json::from_str(&text)
        .unwrap_or_else(|_| text.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()).collect())
}

#[test]
fn the_fields_own_loaders_read_what_is_written() {
    if Command::new("python3").arg("--version").output().is_err() {
        println!("skipped: there is no python3 to run the field's loaders");
        return;
    }
    let loaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field_loaders.py");
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        (DatasetFormat::R2r, "a.json"),
        (DatasetFormat::Reverie, "b.json"),
        (DatasetFormat::Rxr, "c.jsonl"),
        (DatasetFormat::Rxr, "c.jsonl.gz"),
    ];
    for (format, name) in
        cases.into_iter().chain([(DatasetFormat::Vlnce, "d.json"), (DatasetFormat::Vlnce, "d.json.gz")])
    {
        let file = folder.path().join(name);
        write(format, &file, &episodes());
        let output = Command::new("python3").arg(&loaders).args([format.name()]).arg(&file).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
        assert_eq!(said, "4", "{format}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn the_loader_check_crashes_on_an_unknown_key() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("d.json");
    write(DatasetFormat::Vlnce, &file, &episodes());
    let text =
        std::fs::read_to_string(&file).unwrap().replacen("\"episode_id\"", "\"style\":\"r2r\",\"episode_id\"", 1);
    std::fs::write(&file, text).unwrap();
    let loaders = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field_loaders.py");
    match Command::new("python3").arg(loaders).arg("vlnce").arg(&file).output() {
        Ok(output) => assert!(String::from_utf8_lossy(&output.stderr).contains("TypeError")),
        Err(_) => println!("skipped: there is no python3 to run the field's loaders"),
    }
}

#[test]
fn detect_recognises_every_export_by_its_content() {
    let folder = tempfile::tempdir().unwrap();
    for format in [DatasetFormat::R2r, DatasetFormat::Reverie, DatasetFormat::Rxr, DatasetFormat::Vlnce] {
        let file = folder.path().join("export");
        write(format, &file, &episodes());
        assert_eq!(wayword_formats::detect_format(&file).unwrap(), format);
        let texts: Vec<_> =
            read_any_format(&file).unwrap().into_iter().flat_map(|episode| episode.instructions).collect();
        assert_eq!(texts, episodes().into_iter().flat_map(|episode| episode.instructions).collect::<Vec<_>>());
    }
}

#[test]
fn a_path_whose_name_is_no_number_gets_one_and_keeps_its_name() {
    let items = written(DatasetFormat::Reverie, &episodes());
    assert_eq!(items[0]["id"], "0_66");
    assert_eq!(items[0]["objId"], 66);
    assert_eq!(items[0]["provenance"], json!({"writer": "rules"}));
    assert_eq!(
        (&items[1]["id"], &items[1]["path_id"], &items[1]["path_name"]),
        (&json!("1_12"), &json!(1), &json!("house2-3-17"))
    );
    assert_eq!((&items[2]["id"], items[2].get("objId")), (&json!("2"), None));
}

#[test]
fn r2r_gets_one_item_per_path_and_heading() {
    let mut turned = episode("7", Some("3"), &["three"]);
    turned.start_heading = Some(Heading::new(2.0).unwrap());
    let items =
        written(DatasetFormat::R2r, &[episode("7", Some("1"), &["one"]), episode("7", Some("2"), &["two"]), turned]);
    assert_eq!(items.as_array().unwrap().len(), 2);
    assert_eq!((&items[0]["path_id"], &items[0]["instructions"]), (&json!(7), &json!(["one", "two"])));
    assert_eq!((&items[1]["path_id"], &items[1]["path_name"]), (&json!(0), &json!("7")));
    assert_eq!(items[0]["distance"], 5.0);
}

#[test]
fn reverie_refuses_two_items_of_one_id() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("export.json");
    let twice = [episode("7", Some("1"), &["one"]), episode("7", Some("1"), &["two"])];
    assert!(
        reverie::write_reverie_file(&file, &twice)
            .unwrap_err()
            .to_string()
            .contains("has the same path and object as another")
    );
    assert!(!file.exists());
}

#[test]
fn rxr_drops_the_annotators_fields_of_a_replaced_text() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("guide.jsonl");
    let line = json!({"split": "val_seen", "instruction_id": 4, "annotator_id": 31, "language": "hi-IN", "path_id": 9,
        "scan": "house1", "path": ["a"], "heading": 0.5, "instruction": "as spoken", "edit_distance": 0.5,
        "timed_instruction": [{"word": "as", "start_time": 0.0, "end_time": 1.0}]});
    std::fs::write(&file, line.to_string()).unwrap();
    let mut episodes = rxr::read_rxr_file(&file).unwrap();
    assert_eq!(written(DatasetFormat::Rxr, &episodes), line);
    episodes[0].instructions = vec!["Walk on.".into()];
    let anew = written(DatasetFormat::Rxr, &episodes);
    assert_eq!(
        (&anew["annotator_id"], &anew["language"], &anew["edit_distance"]),
        (&json!(0), &json!("en-US"), &json!(0.0))
    );
    assert_eq!(anew["timed_instruction"], json!([{"word": "Walk"}, {"word": "on."}]));
    assert_eq!((&anew["instruction_id"], &anew["split"]), (&json!(4), &json!("val_seen")));
}

#[test]
fn vlnce_positions_are_on_the_floor_in_habitats_frame() {
    let dataset = written(DatasetFormat::Vlnce, &[episode("3", None, &["Walk on."])]);
    let episode = &dataset["episodes"][0];
    assert_eq!(episode["reference_path"], json!([[0.0, 0.0, -0.0], [0.0, 0.0, -2.0], [3.0, 0.0, -2.0]]));
    assert_eq!(episode["start_position"], episode["reference_path"][0]);
    assert_eq!(episode["goals"], json!([{"position": [3.0, 0.0, -2.0], "radius": 3.0}]));
    assert_eq!(
        (&episode["scene_id"], &episode["info"]["geodesic_distance"]),
        (&json!("mp3d/house1/house1.glb"), &json!(5.0))
    );
}

#[test]
fn vlnce_keeps_a_vocabulary_that_agents_know() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("d.json");
    let words = ["<pad>", "<unk>", "walk", "on", "."].map(str::to_owned).to_vec();
    let vocabulary = wayword_formats::TokenVocabulary::new(words.clone());
    vlnce::write_vlnce_file(
        &file,
        &vlnce::VlnceDataset { episodes: vec![episode("3", None, &["Walk past, on."])], vocabulary },
    )
    .unwrap();
    let dataset: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    assert_eq!(dataset["instruction_vocab"]["word_list"], json!(words));
    assert_eq!(
        dataset["episodes"][0]["instruction"]["instruction_tokens"].as_array().unwrap()[..5],
        [2, 1, 3, 4, 0].map(Value::from)
    );
}

#[test]
fn writers_refuse_paths_without_viewpoints_or_floors() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("export.json");
    let scene = SceneId::new("house1").unwrap();
    let mut nowhere = Episode::new("1", "1", scene);
    nowhere.instructions.push("Go.".into());
    let r2r = r2r::write_r2r_file(&file, std::slice::from_ref(&nowhere)).unwrap_err().to_string();
    assert!(r2r.contains("names no viewpoints") && r2r.contains("vlnce"), "{r2r}");
    let vlnce =
        vlnce::write_vlnce_file(&file, &vlnce::VlnceDataset::from_episodes(vec![nowhere])).unwrap_err().to_string();
    assert!(vlnce.contains("no floor positions"), "{vlnce}");
}

#[test]
fn no_writer_invents_poses_for_a_path_without_them() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("export.json");
    let video = wayword_core::Path { motion: PathMotion::Unknown, ..path("7", None) };
    let episode = Episode::from_path(&video, vec!["Go on.".into()]).with_floor_positions(&video, EYE_HEIGHT_M);
    assert_eq!((episode.start_heading, episode.floor_length_m()), (None, None));
    let episode = std::slice::from_ref(&episode);
    for refused in [
        r2r::write_r2r_file(&file, episode),
        reverie::write_reverie_file(&file, episode),
        rxr::write_rxr_file(&file, episode),
    ] {
        assert!(refused.unwrap_err().to_string().contains("names no viewpoints"));
    }
    let refused = vlnce::write_vlnce_file(&file, &vlnce::VlnceDataset::from_episodes(episode.to_vec()));
    assert!(refused.unwrap_err().to_string().contains("no floor positions"));
    assert!(!file.exists());
}

#[test]
fn write_sidecar_puts_the_file_next_to_its_dataset() {
    let folder = tempfile::tempdir().unwrap();
    let dataset = folder.path().join("d.json.gz");
    let sidecar =
        write_sidecar(&dataset, &[json!({"episode_id": "0_0"}), json!({"episode_id": "0_1"})]).unwrap().unwrap();
    assert_eq!(sidecar, folder.path().join("d.json.gz.provenance.jsonl"));
    assert_eq!(std::fs::read_to_string(sidecar).unwrap(), "{\"episode_id\":\"0_0\"}\n{\"episode_id\":\"0_1\"}\n");
}

#[cfg(unix)]
#[test]
fn a_pipe_is_written_through_and_a_link_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let (pipe, real, link) = (folder.path().join("pipe"), folder.path().join("real.json"), folder.path().join("link"));
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let episodes = [episode("1", None, &["Stop."])];
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || std::fs::read_to_string(pipe).unwrap())
    };
    r2r::write_r2r_file(&pipe, &episodes).unwrap();
    let through = reader.join().unwrap();
    std::fs::write(&real, "old").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    r2r::write_r2r_file(&link, &episodes).unwrap();
    assert_eq!(std::fs::read_to_string(&real).unwrap(), through);
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(write_sidecar(&pipe, &[json!({})]).unwrap(), None);
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 3, "{left:?}");
}
