//! The file of a worker's spans. An error of its disk costs lines, but never stops the worker.

use crate::{error::CommandError, output::CommandOutput};
use serde::Serialize;
use std::{
    fs::{self, File},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// A file of JSON lines that drops a line that it cannot write.
pub(super) struct LineFile {
    path: PathBuf,
    output: CommandOutput,
    state: Mutex<LineFileState>,
}

struct LineFileState {
    file: File,
    /// Length of the complete lines, bytes. A half-written line is cut off there.
    whole_bytes: u64,
    /// Whether the warning about lost lines was printed.
    has_warned: bool,
}

impl LineFile {
    /// Makes the file. `None` if the disk is full, after a warning.
    ///
    /// # Errors
    /// When it cannot be made for another reason.
    pub(super) fn begin(path: &Path, output: &CommandOutput) -> Result<Option<Self>, CommandError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let file = match fs::create_dir_all(folder).and_then(|()| File::options().append(true).create(true).open(path))
        {
            Ok(file) => file,
            Err(error) if matches!(error.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded) => {
                output.say(lost_warning(path, &error));
                return Ok(None);
            }
            Err(error) => return Err(CommandError::io(path, "make the file of spans")(error)),
        };
        Ok(Some(Self::from_file(path, file, output)))
    }

    fn from_file(path: &Path, file: File, output: &CommandOutput) -> Self {
        let state = Mutex::new(LineFileState { file, whole_bytes: 0, has_warned: false });
        Self { path: path.to_owned(), output: output.clone(), state }
    }

    /// Appends a line in one write.
    pub(super) fn append(&self, line: &impl Serialize) {
        let Ok(mut bytes) = serde_json::to_vec(line) else { return };
        bytes.push(b'\n');
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        match state.file.write_all(&bytes) {
            Ok(()) => state.whole_bytes += bytes.len() as u64,
            Err(error) => {
                // A part of the line may be there. If it cannot be cut off, the file cannot be written at all.
                let _ = state.file.set_len(state.whole_bytes);
                if !std::mem::replace(&mut state.has_warned, true) {
                    self.output.say(lost_warning(&self.path, &error));
                }
            }
        }
    }
}

fn lost_warning(path: &Path, error: &std::io::Error) -> String {
    format!("warning: {}: spans cannot be written ({error}); the run goes on, and they are lost", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::CommandOutputListener;
    use indicatif::ProgressBar;
    use std::sync::Arc;

    #[derive(Default)]
    struct Heard(Mutex<Vec<String>>);

    impl CommandOutputListener for Heard {
        fn take_result(&self, _: String) {}

        fn take_message(&self, text: String) {
            self.0.lock().unwrap().push(text);
        }

        fn take_bar(&self, _: &ProgressBar) {}
    }

    #[test]
    fn append_warns_once_about_a_file_that_cannot_be_written() {
        let heard = Arc::new(Heard::default());
        let output = CommandOutput::heard_by(Arc::clone(&heard) as Arc<dyn CommandOutputListener>);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("w.jsonl");
        fs::write(&path, "").unwrap();
        // Opened for reading alone, so every write fails.
        let file = LineFile::from_file(&path, File::open(&path).unwrap(), &output);
        for number in 0..3 {
            file.append(&number);
        }
        let told = heard.0.lock().unwrap().clone();
        assert!(told.len() == 1 && told[0].contains("w.jsonl") && told[0].contains("goes on"), "{told:?}");
    }

    #[test]
    fn begin_refuses_a_folder_that_cannot_be_made() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        let refused =
            LineFile::begin(&folder.path().join("file/spans/w.jsonl"), &CommandOutput::new(false, true)).err();
        assert!(refused.unwrap().to_string().contains("cannot make the file of spans"));
    }
}
