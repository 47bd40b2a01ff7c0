//! Reads small text files of the user, up to a limit.

use crate::error::CommandError;
use std::{
    fs::{self, File},
    io::Read,
    path::Path,
};
use wayword_world::files;

/// Largest file that is read, bytes. A larger one is refused.
const MAX_TEXT_FILE_BYTES: u64 = 4 << 20;

/// The text of a file, without a byte order mark. `what` is what the program was doing, for the error ("read the settings").
///
/// # Errors
/// When it cannot be read, is not a plain file (but a pipe, say), is not UTF-8, or is larger than 4 MiB.
pub fn read_text_file(path: &Path, what: &'static str) -> Result<String, CommandError> {
    let refusal = |reason: &str, hint: &str| CommandError::usage(format!("{}: this {reason}", path.display()), hint);
    let metadata = fs::metadata(path).map_err(CommandError::io(path, what))?;
    if let Some(reason) = files::describe_irregular(&metadata) {
        return Err(refusal(reason, "give a file"));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(CommandError::io(path, what))?;
    file.take(MAX_TEXT_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(CommandError::io(path, what))?;
    if bytes.len() as u64 > MAX_TEXT_FILE_BYTES {
        return Err(refusal("is larger than 4 MiB", "check that this is the right file"));
    }
    files::decode_utf8(bytes).map_err(|reason| refusal(reason, "check that this is the right file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_text_file_accepts_utf8_with_or_without_a_mark_only() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("settings.toml");
        let told = |bytes: &[u8]| {
            fs::write(&file, bytes).unwrap();
            read_text_file(&file, "read the settings").map_err(|error| error.to_string())
        };
        assert_eq!(told(b"\xef\xbb\xbfseed = 1"), Ok("seed = 1".to_owned()));
        assert_eq!(told(b"seed = 1"), Ok("seed = 1".to_owned()));
        assert!(told(b"\xff\xfes\0").unwrap_err().contains("is text in UTF-16; save it as UTF-8"));
        assert!(told(b"\xff").unwrap_err().contains("not text in UTF-8"));
        assert!(told(&vec![b' '; (4 << 20) + 1]).unwrap_err().contains("larger than 4 MiB"));
    }

    #[cfg(unix)]
    #[test]
    fn read_text_file_refuses_a_pipe_without_waiting_for_it() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(read_text_file(&pipe, "read the settings").unwrap_err().to_string().contains("is a pipe or a device"));
        assert!(read_text_file(folder.path(), "read the settings").unwrap_err().to_string().contains("is a folder"));
    }
}
