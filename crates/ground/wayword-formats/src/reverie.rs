//! REVERIE: a path, the object at its end, and short instructions that name a task on it.
//!
//! Fields: `id` ("path_objId"), `scan`, `path_id`, `path`, `objId`, `heading`, `instructions`. The first release adds
//! `distance`, `ix` and `instructions_l` (R2R's text); they are kept as unknown fields are.

use crate::{
    DatasetItem, Episode, FormatError, input, item, matterport, output,
    read_tally::{ReadTally, SharedPathId},
};
use matterport::PathNumbers;
use serde_json::{Map, Value};
use std::path::Path;

/// Reads a REVERIE file of either release, a list or JSON Lines, plain or gzip.
///
/// # Errors
/// When the file cannot be read or is not JSON, a field of an item is missing or wrong, an id is given twice, or two
/// paths of a scan with one `path_id` start at different viewpoints, or an `id` is not "path_objId" although others are.
pub fn read_reverie_file(file: &Path) -> Result<Vec<Episode>, FormatError> {
    let mut episodes = Vec::new();
    let mut tally = ReadTally::default();
    let mut item_names = ItemNames::default();
    input::each_item(file, |mut item| {
        let name = matterport::name_field(&item, "id");
        let mut episode = matterport::take_path(&mut item, name)?;
        tally.claim_name(&item, name, &episode)?;
        tally.claim_path(&item, &episode, SharedPathId::Start)?;
        // Items of test splits, and those with a free target, have no object.
        if let Some(object) = item.take_optional("objId").filter(|object| !object.is_null()) {
            episode.target_object = Some(item.checked_object("objId", &object)?);
            episode.remember_spelling("objId", object);
        }
        if name == "id" {
            item_names.note_name(&item, &episode);
        }
        episode.instructions = matterport::take_instructions(&mut item)?;
        episodes.push(tally.finish_episode(episode, item)?);
        Ok(())
    })?;
    item_names.refuse_mixture()?;
    tally.finish_file(episodes)
}

/// How a file names its items. REVERIE's own name is "path_objId". Files that others made may have names of another kind
/// throughout, but where only some differ, one of the three fields is wrong.
#[derive(Default)]
struct ItemNames {
    /// Whether an item is named by its path and object.
    has_usual: bool,
    /// The first item that is not, as an error about it.
    first_other: Option<FormatError>,
}

impl ItemNames {
    /// Takes in the name of an item that has an object.
    fn note_name(&mut self, item: &DatasetItem<'_>, episode: &Episode) {
        let Some(object) = &episode.target_object else { return };
        let usual = format!("{}_{object}", episode.path_id);
        self.has_usual |= episode.id == usual;
        if episode.id != usual && self.first_other.is_none() {
            let problem = format!("it is {:?}, but path_id and objId give {usual:?}, as in other items", episode.id);
            self.first_other = Some(item.wrong_field("id", problem, "correct id, path_id or objId"));
        }
    }

    /// Refuses a file in which only some items are named by path and object.
    fn refuse_mixture(self) -> Result<(), FormatError> {
        self.first_other.filter(|_| self.has_usual).map_or(Ok(()), Err)
    }
}

/// Writes a REVERIE file (2022 release; fields of the first release are kept where an item has them).
///
/// An item's id is "path_objId", or "path" where it has no target. A path with a name that is not a number gets one,
/// and keeps its name in `path_name`.
///
/// # Errors
/// When a path names no viewpoints, two items would have the same id, or the file cannot be written.
pub fn write_reverie_file(file: &Path, episodes: &[Episode]) -> Result<(), FormatError> {
    let mut numbers = PathNumbers::new(episodes);
    let mut ids = std::collections::BTreeSet::new();
    let mut items = Vec::with_capacity(episodes.len());
    for episode in episodes {
        let item = item_fields(file, episode, &mut numbers)?;
        if !ids.insert(item.get("id").map(Value::to_string)) {
            let problem =
                format!("item {:?} has the same path and object as another, so both get the same id", episode.id);
            return Err(FormatError::for_document(
                file,
                problem,
                "put instructions for one path and object into one item",
            ));
        }
        items.push(item);
    }
    output::write_file(file, |out| output::write_list(out, &items))
}

/// The fields of an item, in REVERIE's order.
fn item_fields(file: &Path, episode: &Episode, numbers: &mut PathNumbers) -> Result<Map<String, Value>, FormatError> {
    let mut fields = Map::new();
    // Keeps the first place. The value needs `path_id`, so it follows below.
    fields.insert("id".to_owned(), Value::Null);
    fields.insert("scan".to_owned(), episode.scene.as_str().into());
    numbers.put_path_id(&mut fields, episode);
    fields.insert("path".to_owned(), matterport::path_field(file, episode)?);
    if let Some(object) = &episode.target_object {
        fields.insert("objId".to_owned(), episode.name_field("objId", object.as_str()));
    }
    fields.insert("heading".to_owned(), episode.heading_field());
    fields.insert("instructions".to_owned(), episode.instructions.clone().into());
    matterport::add_encodings(&mut fields, episode);
    let id = composed_id(episode, fields.get("path_id"));
    fields.insert("id".to_owned(), id);
    matterport::add_extra(&mut fields, episode);
    Ok(fields)
}

/// The `id`: the one that was read where object and name are unchanged, else path and object.
fn composed_id(episode: &Episode, path_id: Option<&Value>) -> Value {
    let path = path_id.and_then(item::name_of).unwrap_or_default();
    let unchanged = |value: &Value| {
        let object = episode.as_read.get("objId").and_then(item::name_of);
        item::name_of(value).as_ref() == Some(&episode.id)
            && object.as_deref() == episode.target_object.as_ref().map(wayword_core::ObjectId::as_str)
    };
    episode.field_value("id", unchanged, || match &episode.target_object {
        Some(object) => format!("{path}_{object}").into(),
        None => path.into(),
    })
}
