//! Walks on `.navmesh` files: islands, storeys, shortest ways, the viewpoint graph, frames along a way.
//!
//! The search for ways (`polyanya`) is third-party code; its panics are contained. Memory: a polygon of 32 bytes may
//! name the 255 triangles of a list that other polygons name too (72 bytes each). The numbers of viewpoints and frames
//! are bounded, whatever the area.
#![no_main]

use libfuzzer_sys::fuzz_target;
use wayword_core::seeded_rng;
use wayword_fuzz::{Bound, begin, seeds};
use wayword_habitat::{
    NavMesh, NavMeshGround,
    ground::{stops_along, viewpoint_graph},
};

const BOUND: Bound = Bound { flat: 96 << 20, per_byte: 4096 };

fuzz_target!(init: begin("ground", &seeds::navmesh::all()), |data: &[u8]| {
    BOUND.hold(data, || {
        let Ok(mesh) = NavMesh::from_bytes(data) else { return };
        let ground = NavMeshGround::new(&mesh);
        let mut rng = seeded_rng(1, &["fuzz"]);
        for island in 0..2 {
            let places = [ground.random_place(island, &mut rng), ground.random_place(island, &mut rng)];
            if let [Some(from), Some(to)] = places
                && let Ok(way) = ground.geodesic(from.place, to.place)
            {
                let _ = stops_along(&ground, &way, 1.0);
            }
        }
        // On wide ground this takes half a second, so it runs for a part of these inputs only.
        if ground.area_m2() < 60.0 || data.ends_with(&[0]) {
            let _ = viewpoint_graph(&ground, 0);
        }
    });
});
