//! Tests the reader with the stand-in's frames, and with frames that no build should send.

use super::{BuildOutput, output, stand_in::frames_of_every_kind};
use proptest::prelude::*;

#[test]
fn every_kind_of_frame_is_read_whole() {
    for (id, frame) in frames_of_every_kind() {
        let read = BuildOutput::read(frame).unwrap_or_else(|error| panic!("{error}"));
        assert!(!matches!(read, BuildOutput::Other(_)), "{id}");
    }
}

#[test]
fn both_layouts_of_the_version_are_read() {
    let versions = frames_of_every_kind().iter().filter(|(id, _)| id == "vers").map(|(_, frame)| {
        match BuildOutput::read(frame).unwrap() {
            BuildOutput::Version(version) => (version.tdw.to_owned(), version.unity.to_owned(), version.standalone),
            other => panic!("{other:?}"),
        }
    });
    let expected = ["1.12.27", "1.13.0.0"].map(|tdw| (tdw.to_owned(), "2020.3.24f1".to_owned(), true));
    assert_eq!(versions.collect::<Vec<_>>(), expected);
}

/// A path frame as flatc 2.0.8 lays it out (`tdw.fbs` of the reference): vtable before the table, vector after.
#[test]
fn a_buffer_laid_out_by_another_writer_is_read() {
    let mut frame = Vec::new();
    frame.extend(20_u32.to_le_bytes());
    frame.extend(b"path");
    // Two bytes of padding, then the vtable: its size, the table's size, and where path, state and id are.
    frame.extend([0, 0]);
    frame.extend([10_u16, 16, 8, 7, 12].iter().flat_map(|entry| entry.to_le_bytes()));
    frame.extend(10_i32.to_le_bytes());
    frame.extend([0, 0, 0, 2]);
    frame.extend(8_u32.to_le_bytes());
    frame.extend(9_i32.to_le_bytes());
    frame.extend(12_u32.to_le_bytes());
    frame.extend([1.5_f32, 0.0, -2.0].iter().flat_map(|number| number.to_le_bytes()));
    let path = super::NavMeshPath { id: 9, state: 2, corners: vec![[1.5, 0.0, -2.0]] };
    assert_eq!(BuildOutput::read(&frame), Ok(BuildOutput::Path(path)));
}

#[test]
fn output_errors_name_position_and_expected_content() {
    let frame = &frames_of_every_kind().iter().find(|(id, _)| id == "path").unwrap().1;
    let error = BuildOutput::read(&frame[..frame.len() - 8]).unwrap_err().to_string();
    assert!(error.contains("`path`") && error.contains("byte ") && error.contains("within the frame"), "{error}");
    assert_eq!(BuildOutput::read(b"abc").unwrap_err().source.at, 4);
}

/// Bytes that reading a frame allocates, at most.
fn held(output: &BuildOutput<'_>) -> usize {
    match output {
        BuildOutput::Images(images) => size_of_val(&images.passes[..]),
        BuildOutput::Segmentation(segments) => size_of_val(&segments[..]),
        BuildOutput::Path(path) => size_of_val(&path.corners[..]),
        BuildOutput::Regions(regions) => size_of_val(&regions[..]),
        BuildOutput::Occupancy(map) => map.cells.len() + size_of_val(&map.positions[..]),
        BuildOutput::Transforms(transforms) => size_of_val(&transforms[..]),
        BuildOutput::Bounds(bounds) => size_of_val(&bounds[..]),
        BuildOutput::Categories(categories) => size_of_val(&categories[..]),
        BuildOutput::Sensors(_, sensors) => size_of_val(&sensors[..]),
        _ => 0,
    }
}

/// An element takes at least four bytes in the frame, its offset, and at most 64 bytes once it is read.
const MOST_FOLD: usize = 16;

fn reads_within_bounds(frame: &[u8]) {
    if let Ok(output) = BuildOutput::read(frame) {
        assert!(held(&output) <= MOST_FOLD * frame.len() + 64, "{} bytes of {}", held(&output), frame.len());
    }
}

proptest! {
    #[test]
    fn no_bytes_break_the_reader(kind in 0..64_usize, bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let kinds = frames_of_every_kind();
        let mut frame = vec![bytes.len() as u8 / 2, 0, 0, 0];
        frame.extend(kinds[kind % kinds.len()].0.as_bytes());
        frame.extend(&bytes);
        reads_within_bounds(&frame);
    }

    #[test]
    fn no_mutation_breaks_the_reader(
        kind in 0..64_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let kinds = frames_of_every_kind();
        let mut frame = kinds[kind % kinds.len()].1.clone();
        // Only this part has offsets and lengths. Pixels and numbers further on are valid whatever their value.
        let near = frame.len().min(400);
        for (at, byte) in changes {
            frame[at.index(near)] = byte;
        }
        if is_cut {
            frame.truncate(cut.index(frame.len()));
        }
        reads_within_bounds(&frame);
    }

    #[test]
    fn an_id_is_read_from_anything(bytes in prop::collection::vec(any::<u8>(), 0..12)) {
        prop_assert_eq!(output::frame_id(&bytes).is_some(), bytes.len() >= 8);
    }
}
