//! Tests with videos that ffmpeg made (`fixtures/make_video.py`): each picture shows its number in bars.

use super::{FilmFile, Mp4Film};
use crate::{describe::RecordingDescription, reel::RecordingSource};
use proptest::prelude::*;
use rand::Rng;
use std::path::{Path, PathBuf};
use wayword_core::Image;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/video").join(name)
}

fn film(name: &str) -> Mp4Film {
    Mp4Film::open(&fixture(name), None).unwrap()
}

/// Pictures with their numbers.
fn pictures(film: &Mp4Film, wanted: &[usize]) -> Result<Vec<(usize, Image)>, String> {
    let mut taken = Vec::new();
    let done = film.decode_pictures(wanted, &mut |number, picture| {
        taken.push((number, picture));
        Ok(())
    });
    done.map(|()| taken).map_err(|error| error.to_string())
}

/// Whether the middle of bar `bar` of 6 is white, at a share of the height.
fn is_white(picture: &Image, bar: usize, height: f64) -> bool {
    let (width, rows) = (picture.width_px() as usize, f64::from(picture.height_px()));
    let at = ((rows * height) as usize * width + (2 * bar + 1) * width / 12) * 3;
    picture.rgb_bytes()[at] > 127
}

/// The number that the bars of a picture show; both halves have to agree.
fn number_in_bars(picture: &Image) -> usize {
    let number = |height, white| (0..6).map(|bar| usize::from(is_white(picture, bar, height) == white) << bar).sum();
    let (above, below): (usize, usize) = (number(0.25, true), number(0.75, false));
    assert_eq!(above, below, "the halves of a picture belong to different numbers");
    above
}

/// Checks that every picture shows its number, whichever pictures are wanted.
fn holds(name: &str, count: usize, first: usize) {
    let film = film(name);
    assert_eq!(film.times_s().len(), count, "{name}");
    let mut asked: Vec<Vec<usize>> = [1, 2, 5, 11].map(|step| (0..count).step_by(step).collect()).to_vec();
    asked.extend([vec![], vec![count - 1], vec![0, count - 1], vec![count / 2, count / 2 + 1]]);
    for wanted in asked {
        let taken = pictures(&film, &wanted).unwrap();
        let numbers: Vec<usize> = taken.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, wanted, "{name}");
        for (number, picture) in taken {
            assert_eq!(number_in_bars(&picture), first + number, "{name}, asked for {wanted:?}");
        }
    }
}

fn near(times_s: &[f64], expected: impl IntoIterator<Item = f64>) {
    let expected: Vec<f64> = expected.into_iter().collect();
    assert_eq!(times_s.len(), expected.len());
    let off = times_s.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3, "{times_s:?}");
}

fn tenths(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(|number| number as f64 / 10.0)
}

#[test]
fn each_number_of_h264_is_its_picture() {
    for (name, count) in [("high.mp4", 40), ("baseline.mp4", 12), ("open_gop.mp4", 40), ("cropped.mp4", 6)] {
        holds(name, count, 0);
        near(film(name).times_s(), tenths(count));
    }
}

#[test]
fn each_number_of_av1_is_its_picture() {
    for (name, count) in [("av1.mp4", 24), ("av1_odd.mp4", 8), ("av1_10_bits.mp4", 6), ("av1_grey.mp4", 4)] {
        holds(name, count, 0);
        near(film(name).times_s(), tenths(count));
    }
}

#[test]
fn other_containers_hold_the_same() {
    for name in ["fragmented.mp4", "fragmented_old.mp4", "quicktime.mov"] {
        holds(name, 40, 0);
        near(film(name).times_s(), tenths(40));
    }
}

#[test]
fn pictures_outside_the_edit_list_are_not_shown() {
    holds("cut.mp4", 24, 16);
    // The cut was at 1.55 s, and the next picture was at 1.6 s.
    near(film("cut.mp4").times_s(), tenths(24).map(|time_s| time_s + 0.05));
}

#[test]
fn uneven_times_stay_uneven() {
    holds("uneven.mp4", 12, 0);
    // As ffprobe lists them.
    near(film("uneven.mp4").times_s(), [0.0, 0.1, 0.2, 0.5, 0.6, 0.8, 1.1, 1.3, 1.4, 1.8, 1.9, 2.0]);
}

#[test]
fn sizes_need_not_be_those_of_blocks() {
    let size = |name: &str| {
        let picture = &pictures(&film(name), &[0]).unwrap()[0].1;
        (picture.width_px(), picture.height_px())
    };
    assert_eq!(size("cropped.mp4"), (98, 66));
    assert_eq!(size("av1_odd.mp4"), (97, 65));
}

#[test]
fn a_video_of_an_upright_phone_is_shown_upright() {
    let turned = pictures(&film("turned.mp4"), &[5]).unwrap().remove(0).1;
    let lying = pictures(&film("baseline.mp4"), &[5]).unwrap().remove(0).1;
    assert_eq!((turned.width_px(), turned.height_px()), (64, 96));
    // ffmpeg's rotate=90: the left becomes the top, and the top becomes the right.
    let pixel = |picture: &Image, x: u32, y: u32| picture.rgb_bytes()[((y * picture.width_px() + x) * 3) as usize];
    for (x, y) in [(0, 0), (10, 5), (95, 63), (40, 50)] {
        assert_eq!(pixel(&turned, 63 - y, x), pixel(&lying, x, y));
    }
}

#[test]
fn colours_follow_the_stream() {
    for name in ["bt709.mp4", "full_range.mp4", "av1_bt709.mp4"] {
        let picture = pictures(&film(name), &[0]).unwrap().remove(0).1;
        for (bar, x) in [16, 48, 80].into_iter().enumerate() {
            let at = (16 * 96 + x) * 3;
            let pixel = &picture.rgb_bytes()[at..at + 3];
            for (channel, value) in pixel.iter().enumerate() {
                let wanted = if channel == bar { 255 } else { 0 };
                assert!(value.abs_diff(wanted) < 12, "{name}: {pixel:?} in bar {bar}");
            }
        }
    }
}

#[test]
fn unreadable_videos_are_named_with_a_hint() {
    let said = |name: &str, camera| Mp4Film::open(&fixture(name), camera).unwrap_err().to_string();
    let hevc = said("hevc.mp4", None);
    assert!(hevc.contains("HEVC (H.265)") && hevc.contains("ffmpeg -i IN -c:v libx264"), "{hevc}");
    assert!(said("interlaced.mp4", None).contains("interlaced"));
    let two = said("two_cameras.mp4", None);
    assert!(two.contains("1 (H.264, 98 x 66), 2 (H.264, 96 x 64)") && two.contains("camera ="), "{two}");
    assert!(said("two_cameras.mp4", Some("3")).contains("no video track \"3\""));
    let second = Mp4Film::open(&fixture("two_cameras.mp4"), Some("2")).unwrap();
    assert_eq!(pictures(&second, &[4]).unwrap()[0].1.width_px(), 96);
    assert!(said("../make_video.py", None).contains("is text, not an MP4 video"));
}

#[test]
fn a_video_is_a_recording_of_one_scene() {
    let file = FilmFile::open(&fixture("uneven.mp4"), RecordingDescription::default()).unwrap();
    let scenes = file.scenes();
    assert_eq!(scenes.iter().map(ToString::to_string).collect::<Vec<_>>(), ["uneven"]);
    let recording = file.open(&scenes[0]).unwrap();
    assert!(recording.track.is_none());
    assert_eq!((recording.reel.times_s().len(), recording.reel.picture_name(7)), (12, "7".to_owned()));
}

#[test]
fn poses_beside_a_video_count_from_its_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.mp4");
    std::fs::copy(fixture("uneven.mp4"), &path).unwrap();
    std::fs::write(folder.path().join("walk.tum"), "0.0 0 0 0 0 0 0 1\n2.0 4 0 0 0 0 0 1\n").unwrap();
    let file = FilmFile::open(&path, RecordingDescription::default()).unwrap();
    let recording = file.open(&file.scenes()[0]).unwrap();
    let fix = recording.track.unwrap().fix_at(recording.reel.times_s()[4]).unwrap();
    assert!((fix.position.x - 1.2).abs() < 1e-3, "{fix:?}");
}

/// Opens a file with these bytes, and reads all its pictures.
fn read(bytes: &[u8]) -> Result<usize, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("video.mp4");
    std::fs::write(&file, bytes).unwrap();
    let film = Mp4Film::open(&file, None).map_err(|error| error.to_string())?;
    let all: Vec<usize> = (0..film.times_s().len()).collect();
    pictures(&film, &all).map(|taken| taken.len())
}

#[test]
fn a_recording_that_was_broken_off_is_read_as_far_as_it_goes() {
    let whole = std::fs::read(fixture("fragmented.mp4")).unwrap();
    // The index at the end and half of the last fragment are missing.
    let count = read(&whole[..whole.len() - 700]).unwrap();
    assert!((24..40).contains(&count), "{count}");
    let whole = std::fs::read(fixture("high.mp4")).unwrap();
    assert!(read(&whole[..whole.len() - 50]).unwrap_err().contains("moov"));
}

#[test]
fn what_a_video_lacks_that_breaks_off_is_said() {
    let whole = std::fs::read(fixture("fragmented.mp4")).unwrap();
    assert!(film("fragmented.mp4").remarks().is_empty() && film("high.mp4").remarks().is_empty());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("video.mp4");
    for bytes in [whole.len() - 700, whole.len() * 6 / 10] {
        std::fs::write(&file, &whole[..bytes]).unwrap();
        let film = Mp4Film::open(&file, None).unwrap();
        let last_s = film.times_s().last().unwrap();
        let told = film.remarks().join("\n");
        assert!(told.contains("breaks off") && told.contains(&format!("end after {last_s:.1} s")), "{told}");
    }
    // The index is at the beginning of this one.
    let whole = std::fs::read(fixture("cut.mp4")).unwrap();
    std::fs::write(&file, &whole[..whole.len() * 6 / 10]).unwrap();
    let error = Mp4Film::open(&file, None).unwrap_err().to_string();
    assert!(error.contains("moov") || error.contains("copy the file again"), "{error}");
}

#[test]
fn a_table_that_claims_four_thousand_million_pictures_is_refused() {
    let mut bytes = std::fs::read(fixture("high.mp4")).unwrap();
    let stsz = bytes.windows(4).position(|kind| kind == b"stsz").unwrap();
    bytes[stsz + 8..stsz + 16].copy_from_slice(&[0, 0, 0, 1, 0xff, 0xff, 0xff, 0xff]);
    assert!(read(&bytes).unwrap_err().contains("claims 4294967295 samples"));
}

#[test]
fn a_thousand_broken_files_are_read_or_refused() {
    let mut rng = wayword_core::seeded_rng(6, &["broken videos"]);
    let names = [
        "high.mp4",
        "uneven.mp4",
        "cut.mp4",
        "fragmented.mp4",
        "av1.mp4",
        "av1_odd.mp4",
        "quicktime.mov",
        "turned.mp4",
    ];
    let mut refused = 0;
    for round in 0..1000 {
        let mut bytes = std::fs::read(fixture(names[round % names.len()])).unwrap();
        for _ in 0..rng.random_range(1..8) {
            let at = rng.random_range(0..bytes.len());
            bytes[at] =
                if rng.random_bool(0.5) { rng.random() } else { [0, 1, 0x7f, 0x80, 0xff][rng.random_range(0..5)] };
        }
        if rng.random_bool(0.1) {
            bytes.truncate(rng.random_range(0..bytes.len()));
        }
        refused += usize::from(read(&bytes).is_err());
    }
    assert!(refused > 100, "{refused}");
}

proptest! {
    #[test]
    fn any_bytes_are_a_parameter_set_or_none(unit in prop::collection::vec(any::<u8>(), 0..80)) {
        let _ = super::sps::SequenceParameters::read(&unit);
    }
}

/// Files with the ending .mp4 that are something else, as users may have them.
#[test]
fn files_that_are_no_mp4_are_named_by_their_kind() {
    let folder = tempfile::tempdir().unwrap();
    let webm = b"\x1a\x45\xdf\xa3\x9fB\x86\x81\x01B\xf7\x81\x01B\xf2\x81\x04B\xf3\x81\x08B\x82\x84webm";
    for (bytes, told) in [
        (&b""[..], "is empty"),
        (b"It is no video.\n", "is text"),
        (b"version https://git-lfs.github.com/spec/v1\n", "is a pointer of git-lfs"),
        (webm, "is a WebM video, not an MP4 video; if a video player shows it"),
        (b"\0\0\0\x08free\0\0\0\x08mdat", "it has no box `moov`"),
    ] {
        let file = folder.path().join("walk.mp4");
        std::fs::write(&file, bytes).unwrap();
        let error = Mp4Film::open(&file, None).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
        assert!(!error.contains("-c copy"), "{error}");
    }
}
