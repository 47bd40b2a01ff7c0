//! Finds the scenes in a folder and the files that belong to each. Habitat calls the mesh of a scene its stage.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

use crate::{
    file_error::FileError,
    scene::{HabitatStage, files_beside, has_ending, scene_stem},
    semantics::SemanticFiles,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::SceneId;

/// Depth of nested folders that is searched; deeper folders are ignored.
const MAX_FOLDER_DEPTH: usize = 4;
/// Most files and folders that are examined; the others are ignored.
pub(super) const MAX_ENTRIES: usize = 200_000;
const DATA_HINT: &str = "give a scene's .glb file, or a folder of scenes laid out as in Habitat's datasets";

/// The files of one scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StageFiles {
    /// The stage configuration, GLB or glTF.
    pub(super) stage: PathBuf,
    /// The viewpoint graph for its paths; `None` if paths lead over its ground.
    pub(super) graph: Option<PathBuf>,
}

/// Every scene at a path, which is a file or a folder. The id is the file's name without the ending for its format; if
/// two are equal, the folder's name is put before it.
pub(super) fn find_scenes(place: &Path) -> Result<BTreeMap<SceneId, StageFiles>, FileError> {
    let mut files = Vec::new();
    if place.is_dir() {
        collect_files(place, MAX_FOLDER_DEPTH, &mut files)?;
    } else {
        files.push(place.to_owned());
    }
    // For each folder and scene name in it, the best stage with its rank.
    let mut by_stem: BTreeMap<(PathBuf, String), (usize, PathBuf)> = BTreeMap::new();
    for file in files {
        let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let Some(rank) = stage_rank(name) else { continue };
        let key = (file.parent().unwrap_or(Path::new("")).to_owned(), scene_stem(name).to_owned());
        let known = by_stem.entry(key).or_insert_with(|| (rank, file.clone()));
        if rank < known.0 {
            *known = (rank, file);
        }
    }
    let mut scenes = BTreeMap::new();
    for ((folder, stem), (_, stage)) in by_stem {
        let parent = folder.file_name().and_then(|name| name.to_str()).unwrap_or("scene");
        let names = [stem.clone(), format!("{parent}.{stem}")];
        let free = names.into_iter().filter_map(|name| SceneId::new(name).ok()).find(|id| !scenes.contains_key(id));
        if let Some(id) = free {
            scenes.insert(id, StageFiles { stage, graph: None });
        }
    }
    if scenes.is_empty() {
        return Err(FileError::new(place, "contains no scene", DATA_HINT));
    }
    Ok(scenes)
}

/// How well a file serves as a stage: 0 is the best, and `None` means that it is no stage.
fn stage_rank(name: &str) -> Option<usize> {
    let endings = [".stage_config.json", ".basis.glb", ".glb", ".gltf"];
    let rank = endings.iter().position(|ending| name.ends_with(ending))?;
    (!name.contains(".semantic.")).then_some(rank)
}

fn is_gltf(file: &Path) -> bool {
    has_ending(file, "glb") || has_ending(file, "gltf")
}

/// Adds the files in a folder and, down to `depth`, in the folders below it.
fn collect_files(folder: &Path, depth: usize, files: &mut Vec<PathBuf>) -> Result<(), FileError> {
    let wrong = |error: std::io::Error| FileError::new(folder, error.to_string(), DATA_HINT);
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)?.take(MAX_ENTRIES) {
        entries.push(entry.map_err(wrong)?.path());
    }
    entries.sort();
    for entry in entries {
        if files.len() >= MAX_ENTRIES {
            break;
        }
        if !entry.is_dir() {
            files.push(entry);
        } else if depth > 0 {
            collect_files(&entry, depth - 1, files)?;
        }
    }
    Ok(())
}

impl StageFiles {
    /// The navmesh beside the scene.
    pub(super) fn navmesh_file(&self, stage: &HabitatStage) -> Option<PathBuf> {
        let own = self.sibling_files(&[".basis.navmesh", ".navmesh"]);
        let named = stage.navmesh.iter().filter(|file| has_ending(file, "navmesh"));
        named.chain(&own).find(|file| file.is_file()).cloned()
    }

    /// The file that shows where one can walk: the viewpoint graph, or else the navmesh.
    fn ways_file(&self, stage: &HabitatStage) -> Option<PathBuf> {
        self.graph.clone().or_else(|| self.navmesh_file(stage))
    }

    /// Every file that the scene is read from, sorted. It includes the files to which its GLB or glTF files refer.
    pub(super) fn all_files(&self, stage: &HabitatStage) -> Vec<PathBuf> {
        let SemanticFiles { painted, numbered } = self.semantic_files(stage);
        let pairs = painted.into_iter().chain(numbered).flat_map(|(mesh, names)| [mesh, names]);
        let mut all: Vec<PathBuf> =
            [self.stage.clone(), stage.asset.clone()].into_iter().chain(self.ways_file(stage)).chain(pairs).collect();
        let named: Vec<PathBuf> = all.iter().filter(|file| is_gltf(file)).flat_map(|file| files_beside(file)).collect();
        all.extend(named);
        all.sort();
        all.dedup();
        all
    }

    /// The semantic files that the configuration names, or else those beside the scene.
    pub(super) fn semantic_files(&self, stage: &HabitatStage) -> SemanticFiles {
        let there = |ending: &str| self.sibling_files(&[ending]).into_iter().find(|file| file.is_file());
        let usable = |file: &Option<PathBuf>, is_kind: fn(&Path) -> bool| {
            file.clone().filter(|file| is_kind(file) && file.is_file())
        };
        let mesh = usable(&stage.semantics, is_gltf).or_else(|| there(".semantic.glb"));
        let list = usable(&stage.object_list, |file| has_ending(file, "txt")).or_else(|| there(".semantic.txt"));
        let faces = usable(&stage.semantics, |file| has_ending(file, "ply")).or_else(|| there("_semantic.ply"));
        let house = usable(&stage.object_list, |file| has_ending(file, "house")).or_else(|| there(".house"));
        SemanticFiles { painted: mesh.zip(list), numbered: faces.zip(house) }
    }

    /// The paths beside the stage that have the scene's name and one of these endings.
    fn sibling_files(&self, endings: &[&str]) -> Vec<PathBuf> {
        let name = self.stage.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        endings.iter().map(|ending| self.stage.with_file_name(format!("{}{ending}", scene_stem(name)))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn find_scenes_finds_the_files_of_each_scene() {
        let folder = tempfile::tempdir().unwrap();
        for file in [
            "hm3d/00800-a/a.basis.glb",
            "hm3d/00800-a/a.glb",
            "hm3d/00800-a/a.basis.navmesh",
            "hm3d/00800-a/a.semantic.glb",
            "hm3d/00800-a/a.semantic.txt",
            "mp3d/b/b.glb",
            "mp3d/b/b.house",
            "mp3d/b/b_semantic.ply",
            "other/b.glb",
            "other/notes.txt",
        ] {
            let file = folder.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        let scenes = find_scenes(folder.path()).unwrap();
        assert_eq!(scenes.keys().map(SceneId::as_str).collect::<Vec<_>>(), ["a", "b", "other.b"]);
        let files = &scenes[&SceneId::new("a").unwrap()];
        assert!(files.stage.ends_with("a.basis.glb"));
        let stage = HabitatStage::from_file(&files.stage).unwrap();
        assert!(files.navmesh_file(&stage).unwrap().ends_with("a.basis.navmesh"));
        assert!(files.semantic_files(&stage).painted.unwrap().1.ends_with("a.semantic.txt"));
        let matterport = &scenes[&SceneId::new("b").unwrap()];
        assert!(matterport.semantic_files(&HabitatStage::from_file(&matterport.stage).unwrap()).numbered.is_some());
    }

    #[test]
    fn semantic_files_are_those_that_the_configuration_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for file in ["x.glb", "x.semantic.glb", "x.semantic.txt", "b.glb", "b.txt", "c.ply", "c.house"] {
            std::fs::write(at(file), "").unwrap();
        }
        let found = |mesh: &str, list: &str| {
            let config = at("x.stage_config.json");
            let fields = serde_json::json!({
                "render_asset": "x.glb", "semantic_asset": mesh, "semantic_descriptor_filename": list
            });
            std::fs::write(&config, fields.to_string()).unwrap();
            let stage = HabitatStage::from_file(&config).unwrap();
            StageFiles { stage: config, graph: None }.semantic_files(&stage)
        };
        let painted = |mesh: &str, list: &str| Some((at(mesh), at(list)));
        assert_eq!(found("b.glb", "b.txt").painted, painted("b.glb", "b.txt"));
        assert_eq!(found("", "").painted, painted("x.semantic.glb", "x.semantic.txt"));
        assert_eq!(found("nosuch.glb", "nosuch.txt").painted, painted("x.semantic.glb", "x.semantic.txt"));
        assert_eq!(found("c.ply", "c.house").numbered, Some((at("c.ply"), at("c.house"))));
    }

    #[test]
    fn all_files_include_those_that_a_gltf_names() {
        let folder = tempfile::tempdir().unwrap();
        let document = serde_json::json!({
            "buffers": [{ "uri": "yard%20walls.bin" }, { "uri": "data:application/octet-stream;base64,AAAA" }, {}],
            "images": [{ "uri": "./paint/a.png" }, { "uri": "../out.png" }, { "uri": "gone.png" }, { "bufferView": 0 }],
        });
        std::fs::create_dir_all(folder.path().join("in/paint")).unwrap();
        for file in ["in/yard walls.bin", "in/paint/a.png", "in/other.bin", "out.png"] {
            std::fs::write(folder.path().join(file), "").unwrap();
        }
        let glb = crate::scene::tests::glb(&document, b"binary");
        let place = folder.path().join("in");
        for (name, bytes) in [("yard.gltf", document.to_string().into_bytes()), ("yard.glb", glb)] {
            let file = place.join(name);
            std::fs::write(&file, bytes).unwrap();
            let all =
                StageFiles { stage: file.clone(), graph: None }.all_files(&HabitatStage::from_file(&file).unwrap());
            assert_eq!(all, [place.join("paint/a.png"), place.join("yard walls.bin"), file]);
            std::fs::remove_file(place.join(name)).unwrap();
        }
    }

    #[test]
    fn a_folder_without_scenes_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(find_scenes(folder.path()).unwrap_err().to_string().contains("contains no scene"));
    }
}
