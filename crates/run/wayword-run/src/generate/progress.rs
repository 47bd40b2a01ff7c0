//! Counts the finished items of a run for its progress bar, and decides after each item whether the run goes on.

use super::keep::ItemFate;
use crate::{
    calls::ModelCalls,
    count::count_phrase,
    error::{CommandError, Exit},
    interrupt,
    lookout::DetectorLookout,
    losses::{LossCounter, MAX_FAILURES_IN_A_ROW},
    output::{CommandOutput, CommandProgress, ProgressBar},
    run_folder::RunFolder,
};
use wayword_core::FailureKind;

/// Items between two flushes to the disk: few, so that little is lost when the machine fails.
const FLUSH_INTERVAL_ITEMS: usize = 16;

/// Why a run stopped before its end.
pub(super) struct RunStop {
    /// The reason, for the user.
    pub(super) reason: String,
    /// The exit code that goes with it.
    pub(super) exit: Exit,
}

/// The progress of a run.
pub(super) struct RunProgress<'a> {
    bar: CommandProgress,
    calls: Option<&'a ModelCalls>,
    /// Looks for things along the paths.
    lookout: Option<&'a DetectorLookout>,
    /// Items that are not finished yet.
    left: usize,
    /// Items since the last flush to the disk.
    unflushed: usize,
    losses: LossCounter,
    /// The reason and the number of the items so far, if all have failed for the same reason.
    same_lack: Option<(String, usize)>,
    /// Set once the run has to stop.
    stop: Option<RunStop>,
}

impl<'a> RunProgress<'a> {
    pub(super) fn new(
        output: &CommandOutput,
        items: usize,
        left: usize,
        calls: Option<&'a ModelCalls>,
        lookout: Option<&'a DetectorLookout>,
    ) -> Self {
        // With models an item may take minutes, so calls are a better measure of the progress.
        let bar = if calls.is_some() { output.call_progress_bar(items) } else { output.progress_bar(items, "items") };
        bar.set_position((items - left) as u64);
        // Items of earlier commands must not count for the pace.
        bar.reset_eta();
        Self {
            bar,
            calls,
            lookout,
            left,
            unflushed: 0,
            losses: LossCounter::default(),
            same_lack: Some((String::new(), 0)),
            stop: None,
        }
    }

    /// The bar, to show the calls on it.
    pub(super) fn progress_bar(&self) -> ProgressBar {
        self.bar.clone()
    }

    /// Counts an item by its outcome. Returns whether the run goes on.
    pub(super) fn count_item(&mut self, run: &mut RunFolder, fate: ItemFate) -> Result<bool, CommandError> {
        let failed = match fate {
            ItemFate::Stopped(error) => {
                // A call that an interrupt cut off looks like one that the ledger refused to send.
                let exit = error.exit_code();
                self.stop = interrupt_stop().or_else(|| Some(RunStop { reason: error.to_string(), exit }));
                return Ok(false);
            }
            ItemFate::Failed(failure, reason) => Some((failure, reason)),
            ItemFate::Made => None,
        };
        self.left -= 1;
        self.bar.inc(1);
        match self.calls {
            None => self.bar.set_message(self.progress_message(run)),
            Some(_) => self.bar.set_prefix(self.progress_message(run)),
        }
        self.unflushed += 1;
        if self.unflushed == FLUSH_INTERVAL_ITEMS {
            run.sync()?;
            self.unflushed = 0;
        }
        let is_lost = self.losses.ends_command(failed.as_ref().map(|(failure, _)| *failure));
        let lacks = run.walks.is_empty() && self.all_lack_same_thing(failed.as_ref());
        self.stop = interrupt_stop().filter(|_| self.left > 0).or_else(|| {
            let (_, reason) = failed?;
            let (what, exit) = match (is_lost, lacks) {
                (true, _) => ("were lost", Exit::Lost),
                (false, true) => ("failed for the same reason", Exit::BadInput),
                (false, false) => return None,
            };
            Some(RunStop {
                reason: format!("{MAX_FAILURES_IN_A_ROW} items in a row {what}; the last reason: {reason}"),
                exit,
            })
        });
        Ok(self.stop.is_none())
    }

    /// Whether the first items of a run all failed because the same thing is missing (for example a model that sees), so that
    /// the other items would fail too.
    fn all_lack_same_thing(&mut self, failed: Option<&(FailureKind, String)>) -> bool {
        self.same_lack = match (self.same_lack.take(), failed) {
            (Some((_, 0)), Some((FailureKind::Missing, reason))) => Some((reason.clone(), 1)),
            (Some((same, number)), Some((FailureKind::Missing, reason))) if same == *reason => Some((same, number + 1)),
            _ => None,
        };
        self.same_lack.as_ref().is_some_and(|(_, number)| *number >= MAX_FAILURES_IN_A_ROW)
    }

    /// Finishes the bar. Returns the reason if the run stopped before its end.
    pub(super) fn into_stop(self) -> Option<RunStop> {
        self.bar.finish_and_clear();
        self.stop
    }

    fn progress_message(&self, run: &RunFolder) -> String {
        let mut done = format!("{} written, {} rejected", run.instructions.len(), run.rejected.len());
        if !run.errors.is_empty() {
            done += &format!(", {} failed", run.errors.len());
        }
        if let Some(lookout) = self.lookout {
            done += &format!(", {} searched", count_phrase(lookout.view_count(), "view"));
        }
        self.calls.map_or(done.clone(), |calls| format!("{done}; {}", calls.spent_so_far()))
    }
}

fn interrupt_stop() -> Option<RunStop> {
    let reason = "interrupted\nhint: give the same command again; it keeps the finished items and makes the others";
    interrupt::is_interrupted().then(|| RunStop { reason: reason.to_owned(), exit: Exit::Interrupted })
}
