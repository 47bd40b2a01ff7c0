//! Scenes as text glTF with their bytes in data addresses: the same as `glb`, without the container.
//!
//! Containment and memory: see `glb`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, habitat::draw, scratch, seeds};

const BOUND: Bound = Bound { flat: 64 << 20, per_byte: 16 << 10 };

fuzz_target!(init: begin("gltf", &seeds::glb::texts()), |data: &[u8]| {
    let folder = scratch::folder();
    scratch::write(folder.path(), "x.gltf", data);
    BOUND.hold(data, || { draw(&folder.path().join("x.gltf")); });
});
