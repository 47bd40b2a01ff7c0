//! Where the answers of the genuine Habitat lie.

#![allow(dead_code, reason = "each test binary uses a part")]
#![allow(clippy::print_stderr, reason = "a test that is skipped says so")]

use std::path::{Path, PathBuf};
use wayword_core::DVec3;
use wayword_habitat::axes::wayword_from_habitat;

/// The folder of the oracles, or nothing, said loudly.
pub(crate) fn folder() -> Option<PathBuf> {
    let data = std::env::var_os("WAYWORD_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data"), PathBuf::from);
    let oracles = data.join("oracles");
    if oracles.is_dir() {
        return Some(oracles);
    }
    eprintln!("SKIPPED: no oracles at {} (set WAYWORD_DATA)", oracles.display());
    None
}

/// All navmeshes among them.
pub(crate) fn navmeshes() -> Vec<PathBuf> {
    let names = [
        "habitat_navmesh/rooms.navmesh",
        "habitat_frames/traj_flat_a/scene.navmesh",
        "habitat_frames/traj_simple_room/scene.navmesh",
    ];
    folder().map(|folder| names.map(|name| folder.join(name)).to_vec()).unwrap_or_default()
}

/// A file of JSON.
pub(crate) fn json(file: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

/// A place of Habitat, in Wayword's frame.
pub(crate) fn place(point: &serde_json::Value) -> DVec3 {
    let number = |at: usize| point[at].as_f64().unwrap();
    wayword_from_habitat(DVec3::new(number(0), number(1), number(2)))
}
