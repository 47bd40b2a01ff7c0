//! Counts the finished items of a run for its progress bar, and decides after each item whether the run goes on.

use super::keep::Fate;
use crate::{
    calls::Calls,
    count::count,
    error::{Error, Exit},
    interrupt,
    looking_for::Lookout,
    losses::{Losses, MOST_IN_A_ROW},
    output::Output,
    run_folder::RunFolder,
};
use indicatif::ProgressBar;
use wayword_core::Failure;

/// Items between two flushes to the disk: few, so that little is lost when the machine fails.
const FLUSH: usize = 16;

/// Why a run stopped before its end.
pub(super) struct Stop {
    pub(super) reason: String,
    pub(super) exit: Exit,
}

/// The progress of a run.
pub(super) struct Progress<'a> {
    bar: ProgressBar,
    calls: Option<&'a Calls>,
    /// Looks for things along the paths.
    lookout: Option<&'a Lookout>,
    /// Items that are not finished yet.
    left: usize,
    unflushed: usize,
    losses: Losses,
    /// The reason and the number of the items so far, if all have failed for the same reason.
    nothing_but: Option<(String, usize)>,
    stop: Option<Stop>,
}

impl<'a> Progress<'a> {
    pub(super) fn new(
        output: &Output,
        items: usize,
        left: usize,
        calls: Option<&'a Calls>,
        lookout: Option<&'a Lookout>,
    ) -> Self {
        // With models an item may take minutes, so calls are a better measure of the progress.
        let bar = if calls.is_some() { output.progress_by_calls(items) } else { output.progress(items, "items") };
        bar.set_position((items - left) as u64);
        // Items of earlier commands must not count for the pace.
        bar.reset_eta();
        Self {
            bar,
            calls,
            lookout,
            left,
            unflushed: 0,
            losses: Losses::default(),
            nothing_but: Some((String::new(), 0)),
            stop: None,
        }
    }

    /// The bar, to show the calls on it.
    pub(super) fn bar(&self) -> ProgressBar {
        self.bar.clone()
    }

    /// Counts an item by its outcome. Returns whether the run goes on.
    pub(super) fn takes_note(&mut self, run: &mut RunFolder, fate: Fate) -> Result<bool, Error> {
        let failed = match fate {
            Fate::Stopped(error) => {
                // A call that an interrupt cut off looks like one that the ledger refused to send.
                let exit = error.exit_code();
                self.stop = interrupted().or_else(|| Some(Stop { reason: error.to_string(), exit }));
                return Ok(false);
            }
            Fate::Failed(failure, reason) => Some((failure, reason)),
            Fate::Made => None,
        };
        self.left -= 1;
        self.bar.inc(1);
        match self.calls {
            None => self.bar.set_message(self.message(run)),
            Some(_) => self.bar.set_prefix(self.message(run)),
        }
        self.unflushed += 1;
        if self.unflushed == FLUSH {
            run.sync()?;
            self.unflushed = 0;
        }
        let is_lost = self.losses.are_enough(failed.as_ref().map(|(failure, _)| *failure));
        let lacks = run.walks.is_empty() && self.lacks_for_all(failed.as_ref());
        self.stop = interrupted().filter(|_| self.left > 0).or_else(|| {
            let (_, reason) = failed?;
            let (what, exit) = match (is_lost, lacks) {
                (true, _) => ("were lost", Exit::Lost),
                (false, true) => ("failed for the same reason", Exit::BadInput),
                (false, false) => return None,
            };
            Some(Stop { reason: format!("{MOST_IN_A_ROW} items in a row {what}; the last reason: {reason}"), exit })
        });
        Ok(self.stop.is_none())
    }

    /// Whether the first items of a run all failed because the same thing is missing (for example a model that sees), so that
    /// the other items would fail too.
    fn lacks_for_all(&mut self, failed: Option<&(Failure, String)>) -> bool {
        self.nothing_but = match (self.nothing_but.take(), failed) {
            (Some((_, 0)), Some((Failure::Missing, reason))) => Some((reason.clone(), 1)),
            (Some((same, number)), Some((Failure::Missing, reason))) if same == *reason => Some((same, number + 1)),
            _ => None,
        };
        self.nothing_but.as_ref().is_some_and(|(_, number)| *number >= MOST_IN_A_ROW)
    }

    /// Finishes the bar. Returns the reason if the run stopped before its end.
    pub(super) fn end(self) -> Option<Stop> {
        self.bar.finish_and_clear();
        self.stop
    }

    fn message(&self, run: &RunFolder) -> String {
        let mut done = format!("{} written, {} rejected", run.instructions.len(), run.rejected.len());
        if !run.errors.is_empty() {
            done += &format!(", {} failed", run.errors.len());
        }
        if let Some(lookout) = self.lookout {
            done += &format!(", {} searched", count(lookout.views(), "view"));
        }
        self.calls.map_or(done.clone(), |calls| format!("{done}; {}", calls.spent()))
    }
}

fn interrupted() -> Option<Stop> {
    let reason = "interrupted\nhint: give the same command again; it keeps the finished items and makes the others";
    interrupt::is_asked().then(|| Stop { reason: reason.to_owned(), exit: Exit::Interrupted })
}
