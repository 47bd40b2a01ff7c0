//! Reads the annotations of HEAR (Hallucination Detection and Remedy): texts about paths, with spans that people called
//! right or wrong.
//!
//! The file is one JSON object of items by name. Fields: those of R2R's path (`scan`, `path`, `heading`),
//! `original_instr` (the text), `numbered_instruction` (its tokens, each followed by its number from 0: `turn (0) left
//! (1) . (2)`) and `id2label`, from token numbers to a label. A key is one number, or numbers that ascend: "5-8" means
//! tokens 5 to 8. Labels are 1 (right), 0 and -1 (wrong). `id2gold_alternative`, which may be missing, gives for the
//! same keys the words that people would use instead, several of them between slashes, or `REMOVE`. Other fields are
//! not read.

use crate::{DatasetItem, Episode, FormatError, ItemPlace, input, json_fault::JsonFault, strict_json::StrictJson};
use serde::de::DeserializeSeed;
use serde_json::{Map, Value};
use std::{cell::RefCell, path::Path};

/// A text with the labels that people gave to its spans.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledText {
    /// Its name in the file.
    pub name: String,
    /// Its path, with the text as its only instruction. Its id is the text's name.
    pub episode: Episode,
    /// The text.
    pub text: String,
    /// The spans that people labelled, in the order of the file. Spans may overlap.
    pub spans: Vec<LabelledSpan>,
}

/// A span of a text that people called right or wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LabelledSpan {
    /// Its key in the file ("5-8").
    pub key: String,
    /// Byte range in the text.
    pub span: [usize; 2],
    /// Whether people called it right.
    pub is_right: bool,
    /// The words that people would use instead; `None` where they would leave the words out.
    pub corrections: Vec<Option<String>>,
}

/// Reads a file of HEAR, plain or gzip.
///
/// # Errors
/// When the file cannot be read, is not a JSON object of items, contains no text, or an item is refused: a field is
/// missing or wrong, the tokens are not those of the text, a key names no tokens, or a label is none of 1, 0 and -1. The
/// error names the text and the key.
pub fn read_hear_file(file: &Path) -> Result<Vec<LabelledText>, FormatError> {
    let texts = read_object(file)?;
    if texts.is_empty() {
        return Err(FormatError::for_document(file, "it holds no text", "give a file of HEAR's annotations"));
    }
    let labelled = |(index, (name, value))| labelled_text(DatasetItem::new(file, ItemPlace::Item(index), value)?, name);
    texts.into_iter().enumerate().map(labelled).collect()
}

/// A file that is one JSON object, read as a whole. It keeps to the limits on one item.
fn read_object(file: &Path) -> Result<Map<String, Value>, FormatError> {
    let field = RefCell::default();
    let mut parser = input::json_parser(file)?;
    let value = StrictJson(&field).deserialize(&mut parser).and_then(|value| parser.end().map(|()| value));
    let value = value.map_err(|error| {
        let within = Some(field.take()).filter(|field| !field.is_empty());
        let within = within.map_or_else(String::new, |field| format!("field \"{field}\": "));
        let JsonFault { problem, hint } = JsonFault::new(&error);
        let problem = format!("{within}{problem} (line {}, column {})", error.line(), error.column());
        FormatError::for_document(file, problem, hint)
    })?;
    match value {
        Value::Object(map) => Ok(map),
        _ => Err(FormatError::for_document(file, "it is not a JSON object", "give a file of HEAR's annotations")),
    }
}

/// The text of an item, with its path and its labelled spans.
fn labelled_text(mut item: DatasetItem<'_>, name: String) -> Result<LabelledText, FormatError> {
    item.set_id(&name.chars().take(80).collect::<String>());
    let name = item.checked_name("its name", &Value::String(name))?;
    let [path_id, scan, path] = [item.take_field("path_id")?, item.take_field("scan")?, item.take_field("path")?];
    let mut episode =
        Episode::new(name.clone(), item.checked_name("path_id", &path_id)?, item.checked_scene("scan", &scan)?);
    episode.viewpoints = item.checked_viewpoints("path", &path)?;
    let heading = item.take_field("heading")?;
    episode.start_heading = Some(item.checked_heading("heading", &heading)?);
    let text = item.take_field("original_instr")?;
    let text = item.checked_instruction("original_instr", &text)?;
    episode.instructions = vec![text.clone()];
    let tokens = token_spans(&mut item, &text)?;
    let labels = item.take_field("id2label")?;
    let Value::Object(labels) = labels else {
        return Err(item.expected_kind("id2label", "an object", &labels, "give a label for each range of tokens"));
    };
    let corrections = take_corrections(&mut item)?;
    let spans = labels.into_iter().map(|(key, label)| {
        let corrections = corrections.get(&key).map(|words| split_corrections(&item, &key, words)).transpose()?;
        labelled_span(&item, &tokens, (key, &label), corrections.unwrap_or_default())
    });
    let spans = spans.collect::<Result<Vec<_>, _>>()?;
    Ok(LabelledText { name, episode, text, spans })
}

/// Byte ranges of the tokens in the text.
fn token_spans(item: &mut DatasetItem<'_>, text: &str) -> Result<Vec<[usize; 2]>, FormatError> {
    const FIELD: &str = "numbered_instruction";
    const HINT: &str = "number the words of original_instr: each word, then its number from 0 in brackets";
    let numbered = item.take_field(FIELD)?;
    let numbered = item.checked_instruction(FIELD, &numbered)?;
    let mut parts = numbered.split_whitespace();
    let mut tokens: Vec<[usize; 2]> = Vec::new();
    let mut rest = text;
    while let Some(word) = parts.next() {
        let number = tokens.len();
        if parts.next() != Some(format!("({number})").as_str()) {
            return Err(item.wrong_field(
                FIELD,
                format!("token {number} ({word:?}) is not followed by its number"),
                HINT,
            ));
        }
        let Some(after) = rest.trim_start().strip_prefix(word) else {
            let problem = format!("token {number} ({word:?}) is not the next word of original_instr");
            return Err(item.wrong_field(FIELD, problem, HINT));
        };
        let end = text.len() - after.len();
        tokens.push([end - word.len(), end]);
        rest = after;
    }
    if !rest.trim().is_empty() {
        let at = text.len() - rest.len();
        return Err(item.wrong_field(FIELD, format!("it ends before byte {at} of original_instr"), HINT));
    }
    Ok(tokens)
}

/// The words that people would use instead, by the keys of `id2label`.
fn take_corrections(item: &mut DatasetItem<'_>) -> Result<Map<String, Value>, FormatError> {
    const FIELD: &str = "id2gold_alternative";
    match item.take_optional(FIELD) {
        None => Ok(Map::new()),
        Some(Value::Object(corrections)) => Ok(corrections),
        Some(other) => Err(item.expected_kind(FIELD, "an object", &other, "give words for each range of tokens")),
    }
}

/// The alternatives of one correction, which are separated by slashes; `None` for `REMOVE`.
fn split_corrections(
    item: &DatasetItem<'_>,
    key: &str,
    correction: &Value,
) -> Result<Vec<Option<String>>, FormatError> {
    let Value::String(alternatives) = correction else {
        let field = format!("id2gold_alternative.{key:.40}");
        return Err(item.expected_kind(&field, "a string", correction, "give words, or REMOVE"));
    };
    let words = alternatives.split('/').map(str::trim).filter(|words| !words.is_empty());
    Ok(words.map(|words| (words != "REMOVE").then(|| words.to_owned())).collect())
}

/// The span that a key of `id2label` names, with its label.
fn labelled_span(
    item: &DatasetItem<'_>,
    tokens: &[[usize; 2]],
    (key, label): (String, &Value),
    corrections: Vec<Option<String>>,
) -> Result<LabelledSpan, FormatError> {
    // A hostile key may be as long as its file.
    let field = format!("id2label.{key:.40}");
    let is_right = match label.as_i64() {
        Some(1) => true,
        Some(0 | -1) => false,
        _ => return Err(item.expected_kind(&field, "1, 0 or -1", label, "1 means right, 0 and -1 mean wrong")),
    };
    let Some((first, last)) = key_ends(&key) else {
        let problem = "the key is neither the number of a token nor numbers that ascend, joined by hyphens";
        return Err(item.wrong_field(&field, problem, "write 5 for one token, 5-8 for several"));
    };
    let (Some([from, _]), Some([_, to])) = (tokens.get(first), tokens.get(last)) else {
        let problem = format!("it names token {last}, but the text has {}", tokens.len());
        return Err(item.wrong_field(&field, problem, "count the tokens of numbered_instruction from 0"));
    };
    Ok(LabelledSpan { key, span: [*from, *to], is_right, corrections })
}

/// The first and the last token that a key names: 5 and 8 for "5-8". `None` where it is not such a key.
fn key_ends(key: &str) -> Option<(usize, usize)> {
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let number = |part: &str| part.parse::<usize>().ok().filter(|_| is_number(part));
    let numbers = key.split('-').map(number).collect::<Option<Vec<_>>>()?;
    let ascend = numbers.is_sorted_by(|before, after| before < after);
    Some((*numbers.first()?, *numbers.last()?)).filter(|_| ascend)
}
