//! Seed inputs. All are made here, and none comes from a dataset.

pub mod basis;
pub mod glb;
pub mod navmesh;
pub mod picture;
pub mod recordings;
pub mod semantics;
pub mod words;

use std::{fs, path::Path};

/// Puts seeds into a target's corpus.
pub fn sow(target: &str, seeds: &[Vec<u8>]) {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    fs::create_dir_all(&corpus).expect("a folder for the corpus");
    for (number, seed) in seeds.iter().enumerate() {
        fs::write(corpus.join(format!("seed-{number:02}")), seed).expect("a seed");
    }
}
