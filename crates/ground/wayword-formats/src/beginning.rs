//! What a file holds, by its outer form and its first item.

use crate::{DatasetFormat, FormatError, input, item, strict_json::StrictJson};
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::{cell::RefCell, fmt, path::Path};

/// Fields of the outer object that are looked at.
const MAX_LOOKED_AT_FIELDS: usize = 40;

/// What a file holds.
#[derive(Debug, PartialEq)]
pub(crate) enum FileContents {
    /// Episodes, as a list, as lines or in an object.
    Dataset(DatasetFormat),
    /// What an agent walked, as a list or as lines.
    Submission,
    /// What an agent walked, as an object from names of instructions to trajectories.
    TrajectoriesByName,
    /// What an agent walked through VLN-CE, or for RxR's leaderboard: positions, or an `instruction_id` and a `path`.
    OtherPredictions,
    /// An empty list.
    EmptyList,
    /// An object around a list of objects: its fields, and which has the list, in words.
    WrappedList(String),
    /// An object with an item for each name.
    ItemsByName,
    /// Something else, in words.
    Other(&'static str),
    /// None of these.
    Unknown,
}

/// The first item of a list, or the fields of an object, as far as they were read.
#[derive(Default)]
struct FileBeginning {
    /// Whether it is a list, or else an object; `None` where it is neither.
    is_list: Option<bool>,
    /// The first item of a list.
    first: Option<Value>,
    /// The object's fields, in short: [`FirstEntry`].
    fields: Map<String, Value>,
}

/// Looks at the beginning of a file. Where it is not JSON, what was recognised before counts; the failure is returned
/// beside it, with the field of the outer object at which it happened.
///
/// # Errors
/// When the file cannot be opened.
pub(crate) fn look_at_beginning(file: &Path) -> Result<(FileContents, Option<BeginningFailure>), FormatError> {
    let mut parser = input::json_parser(file)?;
    let beginning = RefCell::new(FileBeginning::default());
    // Stopping early is an error as well.
    let read = (&mut parser).deserialize_any(BeginningVisitor(&beginning));
    let beginning = beginning.take();
    let field = beginning.fields.keys().next_back().cloned();
    let failure = read.err().map(|error| BeginningFailure { error, field });
    Ok((contents_of(&beginning, failure.as_ref()), failure))
}

/// Why a beginning could not be read.
pub(crate) struct BeginningFailure {
    pub(crate) error: serde_json::Error,
    /// The field of the outer object, where the file is one.
    pub(crate) field: Option<String>,
}

fn contents_of(beginning: &FileBeginning, failure: Option<&BeginningFailure>) -> FileContents {
    match (beginning.is_list, &beginning.first) {
        // The reader of items says where in the first one the mistake is.
        (Some(true), None) if failure.is_some_and(|failure| !failure.error.is_eof()) => {
            FileContents::Dataset(DatasetFormat::R2r)
        }
        (Some(true), None) if failure.is_some() => FileContents::Unknown,
        (Some(true), None) => FileContents::EmptyList,
        (Some(true), Some(Value::Object(item))) => match contents_by_item(item) {
            // Fields are missing. The reader says which.
            FileContents::Unknown => FileContents::Dataset(DatasetFormat::R2r),
            known => known,
        },
        (Some(false), _) => contents_by_object(&beginning.fields),
        _ => FileContents::Unknown,
    }
}

/// What an item says of the list or the lines that it stands in.
fn contents_by_item(item: &Map<String, Value>) -> FileContents {
    let has = |field: &str| item.contains_key(field);
    let is_path = has("scan") && has("path");
    if has("trajectory") && !is_path {
        return FileContents::Submission;
    }
    if has("instruction_id") {
        let is_prediction = has("path") && !has("scan") && !has("instruction");
        return if is_prediction { FileContents::OtherPredictions } else { FileContents::Dataset(DatasetFormat::Rxr) };
    }
    if has("video") && has("actions") {
        return FileContents::Dataset(DatasetFormat::Streamvln);
    }
    if has("video_id") && has("frames") {
        return FileContents::Dataset(DatasetFormat::Navila);
    }
    if has("episode_index") && has("tasks") {
        return FileContents::Dataset(DatasetFormat::Internnav);
    }
    if has("unobstructed") && has("image_id") {
        return FileContents::Other("the viewpoint graph of a scene");
    }
    if ["dialog_history", "inst_idx", "planner_path", "end_panos"].into_iter().any(has) {
        return FileContents::Other("CVDN's dialogues (NDH)");
    }
    if is_reverie(item) {
        return FileContents::Dataset(DatasetFormat::Reverie);
    }
    if has("bboxes") {
        return FileContents::Other("SOON's dataset");
    }
    if is_path || has("path_id") {
        return FileContents::Dataset(DatasetFormat::R2r);
    }
    if has("instr_id") { FileContents::Submission } else { FileContents::Unknown }
}

/// What an outer object is: a dataset itself, the first of many lines, or something around other things.
fn contents_by_object(fields: &Map<String, Value>) -> FileContents {
    if fields.contains_key("episodes") || fields.contains_key("instruction_vocab") {
        return FileContents::Dataset(DatasetFormat::Vlnce);
    }
    if fields.contains_key("format") {
        return FileContents::Dataset(DatasetFormat::Wayword);
    }
    if let Some(what) = written_beside_texts(fields) {
        return FileContents::Other(what);
    }
    let as_line = contents_by_item(fields);
    if as_line != FileContents::Unknown {
        return as_line;
    }
    let Some((name, first)) = fields.iter().next() else { return FileContents::Unknown };
    match first {
        Value::Object(item) if item.contains_key("trajectory") => FileContents::TrajectoriesByName,
        Value::Object(item) if contents_by_item(item) != FileContents::Unknown => FileContents::ItemsByName,
        Value::Array(entries) => match entries.first() {
            Some(Value::Object(entry)) if entry.contains_key("position") => FileContents::OtherPredictions,
            Some(Value::Array(_) | Value::String(_)) if name.contains('_') => FileContents::TrajectoriesByName,
            _ => wrapped_list(fields),
        },
        _ => wrapped_list(fields),
    }
}

/// What a line is that this program writes into a folder, beside the file that has the texts or the walks.
fn written_beside_texts(fields: &Map<String, Value>) -> Option<&'static str> {
    let has_all = |names: &[&str]| names.iter().all(|name| fields.contains_key(*name));
    if has_all(&["path", "observations"]) {
        Some("walks.jsonl of a run, whose texts are in instructions.jsonl beside it")
    } else if has_all(&["agent", "item", "steps"]) {
        Some("walks.jsonl of a comparison, whose folder submissions has what an evaluator reads")
    } else if has_all(&["item", "style", "reason"]) {
        Some("the texts that a run rejected")
    } else if has_all(&["item", "failure", "reason"]) {
        Some("the items of a run that failed")
    } else {
        None
    }
}

fn wrapped_list(fields: &Map<String, Value>) -> FileContents {
    let is_list = |value: &Value| value.as_array().is_some_and(|list| list.first().is_some_and(Value::is_object));
    let Some((list, _)) = fields.iter().find(|(_, value)| is_list(value)) else { return FileContents::Unknown };
    let names: Vec<String> = fields.keys().take(8).map(|name| format!("{name:.40?}")).collect();
    let more = if fields.len() > names.len() { ", ..." } else { "" };
    FileContents::WrappedList(format!("the fields {}{more}, and the list is in {list:.40?}", names.join(", ")))
}

/// Whether an item of a list is REVERIE's and not R2R's.
fn is_reverie(item: &Map<String, Value>) -> bool {
    let name = |field: &str| item.get(field).and_then(item::name_of);
    let begins = |id: String, path: String| id == path || id.starts_with(&format!("{path}_"));
    item.contains_key("objId") || name("id").zip(name("path_id")).is_some_and(|(id, path)| begins(id, path))
}

/// Reads the first item of a list, or an object's fields up to the first that decides.
struct BeginningVisitor<'a>(&'a RefCell<FileBeginning>);

impl<'de> Visitor<'de> for BeginningVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of items, or an object")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let mut beginning = self.0.borrow_mut();
        beginning.is_list = Some(true);
        beginning.first = list.next_element_seed(StrictJson(&RefCell::default()))?;
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        while let Some(key) = entries.next_key::<String>()? {
            let mut beginning = self.0.borrow_mut();
            beginning.is_list = Some(false);
            // What stands in these fields may be the whole file.
            let decides = matches!(key.as_str(), "episodes" | "instruction_vocab" | "format");
            beginning.fields.insert(key.clone(), Value::Null);
            if decides || beginning.fields.len() >= MAX_LOOKED_AT_FIELDS {
                return Ok(());
            }
            let value = entries.next_value_seed(FirstEntry)?;
            beginning.fields.insert(key, value);
        }
        Ok(())
    }
}

/// Reads a value in short: of a list the first entry, and of an object the names of its fields.
struct FirstEntry;

impl<'de> DeserializeSeed<'de> for FirstEntry {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for FirstEntry {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let first = list.next_element_seed(FirstEntry)?;
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Value::Array(first.into_iter().collect()))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut fields = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            entries.next_value::<IgnoredAny>()?;
            if fields.len() < MAX_LOOKED_AT_FIELDS {
                fields.insert(key, Value::Null);
            }
        }
        Ok(Value::Object(fields))
    }
}
