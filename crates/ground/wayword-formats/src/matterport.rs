//! The fields that R2R, REVERIE and RxR share: paths over Matterport3D's viewpoint graphs.

use crate::{DatasetItem, Episode, FormatError, item};
use serde_json::{Map, Value};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{SceneId, ViewpointId};

/// Takes `path_id`, `scan`, `path` and `heading`. `id` is the field that names the item.
pub(crate) fn take_path(item: &mut DatasetItem<'_>, id: &str) -> Result<Episode, FormatError> {
    let id_as_read = item.take_field(id)?;
    let id_text = item.checked_name(id, &id_as_read)?;
    item.set_id(&id_text);
    let path_as_read = if id == "path_id" { id_as_read.clone() } else { item.take_field("path_id")? };
    let path_id = item.checked_name("path_id", &path_as_read)?;
    let scan = item.take_field("scan")?;
    let mut episode = Episode::new(id_text, path_id, item.checked_scene("scan", &scan)?);
    let path = item.take_field("path")?;
    episode.viewpoints = item.checked_viewpoints("path", &path)?;
    let heading = item.take_field("heading")?;
    episode.start_heading = Some(item.checked_heading("heading", &heading)?);
    episode.remember_spelling(id, id_as_read);
    episode.remember_spelling("path_id", path_as_read);
    episode.remember_spelling("heading", heading);
    Ok(episode)
}

/// The field that names an instruction in files of loaders, which have an item for each.
pub(crate) const INSTRUCTION_NAME: &str = "instr_id";

/// The field that names an item: `id`, or else `instr_id` where the item is a single instruction, as loaders of agents
/// split them (`instruction` in place of `instructions`). Then `path_id` and `id` are repeated.
pub(crate) fn name_field<'f>(item: &DatasetItem<'_>, id: &'f str) -> &'f str {
    let is_single = item.peek_field("instructions").is_none() && item.peek_field("instruction").is_some();
    if is_single && item.peek_field(INSTRUCTION_NAME).is_some() { INSTRUCTION_NAME } else { id }
}

/// Takes the texts of an item: a list, or a single one as loaders of agents split them. The ids of the tokens of a single
/// one are left, because items with a list have them in another field.
pub(crate) fn take_instructions(item: &mut DatasetItem<'_>) -> Result<Vec<String>, FormatError> {
    if item.peek_field("instructions").is_some() {
        let instructions = item.take_field("instructions")?;
        return item.checked_instructions("instructions", &instructions);
    }
    let encoding = item.take_optional(ENCODING_FIELD);
    match item.take_optional("instruction") {
        Some(text) => Ok(vec![item.checked_instruction("instruction", &text)?]),
        None if encoding.is_some() => Err(item.wrong_field(
            "instructions",
            "it is missing: the item has the ids of the tokens alone, as files for pre-training do",
            "give the file with the texts",
        )),
        None => item.take_field("instructions").map(|_| Vec::new()),
    }
}

/// The nodes of a path, as they are written.
pub(crate) fn path_field(file: &Path, episode: &Episode) -> Result<Value, FormatError> {
    if episode.viewpoints.is_empty() {
        let problem = format!("the path of item {:?} names no viewpoints, and this format requires them", episode.id);
        return Err(FormatError::for_document(
            file,
            problem,
            "houses have none; write it as vlnce, wayword, parquet, hf or steps",
        ));
    }
    Ok(episode.viewpoints.iter().map(ViewpointId::as_str).collect())
}

/// The field with the ids of a single instruction's tokens, for agents that load them.
pub(crate) const ENCODING_FIELD: &str = "instr_encoding";

/// The field with the ids of each instruction's tokens.
pub(crate) const ENCODINGS_FIELD: &str = "instr_encodings";

/// Adds the ids of the tokens, if there are any.
pub(crate) fn add_encodings(fields: &mut Map<String, Value>, episode: &Episode) {
    if !episode.encodings.is_empty() {
        fields.insert(ENCODINGS_FIELD.to_owned(), episode.encodings.clone().into());
    }
}

/// Adds the unknown fields. Where a known field has the same name, that one stays.
pub(crate) fn add_extra(fields: &mut Map<String, Value>, episode: &Episode) {
    for (key, value) in &episode.extra {
        if !fields.contains_key(key) {
            fields.insert(key.clone(), value.clone());
        }
    }
}

/// The field that keeps the name of a path that had to be numbered.
pub(crate) const PATH_NAME: &str = "path_name";

/// The numbers of a file's paths. The field's evaluators read a path's name back with `int()`. So a path with another
/// name (`house2-3-17`) gets a number that no other path of the file has, and keeps its name in `path_name`.
pub(crate) struct PathNumbers {
    numbers: FreeNumbers,
    /// The numbers of paths with other names, by the name.
    given: BTreeMap<String, u64>,
    /// The different paths of a scene with one name.
    own: BTreeMap<(SceneId, String), Vec<NumberedPath>>,
}

/// One of several paths with one name.
struct NumberedPath {
    viewpoints: Vec<ViewpointId>,
    /// Its own number; the first path keeps the name.
    number: Option<u64>,
}

impl PathNumbers {
    pub(crate) fn new(episodes: &[Episode]) -> Self {
        let names = episodes.iter().map(|episode| episode.path_id.as_str());
        Self { numbers: FreeNumbers::not_in(names), given: BTreeMap::new(), own: BTreeMap::new() }
    }

    /// A number that no path has.
    pub(crate) fn next_number(&mut self) -> u64 {
        self.numbers.next_free()
    }

    /// Writes `path_id`, and `path_name` where the path had to be numbered.
    pub(crate) fn put_path_id(&mut self, fields: &mut Map<String, Value>, episode: &Episode) {
        let name = &episode.path_id;
        let as_read = episode.as_read.get("path_id").and_then(item::name_of);
        if number_of(name).is_some() || as_read.as_ref() == Some(name) {
            fields.insert("path_id".to_owned(), episode.name_field("path_id", name));
            return;
        }
        let number = match self.given.get(name) {
            Some(number) => *number,
            None => self.numbers.next_free(),
        };
        self.given.insert(name.clone(), number);
        fields.insert("path_id".to_owned(), number.into());
        fields.insert(PATH_NAME.to_owned(), name.as_str().into());
    }

    /// As [`Self::put_path_id`], for a format in which a `path_id` is one path: a different path of the same name gets a
    /// number of its own.
    pub(crate) fn put_own_path_id(&mut self, fields: &mut Map<String, Value>, episode: &Episode) {
        let Episode { scene, path_id, viewpoints, .. } = episode;
        let paths = self.own.entry((scene.clone(), path_id.clone())).or_default();
        let number = match paths.iter().find(|other| other.viewpoints == *viewpoints) {
            Some(known) => known.number,
            None => {
                let number = (!paths.is_empty()).then(|| self.numbers.next_free());
                paths.push(NumberedPath { viewpoints: viewpoints.clone(), number });
                number
            }
        };
        let Some(number) = number else { return self.put_path_id(fields, episode) };
        fields.insert("path_id".to_owned(), number.into());
        fields.insert(PATH_NAME.to_owned(), path_id.as_str().into());
    }
}

/// Numbers that are still free in a file.
pub(crate) struct FreeNumbers {
    taken: BTreeSet<u64>,
    next: u64,
}

impl FreeNumbers {
    /// The numbers that are not among these names.
    pub(crate) fn not_in<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        Self { taken: names.filter_map(number_of).collect(), next: 0 }
    }

    /// The smallest free number, which is taken from now on.
    pub(crate) fn next_free(&mut self) -> u64 {
        while !self.taken.insert(self.next) {
            self.next += 1;
        }
        self.next
    }
}

/// A name's number, where the name is one.
pub(crate) fn number_of(name: &str) -> Option<u64> {
    item::value_of(name).as_u64()
}
