//! Tests with recordings that other programs wrote (`fixtures/make_mcap.py`), and with broken and odd ones that are
//! made here.

use super::{contents::McapContents, record::RecordPlace, *};
use ::mcap::MAGIC;
use proptest::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    ops::ControlFlow,
};
use tempfile::TempDir;
use wayword_core::{Heading, Image};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/mcap").join(name)
}

pub(super) fn read(path: &Path, described: RecordingDescription) -> Result<Recording, String> {
    let file = McapFile::open(path, described).map_err(|error| error.to_string())?;
    file.open(&file.scenes()[0]).map_err(|error| error.to_string())
}

pub(super) fn bytes_read(bytes: &[u8], described: RecordingDescription) -> (TempDir, Result<Recording, String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("made.mcap");
    std::fs::write(&path, bytes).unwrap();
    let recording = read(&path, described);
    (folder, recording)
}

pub(super) fn pictures(recording: &Recording, wanted: &[usize]) -> Result<Vec<Image>, String> {
    let mut images = Vec::new();
    let taken = recording.reel.hand_out_pictures(wanted, &mut |number, image| {
        assert_eq!(wanted[images.len()], number);
        images.push(image);
        Ok(())
    });
    taken.map(|()| images).map_err(|error| error.to_string())
}

/// The robot's position, and its heading in degrees.
fn robot(frame: usize) -> (DVec3, f64) {
    match frame {
        0..=5 => (DVec3::new(frame as f64 * 0.5, 0.0, 0.0), 90.0),
        _ => (DVec3::new(2.5, (frame - 5) as f64 * 0.5, 0.0), 0.0),
    }
}

fn check_colours(recording: &Recording, frames: &[usize]) {
    for (frame, image) in frames.iter().zip(pictures(recording, frames).unwrap()) {
        let step = *frame as i32;
        let expected = [20 * step, 255 - 20 * step, 40 + 80 * (step % 3)];
        assert_eq!((image.width_px(), image.height_px()), (32, 24));
        for pixel in image.rgb_bytes().chunks(3) {
            let off = pixel.iter().zip(expected).map(|(found, expected)| (i32::from(*found) - expected).abs());
            assert!(off.max().unwrap() <= 3, "frame {frame}: {pixel:?}, not {expected:?}");
        }
    }
}

/// Checks a recording against the path of all fixtures, seen from `ahead_m` before the robot and `up_m` above the
/// ground.
fn check_walk(recording: &Recording, frames: usize, [ahead_m, up_m]: [f64; 2]) {
    let times_s = recording.reel.times_s();
    assert_eq!(times_s.len(), frames);
    let track = recording.track.as_ref().unwrap();
    for (frame, time_s) in times_s.iter().enumerate() {
        assert!((time_s - frame as f64 * 0.5).abs() < 1e-9);
        let fix = track.fix_at(*time_s).unwrap();
        let (position, deg) = robot(frame);
        let heading = Heading::new(deg.to_radians()).unwrap();
        let ahead = DVec3::new(deg.to_radians().sin(), deg.to_radians().cos(), 0.0);
        let expected = position + ahead_m * ahead + up_m * DVec3::Z;
        assert!(fix.position.abs_diff_eq(expected, 1e-9), "frame {frame}: {}, not {expected}", fix.position);
        assert!(fix.heading.unwrap().turn_to(heading).abs() < 1e-9, "frame {frame}: {:?}", fix.heading);
    }
    check_colours(recording, &(0..frames).collect::<Vec<_>>());
}

const ALL: [(&str, [f64; 2]); 5] = [
    ("poses_zstd.mcap", [0.0, 0.0]),
    ("odometry_lz4.mcap", [0.2, 1.0]),
    ("odometry_zstd.mcap", [0.2, 1.0]),
    ("tree_bare.mcap", [0.2, 1.0]),
    ("tree_chunks.mcap", [0.2, 1.0]),
];

#[test]
fn recordings_of_other_programs_give_their_path() {
    for (name, camera) in ALL {
        let recording = read(&fixture(name), RecordingDescription::default()).unwrap();
        check_walk(&recording, 11, camera);
        // Any picture can be read, also backwards in the file.
        check_colours(&recording, &[9]);
        check_colours(&recording, &[0, 3, 10]);
        let fov_deg = recording.horizontal_fov_rad.map(|fov| fov.to_degrees().round());
        assert_eq!(fov_deg, Some(90.0).filter(|_| name != "tree_chunks.mcap"), "{name}");
        assert_eq!(recording.reel.picture_name(3), "000003");
    }
}

#[test]
fn a_summary_gives_the_same_contents_as_all_records() {
    for (name, _) in ALL {
        let file = File::open(fixture(name)).unwrap();
        let bytes = std::fs::read(fixture(name)).unwrap();
        let told = McapContents::from_file(&file).unwrap();
        let (folder, _) = bytes_read(&bytes[..bytes.len() - 8], RecordingDescription::default());
        let walked = McapContents::from_file(&File::open(folder.path().join("made.mcap")).unwrap()).unwrap();
        assert_eq!(told.topics, walked.topics, "{name}");
        assert_eq!(places(&file, &told), places(&file, &walked), "{name}");
        // Only the end of the summary is missing.
        assert_eq!(walked.broken, None, "{name}");
        assert!(told.broken.is_none(), "{name}: {:?}", told.broken);
    }
    assert!(chunks("odometry_lz4.mcap").len() > 2, "one chunk would show nothing");
}

/// The places of all messages that can be read.
fn places(file: &File, contents: &McapContents) -> Vec<(String, RecordPlace)> {
    let mut places = Vec::new();
    let heard = contents.each_message(file, &contents.channels_where(|_, _| true), &mut |message| {
        places.push((message.topic.to_owned(), message.place));
        Ok(ControlFlow::Continue(()))
    });
    heard.unwrap();
    places
}

/// The offsets of a file's compressed chunks.
fn chunks(name: &str) -> BTreeSet<usize> {
    let file = File::open(fixture(name)).unwrap();
    let places = places(&file, &McapContents::from_file(&file).unwrap());
    let chunks =
        places.iter().filter_map(|(_, place)| place.to_string().split_once(" of the chunk at byte ")?.1.parse().ok());
    chunks.collect()
}

#[test]
fn a_file_of_a_crashed_recorder_is_read_up_to_its_break() {
    for (name, camera) in ALL {
        let bytes = std::fs::read(fixture(name)).unwrap();
        let mut counts = Vec::new();
        for tenths in 1..10 {
            let (_folder, recording) = bytes_read(&bytes[..bytes.len() * tenths / 10], RecordingDescription::default());
            match recording {
                Ok(recording) => {
                    let frames = recording.reel.times_s().len();
                    // The last picture may have come before the last pose.
                    let placed = |at: &f64| recording.track.as_ref().is_some_and(|track| track.fix_at(*at).is_some());
                    if recording.reel.times_s().iter().all(placed) {
                        check_walk(&recording, frames, camera);
                    } else {
                        check_colours(&recording, &(0..frames).collect::<Vec<_>>());
                    }
                    counts.push(frames);
                }
                Err(error) => {
                    assert!(counts.is_empty(), "{name}: {error}");
                    assert!(error.contains("it can be read only up to byte"), "{name}: {error}");
                }
            }
        }
        assert!(counts.is_sorted(), "{name}: {counts:?}");
        assert!(
            name.ends_with("_zstd.mcap") || counts.iter().any(|count| (1..11).contains(count)),
            "{name}: {counts:?}"
        );
    }
}

#[test]
fn named_cameras_and_poses_are_taken() {
    let path = fixture("odometry_zstd.mcap");
    let named = |camera: &str, poses: &str| RecordingDescription {
        camera: Some(camera.to_owned()).filter(|name| !name.is_empty()),
        poses: Some(poses.to_owned()).filter(|name| !name.is_empty()),
        ..RecordingDescription::default()
    };
    check_walk(&read(&path, named("/camera/color/image_raw", "/odom")).unwrap(), 11, [0.2, 1.0]);
    let error = |camera, poses| read(&path, named(camera, poses)).err().unwrap();
    let depth = error("/camera/depth/image", "");
    assert!(
        depth.contains("the pictures of /camera/depth/image have the encoding \"16UC1\", which is depth"),
        "{depth}"
    );
    assert!(error("/cam", "").contains("has no camera /cam; its topics: /camera/color/camera_info"));
    assert!(error("/odom", "").contains("/odom has no pictures, but nav_msgs/msg/Odometry as cdr"));
    assert!(error("", "/pose").contains("has no pose topic /pose; its pose topics: /odom, /tf_static"));
    assert!(error("", "/tf_static").contains("its frame is camera_optical in base_link, which never moves"));
}

#[test]
fn messages_compressed_by_themselves_are_recognised() {
    let error = read(&fixture("messages_zstd.mcap"), RecordingDescription::default()).err().unwrap();
    assert!(error.contains("each message is compressed by itself"), "{error}");
}

#[test]
fn open_refuses_files_that_are_no_mcap_at_once() {
    for (bytes, told) in [
        (&b"\x89MCAP"[..], "byte 0: does not begin like an MCAP file"),
        (b"#ROSBAG V2.0\n....", "is a ROS 1 bag, not an MCAP file"),
        (b"", "is empty"),
    ] {
        let error = bytes_read(bytes, RecordingDescription::default()).1.err().unwrap();
        assert!(error.contains(told), "{error}");
    }
    assert!(bytes_read(MAGIC, RecordingDescription::default()).1.err().unwrap().contains("has no messages"));
}

/// A file that the Rust library writes, of messages: topic, schema, encoding, log time, bytes.
pub(super) fn made(messages: &[(&str, &str, &str, u64, Vec<u8>)]) -> Vec<u8> {
    let options = ::mcap::WriteOptions::new().compression(None).chunk_size(Some(1024));
    let mut writer = options.create(std::io::Cursor::new(Vec::new())).unwrap();
    for (topic, schema, encoding, log_time, bytes) in messages {
        let schema = writer.add_schema(schema, "ros2msg", b"").unwrap();
        let channel_id = writer.add_channel(schema, topic, encoding, &BTreeMap::new()).unwrap();
        let (log_time, publish_time) = (*log_time, *log_time);
        let header = ::mcap::records::MessageHeader { channel_id, sequence: 0, log_time, publish_time };
        writer.write_to_known_channel(&header, bytes).unwrap();
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner()
}

/// Writes CDR, most significant byte first.
pub(super) struct Out(pub(super) Vec<u8>);

impl Out {
    pub(super) fn message(seconds: i32, frame: &str) -> Self {
        Self::message_at(i64::from(seconds) * 1_000_000_000, frame)
    }

    /// The header of a message with a stamp in nanoseconds.
    pub(super) fn message_at(stamp_ns: i64, frame: &str) -> Self {
        let (seconds, rest) = (stamp_ns.div_euclid(1_000_000_000) as i32, stamp_ns.rem_euclid(1_000_000_000) as u32);
        Self(vec![0, 0, 0, 0]).number(seconds.to_be_bytes()).number(rest.to_be_bytes()).text(frame)
    }

    pub(super) fn number<const BYTES: usize>(mut self, bytes: [u8; BYTES]) -> Self {
        while !(self.0.len() - 4).is_multiple_of(BYTES) {
            self.0.push(0);
        }
        self.0.extend(bytes);
        self
    }

    pub(super) fn text(self, text: &str) -> Self {
        let mut out = self.number((text.len() as u32 + 1).to_be_bytes());
        out.0.extend(text.as_bytes());
        out.0.push(0);
        out
    }
}

fn grey(seconds: i32, grey: u8) -> Vec<u8> {
    grey_at(i64::from(seconds) * 1_000_000_000, grey)
}

/// A picture of one pixel, with a stamp in nanoseconds.
pub(super) fn grey_at(stamp_ns: i64, grey: u8) -> Vec<u8> {
    let out = Out::message_at(stamp_ns, "cam").number(1_u32.to_be_bytes()).number(1_u32.to_be_bytes()).text("mono8");
    out.number([1]).number(1_u32.to_be_bytes()).number(1_u32.to_be_bytes()).number([grey]).0
}

fn pose(seconds: i32, x: f64) -> Vec<u8> {
    let numbers = [x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    numbers.iter().fold(Out::message(seconds, "map"), |out, number| out.number(number.to_be_bytes())).0
}

pub(super) const IMAGE: &str = "sensor_msgs/msg/Image";
pub(super) const POSE: &str = "geometry_msgs/msg/PoseStamped";
const S: u64 = 1_000_000_000;

#[test]
fn pictures_and_poses_meet_on_a_clock_that_both_have() {
    // Stamps of pictures and poses, and the expected x at the second picture's time. That picture was logged at 12 s,
    // as the pose with x = 2.0 was.
    for (shot, posed, expected) in [
        ([100, 102], [100, 102], 2.0),
        // Simulated time begins with 0, so that picture counts as without a stamp.
        ([0, 2], [0, 2], 2.0),
        ([0, 0], [100, 102], 2.0),
        ([100, 102], [0, 0], 2.0),
        // The camera has its own clock.
        ([100, 102], [9000, 9002], 2.0),
    ] {
        let bytes = made(&[
            ("/image", IMAGE, "cdr", 10 * S, grey(shot[0], 7)),
            ("/pose", POSE, "cdr", 10 * S, pose(posed[0], 1.0)),
            ("/image", IMAGE, "cdr", 12 * S, grey(shot[1], 9)),
            ("/pose", POSE, "cdr", 12 * S, pose(posed[1], 2.0)),
        ]);
        let (_folder, recording) = bytes_read(&bytes, RecordingDescription::default());
        let recording = recording.unwrap();
        let last_s = *recording.reel.times_s().last().unwrap();
        let fix = recording.track.as_ref().unwrap().fix_at(last_s).unwrap();
        assert_eq!(fix.position.x, expected, "{shot:?} {posed:?}");
        let last = recording.reel.times_s().len() - 1;
        assert_eq!(pictures(&recording, &[last]).unwrap()[0].rgb_bytes(), [9, 9, 9]);
    }
}

#[test]
fn pictures_that_were_written_late_keep_their_order() {
    let bytes = made(&[
        ("/image", IMAGE, "cdr", 10 * S, grey(30, 3)),
        ("/image", IMAGE, "cdr", 11 * S, grey(10, 1)),
        ("/image", IMAGE, "cdr", 12 * S, grey(20, 2)),
    ]);
    let (_folder, recording) = bytes_read(&bytes, RecordingDescription::default());
    let recording = recording.unwrap();
    assert_eq!(recording.reel.times_s(), [0.0, 10.0, 20.0]);
    let greys: Vec<u8> = pictures(&recording, &[0, 1, 2]).unwrap().iter().map(|image| image.rgb_bytes()[0]).collect();
    assert_eq!(greys, [1, 2, 3]);
    assert!(recording.track.is_none());
}

#[test]
fn errors_name_the_topics_and_a_way_out() {
    let errors: Vec<String> = [
        made(&[("/left/image", IMAGE, "cdr", 1, grey(1, 1)), ("/right/image", IMAGE, "cdr", 2, grey(1, 1))]),
        made(&[("/video", "foxglove.CompressedVideo", "protobuf", 1, vec![1])]),
        made(&[("/image", "sensor_msgs/Image", "ros1", 1, vec![1])]),
        made(&[("/image", IMAGE, "cdr", 1, grey(1, 1)[..20].to_vec())]),
        made(&[("/image", IMAGE, "cdr", 1, vec![0, 9, 0, 0])]),
    ]
    .map(|bytes| bytes_read(&bytes, RecordingDescription::default()).1.err().unwrap())
    .map(|error| error.split_once("made.mcap").unwrap().1.to_owned())
    .into();
    for (error, expected) in errors.iter().zip([
        ": holds several cameras: /left/image, /right/image; write `camera = \"TOPIC\"`",
        ": has no pictures that can be read; its topics: /video (foxglove.CompressedVideo as protobuf); record",
        ": has no pictures that can be read; its topics: /image (sensor_msgs/Image as ros1); convert the ROS 1 bag",
        ": message at byte ",
        ": message at byte ",
    ]) {
        assert!(error.starts_with(expected), "{error}");
    }
    assert!(errors[3].contains("bytes expected"), "{}", errors[3]);
    assert!(errors[4].contains("not as plain CDR"), "{}", errors[4]);
}

#[test]
fn an_error_about_a_cut_picture_names_its_number() {
    let mut cut = grey(1, 1);
    cut.pop();
    let bytes = made(&[("/image", IMAGE, "cdr", 1, grey(1, 1)), ("/image", IMAGE, "cdr", 2, cut)]);
    let (_folder, recording) = bytes_read(&bytes, RecordingDescription::default());
    let error = pictures(&recording.unwrap(), &[0, 1]).unwrap_err();
    assert!(error.contains("picture 1 of /image: message at byte"), "{error}");
}

#[test]
fn lengths_that_lie_take_no_memory() {
    // A chunk that claims an enormous length, and one that claims to unpack to an enormous length.
    let bytes = std::fs::read(fixture("odometry_lz4.mcap")).unwrap();
    let at = *chunks("odometry_lz4.mcap").first().unwrap();
    for (from, to) in [(at + 1, at + 9), (at + 9 + 16, at + 9 + 24)] {
        let mut bytes = bytes.clone();
        bytes[from..to].fill(0x7f);
        let (_folder, recording) = bytes_read(&bytes, RecordingDescription::default());
        if let Err(error) = recording.and_then(|recording| pictures(&recording, &[0])) {
            assert!(error.contains("byte"), "{error}");
        }
    }
}

#[test]
fn a_damaged_chunk_in_a_file_with_a_summary_is_an_error_that_names_the_byte() {
    for name in ["odometry_lz4.mcap", "odometry_zstd.mcap"] {
        let whole = std::fs::read(fixture(name)).unwrap();
        let at = *chunks(name).last().unwrap();
        // Its type, the name of its compression, and the first bytes of its content.
        for damaged in [at, at + 9 + 32, at + 9 + 44] {
            let mut bytes = whole.clone();
            bytes[damaged] ^= 0x55;
            let (_folder, recording) = bytes_read(&bytes, RecordingDescription::default());
            let error = recording.and_then(|recording| pictures(&recording, &[0])).err().unwrap_or_default();
            assert!(error.contains(&format!("byte {at}")), "{name} {damaged}: {error}");
        }
    }
}

/// The offset of a file's first chunk.
fn first_chunk(bytes: &[u8]) -> usize {
    let mut at = MAGIC.len();
    while bytes[at] != ::mcap::records::op::CHUNK {
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    at
}

/// The checksum that MCAP has: CRC-32.
fn crc_32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 };
    let take = |crc: u32, byte: &u8| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc));
    !bytes.iter().fold(!0, take)
}

/// A bit that changed in a picture leaves a chunk that can be read, and only its checksum shows it.
#[test]
fn a_chunk_with_a_wrong_checksum_is_an_error_that_names_the_byte() {
    for (name, is_packed) in [("tree_chunks.mcap", false), ("odometry_lz4.mcap", true)] {
        let mut bytes = std::fs::read(fixture(name)).unwrap();
        let at = first_chunk(&bytes);
        let checksum = at + 9 + 24..at + 9 + 28;
        if !is_packed {
            let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
            let right = crc_32(&bytes[at + 9 + 40..at + 9 + length]);
            bytes[checksum.clone()].copy_from_slice(&right.to_le_bytes());
        }
        let (_folder, recording) = bytes_read(&bytes, RecordingDescription::default());
        check_colours(&recording.unwrap(), &[0, 1, 4, 10]);
        bytes[checksum.start] ^= 0x55;
        let error = bytes_read(&bytes, RecordingDescription::default()).1.err().unwrap_or_default();
        assert!(error.contains(&format!("chunk at byte {at} is damaged: its checksum")), "{name}: {error}");
        assert!(error.contains("mcap recover"), "{error}");
        // A recorder that writes none.
        bytes[checksum].fill(0);
        assert!(bytes_read(&bytes, RecordingDescription::default()).1.is_ok(), "{name}");
    }
}

#[test]
fn what_a_cut_file_lacks_is_said() {
    for name in ["tree_chunks.mcap", "tree_bare.mcap", "odometry_lz4.mcap"] {
        let whole = std::fs::read(fixture(name)).unwrap();
        assert!(read(&fixture(name), RecordingDescription::default()).unwrap().reel.remarks().is_empty(), "{name}");
        let cut = chunks(name).last().map_or(whole.len() * 7 / 10, |chunk| chunk + 60);
        let (_folder, recording) = bytes_read(&whole[..cut], RecordingDescription::default());
        let recording = recording.unwrap();
        let last_s = recording.reel.times_s().last().copied().unwrap();
        let told = recording.reel.remarks().join("\n");
        assert!(
            told.contains("made.mcap is cut off or damaged (byte")
                && told.contains(&format!("end after {last_s:.1} s")),
            "{name}: {told}"
        );
    }
}

/// Reads all of a file that may be broken.
fn exhaust(bytes: &[u8]) {
    if let (_folder, Ok(recording)) = bytes_read(bytes, RecordingDescription::default()) {
        let times_s = recording.reel.times_s();
        assert!(times_s.is_sorted());
        let _ = pictures(&recording, &(0..times_s.len()).collect::<Vec<_>>());
        for number in 0..times_s.len() {
            let _ = pictures(&recording, &[number]);
        }
    }
}

#[test]
fn a_text_that_is_longer_than_its_file_is_refused_before_it_takes_memory() {
    let record = |opcode: u8, body: &[u8]| [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat();
    // A schema with a name that claims a length of 1.7 GB.
    let schema = record(3, &[&[1, 0][..], b"iense", &[0; 8]].concat());
    let (_folder, read) = bytes_read(&[b"\x89MCAP0\r\n".to_vec(), schema].concat(), RecordingDescription::default());
    let error = read.err().unwrap();
    assert!(error.contains("larger than the record"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]
    #[test]
    fn no_damage_makes_it_panic(
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        cut in prop::option::of(any::<prop::sample::Index>()),
        lost in prop::option::of((any::<prop::sample::Index>(), 1..40_usize)),
    ) {
        for (name, _) in ALL {
            let mut bytes = std::fs::read(fixture(name)).unwrap();
            for (at, byte) in &damage {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            if let Some((at, count)) = lost {
                let at = at.index(bytes.len());
                bytes.drain(at..(at + count).min(bytes.len()));
            }
            if let Some(cut) = cut {
                bytes.truncate(cut.index(bytes.len()));
            }
            exhaust(&bytes);
        }
    }
}
