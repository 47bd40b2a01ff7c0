//! Pose files beside pictures. The first byte says of which kind the rest is: text, CSV, JSON, or the description of a
//! recording.
//!
//! No containment: JSON (`serde_json`) and TOML (`toml`) are read by third-party code, but its panics would reach the
//! user. Memory: a byte of JSON becomes a value of 72 bytes, in a list that is copied while it grows.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, recording::walk, scratch, seeds};

const BOUND: Bound = Bound { flat: 16 << 20, per_byte: 2048 };

fuzz_target!(init: begin("poses", &seeds::recordings::poses()), |data: &[u8]| {
    let Some((which, file)) = data.split_first() else { return };
    let folder = scratch::folder();
    for number in 0..3 {
        scratch::write(folder.path(), &format!("{number}.png"), &seeds::picture::png(8 + number, 6));
    }
    let name = ["poses.txt", "poses.csv", "poses.json", "recording.toml"][usize::from(which % 4)];
    scratch::write(folder.path(), name, file);
    BOUND.hold(data, || drop(walk(folder.path())));
});
