//! Tests of recordings whose messages have clocks that differ, begin again or stand still, of bags in several files, and of
//! odometry without rotations. A robot walks on a bend, and each picture is one grey pixel that tells where it was taken.

use super::{
    tests::{IMAGE, Out, bytes_read, grey_at, made, pictures},
    *,
};
use crate::describe::RecordingClock;
use rand::Rng;
use std::path::PathBuf;
use wayword_core::seeded_rng;

const S: i64 = 1_000_000_000;
const MS: i64 = 1_000_000;
const ODOMETRY: &str = "nav_msgs/msg/Odometry";
const TRANSFORMS: &str = "tf2_msgs/msg/TFMessage";
/// Time of the walk's first picture on the recorder's clock.
const START_NS: i64 = 1_700_000_000 * S;
const PICTURES: i64 = 40;
/// Time between two pictures.
const STEP_NS: i64 = 400 * MS;

/// A message: topic, type, stamp, the recorder's time, and the bytes after the stamp is known.
#[derive(Clone)]
struct SentMessage {
    topic: &'static str,
    schema: &'static str,
    stamp_ns: i64,
    logged_ns: i64,
    body: MessageBody,
}

#[derive(Clone, Copy)]
enum MessageBody {
    Grey(u8),
    /// Position, and the quaternion.
    Odometry([f64; 3], [f64; 4]),
    /// The transform of `base` in `odom`.
    Transform([f64; 3], [f64; 4]),
    /// The camera on the robot: 1 m above it.
    Mount,
    /// The transform of `odom` in `map`, which are the same here.
    Ground,
}

impl SentMessage {
    fn bytes(&self) -> Vec<u8> {
        let numbers =
            |out: Out, numbers: &[f64]| numbers.iter().fold(out, |out, number| out.number(number.to_be_bytes())).0;
        let transform = |frame, child, position: [f64; 3], rotation: [f64; 4]| {
            let head = Out::message_at(self.stamp_ns, frame).text(child).0;
            // A list of one.
            let out = Out([&head[..4], &1_u32.to_be_bytes(), &head[4..]].concat());
            numbers(out, &[position.as_slice(), rotation.as_slice()].concat())
        };
        match self.body {
            MessageBody::Grey(grey) => grey_at(self.stamp_ns, grey),
            MessageBody::Odometry(position, rotation) => {
                let out = Out::message_at(self.stamp_ns, "odom").text("base");
                numbers(out, &[position.as_slice(), rotation.as_slice()].concat())
            }
            MessageBody::Transform(position, rotation) => transform("odom", "base", position, rotation),
            MessageBody::Ground => transform("map", "odom", [0.0; 3], [0.0, 0.0, 0.0, 1.0]),
            MessageBody::Mount => transform("base", "cam", [0.0, 0.0, 1.0], [-0.5, 0.5, -0.5, 0.5]),
        }
    }
}

/// The robot's position at a time of the walk: 6 m east, then north.
fn position_at(time_ns: i64) -> [f64; 3] {
    let walked = time_ns as f64 * 1e-9 * 0.75;
    if walked < 6.0 { [walked, 0.0, 0.0] } else { [6.0, walked - 6.0, 0.0] }
}

fn rotation_at(time_ns: i64) -> [f64; 4] {
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    if position_at(time_ns)[1] == 0.0 { [0.0, 0.0, 0.0, 1.0] } else { [0.0, 0.0, quarter, quarter] }
}

/// The walk by one clock, in the order of its times: pictures, and odometry ten times a second.
fn walk() -> Vec<SentMessage> {
    let picture = |at: i64| {
        let time_ns = at * STEP_NS;
        let body = MessageBody::Grey(at as u8);
        SentMessage {
            topic: "/image",
            schema: IMAGE,
            stamp_ns: START_NS + time_ns,
            logged_ns: START_NS + time_ns,
            body,
        }
    };
    let pose = |at: i64| {
        let time_ns = at * 100 * MS;
        let body = MessageBody::Odometry(position_at(time_ns), rotation_at(time_ns));
        SentMessage {
            topic: "/odom",
            schema: ODOMETRY,
            stamp_ns: START_NS + time_ns,
            logged_ns: START_NS + time_ns,
            body,
        }
    };
    let mut sent: Vec<SentMessage> = (0..PICTURES).map(picture).chain((-5..=PICTURES * 4 + 5).map(pose)).collect();
    sent.sort_by_key(|message| message.logged_ns);
    sent
}

/// The same with transforms in place of odometry, and the camera's mounting.
fn walk_by_transforms() -> Vec<SentMessage> {
    let mut sent = walk();
    for message in &mut sent {
        if let MessageBody::Odometry(position, rotation) = message.body {
            (message.topic, message.schema) = ("/tf", TRANSFORMS);
            message.body = MessageBody::Transform(position, rotation);
        }
    }
    let first_ns = sent[0].logged_ns;
    let mount = SentMessage {
        topic: "/tf_static",
        schema: TRANSFORMS,
        stamp_ns: 7,
        logged_ns: first_ns,
        body: MessageBody::Mount,
    };
    sent.insert(0, mount);
    sent
}

fn change(mut sent: Vec<SentMessage>, each: impl Fn(&mut SentMessage)) -> Vec<SentMessage> {
    sent.iter_mut().for_each(each);
    sent
}

fn is_picture(message: &SentMessage) -> bool {
    matches!(message.body, MessageBody::Grey(_))
}

fn file_bytes(sent: &[SentMessage]) -> Vec<u8> {
    let messages: Vec<_> = sent
        .iter()
        .map(|message| (message.topic, message.schema, "cdr", message.logged_ns as u64, message.bytes()))
        .collect();
    made(&messages)
}

fn read_sent(sent: &[SentMessage], described: RecordingDescription) -> (tempfile::TempDir, Result<Recording, String>) {
    bytes_read(&file_bytes(sent), described)
}

/// How many pictures a recording has, after each was checked: it was taken at most `most_m` from the place that its track says,
/// and in its direction.
fn check_places(recording: &Recording, most_m: f64) -> usize {
    let times_s = recording.reel.times_s();
    let all: Vec<usize> = (0..times_s.len()).collect();
    let track = recording.track.as_ref().expect("poses");
    let mut last = -1;
    for (number, image) in all.iter().zip(pictures(recording, &all).unwrap()) {
        let grey = i64::from(image.rgb_bytes()[0]);
        assert!(grey > last, "pictures in the order in which they were taken, each once: {grey} after {last}");
        last = grey;
        let fix = track.fix_at(times_s[*number]).unwrap_or_else(|| panic!("no pose for picture {grey}"));
        let [x, y, _] = position_at(grey * STEP_NS);
        let off_m = (fix.position.x - x).hypot(fix.position.y - y);
        assert!(off_m <= most_m, "picture {grey}: {off_m} m off");
        // At the corner either direction is right.
        let at_corner = (x - 6.0).abs() < 0.4 && y < 0.4;
        let deg = if y > 0.0 { 0.0 } else { 90.0 };
        let turn = fix.heading.map(|heading| (heading.deg() - deg + 180.0).rem_euclid(360.0) - 180.0);
        assert!(at_corner || turn.is_none_or(|turn| turn.abs() < 1.0), "picture {grey}: {turn:?} degrees off");
    }
    all.len()
}

/// Checks a recording that has all pictures, and returns what the user is told.
fn remarks_of_whole(what: &str, sent: &[SentMessage], most_m: f64) -> String {
    let (_folder, recording) = read_sent(sent, RecordingDescription::default());
    let recording = recording.unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(check_places(&recording, most_m), PICTURES as usize, "{what}");
    recording.reel.remarks().join("\n")
}

#[test]
fn clocks_that_differ_by_a_constant_are_brought_together_and_told() {
    for base in [walk(), walk_by_transforms()] {
        for (shift_ns, of_pictures, told) in [
            (-20 * S, false, "20.0 s behind those of the pictures"),
            (-6 * S, true, "6.0 s ahead of those of the pictures"),
            (1500 * MS, false, "1.5 s ahead of"),
            (9_000_000 * S, true, "9000000.0 s behind"),
        ] {
            let sent = change(base.clone(), |message| {
                if is_picture(message) == of_pictures && !matches!(message.body, MessageBody::Mount) {
                    message.stamp_ns += shift_ns;
                }
            });
            let remarks = remarks_of_whole(told, &sent, 1e-3);
            assert!(remarks.contains(told) && remarks.contains("clock = \"stamps\""), "{remarks}");
        }
    }
}

#[test]
fn a_delay_that_a_camera_may_have_moves_nothing_and_is_told() {
    for base in [walk(), walk_by_transforms()] {
        let sent = change(base, |message| message.logged_ns += if is_picture(message) { 700 * MS } else { 0 });
        let remarks = remarks_of_whole("a slow camera", &sent, 1e-3);
        assert!(remarks.contains("0.7 s") && remarks.contains("the stamps are believed"), "{remarks}");
        assert!(remarks.contains("clock = \"recorder\""), "{remarks}");
    }
}

/// What happened to the clocks, and how it changes a message.
type ClockChange = (&'static str, fn(&mut SentMessage));

#[test]
fn what_is_usual_among_clocks_is_read_by_the_stamps_without_a_word() {
    let changes: [ClockChange; 6] = [
        ("one clock", |_| ()),
        ("a late recorder", |message| message.logged_ns += 5 * S),
        ("simulated time", |message| message.stamp_ns -= START_NS - 3 * S),
        ("late pictures", |message| message.logged_ns += if is_picture(message) { 450 * MS } else { 0 }),
        ("uneven latency", |message| message.logged_ns += message.stamp_ns / MS * 37 % 400 * MS),
        ("played again, at half speed", |message| {
            message.logged_ns = START_NS + 100_000 * S + 2 * (message.logged_ns - START_NS);
        }),
    ];
    for base in [walk(), walk_by_transforms()] {
        for (what, each) in changes {
            let mut sent = change(base.clone(), each);
            sent.sort_by_key(|message| message.logged_ns);
            assert_eq!(remarks_of_whole(what, &sent, 1e-3), "", "{what}");
        }
    }
}

#[test]
fn a_localiser_that_stamps_ahead_has_no_other_clock() {
    let mut sent = walk_by_transforms();
    let localiser = |at: i64| SentMessage {
        topic: "/tf",
        schema: TRANSFORMS,
        stamp_ns: START_NS + at * 200 * MS + S,
        logged_ns: START_NS + at * 200 * MS,
        body: MessageBody::Ground,
    };
    sent.extend((-20..100).map(localiser));
    sent.sort_by_key(|message| message.logged_ns);
    assert_eq!(remarks_of_whole("a localiser", &sent, 1e-3), "");
}

#[test]
fn messages_that_were_recorded_twice_change_nothing() {
    let twice: Vec<SentMessage> = walk().into_iter().flat_map(|message| [message.clone(), message]).collect();
    assert_eq!(remarks_of_whole("twice", &twice, 1e-3), "");
    let mut relayed = walk();
    relayed.extend(change(walk(), |message| message.logged_ns += 1300 * MS));
    relayed.sort_by_key(|message| message.logged_ns);
    assert_eq!(remarks_of_whole("relayed", &relayed, 1e-3), "");
}

/// Stamps that begin again after picture 24, while the recorder's time goes on.
fn restarted(sent: Vec<SentMessage>, of_pictures_alone: bool) -> Vec<SentMessage> {
    change(sent, |message| {
        let since_ns = message.logged_ns - START_NS - 24 * STEP_NS - STEP_NS / 2;
        if since_ns >= 0 && (is_picture(message) || !of_pictures_alone) {
            message.stamp_ns = START_NS + since_ns;
        }
    })
}

#[test]
fn a_recording_is_cut_where_stamps_begin_again() {
    for base in [walk(), walk_by_transforms()] {
        for alone in [false, true] {
            let sent = restarted(base.clone(), alone);
            let (_folder, recording) = read_sent(&sent, RecordingDescription::default());
            let recording = recording.unwrap();
            assert_eq!(check_places(&recording, 1e-3), 25);
            let remarks = recording.reel.remarks().join("\n");
            for told in ["go back by 9.", "2 parts, and only part 1 is used, with 25 of 40 pictures", "`part = N`"] {
                assert!(remarks.contains(told), "{remarks}");
            }
            let second = RecordingDescription { part: Some(2), ..RecordingDescription::default() };
            assert_eq!(check_places(&read_sent(&sent, second).1.unwrap(), 1e-3), 15);
        }
    }
    let third = RecordingDescription { part: Some(3), ..RecordingDescription::default() };
    let error = read_sent(&restarted(walk(), false), third).1.err().unwrap();
    assert!(error.contains("part = 3, but its parts are 1 to 2"), "{error}");
    let by_recorder = RecordingDescription { clock: Some(RecordingClock::Recorder), ..RecordingDescription::default() };
    assert_eq!(check_places(&read_sent(&restarted(walk(), false), by_recorder).1.unwrap(), 1e-3), 40);
}

#[test]
fn stamps_that_stand_still_are_no_clock() {
    for of_pictures in [true, false] {
        let sent = change(walk(), |message| {
            if is_picture(message) == of_pictures {
                message.stamp_ns = START_NS;
            }
        });
        assert!(remarks_of_whole("still", &sent, 1e-3).contains("stand still"));
    }
}

#[test]
fn a_clock_that_was_set_in_the_middle_is_asked_about() {
    let sent = change(walk(), |message| {
        let is_late = message.logged_ns > START_NS + 20 * STEP_NS;
        if is_picture(message) {
            message.stamp_ns -= if is_late { 3 * S } else { 9 * S };
        }
    });
    let (_folder, recording) = read_sent(&sent, RecordingDescription::default());
    let error = recording.err().unwrap();
    for told in ["/odom are between 3.0 and 9.0 s ahead of", "not by a constant time", "clock = \"recorder\""] {
        assert!(error.contains(told), "{error}");
    }
    let by_recorder = RecordingDescription { clock: Some(RecordingClock::Recorder), ..RecordingDescription::default() };
    assert_eq!(check_places(&read_sent(&sent, by_recorder).1.unwrap(), 1e-3), 40);
}

#[test]
fn simulated_time_beside_that_of_the_day_is_read_by_the_recorder() {
    // The simulator runs at half speed, and the camera's driver stamps by the time of the day.
    let sent = change(walk(), |message| {
        if !is_picture(message) {
            message.stamp_ns = 100 * S + (message.stamp_ns - START_NS) / 2;
        }
    });
    assert!(remarks_of_whole("two times", &sent, 1e-3).contains("are of another time than those of the pictures"));
}

#[test]
fn a_setting_keeps_the_stamps() {
    let sent = change(walk(), |message| message.stamp_ns -= if is_picture(message) { 0 } else { 2 * S });
    let stamps = RecordingDescription { clock: Some(RecordingClock::Stamps), ..RecordingDescription::default() };
    let (_folder, recording) = read_sent(&sent, stamps);
    let recording = recording.unwrap();
    assert!(recording.reel.remarks().is_empty());
    // Two seconds at 0.75 m/s.
    let fix = recording.track.unwrap().fix_at(1.2).unwrap();
    assert!((fix.position.x - position_at(1200 * MS + 2 * S)[0]).abs() < 1e-3, "{}", fix.position);
}

#[test]
fn changed_clocks_give_the_same_pictures_at_the_same_places() {
    let mut asked = 0;
    let cases = 120;
    for case in 0..cases {
        let mut dice = seeded_rng(case, &["clocks"]);
        let mut base = if dice.random_bool(0.5) { walk() } else { walk_by_transforms() };
        // Beginning and end are cut off, but not the camera's mounting.
        let from_ns = START_NS + dice.random_range(0..15) * STEP_NS;
        let to_ns = START_NS + dice.random_range(25..PICTURES) * STEP_NS;
        base.retain(|message| match message.body {
            MessageBody::Mount => true,
            MessageBody::Grey(_) => (from_ns..=to_ns).contains(&message.stamp_ns),
            _ => (from_ns - S..=to_ns + S).contains(&message.stamp_ns),
        });
        let shift_ns = dice.random_range(1400 * MS..2000 * S) * if dice.random_bool(0.5) { 1 } else { -1 };
        let (of_pictures, of_all) = (dice.random_bool(0.5), dice.random_range(-1000 * S..1000 * S));
        let jitter_ms = dice.random_range(1..60_i64);
        let mut sent = change(base, |message| {
            message.stamp_ns += of_all + if is_picture(message) == of_pictures { shift_ns } else { 0 };
            message.logged_ns += (message.logged_ns / MS).rem_euclid(jitter_ms) * MS;
        });
        if dice.random_bool(0.5) {
            sent = sent.into_iter().flat_map(|message| [message.clone(), message]).collect();
        }
        let wanted = sent.iter().filter(|message| is_picture(message)).map(SentMessage::bytes);
        let wanted = wanted.collect::<std::collections::BTreeSet<_>>().len();
        sent.sort_by_key(|message| message.logged_ns);
        match read_sent(&sent, RecordingDescription::default()) {
            (_, Err(_)) => asked += 1,
            // At the ends a pose may be missing by the jitter.
            (_folder, Ok(recording)) => assert_eq!(check_places(&recording, 0.1), wanted, "case {case}"),
        }
    }
    assert!(asked * 10 <= cases, "asked in {asked} of {cases} cases");
}

#[test]
fn odometry_without_rotations_gives_positions() {
    let none = change(walk(), |message| {
        if let MessageBody::Odometry(_, rotation) = &mut message.body {
            *rotation = [0.0; 4];
        }
    });
    let remarks = remarks_of_whole("no rotations", &none, 1e-3);
    assert!(remarks.contains("171 of 171 poses of /odom have the quaternion 0,0,0,0"), "{remarks}");
    assert!(remarks.contains("only the positions are used"), "{remarks}");
    let some = change(walk(), |message| {
        if let MessageBody::Odometry(_, rotation) = &mut message.body
            && message.stamp_ns < START_NS
        {
            *rotation = [0.0; 4];
        }
    });
    let remarks = remarks_of_whole("some rotations", &some, 1e-3);
    assert!(remarks.contains("5 of 171 poses of /odom") && remarks.contains("these are left out"), "{remarks}");
    let transforms = change(walk_by_transforms(), |message| {
        if let MessageBody::Transform(_, rotation) = &mut message.body {
            *rotation = [0.0; 4];
        }
    });
    let (_folder, recording) = read_sent(&transforms, RecordingDescription::default());
    let recording = recording.unwrap();
    assert!(recording.track.is_none());
    assert!(recording.reel.remarks()[0].contains("171 transforms of base in odom have the quaternion 0,0,0,0"));
}

/// Writes the files of a bag into a folder `bag`, and opens it.
fn open_bag(parts: &[&[SentMessage]], written: usize) -> (tempfile::TempDir, Result<Recording, String>) {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    std::fs::create_dir(&bag).unwrap();
    let names: Vec<String> = (0..parts.len()).map(|part| format!("bag_{part}.mcap")).collect();
    for (name, sent) in names.iter().zip(parts).take(written) {
        std::fs::write(bag.join(name), file_bytes(sent)).unwrap();
    }
    let list: String = names.iter().map(|name| format!("    - {name}\n")).collect();
    let metadata = format!("rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n{list}  duration: 1\n");
    std::fs::write(bag.join("metadata.yaml"), metadata).unwrap();
    let opened = find_bag_files(&bag).and_then(|files| {
        let file = McapFile::open_bag(&bag, files.unwrap(), RecordingDescription::default())?;
        assert_eq!(file.scenes()[0].as_str(), "bag");
        assert_eq!(file.files(&file.scenes()[0])?.len(), parts.len() + 1);
        file.open(&file.scenes()[0])
    });
    (folder, opened.map_err(|error| error.to_string()))
}

#[test]
fn the_files_of_a_bag_are_one_recording() {
    let sent = walk_by_transforms();
    let thirds: Vec<&[SentMessage]> = sent.chunks(sent.len().div_ceil(3)).collect();
    let (_folder, recording) = open_bag(&thirds, 3);
    let recording = recording.unwrap();
    // The camera's mounting is in the first file alone, and counts in all.
    assert_eq!(check_places(&recording, 1e-3), PICTURES as usize);
    let track = recording.track.as_ref().unwrap();
    assert!(
        recording.reel.times_s().iter().all(|time_s| (track.fix_at(*time_s).unwrap().position.z - 1.0).abs() < 1e-9)
    );
    // Pictures of all files, in any order.
    let greys: Vec<u8> =
        pictures(&recording, &[2, 13, 14, 39]).unwrap().iter().map(|image| image.rgb_bytes()[0]).collect();
    assert_eq!(greys, [2, 13, 14, 39]);
    let error = open_bag(&thirds, 2).1.err().unwrap();
    assert!(error.contains("lists bag_2.mcap, which is not there"), "{error}");
}

#[test]
fn a_bag_is_opened_by_its_folder_and_by_the_folder_above() {
    let sent = walk();
    let halves: Vec<&[SentMessage]> = sent.chunks(sent.len().div_ceil(2)).collect();
    let (folder, _) = open_bag(&halves, 2);
    for path in [folder.path().join("bag"), folder.path().to_owned()] {
        let source = crate::open::open_source(&path, &|_| ()).unwrap();
        let scenes: Vec<String> = source.scenes().iter().map(|scene| scene.to_string()).collect();
        assert_eq!(scenes, ["bag"], "{}", path.display());
        assert_eq!(check_places(&source.open(&source.scenes()[0]).unwrap(), 1e-3), PICTURES as usize);
    }
    let single: PathBuf = folder.path().join("bag/bag_1.mcap");
    let source = crate::open::open_source(&single, &|_| ()).unwrap();
    assert_eq!(source.scenes()[0].as_str(), "bag_1");
}
