//! Finds the viewpoint graph of each scene: the file `SCENE_connectivity.json` in a folder.

use super::files::{MAX_ENTRIES, StageFiles};
use crate::{file_error::FileError, scene::scene_stem};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::{SceneId, SceneLack};
use wayword_world::connectivity::CONNECTIVITY_FILE_SUFFIX;

/// Most graphs without a scene that a warning names.
const MAX_NAMED_GRAPHS: usize = 3;
const CONNECTIVITY_HINT: &str = "give --connectivity the folder with the files SCENE_connectivity.json";

/// Scenes with their graphs.
#[derive(Debug, Default)]
pub(super) struct GraphPairing {
    pub(super) scenes: BTreeMap<SceneId, StageFiles>,
    /// Scenes and graphs that cannot be used, with the reason.
    pub(super) unpaired: BTreeMap<SceneId, SceneLack>,
    /// Names of graphs without a scene. A folder of graphs usually has many more of them than there are scenes.
    idle: Vec<String>,
    /// Other names of scenes, which episodes may use.
    pub(super) aliases: BTreeMap<SceneId, SceneId>,
}

impl GraphPairing {
    /// Scenes without graphs.
    pub(super) fn without_graphs(scenes: BTreeMap<SceneId, StageFiles>) -> Self {
        Self { scenes, ..Self::default() }
    }

    /// A line that names the graphs without a scene; `None` if every graph has one.
    pub(super) fn describe_idle_graphs(&self) -> Option<String> {
        let named = self.idle.iter().take(MAX_NAMED_GRAPHS).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = if self.idle.len() > MAX_NAMED_GRAPHS { " ..." } else { "" };
        (!self.idle.is_empty())
            .then(|| format!("{} of the graphs have no scene below --data: {named}{more}", self.idle.len()))
    }
}

/// Pairs scenes with the graphs of a folder.
///
/// HM3D's scenes are numbered: the folder `00800-TEEsavR23oF` holds `TEEsavR23oF.basis.glb`, and graphs have either
/// name. The scene id has the number if the folder or the graph shows it, because official splits use it.
pub(super) fn pair_graphs(scenes: BTreeMap<SceneId, StageFiles>, folder: &Path) -> Result<GraphPairing, FileError> {
    let graphs = find_graphs(folder)?;
    let mut used_graphs: BTreeMap<PathBuf, SceneId> = BTreeMap::new();
    let mut pairs = GraphPairing::default();
    for (id, files) in scenes {
        let (stem, numbered) = scene_names(&files.stage);
        let numbered_by_graph = graphs.keys().find(|name| has_scene_number(name, &stem)).cloned();
        let candidates = [numbered.clone(), numbered_by_graph.clone(), Some(stem.clone())];
        let found = candidates.into_iter().flatten().find_map(|name| Some((graphs.get(&name)?.clone(), name)));
        let Some((graph, name)) = found else {
            pairs.unpaired.insert(id, lack_of_graph(&files, folder, &stem, numbered.as_deref()));
            continue;
        };
        if let Some(first) = used_graphs.get(&graph) {
            pairs.unpaired.insert(id, lack_of_own_graph(&files, &graph, first));
            continue;
        }
        let chosen_id = numbered.or(numbered_by_graph).and_then(|name| SceneId::new(name).ok());
        let chosen_id =
            chosen_id.filter(|chosen_id| !pairs.scenes.contains_key(chosen_id)).unwrap_or_else(|| id.clone());
        for other in [Some(id), SceneId::new(name).ok(), SceneId::new(stem).ok()].into_iter().flatten() {
            if other != chosen_id {
                pairs.aliases.entry(other).or_insert_with(|| chosen_id.clone());
            }
        }
        used_graphs.insert(graph.clone(), chosen_id.clone());
        pairs.scenes.insert(chosen_id, StageFiles { graph: Some(graph), ..files });
    }
    pairs.idle = graphs.into_iter().filter(|(_, file)| !used_graphs.contains_key(file)).map(|(name, _)| name).collect();
    Ok(pairs)
}

/// The graphs of a folder by the names of their scenes.
fn find_graphs(folder: &Path) -> Result<BTreeMap<String, PathBuf>, FileError> {
    let wrong = |error: std::io::Error| FileError::new(folder, error.to_string(), CONNECTIVITY_HINT);
    let mut graphs = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)?.take(MAX_ENTRIES) {
        let file = entry.map_err(wrong)?.path();
        let name = file
            .file_name()
            .and_then(|name| name.to_str())
            .and_then(|name| name.strip_suffix(CONNECTIVITY_FILE_SUFFIX));
        if let Some(name) = name.filter(|name| !name.is_empty()) {
            graphs.insert(name.to_owned(), file);
        }
    }
    if graphs.is_empty() {
        return Err(FileError::new(
            folder,
            format!("contains no viewpoint graph: no file ends in {CONNECTIVITY_FILE_SUFFIX}"),
            CONNECTIVITY_HINT,
        ));
    }
    Ok(graphs)
}

/// A scene's own name, and its numbered name if its folder has one.
fn scene_names(stage: &Path) -> (String, Option<String>) {
    let text = |part: Option<&std::ffi::OsStr>| part.and_then(|part| part.to_str()).unwrap_or_default().to_owned();
    let stem = scene_stem(&text(stage.file_name())).to_owned();
    let folder = text(stage.parent().and_then(Path::file_name));
    let numbered = has_scene_number(&folder, &stem).then_some(folder);
    (stem, numbered)
}

/// Whether a name is a stem with the number of an HM3D scene before it.
fn has_scene_number(name: &str, stem: &str) -> bool {
    let number = name.strip_suffix(stem).and_then(|number| number.strip_suffix('-'));
    number.is_some_and(|number| number.len() == 5 && number.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The reason why a scene without a graph is left out.
fn lack_of_graph(files: &StageFiles, folder: &Path, stem: &str, numbered: Option<&str>) -> SceneLack {
    let name = numbered.unwrap_or(stem);
    SceneLack {
        what: format!("{}: there is no viewpoint graph for it in {}", files.stage.display(), folder.display()),
        hint: format!(
            "put {name}{CONNECTIVITY_FILE_SUFFIX} there, or use the scene without --connectivity, over its navmesh"
        ),
    }
}

/// The reason why a scene is left out when another scene has its graph.
fn lack_of_own_graph(files: &StageFiles, graph: &Path, first: &SceneId) -> SceneLack {
    SceneLack {
        what: format!("{}: scene {first} has the graph {} already", files.stage.display(), graph.display()),
        hint: "give --data a folder in which each scene is once".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for file in files {
            let file = folder.path().join(file);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        folder
    }

    fn paired(files: &[&str]) -> GraphPairing {
        let folder = folder(files);
        pair_graphs(super::super::files::find_scenes(&folder.path().join("s")).unwrap(), &folder.path().join("g"))
            .unwrap()
    }

    fn texts<V>(of: &BTreeMap<SceneId, V>) -> Vec<&str> {
        of.keys().map(SceneId::as_str).collect()
    }

    #[test]
    fn graphs_of_either_name_belong_to_a_numbered_scene() {
        let pairs = paired(&[
            "s/hm3d/00800-TEEsavR23oF/TEEsavR23oF.basis.glb",
            "s/hm3d/00010-DBjEcHFg4oq/DBjEcHFg4oq.basis.glb",
            "s/flat/vLpv2VX547B.glb",
            "s/mp3d/17DRP5sb8fy/17DRP5sb8fy.glb",
            "g/00800-TEEsavR23oF_connectivity.json",
            "g/DBjEcHFg4oq_connectivity.json",
            "g/00009-vLpv2VX547B_connectivity.json",
            "g/17DRP5sb8fy_connectivity.json",
            "g/scans.txt",
        ]);
        let ids = ["00009-vLpv2VX547B", "00010-DBjEcHFg4oq", "00800-TEEsavR23oF", "17DRP5sb8fy"];
        assert_eq!(texts(&pairs.scenes), ids);
        assert!(pairs.unpaired.is_empty(), "{pairs:?}");
        assert_eq!(pairs.aliases[&SceneId::new("TEEsavR23oF").unwrap()].as_str(), "00800-TEEsavR23oF");
        assert_eq!(texts(&pairs.aliases), ["DBjEcHFg4oq", "TEEsavR23oF", "vLpv2VX547B"]);
    }

    #[test]
    fn scenes_and_graphs_without_partner_are_named_with_a_hint() {
        let pairs = paired(&["s/a.glb", "s/b.glb", "s/again/a.glb", "g/a_connectivity.json", "g/c_connectivity.json"]);
        assert_eq!(texts(&pairs.scenes), ["a"]);
        let told = |name: &str| &pairs.unpaired[&SceneId::new(name).unwrap()];
        assert!(told("b").what.contains("b.glb: there is no viewpoint graph for it in"), "{pairs:?}");
        assert!(told("b").hint.contains("put b_connectivity.json there"), "{pairs:?}");
        assert_eq!(pairs.describe_idle_graphs().unwrap(), "1 of the graphs have no scene below --data: c");
        assert!(pairs.unpaired.values().any(|lack| lack.what.contains("has the graph")), "{pairs:?}");
        assert_eq!(pairs.unpaired.len(), 2);
    }

    #[test]
    fn a_folder_without_graphs_is_refused() {
        let folder = folder(&["s/a.glb", "g/readme.txt"]);
        let scenes = super::super::files::find_scenes(&folder.path().join("s")).unwrap();
        let told = |name: &str| pair_graphs(scenes.clone(), &folder.path().join(name)).unwrap_err().to_string();
        assert!(told("g").contains("contains no viewpoint graph") && told("g").contains("--connectivity"));
        assert!(told("nowhere").contains("nowhere"));
    }
}
