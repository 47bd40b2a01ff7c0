//! Small text files of a user's: read whole, within a bound.

use crate::error::Error;
use std::{fs::File, io::Read, path::Path};

/// Largest file that is read, bytes.
const MOST_BYTES: u64 = 4 << 20;

/// The text of a file; `what` is told in errors ("the settings").
///
/// # Errors
/// When it cannot be read, is no UTF-8, or is larger than 4 MiB.
pub(crate) fn read(path: &Path, what: &'static str) -> Result<String, Error> {
    let mut text = String::new();
    let file = File::open(path).map_err(Error::io(path, what))?;
    file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(Error::io(path, what))?;
    if text.len() as u64 > MOST_BYTES {
        return Err(Error::usage(format!("{}: it is larger than 4 MiB", path.display()), "is it the right file?"));
    }
    Ok(text)
}
