//! Names a file that is no dataset by its first bytes, so that nobody looks for a mistake in its JSON.

use crate::FormatError;
use std::path::Path;
use wayword_core::{FileGroup, FileStart};

const UNPACK: &str = "unpack it, and give the file with the JSON";
const WRITE_JSON: &str = "write its contents as JSON, as docs/FORMATS.md has it";
const NO_DATA: &str = "give the file with the data";

const NO_SETTINGS: &str = "give the file with the texts; --config takes settings, and --style takes a style";
const UTF_16: &str = "text in UTF-16";
const UTF_8: &str = "save it as UTF-8";

/// Refuses a file whose first bytes, at most [`FILE_START_BYTES`], are those of another kind of file than JSON.
///
/// # Errors
/// What the file is, and what to do with it.
pub(crate) fn refuse_other_kinds(file: &Path, start: &[u8]) -> Result<(), FormatError> {
    let by_bytes = FileStart::from_bytes(start).map(|FileStart { name, group }| (name, advice_for(group)));
    match by_bytes.or_else(|| kind_of_text(start)) {
        Some((kind, hint)) => Err(FormatError::for_document(file, format!("it is {kind}"), hint)),
        None => Ok(()),
    }
}

/// What to do with a file of a group.
const fn advice_for(group: FileGroup) -> &'static str {
    match group {
        FileGroup::Archive => UNPACK,
        FileGroup::ProgramData | FileGroup::Database => WRITE_JSON,
        FileGroup::LfsPointer => "get the file with `git lfs pull`",
        FileGroup::Utf16 => UTF_8,
        FileGroup::Document
        | FileGroup::Png
        | FileGroup::Jpeg
        | FileGroup::Heic
        | FileGroup::RawPicture
        | FileGroup::Picture
        | FileGroup::Mp4
        | FileGroup::Video
        | FileGroup::Ros1Bag
        | FileGroup::Mcap => NO_DATA,
    }
}

/// What a file without known first bytes is, by the text that it begins with.
fn kind_of_text(start: &[u8]) -> Option<(&'static str, &'static str)> {
    // Text in UTF-16 without a mark: every second byte of ASCII is 0.
    if matches!(start, [0, 1..=127, ..] | [1..=127, 0, 1..=127, 0, ..]) {
        return Some((UTF_16, UTF_8));
    }
    let text = start.trim_ascii_start();
    if text.starts_with(b"<") {
        return Some(("a web page, or other markup, and not data", "get the file that the page is about"));
    }
    let after_brackets = text.iter().position(|byte| !b"[{( \t\r\n".contains(byte)).map(|at| text.split_at(at));
    if let Some((brackets, [b'\'', ..])) = after_brackets
        && !brackets.is_empty()
    {
        return Some(("in Python's own notation (quoted by ')", "write it with json.dump"));
    }
    if is_toml(text) {
        return Some(("TOML (settings, or a style), which has no texts of paths", NO_SETTINGS));
    }
    let line = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let is_table = !matches!(line, [b'[' | b'{', ..]) && line.iter().any(|byte| b",;\t".contains(byte));
    (is_table && line.is_ascii()).then_some(("a table (CSV or the like)", WRITE_JSON))
}

/// Whether a text begins like TOML: after empty lines and comments with `key = value`, or with the name of a table.
fn is_toml(text: &[u8]) -> bool {
    let lines = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let Some(line) = lines.into_iter().find(|line| !line.is_empty() && !line.starts_with(b"#")) else { return false };
    let is_name = |name: &[u8]| {
        let mut bytes = name.iter();
        bytes.next().is_some_and(u8::is_ascii_alphabetic)
            && bytes.all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(byte))
    };
    let table = line.strip_prefix(b"[").map(|rest| rest.strip_prefix(b"[").unwrap_or(rest));
    match table.and_then(|rest| rest.split(|byte| *byte == b']').next().filter(|name| name.len() < rest.len())) {
        Some(name) => is_name(name) && !matches!(name, b"null" | b"true" | b"false"),
        None => {
            let mut sides = line.splitn(2, |byte| *byte == b'=');
            sides.next().is_some_and(|name| is_name(name.trim_ascii())) && sides.next().is_some()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(start: &[u8]) -> String {
        refuse_other_kinds(Path::new("f"), start).map_or_else(|error| error.to_string(), |()| String::new())
    }

    #[test]
    fn other_kinds_of_files_are_named() {
        let tar: Vec<u8> = [b'a'; 257].into_iter().chain(*b"ustar\0").collect();
        for (start, kind) in [
            (b"%PDF-1.7\n".as_slice(), "it is a PDF document"),
            (b"PK\x03\x04\x14\0", "it is a zip archive"),
            (b"\x89PNG\r\n\x1a\n", "it is a PNG picture; give the file with the data"),
            (b"\0\0\0\x20ftypisom\0\0\x02\0", "it is an MP4 video"),
            (b"SQLite format 3\0", "it is an SQLite database"),
            (b"\x80\x04\x95", "it is a pickle"),
            (b"<!DOCTYPE html>", "it is a web page"),
            (b"version https://git-lfs.github.com/spec/v1\n", "`git lfs pull`"),
            (b"instr_id,trajectory\n1_0,\"[a]\"\n", "it is a table"),
            (b"\"instr_id\";\"trajectory\"\n", "it is a table"),
            (b"[{'instr_id': '1_0'}]", "Python's own notation"),
            (b" {\n'instr_id': '1_0'}", "Python's own notation"),
            (b"name = \"mine\"\nreferences = [\"Stop.\"]", "it is TOML"),
            (b"# of mine\n\n[constraints]\nmin_sentences = 2\n", "--config takes settings"),
            (b"[[providers]]\nname = 1\n", "it is TOML"),
            (b"style.words=[2]", "it is TOML"),
            (b"[\0{\0\"\0", "UTF-16"),
            (b"\0[\0{\0\"", "UTF-16"),
            (tar.as_slice(), "it is a tar archive"),
        ] {
            assert!(told(start).contains(kind), "{:?}: {}", String::from_utf8_lossy(start), told(start));
        }
    }

    #[test]
    fn json_of_any_form_is_let_through() {
        for start in [
            "",
            "[]",
            "{}",
            " \n[{\"a\": 'x",
            "{\"a\": 1, \"b\": 2}\n{}",
            "\"a text\"",
            "12",
            "hello",
            "null",
            "[null]",
            "[[1]]",
            "[true]",
        ] {
            assert_eq!(told(start.as_bytes()), "", "{start}");
        }
    }
}
