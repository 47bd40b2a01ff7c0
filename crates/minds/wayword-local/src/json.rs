//! Small JSON files of a model's folder.

use crate::LocalError;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Such a file may be so long, bytes.
const LONGEST: u64 = 4 << 20;

/// Reads one that has to be there.
pub(crate) fn read<T: DeserializeOwned>(folder: &Path, name: &str, what: &'static str) -> Result<T, LocalError> {
    let file = folder.join(name);
    read_if_there(folder, name)?.ok_or_else(|| LocalError::Missing {
        file,
        what,
        hint: "fetch the whole model: wayword models fetch NAME".to_owned(),
    })
}

/// Reads one that may be missing.
pub(crate) fn read_if_there<T: DeserializeOwned>(folder: &Path, name: &str) -> Result<Option<T>, LocalError> {
    let file = folder.join(name);
    let Ok(about) = std::fs::metadata(&file) else { return Ok(None) };
    let wrong = |problem: String| LocalError::File { file: file.clone(), problem, hint: "fetch it again" };
    if about.len() > LONGEST {
        return Err(wrong(format!("{} bytes are too many for it", about.len())));
    }
    let text = std::fs::read_to_string(&file).map_err(|error| LocalError::io(&file, "read", error))?;
    serde_json::from_str(&text).map(Some).map_err(|error| wrong(error.to_string()))
}

/// Sizes that no model has would overflow what is reckoned with them.
const LARGEST_SIZE: usize = 1 << 20;

/// What is wrong with a configuration's sizes, where one is none.
pub(crate) fn size_problem(sizes: &[(&str, usize)]) -> Option<String> {
    let (name, size) = sizes.iter().find(|(_, size)| !(1..=LARGEST_SIZE).contains(size))?;
    Some(format!("{name}: {size} is not from 1 to {LARGEST_SIZE}"))
}
