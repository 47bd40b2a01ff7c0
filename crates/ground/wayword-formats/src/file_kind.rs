//! Names a file that is no dataset by its first bytes, so that nobody looks for a mistake in its JSON.

use crate::FormatError;
use std::path::Path;

/// Bytes at the beginning of a file that [`refuse_other_kinds`] looks at.
pub(crate) const LOOKED_AT_BYTES: usize = 512;

const UNPACK: &str = "unpack it, and give the file with the JSON";
const WRITE_JSON: &str = "write its contents as JSON, as docs/FORMATS.md has it";
const NO_DATA: &str = "give the file with the data";

/// First bytes, what the file is, and what to do.
const KINDS: [(&[u8], &str, &str); 21] = [
    (b"PK\x03\x04", "a zip archive, or a file that is one inside (.xlsx, .npz, .pt)", UNPACK),
    (b"BZh", "packed by bzip2", UNPACK),
    (b"\xfd7zXZ\0", "packed by xz", UNPACK),
    (b"\x28\xb5\x2f\xfd", "packed by zstd", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a rar archive", UNPACK),
    (b"\x80\x02", PICKLE, WRITE_JSON),
    (b"\x80\x03", PICKLE, WRITE_JSON),
    (b"\x80\x04", PICKLE, WRITE_JSON),
    (b"\x80\x05", PICKLE, WRITE_JSON),
    (b"PAR1", "a Parquet table", WRITE_JSON),
    (b"\x89HDF\r\n", "an HDF5 file", WRITE_JSON),
    (b"\x93NUMPY", "an array of NumPy", WRITE_JSON),
    (b"SQLite format 3\0", "an SQLite database", WRITE_JSON),
    (b"%PDF-", "a PDF document", NO_DATA),
    (b"\x89PNG\r\n", "a picture (PNG)", NO_DATA),
    (b"\xff\xd8\xff", "a picture (JPEG)", NO_DATA),
    (b"glTF", "a 3D model (glTF)", NO_DATA),
    (b"version https://git-lfs", "a pointer of Git LFS, and not the file itself", "get the file with `git lfs pull`"),
    (b"\xff\xfe", UTF_16, "save it as UTF-8"),
    (b"\xfe\xff", UTF_16, "save it as UTF-8"),
];
const PICKLE: &str = "a pickle of Python";
const UTF_16: &str = "text in UTF-16";

/// Refuses a file whose first bytes, at most [`LOOKED_AT_BYTES`], are those of another kind of file than JSON.
///
/// # Errors
/// What the file is, and what to do with it.
pub(crate) fn refuse_other_kinds(file: &Path, start: &[u8]) -> Result<(), FormatError> {
    let by_bytes = || KINDS.iter().find(|(first, ..)| start.starts_with(first)).map(|(_, kind, hint)| (*kind, *hint));
    match by_bytes().or_else(|| kind_of_text(start)) {
        Some((kind, hint)) => Err(FormatError::for_document(file, format!("it is {kind}"), hint)),
        None => Ok(()),
    }
}

/// What a file without known first bytes is, by the text that it begins with.
fn kind_of_text(start: &[u8]) -> Option<(&'static str, &'static str)> {
    if start.get(257..262) == Some(b"ustar") {
        return Some(("a tar archive", UNPACK));
    }
    // Text in UTF-16 without a mark: every second byte of ASCII is 0.
    if matches!(start, [0, 1..=127, ..] | [1..=127, 0, 1..=127, 0, ..]) {
        return Some((UTF_16, "save it as UTF-8"));
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
    let line = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let is_table = !matches!(line, [b'[' | b'{', ..]) && line.iter().any(|byte| b",;\t".contains(byte));
    (is_table && line.is_ascii()).then_some(("a table (CSV or the like)", WRITE_JSON))
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
            (b"\x80\x04\x95", "it is a pickle"),
            (b"<!DOCTYPE html>", "it is a web page"),
            (b"version https://git-lfs.github.com/spec/v1\n", "`git lfs pull`"),
            (b"instr_id,trajectory\n1_0,\"[a]\"\n", "it is a table"),
            (b"\"instr_id\";\"trajectory\"\n", "it is a table"),
            (b"[{'instr_id': '1_0'}]", "Python's own notation"),
            (b" {\n'instr_id': '1_0'}", "Python's own notation"),
            (b"[\0{\0\"\0", "UTF-16"),
            (b"\0[\0{\0\"", "UTF-16"),
            (tar.as_slice(), "it is a tar archive"),
        ] {
            assert!(told(start).contains(kind), "{:?}: {}", String::from_utf8_lossy(start), told(start));
        }
    }

    #[test]
    fn json_of_any_form_is_let_through() {
        for start in ["", "[]", "{}", " \n[{\"a\": 'x", "{\"a\": 1, \"b\": 2}\n{}", "\"a text\"", "12", "hello", "null"]
        {
            assert_eq!(told(start.as_bytes()), "", "{start}");
        }
    }
}
