//! How far a run is, and whether it goes on.

use super::keep::Fate;
use crate::{
    calls::Calls,
    error::{Error, Exit},
    interrupt,
    output::Output,
    run::RunFolder,
};
use indicatif::ProgressBar;
use wayword_core::Failure;

/// Items between two flushes to the disk: few enough to lose little when the machine fails.
const FLUSH: usize = 16;
/// So many items in a row whose world or service was lost end the run: the others would wait for the same.
const MOST_LOST_IN_A_ROW: usize = 5;

/// Why a run stopped before its end.
pub(super) struct Stop {
    pub(super) reason: String,
    pub(super) exit: Exit,
}

/// How far a run is.
pub(super) struct Progress<'a> {
    bar: ProgressBar,
    calls: Option<&'a Calls>,
    /// Items that nobody has taken up yet in this command.
    left: usize,
    unflushed: usize,
    lost_in_a_row: usize,
    stop: Option<Stop>,
}

impl<'a> Progress<'a> {
    pub(super) fn new(output: &Output, items: usize, left: usize, calls: Option<&'a Calls>) -> Self {
        let bar = output.progress(items, "items");
        bar.set_position((items - left) as u64);
        // What earlier commands did tells nothing of the pace.
        bar.reset_eta();
        Self { bar, calls, left, unflushed: 0, lost_in_a_row: 0, stop: None }
    }

    /// Takes note of what became of an item. Returns whether the run goes on.
    pub(super) fn takes_note(&mut self, run: &mut RunFolder, fate: Fate) -> Result<bool, Error> {
        let lost = match fate {
            Fate::Stopped(error) => {
                // A call that an interrupt cut off looks like one that the ledger did not let out.
                self.stop = interrupted().or_else(|| Some(Stop { reason: error.to_string(), exit: Exit::Stopped }));
                return Ok(false);
            }
            Fate::Failed(Failure::Lost, reason) => Some(reason),
            Fate::Failed(..) | Fate::Made => None,
        };
        self.lost_in_a_row = lost.as_ref().map_or(0, |_| self.lost_in_a_row + 1);
        self.left -= 1;
        self.bar.inc(1);
        self.bar.set_message(self.message(run));
        self.unflushed += 1;
        if self.unflushed == FLUSH {
            run.sync()?;
            self.unflushed = 0;
        }
        self.stop = match lost {
            Some(reason) if self.lost_in_a_row == MOST_LOST_IN_A_ROW => Some(Stop {
                reason: format!(
                    "{MOST_LOST_IN_A_ROW} items in a row were lost, the last with: {reason}\nhint: see to it, and give the same command again"
                ),
                exit: Exit::Lost,
            }),
            _ => interrupted().filter(|_| self.left > 0),
        };
        Ok(self.stop.is_none())
    }

    /// Why the run stopped before its end, where it did.
    pub(super) fn end(self) -> Option<Stop> {
        self.bar.finish_and_clear();
        self.stop
    }

    fn message(&self, run: &RunFolder) -> String {
        let mut done = format!("{} written, {} rejected", run.instructions.len(), run.rejected.len());
        if !run.errors.is_empty() {
            done += &format!(", {} failed", run.errors.len());
        }
        self.calls.map_or(done.clone(), |calls| format!("{done}; {}", calls.spent()))
    }
}

fn interrupted() -> Option<Stop> {
    interrupt::is_asked().then(|| Stop { reason: Error::Interrupted.to_string(), exit: Exit::Interrupted })
}
