//! `.navmesh` files: read, and written back with the same bytes.
//!
//! No containment: all of this code is our own. Memory: what grows most is a list that is copied while it grows and
//! written out again, each time at most a few times the bytes that it came from.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, seeds};
use wayword_habitat::NavMesh;

const BOUND: Bound = Bound { flat: 64 << 10, per_byte: 16 };

fuzz_target!(init: begin("navmesh", &seeds::navmesh::all()), |data: &[u8]| {
    BOUND.hold(data, || {
        if let Ok(mesh) = NavMesh::from_bytes(data) {
            assert_eq!(mesh.to_bytes(), data);
        }
    });
});
