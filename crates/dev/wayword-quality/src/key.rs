//! The key of a file of corrupted texts: the changes in each text with their places, so that they can be undone.

use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use wayword_run::{error::CommandError, written_files::write_file};
use wayword_world::files;

/// The format of a key, with its version.
const KEY_FORMAT: &str = "wayword-corruptions/1";
/// The largest key that is read, bytes; a larger one is refused.
const MAX_KEY_BYTES: u64 = 256 << 20;
const KEY_HINT: &str = "give the key that was written with the texts";

/// The changes in the texts of a file.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CorruptionKey {
    /// Always [`KEY_FORMAT`].
    format: String,
    /// The seed that the changes were drawn with.
    pub(crate) seed: u64,
    /// One entry for each text.
    pub(crate) corruptions: Vec<TextCorruption>,
}

/// The changes in one text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TextCorruption {
    /// The id of the item with the changed text.
    pub(crate) item: String,
    /// The id of the item that had the original text.
    pub(crate) of: String,
    /// The text's place among its item's instructions.
    pub(crate) instruction: usize,
    /// The path, by scene and name: texts of one path are not independent.
    pub(crate) path: String,
    /// The kind of corruption.
    pub(crate) kind: String,
    /// The changes, in the order of the text.
    pub(crate) changes: Vec<WordChange>,
}

/// One stretch of words that was replaced.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WordChange {
    /// Byte range of the new words in the new text.
    pub(crate) span: [usize; 2],
    /// The old words.
    pub(crate) was: String,
    /// The new words.
    pub(crate) now: String,
}

/// New words for a stretch of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct WordEdit {
    /// Byte range of the old words in the old text.
    pub(crate) span: [usize; 2],
    /// The new words.
    pub(crate) now: String,
}

/// Applies edits to a text. Returns the new text and its changes; `None` where two edits overlap or one is outside the text.
pub(crate) fn apply_edits(text: &str, mut edits: Vec<WordEdit>) -> Option<(String, Vec<WordChange>)> {
    edits.sort_by_key(|edit| edit.span);
    let mut new = String::new();
    let mut from = 0;
    let mut changes = Vec::new();
    for WordEdit { span, now } in edits {
        new.push_str(text.get(from..span[0])?);
        let was = text.get(span[0]..span[1])?.to_owned();
        changes.push(WordChange { span: [new.len(), new.len() + now.len()], was, now: now.clone() });
        new.push_str(&now);
        from = span[1];
    }
    new.push_str(text.get(from..)?);
    Some((new, changes))
}

/// Undoes changes. Returns the old text and the byte ranges of the old words; `None` where the text does not have the changed words.
pub(crate) fn undo_changes(text: &str, changes: &[WordChange]) -> Option<(String, Vec<[usize; 2]>)> {
    let mut old = String::new();
    let mut from = 0;
    let mut spans = Vec::new();
    for WordChange { span, was, now } in changes {
        old.push_str(text.get(from..span[0])?);
        if text.get(span[0]..span[1])? != now {
            return None;
        }
        spans.push([old.len(), old.len() + was.len()]);
        old.push_str(was);
        from = span[1];
    }
    old.push_str(text.get(from..)?);
    Some((old, spans))
}

impl CorruptionKey {
    pub(crate) fn new(seed: u64, corruptions: Vec<TextCorruption>) -> Self {
        Self { format: KEY_FORMAT.to_owned(), seed, corruptions }
    }

    /// The default path of the key of a file of texts: `FILE.key.json` next to `FILE.json`.
    pub(crate) fn path_for_texts(texts: &Path) -> PathBuf {
        texts.with_extension("key.json")
    }

    pub(crate) fn write(&self, file: &Path) -> Result<(), CommandError> {
        let text = serde_json::to_string_pretty(self).map_err(std::io::Error::from);
        write_file(file, text.map_err(CommandError::io(file, "write"))? + "\n")
    }

    pub(crate) fn read(file: &Path) -> Result<Self, CommandError> {
        let wrong = |problem: String| CommandError::usage(format!("{}: {problem}", file.display()), KEY_HINT);
        let bytes = files::json_if_there(file, MAX_KEY_BYTES, KEY_HINT)?;
        let bytes = bytes.ok_or_else(|| wrong("there is no such file".to_owned()))?;
        let key: Self = serde_json::from_slice(&bytes).map_err(|error| wrong(error.to_string()))?;
        if key.format != KEY_FORMAT {
            return Err(wrong(format!("its format is {:?}, not {KEY_FORMAT:?}", key.format)));
        }
        Ok(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undone_restores_an_edited_text() {
        let text = "Turn left at the sofa.";
        let edits = vec![
            WordEdit { span: [17, 21], now: "grand piano".into() },
            WordEdit { span: [5, 9], now: "right".into() },
        ];
        let (new, changes) = apply_edits(text, edits.clone()).unwrap();
        assert_eq!(new, "Turn right at the grand piano.");
        assert!(changes.iter().all(|change| new[change.span[0]..change.span[1]] == change.now));
        assert_eq!(undo_changes(&new, &changes), Some((text.to_owned(), vec![[5, 9], [17, 21]])));
        assert_eq!(undo_changes(text, &changes), None, "these are not the changed words");
        let overlapping = vec![edits[0].clone(), WordEdit { span: [16, 18], now: String::new() }];
        assert_eq!(apply_edits(text, overlapping), None);
    }

    #[test]
    fn a_hostile_key_is_refused_without_a_panic() {
        let change = |span| [WordChange { span, was: String::new(), now: "t".into() }];
        for span in [[3, 2], [0, 99], [99, 100], [1, 2], [usize::MAX, 0]] {
            assert_eq!(undo_changes("\u{e4}t", &change(span)), None, "{span:?}");
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.key.json");
        for (text, problem) in [
            ("[]", "invalid"),
            ("{\"format\": \"other\", \"seed\": 0, \"corruptions\": []}", "its format is"),
            ("{\"format\": \"wayword-corruptions/1\", \"seed\": 0, \"corruptions\": [], \"x\": 1}", "unknown field"),
        ] {
            std::fs::write(&file, text).unwrap();
            let error = CorruptionKey::read(&file).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
        }
        assert!(CorruptionKey::read(&folder.path().join("b")).unwrap_err().to_string().contains("no such file"));
    }

    #[test]
    fn a_key_is_read_as_it_was_written() {
        let changes = vec![WordChange { span: [0, 1], was: "a".into(), now: "b".into() }];
        let [item, of, path, kind] = ["1", "2", "s/2", "k"].map(str::to_owned);
        let key = CorruptionKey::new(7, vec![TextCorruption { item, of, instruction: 0, path, kind, changes }]);
        let folder = tempfile::tempdir().unwrap();
        let file = CorruptionKey::path_for_texts(&folder.path().join("texts.json"));
        key.write(&file).unwrap();
        assert_eq!(file.file_name().unwrap(), "texts.key.json");
        assert_eq!(CorruptionKey::read(&file).unwrap(), key);
    }
}
