//! MCAP files of ROS 2: records, chunks, messages, poses, pictures.
//!
//! The readers (`mcap`, with LZ4 and Zstandard in C, and `image`) are third-party code; their panics are contained.
//! Memory: while a chunk is unpacked, a record of it may have 256 MiB, and 1000 times the chunk's length. A picture may
//! take 256 MiB while it is decoded.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, recording::walk, scratch, seeds::recordings};

const BOUND: Bound = Bound { flat: 600 << 20, per_byte: 4096 };

fuzz_target!(init: begin("mcap", &recordings::of_kind("mcap")), |data: &[u8]| {
    let folder = scratch::folder();
    scratch::write(folder.path(), "x.mcap", data);
    BOUND.hold(data, || drop(walk(&folder.path().join("x.mcap"))));
});
