//! `wayword export` in the layouts that training code reads, and the other way: walks of these layouts as recordings.

#![cfg(all(feature = "habitat", feature = "parquet", feature = "video", feature = "lerobot"))]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{
    Building, Ran,
    models::{KEY, KEY_ENV, Stage, cast},
};
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};
use wayword_core::AgentAction;
use wayword_formats::{
    DatasetFormat, FormatError, read_any_format,
    training::{
        TextsOfWalk, TextsPutBack,
        episode_lines::write_internnav_texts,
        navila::{read_navila_walks, write_navila_texts},
        streamvln::{read_streamvln_file, write_streamvln_file, write_streamvln_texts},
    },
    trajectories::{ActionTrajectory, read_trajectories},
    vlnce_actions::read_actions,
};

const LAYOUTS: [&str; 6] = ["streamvln", "internnav", "internnav-n1", "navila", "uninavid", "lerobot"];

/// A run of two walks through a house, with two texts for each.
fn run(building: &Building) {
    let generate = [
        "generate",
        "--paths",
        "2",
        "--scan",
        "house2-1",
        "--metres",
        "4..9",
        "--style",
        "r2r",
        "--per-path",
        "2",
        "--out",
        "run",
    ];
    let ran = building.wayword(&generate);
    assert_eq!(ran.code, Some(0), "{ran:?}");
}

fn export(building: &Building, format: &str, more: &[&str]) -> Ran {
    let export = ["export", "--run", "run", "--format", format, "--size-px", "32x32", "--out", format, "--json"];
    let ran = building.wayword(&[&export[..], more].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    ran
}

fn trajectories(building: &Building, steps: &str) -> Vec<ActionTrajectory> {
    read_trajectories(&building.path(steps).join("trajectories.jsonl")).unwrap()
}

/// The texts of the run, by their actions: what each layout has to hold.
fn told(building: &Building) -> BTreeMap<String, Vec<AgentAction>> {
    let texts = |walk: ActionTrajectory| {
        let actions = walk.actions.clone();
        walk.instructions.into_iter().map(move |text| (text.text, actions.clone()))
    };
    trajectories(building, "run/steps").into_iter().flat_map(texts).collect()
}

fn files_below(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let (mut found, mut folders) = (BTreeMap::new(), vec![folder.to_owned()]);
    while let Some(place) = folders.pop() {
        for entry in fs::read_dir(place).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else {
                found.insert(entry.strip_prefix(folder).unwrap().display().to_string(), fs::read(&entry).unwrap());
            }
        }
    }
    found
}

#[test]
fn layouts_share_their_pictures_and_are_the_same_bytes_each_time() {
    let building = Building::new();
    run(&building);
    for layout in LAYOUTS {
        let told = export(&building, layout, &[]).json();
        assert_eq!(
            (&told["walks"], &told["instructions"], &told["left_out"]),
            (&json!(2), &json!(4), &json!(0)),
            "{layout}"
        );
        let first = files_below(&building.path(layout));
        let card = String::from_utf8(first["README.md"].clone()).unwrap();
        assert!(card.contains(&format!("in the layout `{layout}`")) && !card.contains("data_files"), "{card}");
        let checks = String::from_utf8(first["checks.jsonl"].clone()).unwrap();
        let line: Value = serde_json::from_str(checks.lines().next().unwrap()).unwrap();
        assert!(checks.lines().count() == 4 && line["unverified"].is_array(), "{line}");
        fs::rename(building.path(layout), building.path("before")).unwrap();
        export(&building, layout, &[]);
        assert!(files_below(&building.path(layout)) == first, "{layout} differs");
        fs::remove_dir_all(building.path("before")).unwrap();
    }
    // InternNav's needs a pitched camera; nothing else was drawn beside the usual one.
    let cameras = |steps: &str| fs::read_dir(building.path(steps).join("cameras")).unwrap().count();
    assert_eq!((cameras("run/steps"), cameras("run/steps_30deg")), (2, 1));
}

/// Puts texts back into a list of walks.
type PutBack = fn(&Path, &Path, TextsOfWalk<'_>) -> Result<TextsPutBack, FormatError>;

#[test]
fn own_readers_find_what_was_exported() {
    let building = Building::new();
    run(&building);
    for layout in ["streamvln", "navila", "internnav", "lerobot"] {
        export(&building, layout, &[]);
    }
    let told = told(&building);
    let walks = read_streamvln_file(&building.path("streamvln/train/annotations.json")).unwrap();
    let texts = walks.iter().flat_map(|walk| walk.instructions.iter().map(|text| (text.clone(), walk.actions.clone())));
    assert_eq!(texts.collect::<BTreeMap<_, _>>(), told);
    let again = building.path("again.json");
    write_streamvln_file(&again, &walks).unwrap();
    assert_eq!(fs::read(again).unwrap(), fs::read(building.path("streamvln/train/annotations.json")).unwrap());
    let walks = read_navila_walks(&building.path("navila/train/annotations.json")).unwrap();
    assert_eq!(walks.into_iter().map(|walk| (walk.text, walk.actions.unwrap())).collect::<BTreeMap<_, _>>(), told);
    // The same texts, put back into the lists that were read: the same bytes.
    for (list, put_back) in [
        ("streamvln/train/annotations.json", write_streamvln_texts as PutBack),
        ("navila/train/annotations.json", write_navila_texts),
        ("internnav/train/house2-1/meta/episodes.jsonl", write_internnav_texts),
    ] {
        let (list, out) = (building.path(list), building.path("again.json"));
        let texts: BTreeMap<String, Vec<String>> = read_any_format(&list)
            .unwrap()
            .into_iter()
            .map(|episode| (episode.scene.as_str().to_owned(), episode.instructions))
            .collect();
        put_back(&list, &out, &|scene| texts[scene].clone()).unwrap();
        assert!(fs::read(&out).unwrap() == fs::read(&list).unwrap(), "{} differs", list.display());
    }
    for (folder, format) in [
        ("streamvln/train", DatasetFormat::Streamvln),
        ("navila/train", DatasetFormat::Navila),
        ("internnav/train/house2-1", DatasetFormat::Internnav),
        ("lerobot/train", DatasetFormat::Lerobot),
    ] {
        assert_eq!(wayword_formats::detect_format(&building.path(folder)).unwrap(), format);
        let episodes = read_any_format(&building.path(folder)).unwrap();
        let read: BTreeSet<String> = episodes.into_iter().flat_map(|episode| episode.instructions).collect();
        assert_eq!(read, told.keys().cloned().collect(), "{folder}");
    }
}

#[test]
fn walks_of_a_layout_are_recordings_whose_texts_are_checked_and_put_back() {
    let building = Building::new();
    run(&building);
    for (layout, data, list) in [
        ("streamvln", "streamvln/train", "annotations.json"),
        ("navila", "navila/train", "annotations.json"),
        ("internnav", "internnav/train/house2-1", "meta/episodes.jsonl"),
    ] {
        export(&building, layout, &[]);
        let check = ["check", data, "--platform", "recording", "--data", data, "--json"];
        let ran = building.wayword(&check);
        assert!(matches!(ran.code, Some(0 | 1)), "{layout}: {ran:?}");
        let counts = ["passed", "unverified", "failed"].map(|count| ran.json()[count].as_u64().unwrap());
        assert_eq!(counts.iter().sum::<u64>(), 4, "{layout}: {ran:?}");
        assert_eq!(ran.json()["by_check"]["turns"]["unverified"], json!(0), "{layout}: its motion is known: {ran:?}");
        let aligned = building.wayword(&["align", data, "--platform", "recording", "--data", data, "--json"]);
        assert_eq!(aligned.code, Some(0), "{layout}: {aligned:?}");
        let episodes = read_any_format(&building.path(data).join(list)).unwrap();
        assert!(episodes.iter().all(|episode| episode.is_whole_recording));
    }
}

#[test]
fn texts_for_walks_that_exist_are_put_back_beside_them() {
    let stage = Stage::new(cast());
    let building = &stage.building;
    run(building);
    for (layout, data, list) in [
        ("streamvln", "streamvln/train", "streamvln/train/annotations.json"),
        ("navila", "navila/train", "navila/train/annotations.json"),
        ("internnav", "internnav/train/house2-1", "internnav/train/house2-1/meta/episodes.jsonl"),
    ] {
        export(building, layout, &[]);
        let models = stage.models();
        let mine = format!("mine_{layout}");
        let generate = ["generate", "--platform", "recording", "--data", data, "--episodes", list, "--style", "r2r"];
        let more = ["--per-path", "2", "--out", &mine, "--json"];
        let flags: Vec<&str> = generate.into_iter().chain(more).chain(models.iter().map(String::as_str)).collect();
        let ran = crate::common::run(building.command(&flags).env(KEY_ENV, KEY));
        let texts: BTreeSet<String> =
            building.records(&mine).into_iter().map(|record| record.instruction.text).collect();
        assert!(!texts.is_empty(), "{ran:?}");
        let out = format!("{list}.new");
        let put = building.wayword(&["export", "--run", &mine, "--format", layout, "--out", &out]);
        assert_eq!(put.code, Some(0), "{put:?}");
        let of = |file: &str| read_any_format(&building.path(file)).unwrap();
        let written: BTreeSet<String> = of(&out).into_iter().flat_map(|episode| episode.instructions).collect();
        assert_eq!(written, texts, "{layout}");
        let scenes = |file: &str| of(file).into_iter().map(|episode| episode.scene).collect::<BTreeSet<_>>();
        assert!(scenes(&out).is_subset(&scenes(list)));
    }
    let walks = |file: &str| read_streamvln_file(&building.path(file)).unwrap();
    let before = walks("streamvln/train/annotations.json");
    for walk in walks("streamvln/train/annotations.json.new") {
        let same = before.iter().find(|other| other.id == walk.id).unwrap();
        assert_eq!((&walk.video, &walk.actions), (&same.video, &same.actions));
    }
    let own = "streamvln/train/annotations.json";
    let over = building.wayword(&["export", "--run", "mine_streamvln", "--format", "streamvln", "--out", own]);
    assert!(over.refused().contains("--out would overwrite streamvln/train/annotations.json"), "{over:?}");
    let wrong = building.wayword(&["export", "--run", "mine_streamvln", "--format", "navila", "--out", "x.json"]);
    assert!(wrong.refused().contains("its episodes are no file of layout navila"), "{wrong:?}");
}

#[test]
fn rxr_ce_has_turns_of_thirty_degrees_and_both_roles() {
    let building = Building::new();
    run(&building);
    let ran = building.wayword(&["export", "--run", "run", "--format", "rxrce", "--out", "rxr", "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let episodes = DatasetFormat::Vlnce.read_file(&building.path("rxr/train/train_guide.json.gz")).unwrap();
    assert!(episodes.len() == 4 && episodes.iter().all(|episode| episode.language_of(0) == Some("en-US")));
    let acted = read_actions(&building.path("rxr/train/train_guide_gt.json.gz")).unwrap();
    assert_eq!(acted.keys().collect::<Vec<_>>(), ["1", "2", "3", "4"]);
    assert!(read_actions(&building.path("rxr/train/train_follower_gt.json.gz")).unwrap().is_empty());
    export(&building, "uninavid", &[]);
    let thirty = trajectories(&building, "run/steps_30deg");
    assert!(acted.values().all(|acted| thirty.iter().any(|walk| walk.actions == acted.actions)));
}

#[test]
fn layouts_refuse_what_their_words_do_not_mean() {
    let building = Building::new();
    run(&building);
    let refused = |more: &[&str]| {
        let ran = building.wayword(&[&["export", "--run", "run", "--out", "x"], more].concat());
        ran.refused().to_owned()
    };
    assert!(
        refused(&["--format", "uninavid", "--turn-deg", "15"])
            .contains("turns of 30 degrees, and the steps have 0.25 m and 15 degrees")
    );
    for layout in ["navila", "streamvln", "internnav", "rxrce"] {
        let told = refused(&["--format", layout, "--forward-m", "0.5"]);
        assert!(told.contains("mean steps of 0.25 m"), "{layout}: {told}");
    }
    assert!(refused(&["--format", "streamvln", "--shard", "3"]).contains("--shard is for --format steps"));
    assert!(refused(&["--format", "steps", "--steps", "y"]).contains("--steps is for what is packed from steps"));
    assert!(refused(&["--format", "lerobot", "--size-px", "33x32"]).contains("even sides"));
    // Another command packs into the folder.
    fs::create_dir_all(building.path("busy/.unfinished")).unwrap();
    let lock = fs::File::create(building.path("busy/.unfinished/run.lock")).unwrap();
    lock.try_lock().unwrap();
    let busy = building.wayword(&["export", "--run", "run", "--format", "streamvln", "--out", "busy"]);
    assert!(busy.code != Some(0) && building.path("busy/.unfinished/run.lock").exists(), "{busy:?}");
    let in_use = building.path("x");
    fs::create_dir_all(&in_use).unwrap();
    building.write("x/mine.txt", "notes");
    assert!(refused(&["--format", "streamvln"]).contains("the folder has files"));
}
