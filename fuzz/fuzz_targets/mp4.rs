//! MP4 files with H.264 or AV1: their boxes, and their pictures.
//!
//! The decoders (`openh264` in C++, `re_rav1d`) are third-party code; their panics are contained. Memory of C++ is not
//! counted; only libFuzzer's limit applies to it. Memory: a picture has at most 64 million pixels of three bytes,
//! whatever the file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, recording::walk, scratch, seeds::recordings};

const BOUND: Bound = Bound { flat: 600 << 20, per_byte: 4096 };

fuzz_target!(init: begin("mp4", &recordings::of_kind("video")), |data: &[u8]| {
    let folder = scratch::folder();
    scratch::write(folder.path(), "x.mp4", data);
    BOUND.hold(data, || drop(walk(&folder.path().join("x.mp4"))));
});
