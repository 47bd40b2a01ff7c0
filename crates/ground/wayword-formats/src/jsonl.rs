//! Wayword's own format for paths of any platform: JSON Lines, one instruction each.
//!
//! A line has `format` ("wayword/1"), `platform`, `split`, `path` (a core path with its frames) and the fields of a
//! core instruction: `text`, `style`, `mentions`, `verdict`, `findings`, `provenance`, and `ambiguity` where it is
//! known. `path_id` names the path in its dataset, where several items may share it. Unknown fields are kept.

use crate::{
    DatasetItem, Episode, FormatError, input, item, limits, output,
    read_tally::ReadTally,
    text_hash::{HASH_FIELD, hash_of_text},
};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Map, Value};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
};
use wayword_core::{Instruction, InstructionPart, Path, SceneId};

/// The value of `format`.
const RECORD_FORMAT: &str = "wayword/1";
/// The field with the name of the dataset's path that an item lies on.
const PATH_ID: &str = "path_id";

/// One instruction for one path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InstructionRecord {
    format: &'static str,
    /// Name of the platform that the path lies on.
    pub platform: String,
    /// The part of the dataset that it belongs to, where that is decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split: Option<DatasetSplit>,
    /// The path that the instruction is about.
    pub path: Path,
    /// The instruction with its evidence.
    #[serde(flatten)]
    pub instruction: Instruction,
    /// Fields that the format does not name, in the order of the file.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// A part of a dataset. No scene is in both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DatasetSplit {
    /// For training.
    Train,
    /// For evaluation.
    Val,
}

impl DatasetSplit {
    /// The name that files use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
        }
    }
}

impl InstructionRecord {
    /// A record that belongs to no split yet.
    #[must_use]
    pub fn new(platform: impl Into<String>, path: Path, instruction: Instruction) -> Self {
        Self { format: RECORD_FORMAT, platform: platform.into(), split: None, path, instruction, extra: Map::new() }
    }

    /// The name of its path in the dataset that it was made over, where several items may share a path: its field
    /// `path_id`, or else the path's own name.
    #[must_use]
    pub fn path_id(&self) -> String {
        self.extra.get(PATH_ID).and_then(item::name_of).unwrap_or_else(|| self.path.id.clone())
    }
}

/// Reads a file of records, plain or gzip.
///
/// # Errors
/// When the file cannot be read or is not JSON, a field of a line is missing or wrong, an instruction is given twice,
/// two paths of a platform have the same id, or a scene is in both splits.
pub fn read_records(file: &FilePath) -> Result<Vec<InstructionRecord>, FormatError> {
    merge_records(&[file])
}

/// Reads several files, of several platforms, as one; each record keeps its split.
///
/// # Errors
/// The same as for [`read_records`], for all files together.
pub fn merge_records<F: AsRef<FilePath>>(files: &[F]) -> Result<Vec<InstructionRecord>, FormatError> {
    let mut records: Vec<InstructionRecord> = Vec::new();
    let mut members = DatasetMembers::default();
    let mut tally = ReadTally::default();
    for file in files {
        input::each_line(file.as_ref(), |mut item| {
            let record = take_record(&mut item)?;
            members
                .check_record(&records, &record)
                .map_err(|clash| item.wrong_field(clash.field, clash.problem, clash.hint))?;
            members.note_record(&record, records.len());
            let instruction = &record.instruction;
            let values = record.path.frames.len() + instruction.mentions.len() + instruction.findings.len();
            records.push(InstructionRecord { extra: tally.take_rest(item, values)?, ..record });
            Ok(())
        })?;
    }
    Ok(records)
}

/// Writes records; gzip where the name ends in `.gz`.
///
/// # Errors
/// When an instruction is given twice, two paths of a platform have the same id, a scene is in both splits, or the file
/// cannot be written.
pub fn write_records(file: &FilePath, records: &[InstructionRecord]) -> Result<(), FormatError> {
    let mut members = DatasetMembers::default();
    for (index, record) in records.iter().enumerate() {
        members
            .check_record(records, record)
            .map_err(|clash| FormatError::for_document(file, clash.problem, clash.hint))?;
        members.note_record(record, index);
    }
    output::write_file(file, |out| output::write_lines(out, records))
}

/// The items of records: one per path, in their order, each with all its instructions.
#[must_use]
pub fn episodes_from_records(records: &[InstructionRecord]) -> Vec<Episode> {
    let mut episodes: Vec<Episode> = Vec::new();
    let mut places = BTreeMap::new();
    for record in records {
        let place = *places.entry((&record.platform, &record.path.id)).or_insert_with(|| {
            let split = record.split.map(|split| split.name().to_owned());
            let path_id = record.path_id();
            episodes.push(Episode { split, path_id, ..Episode::from_path(&record.path, Vec::new()) });
            episodes.len() - 1
        });
        if let Some(episode) = episodes.get_mut(place) {
            episode.instructions.push(record.instruction.text.clone());
        }
    }
    episodes
}

fn take_record(item: &mut DatasetItem<'_>) -> Result<InstructionRecord, FormatError> {
    let format = item.take_field("format")?;
    if item.checked_text("format", &format)? != RECORD_FORMAT {
        let provenance = item.peek_field("provenance");
        let version = provenance.and_then(|provenance| provenance.get("wayword")).and_then(Value::as_str);
        let writer = version.map_or_else(String::new, |version| format!(" by version {version:.20?} of Wayword"));
        let problem = format!("expected {RECORD_FORMAT:?}, found {format}{writer}");
        return Err(item.wrong_field("format", problem, "read it with the version of Wayword that wrote it"));
    }
    let path = take_path(item)?;
    let platform = item.take_field("platform")?;
    let platform = item.checked_name("platform", &platform)?;
    if let Some(path_id) = item.peek_field(PATH_ID) {
        item.checked_name(PATH_ID, path_id)?;
    }
    let split = item.take_optional("split").map(|split| item.parse_value("split", split)).transpose()?;
    let instruction = take_instruction(item, path.frames.len())?;
    Ok(InstructionRecord { split, ..InstructionRecord::new(platform, path, instruction) })
}

fn take_path(item: &mut DatasetItem<'_>) -> Result<Path, FormatError> {
    let path = item.take_field("path")?;
    let id = item.checked_name("path.id", path.get("id").unwrap_or(&Value::Null))?;
    item.set_id(&id);
    let frames =
        item.checked_list("path.frames", path.get("frames").unwrap_or(&Value::Null), limits::MAX_PATH_NODES)?;
    if frames.is_empty() {
        return Err(item.wrong_field("path.frames", "it is empty", "add at least one frame"));
    }
    let is_motion_known = path.get("motion").is_none_or(|motion| motion == "known");
    // One by one, so that an error can name the frame.
    for (index, frame) in frames.iter().enumerate() {
        // Where the motion is not known, frames need no pose.
        if is_motion_known || frame.get("pose").is_some() {
            item.parse_value::<wayword_core::Frame>(&format!("path.frames[{index}]"), frame.clone())?;
        }
    }
    item.parse_value("path", path)
}

/// Takes the instruction. It checks byte ranges and frame numbers against the text and the path, because they are used
/// as indices later.
fn take_instruction(item: &mut DatasetItem<'_>, frames: usize) -> Result<Instruction, FormatError> {
    let text = item.take_field("text")?;
    let mut instruction = Instruction {
        text: item.checked_instruction("text", &text)?,
        style: take_parsed(item, "style")?,
        mentions: take_parsed(item, "mentions")?,
        parts: item
            .take_optional("parts")
            .map(|value| item.parse_value("parts", value))
            .transpose()?
            .unwrap_or_default(),
        verdict: take_parsed(item, "verdict")?,
        findings: take_parsed(item, "findings")?,
        ambiguity: item.take_optional("ambiguity").map(|value| item.parse_value("ambiguity", value)).transpose()?,
        provenance: take_parsed(item, "provenance")?,
    };
    if instruction.text.trim().is_empty() {
        return Err(item.wrong_field("text", "it is empty", "write the instruction, or take the line away"));
    }
    let written = item.peek_field(HASH_FIELD).and_then(Value::as_str);
    if written.is_some_and(|written| written != hash_of_text(&instruction.text)) {
        // Somebody edited the text, so what points into it may point at other words.
        instruction.mentions.clear();
        instruction.parts.clear();
        instruction.findings.iter_mut().for_each(|finding| finding.span = None);
    }
    let fits = |[from, to]: [usize; 2]| instruction.text.get(from..to).is_some();
    let (mentions, findings) = (&instruction.mentions, &instruction.findings);
    if let Some(index) = mentions.iter().position(|mention| !fits(mention.span) || mention.frame >= frames) {
        let field = format!("mentions[{index}]");
        let hint = "give a byte range within the text, and the number of a frame of the path";
        return Err(item.wrong_field(&field, "it points outside the text or the path", hint));
    }
    if let Some(index) = findings.iter().position(|finding| finding.span.is_some_and(|span| !fits(span))) {
        let field = format!("findings[{index}].span");
        return Err(item.wrong_field(&field, "it points outside the text", "give a byte range within the text"));
    }
    let is_stretch = |[first, last]: [usize; 2]| first <= last && last < frames;
    let is_part = |part: &InstructionPart| fits(part.span) && is_stretch(part.frames);
    // Behind the end of the text there are no parts: somebody edited it.
    if !instruction.parts.iter().all(is_part) {
        instruction.parts.clear();
    }
    Ok(instruction)
}

fn take_parsed<T: DeserializeOwned>(item: &mut DatasetItem<'_>, field: &str) -> Result<T, FormatError> {
    let value = item.take_field(field)?;
    item.parse_value(field, value)
}

/// The dataset's records so far, to find those that cannot be in it together.
#[derive(Default)]
struct DatasetMembers {
    /// By platform and path, the number of the first record of the path.
    paths: BTreeMap<(String, String), usize>,
    /// Platform, path, style and words of every instruction.
    texts: BTreeSet<(String, String, String, String)>,
    /// By platform and scene, the split that its records have.
    splits: BTreeMap<(String, SceneId), DatasetSplit>,
}

/// Why a record cannot be in a dataset with the earlier ones.
struct RecordClash {
    field: &'static str,
    problem: String,
    hint: &'static str,
}

impl DatasetMembers {
    /// Compares a record with the earlier ones.
    fn check_record(&self, earlier: &[InstructionRecord], record: &InstructionRecord) -> Result<(), RecordClash> {
        let same_name = self.paths.get(&path_key(record)).and_then(|index| earlier.get(*index));
        if same_name.is_some_and(|other| other.path != record.path) {
            let problem = format!("an earlier record has a different path with the name {:?}", record.path.id);
            return Err(RecordClash {
                field: "path",
                problem,
                hint: "merge only runs whose paths have different names: the seed of a run is in the names of its random paths (--seed)",
            });
        }
        if self.texts.contains(&text_key(record)) {
            let problem = format!("path {:?} already has the same instruction", record.path.id);
            return Err(RecordClash { field: "text", problem, hint: "leave one of the two out" });
        }
        let other = self.splits.get(&scene_key(record));
        if record.split.is_some() && other.is_some() && other != record.split.as_ref() {
            let problem = format!("scene {} is in train and in val", record.path.scene);
            return Err(RecordClash { field: "split", problem, hint: "split the records again, by scene" });
        }
        Ok(())
    }

    /// Adds a record, the `index`-th of the dataset.
    fn note_record(&mut self, record: &InstructionRecord, index: usize) {
        self.paths.entry(path_key(record)).or_insert(index);
        self.texts.insert(text_key(record));
        if let Some(split) = record.split {
            self.splits.insert(scene_key(record), split);
        }
    }
}

fn path_key(record: &InstructionRecord) -> (String, String) {
    (record.platform.clone(), record.path.id.clone())
}

fn text_key(record: &InstructionRecord) -> (String, String, String, String) {
    let (platform, path) = path_key(record);
    (platform, path, record.instruction.style.clone(), record.instruction.text.clone())
}

fn scene_key(record: &InstructionRecord) -> (String, SceneId) {
    (record.platform.clone(), record.path.scene.clone())
}
