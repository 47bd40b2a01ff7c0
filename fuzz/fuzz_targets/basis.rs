//! Basis textures (`GOOGLE_texture_basis`), as the picture of a scene.
//!
//! The decoder (`basisu`) is third-party code; its panics are contained. Memory: its codebooks have at most 2 x 65,536
//! entries; for texels see `glb`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, habitat::draw_picture, seeds};

const BOUND: Bound = Bound { flat: 64 << 20, per_byte: 16 << 10 };

fuzz_target!(init: begin("basis", &seeds::basis::all()), |data: &[u8]| {
    BOUND.hold(data, || { draw_picture(data); });
});
