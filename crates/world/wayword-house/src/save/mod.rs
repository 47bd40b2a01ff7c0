//! Saves a house for other programs: glTF for its looks, JSON for its ground, and the further files that AI Habitat
//! needs.

mod buffer;
mod gltf;
mod navigation;
mod semantic;

use super::{graph::viewpoint_graph, ground::HouseGround, model::House, names::scene_name};
pub use buffer::gltf_from_wayword;
pub use gltf::encode_glb;
pub use navigation::navigation_json;
pub use semantic::{semantic_glb, semantic_txt};
use serde::Serialize;
use std::{
    ffi::OsString,
    fs, io,
    path::{Path, PathBuf},
};
use wayword_core::graph::GraphError;

/// Why a house cannot be saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// A file that cannot be written.
    #[error("cannot write {}: {source}; choose a folder that you can write to", file.display())]
    File {
        /// Which file.
        file: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A texture that cannot be encoded.
    #[error("texture {texture} cannot be encoded: {source}")]
    Texture {
        /// Its index.
        texture: usize,
        /// The encoder's error.
        source: image::ImageError,
    },
    /// A house that cannot be written as JSON.
    #[error("the house cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A viewpoint graph that is wrong.
    #[error("the house's viewpoint graph is wrong: {0}")]
    Graph(#[from] GraphError),
    /// More data than fits into one GLB file.
    #[error("the house takes {bytes} bytes, but a GLB file holds 4 GiB at most")]
    TooLarge {
        /// How many it takes.
        bytes: usize,
    },
}

/// The files of a saved house.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct HouseFiles {
    /// `house2-SEED.glb`: its looks.
    pub model: PathBuf,
    /// `house2-SEED.navigation.json`: rooms, objects, ground, viewpoint graph.
    pub navigation: PathBuf,
    /// `house2-SEED.stage_config.json`: names the other files for AI Habitat and for the platform `habitat`.
    pub stage: PathBuf,
    /// `house2-SEED.navmesh`: where one can walk, for AI Habitat; `None` if it was not given.
    pub navmesh: Option<PathBuf>,
    /// `house2-SEED.semantic.glb` and `house2-SEED.semantic.txt`: which object each surface belongs to.
    pub semantics: [PathBuf; 2],
}

/// Writes a house's files into a folder that exists. `navmesh` has the bytes of the house's navmesh, as Habitat reads them.
///
/// # Errors
/// When a file cannot be written or the house cannot be encoded.
pub fn save_house(house: &House, folder: &Path, navmesh: Option<&[u8]>) -> Result<HouseFiles, SaveError> {
    let ground = HouseGround::for_house(house);
    let graph = viewpoint_graph(house, &ground)?;
    let name = scene_name(house.seed);
    let write = |ending: &str, bytes: &[u8]| {
        let file = folder.join(format!("{name}.{ending}"));
        match write_whole(&file, bytes) {
            Ok(()) => Ok(file),
            Err(source) => Err(SaveError::File { file, source }),
        }
    };
    Ok(HouseFiles {
        model: write("glb", &encode_glb(house)?)?,
        navigation: write("navigation.json", &serde_json::to_vec(&navigation_json(house, &ground, &graph)?)?)?,
        stage: write(
            "stage_config.json",
            &serde_json::to_vec_pretty(&semantic::stage_config(&name, navmesh.is_some()))?,
        )?,
        navmesh: navmesh.map(|bytes| write("navmesh", bytes)).transpose()?,
        semantics: [
            write("semantic.glb", &semantic_glb(house)?)?,
            write("semantic.txt", semantic_txt(house).as_bytes())?,
        ],
    })
}

/// Writes a file under a hidden name first, so that a half one never has its name.
fn write_whole(file: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut hidden = OsString::from(".");
    hidden.push(file.file_name().unwrap_or_default());
    hidden.push(".part");
    let part = file.with_file_name(hidden);
    let written = fs::write(&part, bytes).and_then(|()| fs::rename(&part, file));
    if written.is_err() {
        // The first failure is the one to report.
        let _ = fs::remove_file(&part);
    }
    written
}

#[cfg(test)]
mod tests;
