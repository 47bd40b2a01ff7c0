//! The schema of each layout for training: the types of its fields, none more and none less, and the columns of its tables. Where a loader
//! takes more, the schema has what Wayword writes.

use parquet::{file::reader::FileReader as _, file::reader::SerializedFileReader, schema::printer::print_schema};
use serde::{Deserialize, de::DeserializeOwned};
use std::{collections::BTreeMap, fs, path::Path};
use wayword_core::{AgentAction, DMat4, DVec3, ViewpointId};
use wayword_formats::training::{
    internnav::{InternNavCamera, InternNavEpisode, VlnN1Episode, write_internnav_scene, write_vln_n1_scene},
    lerobot::{ColourStatistics, LeRobotEpisode, write_lerobot_dataset},
    navid::{NavidPolicy, navid_decisions, navid_sample, write_navid_file},
    navila::{NavilaSpeakerItem, navila_samples, write_navila_samples, write_navila_speaker},
    pretraining::{PretrainingLine, write_pretraining_lines},
    streamvln::{StreamVlnWalk, write_streamvln_file},
};

fn actions() -> Vec<AgentAction> {
    [2, 1, 1, 0].map(|number| AgentAction::try_from(number).unwrap()).to_vec()
}

/// A list of items that keep to a type.
fn list<T: DeserializeOwned>(file: &Path) -> Vec<T> {
    serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
}

/// Lines that keep to a type.
fn lines<T: DeserializeOwned>(file: &Path) -> Vec<T> {
    fs::read_to_string(file).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// The columns of a table, without what is between them.
fn columns(file: &Path) -> String {
    let reader = SerializedFileReader::new(fs::File::open(file).unwrap()).unwrap();
    let mut text = Vec::new();
    print_schema(&mut text, reader.metadata().file_metadata().schema());
    String::from_utf8(text).unwrap().lines().map(str::trim).filter(|line| *line != "}").collect::<Vec<_>>().join(" ")
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct StreamVlnItem {
    id: u64,
    video: String,
    instructions: Vec<String>,
    actions: Vec<i8>,
}

#[test]
fn streamvln() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("annotations.json");
    let walk = StreamVlnWalk {
        id: 0.into(),
        video: "images/flat_wayword_000000".to_owned(),
        instructions: vec!["Go.".to_owned()],
        actions: actions(),
        extra: serde_json::Map::new(),
    };
    write_streamvln_file(&file, &[walk]).unwrap();
    let items: Vec<StreamVlnItem> = list(&file);
    assert_eq!(items[0].actions, [-1, 2, 1, 1]);
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct NavilaItem {
    video_id: String,
    q: String,
    a: String,
    frames: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct SpeakerItem {
    video: String,
    instruction: String,
}

#[test]
fn navila() {
    let folder = tempfile::tempdir().unwrap();
    let [policy, speaker] = ["annotations.json", "speaker.json"].map(|name| folder.path().join(name));
    write_navila_samples(&policy, navila_samples("a", "Go.", &actions(), |number| format!("a/frame_{number}.jpg")))
        .unwrap();
    let items: Vec<NavilaItem> = list(&policy);
    let told: Vec<_> = items.iter().map(|item| (item.a.as_str(), item.frames.len())).collect();
    let expected = [
        ("The next action is turn left 15 degree.", 1),
        ("The next action is move forward 50 cm.", 2),
        ("The next action is stop.", 4),
    ];
    assert_eq!(told, expected);
    let item = NavilaSpeakerItem { video: "a.avi".to_owned(), instruction: "Go.".to_owned() };
    write_navila_speaker(&speaker, &[item]).unwrap();
    assert_eq!(list::<SpeakerItem>(&speaker)[0].video, "a.avi");
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct ConversationItem {
    id: String,
    video: String,
    conversations: [Turn; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct Turn {
    from: String,
    value: String,
}

#[test]
fn uninavid() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("uninavid.json");
    let samples = navid_decisions(&actions()).into_iter().map(|run| {
        navid_sample(
            NavidPolicy::UniNaVid,
            ("VLN_a-0", format!("nav_videos/a_{}.avi", run.first)),
            "Go.",
            &actions(),
            run,
        )
    });
    write_navid_file(&file, samples).unwrap();
    let items: Vec<ConversationItem> = list(&file);
    assert!(items.iter().all(|item| item.conversations[0].value.matches("<image>").count() == 1));
    assert_eq!(items[1].conversations[1].value, "forward forward stop stop");
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct EpisodeItem {
    episode_index: u64,
    tasks: Vec<String>,
    length: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct StatisticsItem {
    episode_index: u64,
    task_index: BTreeMap<String, u64>,
    image_index: BTreeMap<String, u64>,
}

#[test]
fn internnav() {
    let folder = tempfile::tempdir().unwrap();
    let camera = InternNavCamera {
        name: "125cm_30deg".to_owned(),
        world_from_camera: vec![DMat4::IDENTITY; 4],
        goals: vec![None, Some(([1, 2], 2)), None, None],
    };
    let episode =
        InternNavEpisode { index: 0, texts: vec!["Go.".to_owned()], actions: actions(), cameras: vec![camera] };
    write_internnav_scene(folder.path(), &[episode]).unwrap();
    assert_eq!(lines::<EpisodeItem>(&folder.path().join("meta/episodes.jsonl"))[0].length, 4);
    let table = folder.path().join("data/chunk-000/episode_000000.parquet");
    assert_eq!(
        columns(&table),
        "message schema { REQUIRED INT32 action; \
         REQUIRED group pose.125cm_30deg (LIST) { REPEATED group list { REQUIRED group element (LIST) { REPEATED group list { \
         REQUIRED FLOAT element; \
         REQUIRED group goal.125cm_30deg (LIST) { REPEATED group list { REQUIRED INT32 element; \
         REQUIRED INT32 relative_goal_frame_id.125cm_30deg; REQUIRED FLOAT timestamp; REQUIRED INT64 frame_index; \
         REQUIRED INT64 episode_index; REQUIRED INT64 index; REQUIRED INT64 task_index;"
    );
}

#[test]
fn internnav_n1() {
    let folder = tempfile::tempdir().unwrap();
    let episode = VlnN1Episode {
        index: 0,
        text: "Go.".to_owned(),
        parts: vec![("Go".to_owned(), [0, 3])],
        world_from_camera: vec![DMat4::IDENTITY; 4],
        focal_px: 112.0,
        centre_px: [112.0; 2],
        height_m: 1.25,
        pitch_rad: 0.0,
    };
    write_vln_n1_scene(folder.path(), &[episode], &[DVec3::ONE]).unwrap();
    let meta = |name: &str| folder.path().join("meta").join(name);
    assert_eq!(lines::<EpisodeItem>(&meta("episodes.jsonl"))[0].tasks.len(), 2);
    let statistics: Vec<StatisticsItem> = lines(&meta("episodes_stats.jsonl"));
    let counts = |map: &BTreeMap<String, u64>| ["min", "max", "count"].map(|name| map[name]);
    assert_eq!((counts(&statistics[0].task_index), counts(&statistics[0].image_index)), ([0, 1, 2], [0, 3, 4]));
    let matrix = |name: &str| {
        format!(
            "REQUIRED group {name} (LIST) {{ REPEATED group list {{ REQUIRED group element (LIST) {{ REPEATED group list {{ REQUIRED FLOAT element;"
        )
    };
    assert_eq!(
        columns(&folder.path().join("data/chunk-000/episode_000000.parquet")),
        format!(
            "message schema {{ REQUIRED INT64 index; {} {} {}",
            matrix("observation.camera_intrinsic"),
            matrix("observation.camera_extrinsic"),
            matrix("action")
        )
    );
    let cloud = fs::read(meta("pointcloud.ply")).unwrap();
    assert!(
        cloud.starts_with(b"ply\nformat binary_little_endian 1.0\nelement vertex 1\n") && cloud.ends_with(&[0, 0, 128])
    );
}

#[test]
fn lerobot() {
    let folder = tempfile::tempdir().unwrap();
    let episode = LeRobotEpisode {
        task: "Go.".to_owned(),
        other_texts: Vec::new(),
        parts: vec![("Go".to_owned(), 0)],
        actions: actions(),
        states: vec![[0.0; 4]; 4],
        goals: BTreeMap::from([(0, [1, 2])]),
        names: ["a", "a-0", "r2r"].map(str::to_owned),
        video: 0,
        video_from: 0,
    };
    let colours = ColourStatistics { pictures: 4, counts: [[1; 256]; 3] };
    write_lerobot_dataset(folder.path(), &[episode], [32, 32], &colours).unwrap();
    let language = |name: &str, time: &str| {
        format!(
            "REQUIRED group {name} (LIST) {{ REPEATED group list {{ REQUIRED group element {{ REQUIRED BYTE_ARRAY role (STRING); \
             OPTIONAL BYTE_ARRAY content (STRING); OPTIONAL BYTE_ARRAY style (STRING); {time}OPTIONAL BYTE_ARRAY camera (STRING); \
             OPTIONAL group tool_calls (LIST) {{ REPEATED group list {{ OPTIONAL BYTE_ARRAY element (STRING);"
        )
    };
    assert_eq!(
        columns(&folder.path().join("data/chunk-000/file-000.parquet")),
        format!(
            "message schema {{ REQUIRED group observation.state (LIST) {{ REPEATED group list {{ REQUIRED FLOAT element; \
             REQUIRED INT64 action; REQUIRED FLOAT timestamp; REQUIRED INT64 frame_index; REQUIRED INT64 episode_index; \
             REQUIRED INT64 index; REQUIRED INT64 task_index; {} {}",
            language("language_persistent", "REQUIRED FLOAT timestamp; "),
            language("language_events", "")
        )
    );
    assert_eq!(
        columns(&folder.path().join("meta/tasks.parquet")),
        "message schema { REQUIRED INT64 task_index; REQUIRED BYTE_ARRAY task (STRING);"
    );
    // Each column of the rows is a feature, and each feature but the video is a column.
    let info: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("meta/info.json")).unwrap()).unwrap();
    let rows = columns(&folder.path().join("data/chunk-000/file-000.parquet"));
    for (feature, about) in info["features"].as_object().unwrap() {
        assert_eq!(rows.contains(&format!(" {feature}")), about["dtype"] != "video", "{feature}");
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(dead_code, reason = "fields are there to be compared with the file")]
struct PretrainingItem {
    instr_id: String,
    scan: String,
    path: Vec<String>,
    heading: f64,
    instr_encoding: Vec<u32>,
    pos_vps: Option<Vec<String>>,
}

#[test]
fn duet_pretrain() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("R2R_train_enc.jsonl");
    let line = PretrainingLine {
        instr_id: "7_0".to_owned(),
        scan: "flat".to_owned(),
        path: ["a", "b"].map(|name| ViewpointId::new(name).unwrap()).to_vec(),
        heading: 0.5,
        instr_encoding: vec![101, 102],
        pos_vps: None,
    };
    write_pretraining_lines(&file, &[line]).unwrap();
    assert_eq!(lines::<PretrainingItem>(&file)[0].instr_encoding, [101, 102]);
}
