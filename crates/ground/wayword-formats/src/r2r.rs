//! R2R: a path and usually three instructions.
//!
//! Fields: `distance`, `scan`, `path_id`, `path`, `heading`, `instructions`. `distance` is kept as unknown fields are.
//! Loaders of agents write an item for each instruction, with `instr_id` and `instruction`; these are read too.

use crate::{Episode, FormatError, input, matterport, output, read_tally::ReadTally};
use matterport::PathNumbers;
use serde_json::{Map, Value};
use std::{collections::BTreeMap, path::Path};

/// Reads an R2R file, a list or JSON Lines, plain or gzip.
///
/// # Errors
/// When the file cannot be read or is not JSON, a field of an item is missing or wrong, or a `path_id` is given twice.
pub fn read_r2r_file(file: &Path) -> Result<Vec<Episode>, FormatError> {
    let mut episodes = Vec::new();
    let mut tally = ReadTally::default();
    input::each_item(file, |mut item| {
        let name = matterport::name_field(&item, "path_id");
        let mut episode = matterport::take_path(&mut item, name)?;
        tally.claim_name(&item, name, &episode)?;
        episode.instructions = matterport::take_instructions(&mut item)?;
        episodes.push(tally.finish_episode(episode, item)?);
        Ok(())
    })?;
    tally.finish_file(episodes)
}

/// Writes an R2R file.
///
/// R2R has one item per path, because its loaders name an instruction by its path and its place in the item. So items
/// on one path with the same heading (REVERIE's, for several objects) become one item with all their instructions.
/// Where the heading differs, the later item gets its own path number. A path with a name that is not a number gets
/// one, and keeps its name in `path_name`.
///
/// # Errors
/// When a path names no viewpoints, or the file cannot be written.
pub fn write_r2r_file(file: &Path, episodes: &[Episode]) -> Result<(), FormatError> {
    let mut numbers = PathNumbers::new(episodes);
    let mut items: Vec<Map<String, Value>> = Vec::with_capacity(episodes.len());
    // For each `path_id`, the numbers of its items.
    let mut items_by_path: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for episode in episodes {
        let mut item = item_fields(file, episode, &mut numbers)?;
        let path_id = item.get("path_id").map(Value::to_string).unwrap_or_default();
        let same_path = items_by_path.entry(path_id).or_default();
        let is_same = |index: &&usize| items.get(**index).is_some_and(|other| same_walk(other, &item));
        let same_index = same_path.iter().find(is_same).copied();
        if let Some(other) = same_index.and_then(|index| items.get_mut(index)) {
            append_instructions(other, &mut item);
            continue;
        }
        if !same_path.is_empty() {
            item.insert("path_id".to_owned(), numbers.next_number().into());
            item.insert(matterport::PATH_NAME.to_owned(), episode.path_id.as_str().into());
        }
        same_path.push(items.len());
        items.push(item);
    }
    output::write_file(file, |out| output::write_list(out, &items))
}

/// The fields of an item, in R2R's order.
fn item_fields(file: &Path, episode: &Episode, numbers: &mut PathNumbers) -> Result<Map<String, Value>, FormatError> {
    let mut fields = Map::new();
    if let Some(length_m) = episode.floor_length_m().filter(|_| !episode.extra.contains_key("distance")) {
        // To the centimetre, as in R2R.
        fields.insert("distance".to_owned(), ((length_m * 100.0).round() / 100.0).into());
    }
    fields.insert("scan".to_owned(), episode.scene.as_str().into());
    numbers.put_path_id(&mut fields, episode);
    fields.insert("path".to_owned(), matterport::path_field(file, episode)?);
    fields.insert("heading".to_owned(), episode.heading_field());
    fields.insert("instructions".to_owned(), episode.instructions.clone().into());
    matterport::add_encodings(&mut fields, episode);
    matterport::add_extra(&mut fields, episode);
    Ok(fields)
}

/// Whether two items have the same path and the same heading at its start.
fn same_walk(a: &Map<String, Value>, b: &Map<String, Value>) -> bool {
    ["scan", "path", "heading"].iter().all(|key| a.get(*key) == b.get(*key))
}

fn append_instructions(to: &mut Map<String, Value>, from: &mut Map<String, Value>) {
    for field in ["instructions", matterport::ENCODINGS_FIELD] {
        if let (Some(Value::Array(to)), Some(Value::Array(from))) = (to.get_mut(field), from.get_mut(field)) {
            to.append(from);
        }
    }
}
