//! Reads the small JSON files of a model's folder, with errors that name the file and the field.

use crate::{LocalError, error::FETCH_AGAIN};
use serde::{Deserialize, de::DeserializeOwned};
use std::path::{Path, PathBuf};

/// The longest file that is read, bytes. A longer one is refused.
const MAX_JSON_BYTES: u64 = 4 << 20;

/// Reads a required file of a folder. `what` is its purpose for the error, as in "the configuration".
pub(crate) fn read_required<T: DeserializeOwned>(
    folder: &Path,
    name: &str,
    what: &'static str,
) -> Result<T, LocalError> {
    let file = folder.join(name);
    read_if_there(folder, name)?.ok_or_else(|| LocalError::Missing {
        file,
        what,
        hint: "fetch the whole model: wayword models fetch NAME".to_owned(),
    })
}

/// Reads a file of a folder. `None` if there is no such file.
pub(crate) fn read_if_there<T: DeserializeOwned>(folder: &Path, name: &str) -> Result<Option<T>, LocalError> {
    let file = folder.join(name);
    let Ok(metadata) = std::fs::metadata(&file) else { return Ok(None) };
    let wrong = |problem: String| LocalError::File { file: file.clone(), problem, hint: FETCH_AGAIN };
    if metadata.len() > MAX_JSON_BYTES {
        return Err(wrong(format!("it is too long: {} bytes", metadata.len())));
    }
    let text = std::fs::read_to_string(&file).map_err(|error| LocalError::from_io(&file, "read", error))?;
    let mut parser = serde_json::Deserializer::from_str(&text);
    let value = serde_path_to_error::deserialize(&mut parser).map_err(|error| wrong(error.to_string()))?;
    parser.end().map_err(|error| wrong(error.to_string()))?;
    Ok(Some(value))
}

/// Where transformers keeps the configuration of a model's pictures: alone until its version 4, and since then within that of the
/// processor.
const PICTURE_FILE: &str = "preprocessor_config.json";
const PROCESSOR_FILE: &str = "processor_config.json";

/// `processor_config.json`.
#[derive(Deserialize)]
#[serde(bound = "T: DeserializeOwned")]
struct ProcessorParts<T> {
    image_processor: Option<T>,
}

/// Reads the configuration of a model's pictures, from `preprocessor_config.json` or else from the part `image_processor` of
/// `processor_config.json`. Also returns the file.
pub(crate) fn read_picture_config<T: DeserializeOwned>(folder: &Path) -> Result<(T, PathBuf), LocalError> {
    if !folder.join(PICTURE_FILE).exists() {
        let parts: Option<ProcessorParts<T>> = read_if_there(folder, PROCESSOR_FILE)?;
        if let Some(config) = parts.and_then(|parts| parts.image_processor) {
            return Ok((config, folder.join(PROCESSOR_FILE)));
        }
    }
    Ok((read_required(folder, PICTURE_FILE, "the configuration of the pictures")?, folder.join(PICTURE_FILE)))
}

/// The largest size that a configuration may have, such as a number of words or of channels. Larger ones could overflow
/// computations.
const MAX_CONFIG_SIZE: usize = 1 << 20;

/// The problem with the sizes of a configuration, if one is 0 or too large. Each size comes with its name.
pub(crate) fn size_problem(sizes: &[(&str, usize)]) -> Option<String> {
    let (name, size) = sizes.iter().find(|(_, size)| !(1..=MAX_CONFIG_SIZE).contains(size))?;
    Some(format!("{name}: {size} is not from 1 to {MAX_CONFIG_SIZE}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    struct Outer {
        #[allow(dead_code, reason = "only read")]
        layers: Vec<Inner>,
    }

    #[derive(Debug, Deserialize)]
    struct Inner {
        #[allow(dead_code, reason = "only read")]
        width: usize,
    }

    #[test]
    fn read_reports_the_wrong_field_and_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let error_for = |text: &str| {
            std::fs::write(folder.path().join("config.json"), text).unwrap();
            read_required::<Outer>(folder.path(), "config.json", "a model").unwrap_err().to_string()
        };
        let wrong = error_for("{\"layers\": [{\"width\": 1},\n{\"width\": \"two\"}]}");
        assert!(
            wrong.contains("config.json") && wrong.contains("layers[1].width") && wrong.contains("line 2"),
            "{wrong}"
        );
        assert!(error_for("{\"layers\": []} and more").contains("trailing characters"));
    }
}
