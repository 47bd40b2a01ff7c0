//! The texts of a file, gathered by the path that they are about.

use crate::{
    count::count_phrase,
    episode_paths::{missing_object, path_for_episode, unusable_path},
    error::CommandError,
    run_folder::{number_of_text, text_label},
};
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_core::{
    CheckFinding, CheckKind, ObjectId, Path, Platform, PlatformError, SceneId, TextProvenance, Verdict, ViewpointId,
};
use wayword_formats::{
    DatasetFormat,
    jsonl::{self, InstructionRecord},
    submission::instr_id,
};
use wayword_world::path_over_viewpoints;

/// A path with every text about it, so that the views along the path are looked up once for all of them.
pub(crate) struct PathTexts {
    pub(crate) path: Path,
    pub(crate) texts: Vec<FileText>,
}

/// A text of the file.
pub(crate) struct FileText {
    /// Its place among the texts of the file, from 0.
    pub(crate) at: usize,
    /// The name of its path.
    pub(crate) path: String,
    /// Its own name: that of its item with its number, from 0, as submissions have it, or the path with the style.
    pub(crate) name: String,
    /// Its words.
    pub words: String,
    /// The style that it was written in, if the file names it.
    pub(crate) style: Option<StyleReference>,
    /// The tag of its language, where the file gives one.
    pub(crate) tag: Option<String>,
    /// Its platform and provenance, if the file has them.
    pub(crate) origin: Option<(String, TextProvenance)>,
    /// The object that its item names, if the scene has none of that id.
    pub(crate) missing_object: Option<ObjectId>,
}

impl FileText {
    /// A text of a dataset, which has no provenance.
    pub(super) fn from_dataset(path: &str, name: String, words: String, tag: Option<String>) -> Self {
        Self { at: 0, path: path.to_owned(), name, words, style: None, tag, origin: None, missing_object: None }
    }

    /// A text of a record. `number` counts the texts of its style about its path, from 0; `origin` is its platform and provenance.
    pub(super) fn from_record(
        path: &str,
        style: String,
        number: usize,
        words: String,
        origin: (String, TextProvenance),
    ) -> Self {
        let name = format!("{path} ({})", text_label(&style, number));
        let style = StyleReference { name: style, hash: origin.1.style_hash.clone() };
        Self { style: Some(style), origin: Some(origin), ..Self::from_dataset(path, name, words, None) }
    }

    /// The finding on an object of its item that the scene lacks: nothing can be known of a task about it.
    pub(crate) fn missing_object_finding(&self, scene: &SceneId) -> Option<CheckFinding> {
        let object = self.missing_object.as_ref()?;
        let reason = format!("the item {} names the object {object}, and scene {scene} has none of that id", self.path);
        Some(CheckFinding { check: CheckKind::Task, verdict: Verdict::Fail, reason, span: None })
    }
}

/// A style, as a record names it.
pub(crate) struct StyleReference {
    pub(crate) name: String,
    pub(crate) hash: String,
}

/// The paths of a file with their texts, in the order of the file.
pub(crate) fn read_path_texts(file: &FilePath, platform: &dyn Platform) -> Result<Vec<PathTexts>, CommandError> {
    let mut walks = PathTextIndex::default();
    if wayword_formats::detect_format(file)? == DatasetFormat::Wayword {
        for record in jsonl::read_records(file)? {
            let number = number_of_text(&record);
            let InstructionRecord { path, instruction, platform: made_on, .. } = record;
            let id = path.id.clone();
            if made_on != platform.name() {
                refuse_other_platform(file, (made_on.as_str(), &path.scene), platform)?;
            }
            let object = path.target.as_ref().map(|target| target.object.clone());
            let path = with_platform_poses(platform, path).map_err(unusable_path(file, &id))?;
            let missing_object = missing_object(platform, &path, object.as_ref())?;
            let origin = (made_on, instruction.provenance);
            let text = FileText::from_record(&path.id, instruction.style, number, instruction.text, origin);
            walks.add_text(path, FileText { missing_object, ..text });
        }
        return walks.expect_texts(file, 0);
    }
    let mut items = 0;
    for episode in wayword_formats::read_any_format(file)? {
        // The check ends with an error at the first missing scene.
        let path = path_for_episode(platform, &episode).map_err(unusable_path(file, &episode.id))?;
        let missing = missing_object(platform, &path, episode.target_object.as_ref())?;
        items += 1;
        for (at, words) in episode.instructions.iter().enumerate() {
            let tag = episode.language_of(at).map(str::to_owned);
            let name = instr_id(&episode, at);
            let text = FileText::from_dataset(&path.id, name, words.clone(), tag);
            walks.add_text(path.clone(), FileText { missing_object: missing.clone(), ..text });
        }
    }
    walks.expect_texts(file, items)
}

/// Refuses texts about a scene that only the platform has on which they were made, and not the one that was opened.
fn refuse_other_platform(
    file: &FilePath,
    (made_on, scene): (&str, &SceneId),
    platform: &dyn Platform,
) -> Result<(), CommandError> {
    match platform.graph_for_scene(scene) {
        Err(PlatformError::UnknownScene { .. }) => {
            let name = platform.name();
            let problem = format!("{}: its paths are of platform {made_on}, and --platform is {name}", file.display());
            Err(CommandError::usage(problem, format!("give --platform {made_on}")))
        }
        _ => Ok(()),
    }
}

/// Texts about paths, gathered by their paths.
#[cfg(feature = "study")]
pub(crate) fn gather_by_path(texts: Vec<(Path, String)>) -> Vec<PathTexts> {
    let mut walks = PathTextIndex::default();
    for (path, words) in texts {
        let text = FileText::from_dataset(&path.id, path.id.clone(), words, None);
        walks.add_text(path, text);
    }
    walks.all
}

/// Paths, gathered from texts.
#[derive(Default)]
struct PathTextIndex {
    /// The paths, in the order of their first texts.
    all: Vec<PathTexts>,
    /// The index in `all` of each path.
    places: BTreeMap<PathEvidenceKey, usize>,
    /// Number of texts so far.
    texts: usize,
}

/// Everything that evidence depends on: the scene, whether the motion is known, and each frame's place, heading and storey.
type PathEvidenceKey = (SceneId, bool, Vec<(([u64; 3], Option<ViewpointId>), u64, Option<u32>)>);

impl PathTextIndex {
    /// The paths of a file with so many items. A file without a text is an error: a check of nothing must not look like a check
    /// that passed.
    fn expect_texts(self, file: &FilePath, items: usize) -> Result<Vec<PathTexts>, CommandError> {
        if !self.all.is_empty() {
            return Ok(self.all);
        }
        Err(match items {
            0 => CommandError::usage(
                format!("{}: there is no instruction in it", file.display()),
                "give a file with instructions; errors.jsonl and rejected.jsonl of a run say what became of its texts",
            ),
            items => CommandError::usage(
                format!("{}: {} without an instruction", file.display(), count_phrase(items, "item")),
                "give a file whose items have instructions; test splits of some datasets have none",
            ),
        })
    }

    /// Adds a text to its path, and numbers it.
    fn add_text(&mut self, path: Path, text: FileText) {
        let frames =
            path.frames.iter().map(|frame| (frame.place_key(), frame.pose.heading.rad().to_bits(), frame.level));
        let key = (path.scene.clone(), path.motion.is_known(), frames.collect());
        let text = FileText { at: self.texts, ..text };
        self.texts += 1;
        let place = *self.places.entry(key).or_insert(self.all.len());
        match self.all.get_mut(place) {
            Some(walk) => walk.texts.push(text),
            None => self.all.push(PathTexts { path, texts: vec![text] }),
        }
    }
}

/// A record's path, with the platform's own poses and storeys if its frames are viewpoints. Those in the file are not trusted.
fn with_platform_poses(platform: &dyn Platform, path: Path) -> Result<Path, PlatformError> {
    let viewpoints: Option<Vec<_>> = path.frames.iter().map(|frame| frame.viewpoint.clone()).collect();
    let Some(viewpoints) = viewpoints else { return Ok(path) };
    // Names of pictures are not viewpoints. Whether the scene has viewpoints is decided by the platform, and not by the file.
    if !path.motion.is_known() && platform.graph_for_scene(&path.scene)?.is_empty() {
        return Ok(path);
    }
    let heading = path.frames.first().map(|frame| frame.pose.heading);
    let object = path.target.as_ref().map(|target| &target.object);
    path_over_viewpoints(platform, &path.id, &path.scene, &viewpoints, heading, object)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DVec3, PathMotion, path::PathStop};

    fn path(id: &str, end_m: f64) -> Path {
        let stop = |y: f64| PathStop { position: DVec3::new(0.0, y, 1.5), viewpoint: None, level: None };
        let frames = Path::frames_along(vec![stop(0.0), stop(end_m)], None);
        Path { id: id.into(), scene: SceneId::new("s").unwrap(), frames, motion: PathMotion::Known, target: None }
    }

    #[test]
    fn texts_about_one_way_are_one_walk_whatever_their_items_are_called() {
        let mut walks = PathTextIndex::default();
        for (id, end_m) in [("1_7", 2.0), ("2", 4.0), ("1_7", 2.0), ("1_9", 2.0)] {
            let path = path(id, end_m);
            walks.add_text(path.clone(), FileText::from_dataset(&path.id, id.into(), "Stop.".into(), None));
        }
        let texts: Vec<Vec<(usize, &str)>> = walks
            .all
            .iter()
            .map(|walk| walk.texts.iter().map(|text| (text.at, text.path.as_str())).collect())
            .collect();
        assert_eq!(texts, [vec![(0, "1_7"), (2, "1_7"), (3, "1_9")], vec![(1, "2")]]);
        let mut other = path("1_7", 2.0);
        other.motion = PathMotion::Unknown;
        walks.add_text(other.clone(), FileText::from_dataset(&other.id, "1_7".into(), "Stop.".into(), None));
        assert_eq!(walks.all.len(), 3, "texts are checked against the motion too");
    }
}
