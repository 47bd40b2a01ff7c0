//! Shows the progress of a download from the model hub.

use crate::output::CommandOutput;
use indicatif::{HumanBytes, ProgressBar};
use std::{
    collections::BTreeSet,
    sync::{Mutex, PoisonError},
};
use wayword_local::DownloadProgress;

/// A bar for the current file, or a line for each file if standard error is not a terminal.
pub struct DownloadBar {
    output: CommandOutput,
    bar: ProgressBar,
    /// The file that the bar shows.
    file: Mutex<String>,
}

impl DownloadBar {
    /// A bar that is drawn by `output`.
    pub fn new(output: &CommandOutput) -> Self {
        Self { output: output.clone(), bar: output.bytes_bar(), file: Mutex::default() }
    }
}

impl DownloadProgress for DownloadBar {
    fn bytes_arrived(&self, file: &str, done: u64, total: Option<u64>) {
        let mut shown = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if *shown != file {
            file.clone_into(&mut shown);
            self.bar.reset();
            self.bar.set_prefix(file.to_owned());
            self.bar.set_length(total.unwrap_or(done));
            if self.bar.is_hidden() {
                let of_total = total.map(|total| format!(" of {}", HumanBytes(total))).unwrap_or_default();
                self.output.say(format_args!("fetching {file}: {}{of_total} so far", HumanBytes(done)));
            }
        }
        self.bar.set_position(done);
    }

    fn waiting_for(&self, file: &str) {
        self.output.say(format_args!("waiting for another process that fetches {file}"));
    }

    fn show_note(&self, note: &str) {
        // A model is looked up before a run and loaded in it, so the same note comes twice. It is printed once.
        static PRINTED_NOTES: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
        if PRINTED_NOTES.lock().unwrap_or_else(PoisonError::into_inner).insert(note.to_owned()) {
            self.output.say(note);
        }
    }
}

impl Drop for DownloadBar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
