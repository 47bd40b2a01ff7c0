//! MCAP files of ROS 2: records, chunks, messages, poses, pictures.
//!
//! The readers (`mcap`, `lz4_flex`, `ruzstd`, `image`) are others' code; panics are contained. Memory: a message with a picture may have
//! 257 MiB where the file, or a chunk unpacked, holds as much; a picture may take 256 MiB while it is decoded.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, recording::walk, scratch, seeds::recordings};

const BOUND: Bound = Bound { flat: 600 << 20, per_byte: 4096 };

fuzz_target!(init: begin("mcap", &recordings::of_kind("mcap")), |data: &[u8]| {
    let folder = scratch::folder();
    scratch::write(folder.path(), "x.mcap", data);
    BOUND.hold(data, || drop(walk(&folder.path().join("x.mcap"))));
});
