//! Semantic files beside a scene, as the platform opens them. The first byte says which one the rest is: HM3D's
//! `.semantic.txt` or `.semantic.glb`, Matterport3D's `.house` or `_semantic.ply`.
//!
//! Decoders of GLB and of pictures are third-party code; their panics are contained. Memory: see `glb`.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_fuzz::{Bound, begin, habitat::visit, scratch, seeds};

const BOUND: Bound = Bound { flat: 64 << 20, per_byte: 16 << 10 };

fuzz_target!(init: begin("semantics", &seeds::semantics::all()), |data: &[u8]| {
    let Some((which, file)) = data.split_first() else { return };
    let folder = scratch::folder();
    let mut files = vec![("x.glb", seeds::glb::binaries().remove(0)), ("x.navmesh", seeds::navmesh::tiled())];
    match which % 4 {
        0 => files.extend([("x.semantic.txt", file.to_vec()), ("x.semantic.glb", seeds::glb::binaries().remove(0))]),
        1 => files.extend([("x.semantic.txt", seeds::semantics::ANNOTATIONS.to_vec()), ("x.semantic.glb", file.to_vec())]),
        2 => files.extend([("x.house", file.to_vec()), ("x_semantic.ply", seeds::semantics::ply())]),
        _ => files.extend([("x.house", seeds::semantics::HOUSE.to_vec()), ("x_semantic.ply", file.to_vec())]),
    }
    files.iter().for_each(|(name, bytes)| scratch::write(folder.path(), name, bytes));
    BOUND.hold(data, || drop(visit(folder.path())));
});
