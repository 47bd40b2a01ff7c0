//! Frames of ThreeDWorld's output: FlatBuffers of every kind.
//!
//! No containment: all of this code is our own. Memory: texts and bytes are borrowed. An entry of a vector that names a
//! table takes four bytes, and becomes a struct of up to 72.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, tape};
use wayword_live::tdw::{BuildOutput, depth_m};

const BOUND: Bound = Bound { flat: 16 << 10, per_byte: 128 };

fn seeds() -> Vec<Vec<u8>> {
    let tapes = ["1.12.27", "1.13.0.0"].map(tape::record);
    tapes.iter().flat_map(|tape| tape::frames(tape)).filter(|frame| frame.len() >= 8).collect()
}

fuzz_target!(init: begin("tdw_output", &seeds()), |data: &[u8]| {
    BOUND.hold(data, || {
        if let Ok(BuildOutput::Images(images)) = BuildOutput::read(data) {
            for pass in &images.passes {
                let _ = depth_m(pass.bytes, images.width, images.height);
            }
        }
    });
});
