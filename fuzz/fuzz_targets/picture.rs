//! PNG and JPEG, as the picture of a scene.
//!
//! The decoders (`image` with `png`, `zune-jpeg`) are third-party code; their panics are contained. Memory: see `glb`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, habitat::draw_picture, seeds};

const BOUND: Bound = Bound { flat: 64 << 20, per_byte: 16 << 10 };

fuzz_target!(init: begin("picture", &seeds::picture::all()), |data: &[u8]| {
    BOUND.hold(data, || { draw_picture(data); });
});
