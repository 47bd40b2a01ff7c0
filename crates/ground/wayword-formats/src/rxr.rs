//! RxR guide annotations: JSON Lines, one instruction each, plain or gzip. A list of the same items is read too.
//!
//! Fields: `split`, `instruction_id`, `annotator_id`, `language`, `path_id`, `scan`, `path`, `heading`, `instruction`,
//! `timed_instruction` (`word`, and where known `start_time`, `end_time`), `edit_distance`.

use crate::{
    DatasetItem, Episode, FormatError, input, limits, matterport, output,
    read_tally::{ReadTally, SharedPathId},
};
use matterport::{FreeNumbers, PathNumbers, number_of};
use serde_json::{Map, Value, json};
use std::{collections::BTreeSet, path::Path};
use wayword_language::Language;

/// Fields that describe the text: they are written back only while the text is unchanged.
const TEXT_FIELDS: [&str; 4] = ["annotator_id", "language", "timed_instruction", "edit_distance"];

/// Reads a file of guide annotations.
///
/// # Errors
/// When the file cannot be read or is not JSON, a field of a line is missing or wrong, an `instruction_id` is given twice,
/// or a `path_id` of a scan is given to two different paths.
pub fn read_rxr_file(file: &Path) -> Result<Vec<Episode>, FormatError> {
    let mut episodes = Vec::new();
    let mut tally = ReadTally::default();
    input::each_line_or_item(file, |mut item| {
        let mut episode = matterport::take_path(&mut item, "instruction_id")?;
        tally.claim_name(&item, "instruction_id", &episode)?;
        tally.claim_path(&item, &episode, SharedPathId::WholePath)?;
        let instruction = item.take_field("instruction")?;
        episode.instructions = vec![item.checked_instruction("instruction", &instruction)?];
        episode.remember_spelling("instruction", instruction);
        if let Some(split) = item.take_optional("split") {
            episode.split = Some(item.checked_name("split", &split)?);
        }
        take_text_fields(&mut item, &mut episode)?;
        episodes.push(tally.finish_episode(episode, item)?);
        Ok(())
    })?;
    tally.finish_file(episodes)
}

/// Takes the fields that annotations by a model may lack.
fn take_text_fields(item: &mut DatasetItem<'_>, episode: &mut Episode) -> Result<(), FormatError> {
    for field in TEXT_FIELDS {
        let Some(value) = item.take_optional(field) else { continue };
        match field {
            "annotator_id" => drop(item.checked_name(field, &value)?),
            "edit_distance" => drop(item.checked_number(field, &value)?),
            "language" => episode.languages = vec![item.checked_text(field, &value)?.to_owned()],
            _ => check_timed_words(item, field, &value)?,
        }
        // Timed words take ten times as much memory as JSON values as they do as text.
        let value = if field == "timed_instruction" { value.to_string().into() } else { value };
        episode.remember_spelling(field, value);
    }
    Ok(())
}

/// Checks that every entry of `timed_instruction` has a word.
fn check_timed_words(item: &DatasetItem<'_>, field: &str, value: &Value) -> Result<(), FormatError> {
    for (index, timed) in item.checked_list(field, value, limits::MAX_INSTRUCTION_BYTES)?.iter().enumerate() {
        let word_field = format!("{field}[{index}].word");
        let Some(word) = timed.get("word") else {
            return Err(item.wrong_field(&word_field, "it is missing", "each entry is an object with a word"));
        };
        item.checked_text(&word_field, word)?;
    }
    Ok(())
}

/// Writes guide annotations, one line per instruction; gzip where the name ends in `.gz`.
///
/// A text that differs from the one that was read gets the `language` of its script ("en-US" for Latin letters), the `annotator_id` 0 (no annotator wrote
/// it), an `edit_distance` of 0 (it is no transcription) and words without times, like some of RxR's own words.
/// Instructions get new numbers where an item has several, or where its id is not a number or is used already. A path
/// with a name that is not a number gets one, and keeps its name in `path_name`; so does the second of two different
/// paths of a scan with one name (REVERIE's, for several objects). An item without a split gets "train".
///
/// # Errors
/// When a path names no viewpoints, or the file cannot be written.
pub fn write_rxr_file(file: &Path, episodes: &[Episode]) -> Result<(), FormatError> {
    let mut paths = PathNumbers::new(episodes);
    let mut fresh = FreeNumbers::not_in(episodes.iter().map(|episode| episode.id.as_str()));
    let mut used = BTreeSet::new();
    let mut lines = Vec::with_capacity(episodes.len());
    for episode in episodes {
        let is_only_one = episode.instructions.len() == 1;
        for (number, text) in episode.instructions.iter().enumerate() {
            let keeps_id = is_only_one && keeps_its_id(episode) && used.insert(&episode.id);
            let id =
                if keeps_id { episode.name_field("instruction_id", &episode.id) } else { fresh.next_free().into() };
            let mut line = line_fields(file, episode, text, id, &mut paths)?;
            if let Some(ids) = episode.encodings.get(number) {
                line.insert(matterport::ENCODING_FIELD.to_owned(), ids.clone().into());
            }
            lines.push(line);
        }
    }
    output::write_file(file, |out| output::write_lines(out, &lines))
}

fn keeps_its_id(episode: &Episode) -> bool {
    number_of(&episode.id).is_some() || episode.as_read.contains_key("instruction_id")
}

/// The tag of the language of a text by its script, as RxR writes it: "en-US" for English.
pub(crate) fn language_tag(text: &str) -> &'static str {
    Language::tag_of_script(text).unwrap_or("en-US")
}

/// The fields of a line, in RxR's order.
fn line_fields(
    file: &Path,
    episode: &Episode,
    text: &str,
    id: Value,
    paths: &mut PathNumbers,
) -> Result<Map<String, Value>, FormatError> {
    let same_text = episode.as_read.get("instruction").and_then(Value::as_str) == Some(text);
    // The value that was read describes the text only while the text is the same.
    let text_field = |field: &str, anew: Value| episode.field_value(field, |_| same_text, || anew);
    let words = || text.split_whitespace().map(|word| json!({ "word": word })).collect();
    let timed = episode.as_read.get("timed_instruction").and_then(Value::as_str).filter(|_| same_text);
    let timed = timed.and_then(|timed| serde_json::from_str(timed).ok()).unwrap_or_else(words);
    let mut fields = Map::new();
    fields.insert("split".to_owned(), episode.split.as_deref().unwrap_or("train").into());
    fields.insert("instruction_id".to_owned(), id);
    fields.insert("annotator_id".to_owned(), text_field("annotator_id", 0.into()));
    fields.insert("language".to_owned(), text_field("language", language_tag(text).into()));
    paths.put_own_path_id(&mut fields, episode);
    fields.insert("scan".to_owned(), episode.scene.as_str().into());
    fields.insert("path".to_owned(), matterport::path_field(file, episode)?);
    fields.insert("heading".to_owned(), episode.heading_field());
    fields.insert("instruction".to_owned(), text.into());
    fields.insert("timed_instruction".to_owned(), timed);
    fields.insert("edit_distance".to_owned(), text_field("edit_distance", 0.0.into()));
    matterport::add_extra(&mut fields, episode);
    Ok(fields)
}
