//! A thousand seeded mutations of every file that the Matterport3D reader reads: each gives a clear error or a
//! plausible result.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or counted"
)]

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::{fs, path::Path};
use wayword_core::{Heading, Platform, PlatformError, SceneId, ViewGaze};
use wayword_platforms::MatterportPlatform;
use wayword_testkit::{SCAN, viewpoint_id, write_building};
use wayword_world::labels_around;

const ROUNDS: u64 = 1000;

/// What hostile or broken files may contain instead of a value.
const ODDITIES: &[&str] = &[
    "NaN",
    "nan",
    "1e999",
    "-1e308",
    "inf",
    "null",
    "[]",
    "{}",
    "\"../../etc/passwd\"",
    "\"a/b\"",
    "..\\..\\x",
    "99999999999999999999",
    "-1",
    "true",
    "false",
    "\"\"",
    "\u{0}",
    "[[[[[[[[",
    "36",
    "1e5",
];

fn mutated(original: &[u8], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..rng.random_range(1..4) {
        if bytes.is_empty() {
            break;
        }
        let at = rng.random_range(0..bytes.len());
        match rng.random_range(0..7) {
            0 => bytes.truncate(at),
            1 => bytes[at] = rng.random(),
            2 => drop(bytes.splice(at..at, ODDITIES[rng.random_range(0..ODDITIES.len())].bytes())),
            3 => replace_token(&mut bytes, at, ODDITIES[rng.random_range(0..ODDITIES.len())]),
            4 => drop(bytes.splice(at..(at + rng.random_range(1..40)).min(bytes.len()), [])),
            5 => {
                let end = (at + rng.random_range(1..200)).min(bytes.len());
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            _ => replace_token(&mut bytes, at, if rng.random() { "true" } else { "false" }),
        }
    }
    bytes
}

/// Replaces the number or word around a position with a text.
fn replace_token(bytes: &mut Vec<u8>, at: usize, with: &str) {
    let inside = |byte: u8| byte.is_ascii_alphanumeric() || matches!(byte, b'.' | b'-' | b'_' | b'#');
    let start = (0..at).rev().take_while(|index| inside(bytes[*index])).last().unwrap_or(at);
    let end = (at..bytes.len()).find(|index| !inside(bytes[*index])).unwrap_or(bytes.len());
    drop(bytes.splice(start..end, with.bytes()));
}

/// Makes all the requests that a run makes to a platform.
fn use_it_all(data: &Path) -> Result<(), PlatformError> {
    let platform = MatterportPlatform::open(data)?;
    let scene = SceneId::new(SCAN).unwrap();
    let graph = platform.graph_for_scene(&scene)?;
    for viewpoint in graph.viewpoints().take(3) {
        assert!(graph.position_of(viewpoint).unwrap().is_finite());
        let frame = graph.path_frames(std::slice::from_ref(viewpoint), None).unwrap().remove(0);
        for label in labels_around(&platform, &scene, &frame)? {
            assert!(!label.name.is_empty() && label.elevation_rad.is_finite());
            assert!(label.distance_m.is_none_or(f64::is_finite));
        }
        platform.look_from(&scene, &frame, ViewGaze::quarter_view(Heading::NORTH))?;
    }
    match platform.sample_path(&scene, &wayword_core::PathRequest::default(), 1) {
        Ok(path) => assert!(path.frames.len() >= 5),
        Err(PlatformError::NoSuchPath { .. }) => {}
        Err(error) => return Err(error),
    }
    Ok(())
}

fn survives(file: &str) {
    let folder = tempfile::tempdir().unwrap();
    write_building(folder.path()).unwrap();
    let path = folder.path().join(file);
    let original = fs::read(&path).unwrap();
    use_it_all(folder.path()).unwrap();
    let name = path.file_name().unwrap().to_str().unwrap();
    let (mut refused, mut taken) = (0, 0);
    for round in 0..ROUNDS {
        let bytes = mutated(&original, &mut ChaCha8Rng::seed_from_u64(round));
        fs::write(&path, &bytes).unwrap();
        match use_it_all(folder.path()) {
            Ok(()) => taken += 1,
            Err(error) => {
                let said = error.to_string();
                let names_it = said.contains(name) && said.len() < 1000;
                assert!(names_it, "round {round}: {said}");
                refused += 1;
            }
        }
    }
    println!("{name}: {refused} refused with the file's name, {taken} taken");
    assert!(refused > ROUNDS / 4, "the mutations of {name} hardly broke anything: {refused}");
}

#[test]
fn connectivity() {
    survives(&format!("matterport/connectivity/{SCAN}_connectivity.json"));
}

#[test]
fn panorama_to_region() {
    survives(&format!("matterport/v1/scans/{SCAN}/house_segmentations/panorama_to_region.txt"));
}

#[test]
fn house_file() {
    survives(&format!("matterport/v1/scans/{SCAN}/house_segmentations/{SCAN}.house"));
}

#[test]
fn boxes() {
    survives(&format!("reverie/BBox/{SCAN}_{}.json", viewpoint_id(0)));
}

#[test]
fn object_positions() {
    survives("reverie/objpos.json");
}

#[test]
fn a_file_without_end_is_not_read_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    write_building(folder.path()).unwrap();
    let path = folder.path().join(format!("matterport/connectivity/{SCAN}_connectivity.json"));
    // The file is sparse: it takes no room on the disk.
    fs::File::create(&path).unwrap().set_len(1 << 36).unwrap();
    let error = use_it_all(folder.path()).unwrap_err().to_string();
    assert!(error.contains("the limit for a file of this kind"), "{error}");
}

#[test]
fn a_graph_in_pieces_still_gives_paths_within_a_piece() {
    let folder = tempfile::tempdir().unwrap();
    write_building(folder.path()).unwrap();
    let path = folder.path().join(format!("matterport/connectivity/{SCAN}_connectivity.json"));
    let mut items: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    // Cut the stairs.
    items[7]["included"] = false.into();
    fs::write(&path, items.to_string()).unwrap();
    let platform = MatterportPlatform::open(folder.path()).unwrap();
    let scene = SceneId::new(SCAN).unwrap();
    assert_eq!(platform.graph_for_scene(&scene).unwrap().count_components(), 2);
    for seed in 0..10 {
        let request = wayword_core::PathRequest { hops: 3..=7, length_m: 2.0..=30.0 };
        let path = platform.sample_path(&scene, &request, seed).unwrap();
        let level = path.frames[0].level;
        assert!(path.frames.iter().all(|frame| frame.level == level));
    }
}
