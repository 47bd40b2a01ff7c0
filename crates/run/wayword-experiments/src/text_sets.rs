//! Reads a set of instructions from a run folder or a dataset file, and groups the texts by item or path.

use crate::{episodes, similarity::args::TextPairing};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_formats::{
    DatasetFormat,
    jsonl::{self, InstructionRecord},
};
use wayword_run::{
    error::CommandError,
    run_folder::{file, refuse_other_format},
    settings::RunSettings,
};

/// The texts of each item by the item's id, or of each path by its name.
pub(crate) type TextSet = BTreeMap<String, ItemTexts>;

/// The texts of one item or path.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct ItemTexts {
    /// Scene and path.
    pub(crate) path: String,
    pub(crate) texts: Vec<String>,
}

/// Reads a set: a run folder, or a file of any format, with `#STYLE` at the end to take one style.
pub(crate) fn read_text_set(name: &str, style: Option<&str>, by: TextPairing) -> Result<TextSet, CommandError> {
    let (_, own_style) = split_style(name);
    refuse_other_folder(name)?;
    let path = text_set_file(name);
    let texts = if wayword_formats::detect_format(&path)? == DatasetFormat::Wayword {
        texts_from_records(&path, own_style.or(style))?
    } else if let Some(style) = own_style {
        let problem = format!("{}: texts of this format have no style, so none has style {style}", path.display());
        return Err(CommandError::usage(problem, "leave out the # and what follows"));
    } else {
        texts_from_episodes(&path)?
    };
    let mut items = TextSet::new();
    for SingleText { item, path, text } in texts {
        let key = if by == TextPairing::Path { path.clone() } else { item };
        items.entry(key).or_insert_with(|| ItemTexts { path, texts: Vec::new() }).texts.push(text);
    }
    Ok(items)
}

/// Refuses a folder that another command than `generate` made: it has no texts.
///
/// # Errors
/// When its settings are those of another command.
pub(crate) fn refuse_other_folder(name: &str) -> Result<(), CommandError> {
    match text_set_run(name) {
        Some(folder) => refuse_other_format::<RunSettings>(&folder),
        None => Ok(()),
    }
}

/// The file of a set: the instructions in a run folder, or the file itself.
pub(crate) fn text_set_file(name: &str) -> PathBuf {
    let (path, _) = split_style(name);
    if path.is_dir() { path.join(file::INSTRUCTIONS) } else { path }
}

/// The run folder of a set, if its name is one.
pub(crate) fn text_set_run(name: &str) -> Option<PathBuf> {
    Some(split_style(name).0).filter(|path| path.is_dir())
}

/// Splits the style off a name. A name that exists as a file or folder is not split.
fn split_style(name: &str) -> (PathBuf, Option<&str>) {
    match name.rsplit_once('#') {
        Some((path, style)) if !Path::new(name).exists() => (path.into(), Some(style)),
        _ => (name.into(), None),
    }
}

/// One text with its item and path.
struct SingleText {
    item: String,
    path: String,
    text: String,
}

fn texts_from_episodes(file: &Path) -> Result<Vec<SingleText>, CommandError> {
    let mut all = Vec::new();
    for episode in wayword_formats::read_any_format(file)? {
        let path = episodes::episode_path_name(&episode);
        let to_text = |text| SingleText { item: episode.id.clone(), path: path.clone(), text };
        all.extend(episode.instructions.into_iter().map(to_text));
    }
    Ok(all)
}

fn texts_from_records(file: &Path, style: Option<&str>) -> Result<Vec<SingleText>, CommandError> {
    let mut records = jsonl::read_records(file)?;
    let styles: BTreeSet<String> = records.iter().map(|record| record.instruction.style.clone()).collect();
    let all = styles.iter().cloned().collect::<Vec<_>>().join(", ");
    if style.is_none() && styles.len() > 1 {
        let problem = format!("{}: it has texts of several styles ({all}), and a set has one", file.display());
        let set = format!("{}#{}", file.display(), styles.first().map_or("", String::as_str));
        let hint = format!("name one style: in `similarity` as {set}, in `compare` as --instructions NAME={set}");
        return Err(CommandError::usage(problem, hint));
    }
    if let Some(style) = style.filter(|style| !styles.contains(*style)) {
        let problem = format!("{}: it has no instruction of style {style}", file.display());
        return Err(CommandError::usage(problem, format!("it has these styles: {all}")));
    }
    records.retain(|record| style.is_none_or(|style| record.instruction.style == style));
    Ok(records.into_iter().map(text_from_record).collect())
}

fn text_from_record(record: InstructionRecord) -> SingleText {
    let path = episodes::path_name(&record.path.scene, &record.path_id());
    SingleText { item: record.path.id, path, text: record.instruction.text }
}
