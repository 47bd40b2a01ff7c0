//! Scenes as binary glTF: read with their pictures, and drawn.
//!
//! The reader of glTF (`gltf`) and the decoders of pictures (`image`, `basisu`) are third-party code; their panics are
//! contained. Memory: JSON grows to some hundred times its length (an empty object of three bytes is a material). A
//! picture may have 2^20 texels in any file, and 512 for each byte of a larger one. A texel takes up to 20 bytes while
//! it is decoded.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, habitat::draw, scratch, seeds};

const BOUND: Bound = Bound { flat: 64 << 20, per_byte: 16 << 10 };

fuzz_target!(init: begin("glb", &seeds::glb::binaries()), |data: &[u8]| {
    let folder = scratch::folder();
    scratch::write(folder.path(), "x.glb", data);
    BOUND.hold(data, || { draw(&folder.path().join("x.glb")); });
});
