//! Saves a house for other programs: glTF for its looks, JSON for its ground.

mod buffer;
mod gltf;
mod navigation;

use super::{graph::viewpoint_graph, ground::Ground, model::House};
pub use gltf::{glb, gltf_from_wayword};
pub use navigation::navigation;
use std::path::{Path, PathBuf};
use wayword_core::graph::GraphError;

/// Why a house cannot be saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// A file that cannot be written.
    #[error("{}: {source}; choose a folder that can be written to", file.display())]
    File {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A texture that cannot be encoded.
    #[error("texture {texture}: {source}")]
    Texture {
        /// Its index.
        texture: usize,
        /// What the encoder says.
        source: image::ImageError,
    },
    /// What cannot be told as JSON.
    #[error("the house cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A road map that does not hold together.
    #[error("the house's road map: {0}")]
    Graph(#[from] GraphError),
    /// More data than one GLB can hold.
    #[error("the house takes {bytes} bytes, and a GLB holds 4 GiB at most")]
    TooLarge {
        /// How many it takes.
        bytes: usize,
    },
}

/// Writes `house-SEED.glb` and `house-SEED.navigation.json` into a folder that exists; gives their names.
///
/// # Errors
/// When a file cannot be written or the house not be encoded.
pub fn save(house: &House, folder: &Path) -> Result<[PathBuf; 2], SaveError> {
    let ground = Ground::of(house);
    let graph = viewpoint_graph(house, &ground)?;
    let looks = folder.join(format!("house-{}.glb", house.seed));
    let ways = folder.join(format!("house-{}.navigation.json", house.seed));
    let write = |file: &PathBuf, bytes: &[u8]| {
        std::fs::write(file, bytes).map_err(|source| SaveError::File { file: file.clone(), source })
    };
    write(&looks, &glb(house)?)?;
    write(&ways, &serde_json::to_vec(&navigation(house, &ground, &graph)?)?)?;
    Ok([looks, ways])
}

#[cfg(test)]
mod tests;
