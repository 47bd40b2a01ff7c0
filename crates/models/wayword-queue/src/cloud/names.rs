//! Checks names of objects. They come from other machines and become names of files, so a hostile name could lead out of
//! the folder.

use super::CloudError;
use object_store::path::Path;
use std::path::PathBuf;

/// The most bytes of a name: the limit of S3 and Azure.
const MAX_NAME_BYTES: usize = 1024;

/// The most bytes of a part between two `/`: the limit of file systems, minus room for the ending of unfinished files.
const MAX_PART_BYTES: usize = 200;

/// The problem of a name, as the end of a sentence; `None` if the name can be used.
fn name_problem(name: &str) -> Option<&'static str> {
    if name.is_empty() {
        return Some("is empty");
    }
    if name.len() > MAX_NAME_BYTES {
        return Some("is too long");
    }
    // Two names that look alike, or a text that changes its direction, are no risk for files. Control characters are:
    // they reach terminals.
    if name.chars().any(|c| c.is_control() || c == '\\') {
        return Some("has a control character or `\\`");
    }
    name.split('/').find_map(|part| match part {
        "" => Some("starts or ends with `/`, or has an empty part"),
        "." | ".." => Some("has a part `.` or `..`"),
        _ if part.len() > MAX_PART_BYTES => Some("has a part that is too long"),
        _ => None,
    })
}

/// Returns an error if the name cannot be used.
pub(super) fn check_name(name: &str) -> Result<(), CloudError> {
    name_problem(name).map_or(Ok(()), |problem| Err(name_error(name, problem)))
}

/// The error of a name, which is cut after 80 characters.
pub(super) fn name_error(name: &str, problem: &'static str) -> CloudError {
    CloudError::Name { name: name.chars().take(80).collect(), problem }
}

/// The path of an object below a prefix. An empty name is the prefix itself.
pub(super) fn path_below(prefix: &Path, name: &str) -> Result<Path, CloudError> {
    let whole = match (prefix.as_ref(), name) {
        ("", name) => name.to_owned(),
        (prefix, "") => prefix.to_owned(),
        (prefix, name) => format!("{prefix}/{name}"),
    };
    if whole.len() > MAX_NAME_BYTES {
        return Err(name_error(name, "is too long"));
    }
    Path::parse(whole).map_err(|_| name_error(name, "is not allowed in object stores"))
}

/// The file that an object becomes, relative to a folder.
pub(super) fn local_file_path(name: &str) -> Result<PathBuf, CloudError> {
    check_name(name)?;
    // A drive letter or a stream of a file on Windows.
    if cfg!(windows) && name.contains(':') {
        return Err(name_error(name, "has a `:`"));
    }
    Ok(name.split('/').collect())
}

#[cfg(test)]
mod tests {
    use super::{check_name, local_file_path};

    #[test]
    fn a_plain_name_is_taken_and_becomes_a_file_below_the_folder() {
        for name in ["a", "a/b.jsonl.gz", "chunk 7/ü.json", "a..b/...", "-", "~"] {
            assert!(check_name(name).is_ok(), "{name}");
            assert!(local_file_path(name).unwrap().is_relative());
        }
    }

    #[test]
    fn a_name_that_leaves_the_folder_is_refused() {
        let long = "x".repeat(201);
        let hostile = [
            "",
            "/",
            "/etc/passwd",
            "..",
            "../a",
            "a/../../b",
            "a/./b",
            "a//b",
            "a/",
            "a\\..\\b",
            "a\nb",
            "a\0",
            "\u{9b}2J",
            &long,
        ];
        for name in hostile {
            assert!(check_name(name).is_err(), "{name:?}");
            assert!(local_file_path(name).is_err(), "{name:?}");
        }
    }
}
