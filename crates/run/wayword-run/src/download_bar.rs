//! Shows the progress of a download from the model hub.

use crate::output::Output;
use indicatif::{HumanBytes, ProgressBar};
use std::{
    collections::BTreeSet,
    sync::{Mutex, PoisonError},
};
use wayword_local::Progress;

/// A bar for the current file, or a line for each file if standard error is not a terminal.
pub struct DownloadBar {
    output: Output,
    bar: ProgressBar,
    file: Mutex<String>,
}

impl DownloadBar {
    pub fn new(output: &Output) -> Self {
        Self { output: output.clone(), bar: output.bytes(), file: Mutex::default() }
    }
}

impl Progress for DownloadBar {
    fn bytes(&self, file: &str, done: u64, total: Option<u64>) {
        let mut shown = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if *shown != file {
            file.clone_into(&mut shown);
            self.bar.reset();
            self.bar.set_prefix(file.to_owned());
            self.bar.set_length(total.unwrap_or(done));
            if self.bar.is_hidden() {
                let of = total.map(|total| format!(" of {}", HumanBytes(total))).unwrap_or_default();
                self.output.say(format_args!("fetching {file}: {}{of} so far", HumanBytes(done)));
            }
        }
        self.bar.set_position(done);
    }

    fn waiting(&self, file: &str) {
        self.output.say(format_args!("waiting for another process that fetches {file}"));
    }

    fn told(&self, note: &str) {
        // A model is looked up before a run and loaded in it, so the same note comes twice. It is printed once.
        static TOLD: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
        if TOLD.lock().unwrap_or_else(PoisonError::into_inner).insert(note.to_owned()) {
            self.output.say(note);
        }
    }
}

impl Drop for DownloadBar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
