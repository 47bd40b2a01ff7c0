//! When a decoder panics on a broken file, the user sees only an error about the file.

#![cfg(feature = "habitat")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::Building;

#[test]
fn a_decoder_that_panics_is_not_heard() {
    let building = Building::new();
    // The header announces a length of 0. The glTF reader subtracts the header's 12 bytes from it, and panics.
    let glb = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &0_u32.to_le_bytes(), &[0; 20]].concat();
    std::fs::write(building.path("broken.glb"), glb).unwrap();
    let ran = building.wayword(&[
        "generate",
        "--platform",
        "habitat",
        "--data",
        "broken.glb",
        "--paths",
        "1",
        "--out",
        "run",
    ]);
    assert!(ran.refused().contains("broken.glb: is broken"), "{ran:?}");
}
