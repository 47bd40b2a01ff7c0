//! The progress of a command: a bar on a terminal, and elsewhere (a pipe, a log) a line from time to time.

use indicatif::{HumanDuration, ProgressBar};
use std::{
    ops::Deref,
    sync::{Arc, Condvar, Mutex, PoisonError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// When lines are printed. The first comes after `first`, and each later one after twice as long as the one before it, but
/// never after longer than `most`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinePace {
    pub(crate) first: Duration,
    pub(crate) most: Duration,
}

impl LinePace {
    /// The pace of work that counts what is done.
    pub(crate) const COUNTED: Self = Self { first: Duration::from_secs(5), most: Duration::from_secs(50) };
    /// The pace of a command that prints nothing else.
    pub(crate) const SILENT: Self = Self { first: Duration::from_secs(8), most: Duration::from_secs(60) };

    /// The time between a line that came after `wait` and the next one.
    fn next_wait(self, wait: Duration) -> Duration {
        (2 * wait).min(self.most)
    }
}

/// The progress of a piece of work. It can be used as a bar. On a terminal the bar is shown. Elsewhere lines are printed until
/// the bar is finished or this is dropped.
#[derive(Debug)]
pub struct CommandProgress {
    bar: ProgressBar,
    /// Held until the work is over.
    _lines: Option<LineThread>,
}

/// What the lines say.
pub(crate) struct LineWords {
    /// What the bar counts, as in "items"; a whole phrase where it counts nothing.
    pub(crate) what: &'static str,
    /// Whether the bar's message already has the time that the rest takes.
    pub(crate) message_has_time: bool,
}

impl CommandProgress {
    /// A progress without lines.
    pub(crate) fn without_lines(bar: ProgressBar) -> Self {
        Self { bar, _lines: None }
    }

    /// A progress that gives its lines to `print`. Where no thread can be started there are no lines.
    pub(crate) fn with_lines(
        bar: ProgressBar,
        words: LineWords,
        pace: LinePace,
        print: impl Fn(&str) + Send + 'static,
    ) -> Self {
        let (shown, mut wait, since) = (bar.clone(), pace.first, Instant::now());
        let lines = LineThread::start(wait, move || {
            if !shown.is_finished() {
                print(&progress_line(&shown, &words, since.elapsed()));
            }
            wait = pace.next_wait(wait);
            wait
        });
        Self { bar, _lines: lines }
    }
}

impl Deref for CommandProgress {
    type Target = ProgressBar;

    fn deref(&self) -> &ProgressBar {
        &self.bar
    }
}

/// When a command printed something last.
#[derive(Debug, Clone)]
pub(crate) struct LastPrint(Arc<Mutex<Option<Instant>>>);

impl LastPrint {
    pub(crate) fn new() -> Self {
        Self(Arc::default())
    }

    pub(crate) fn note_print(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Instant::now());
    }

    /// Time since the last print; `None` before the first.
    fn age(&self) -> Option<Duration> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).map(|at| at.elapsed())
    }
}

/// Prints a line now and then while a command prints nothing else, until this is dropped. It is for work that counts nothing, such as
/// reading scenes.
#[derive(Debug)]
pub struct SilenceWatch {
    /// Held until the command is over.
    _lines: Option<LineThread>,
}

impl SilenceWatch {
    /// A watch that prints nothing.
    pub(crate) fn none() -> Self {
        Self { _lines: None }
    }

    /// Watches the command of this name. Its own lines have to be noted in `last` too.
    pub(crate) fn start(
        command: &'static str,
        last: LastPrint,
        pace: LinePace,
        print: impl Fn(&str) + Send + 'static,
    ) -> Self {
        let (since, look) = (Instant::now(), pace.first / SILENCE_LOOKS);
        let lines = LineThread::start(look, move || {
            // Once the command has printed something, it need not print before the longest time is over.
            let is_due = match last.age() {
                None => since.elapsed() >= pace.first,
                Some(age) => age + look >= pace.most,
            };
            if is_due {
                print(&format!("{command}: at work for {:#}", HumanDuration(since.elapsed())));
                last.note_print();
            }
            look
        });
        Self { _lines: lines }
    }
}

/// How often a watch looks within the time after which its first line comes.
const SILENCE_LOOKS: u32 = 8;

/// The thread that prints the lines; it ends when this is dropped.
#[derive(Debug)]
struct LineThread {
    ended: Arc<(Mutex<bool>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

impl LineThread {
    /// Calls `step` after the time `first`, and then again after each time that it returns. `None` where no thread can be started.
    fn start(first: Duration, mut step: impl FnMut() -> Duration + Send + 'static) -> Option<Self> {
        let ended = Arc::new((Mutex::new(false), Condvar::new()));
        let shared = Arc::clone(&ended);
        let run_steps = move || {
            let mut wait = first;
            while !wait_for_end(&shared, wait) {
                wait = step();
            }
        };
        let thread = thread::Builder::new().name("progress".to_owned()).spawn(run_steps).ok()?;
        Some(Self { ended, thread: Some(thread) })
    }
}

/// Waits for so long, or until the end. Returns whether it is the end.
fn wait_for_end((ended, ends): &(Mutex<bool>, Condvar), wait: Duration) -> bool {
    let ended = ended.lock().unwrap_or_else(PoisonError::into_inner);
    let waited = ends.wait_timeout_while(ended, wait, |ended| !*ended);
    *waited.unwrap_or_else(PoisonError::into_inner).0
}

impl Drop for LineThread {
    fn drop(&mut self) {
        let (ended, ends) = &*self.ended;
        *ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        ends.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// The progress as a line: "items: 31 of 120, 30 written, 1 rejected, 2 minutes left". Where the bar has no length: "houses: 3".
fn progress_line(bar: &ProgressBar, words: &LineWords, elapsed: Duration) -> String {
    let (done, all) = (bar.position(), bar.length().unwrap_or(0));
    let mut line = match (done, all) {
        (0, 0) => format!("{}: at work for {:#}", words.what, HumanDuration(elapsed)),
        (done, 0) => format!("{}: {done}", words.what),
        (done, all) => format!("{}: {done} of {all}", words.what),
    };
    let message = bar.message();
    if !message.is_empty() {
        line += &format!(", {message}");
    }
    // Items that an earlier command made do not count for the pace: the bar's own clock begins after them.
    if let Some(left) = time_left(bar).filter(|_| !words.message_has_time) {
        line += &format!(", about {:#} left", HumanDuration(left));
    }
    line
}

/// Whether so much is done that its pace tells how long the rest takes. The first things take longer, because scenes are made ready for
/// them and threads are idle: an estimate by them was up to fifteen times too high.
pub(crate) fn is_pace_known(done: u64, all: u64) -> bool {
    done >= KNOWN_PACE_COUNT || done > 1 && done >= all.div_ceil(KNOWN_PACE_PARTS)
}

/// After so many things the pace is known.
const KNOWN_PACE_COUNT: u64 = 20;
/// Of few things, the pace is known after this part of them.
const KNOWN_PACE_PARTS: u64 = 5;

/// How long the rest takes, as far as the bar can know.
fn time_left(bar: &ProgressBar) -> Option<Duration> {
    let left = bar.eta();
    let is_known = is_pace_known(bar.position(), bar.length().unwrap_or(0));
    (!left.is_zero() && is_known && left < Duration::from_secs(365 * 86_400)).then(|| left.max(Duration::from_secs(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::ProgressDrawTarget;
    use std::sync::mpsc;

    fn hidden_bar(length: u64) -> ProgressBar {
        let bar = ProgressBar::new(length);
        bar.set_draw_target(ProgressDrawTarget::hidden());
        bar
    }

    const WORDS: LineWords = LineWords { what: "items", message_has_time: true };
    const FAST: LinePace = LinePace { first: Duration::from_millis(1), most: Duration::from_millis(4) };

    #[test]
    fn a_command_prints_a_line_within_ten_seconds_and_then_at_least_each_minute() {
        for pace in [LinePace::COUNTED, LinePace::SILENT] {
            let (mut wait, mut waits) = (pace.first, Vec::new());
            while waits.len() < 30 {
                waits.push(wait);
                wait = pace.next_wait(wait);
            }
            assert!(waits[0] + waits[0] / SILENCE_LOOKS <= Duration::from_secs(10), "{waits:?}");
            assert!(waits.iter().all(|wait| *wait <= Duration::from_secs(60)), "{waits:?}");
            assert!(waits[29] >= Duration::from_secs(50), "and not often in the end");
        }
        // Counted work prints first, and a watch prints nothing beside it.
        assert!(LinePace::COUNTED.first < LinePace::SILENT.first && LinePace::COUNTED.most < LinePace::SILENT.most);
    }

    #[test]
    fn lines_say_what_is_done_of_how_many_until_the_bar_is_finished() {
        let (sender, lines) = mpsc::channel();
        let bar = hidden_bar(8);
        let progress = CommandProgress::with_lines(bar, WORDS, FAST, move |line| sender.send(line.to_owned()).unwrap());
        assert_eq!(lines.recv().unwrap(), "items: 0 of 8");
        progress.inc(3);
        progress.set_message("3 written");
        while lines.recv().unwrap() != "items: 3 of 8, 3 written" {}
        progress.finish_and_clear();
        // A line may be on its way. After it there is none.
        thread::sleep(Duration::from_millis(20));
        while lines.try_recv().is_ok() {}
        thread::sleep(Duration::from_millis(20));
        assert_eq!(lines.try_recv(), Err(mpsc::TryRecvError::Empty));
        drop(progress);
        assert_eq!(lines.try_recv(), Err(mpsc::TryRecvError::Disconnected), "the thread has ended");
    }

    #[test]
    fn a_line_of_work_that_counts_nothing_says_how_long_it_has_lasted() {
        let words = LineWords { what: "reading the scene", message_has_time: false };
        let line = |bar: &ProgressBar| progress_line(bar, &words, Duration::from_secs(65));
        let bar = hidden_bar(0);
        assert_eq!(line(&bar), "reading the scene: at work for 65s");
        bar.inc(2);
        assert_eq!(line(&bar), "reading the scene: 2");
    }

    #[test]
    fn the_first_things_say_nothing_about_the_time_that_is_left() {
        let words = LineWords { what: "panoramas", message_has_time: false };
        let bar = hidden_bar(66);
        thread::sleep(Duration::from_millis(20));
        bar.inc(2);
        assert_eq!(progress_line(&bar, &words, Duration::ZERO), "panoramas: 2 of 66");
        thread::sleep(Duration::from_millis(20));
        bar.inc(18);
        assert!(progress_line(&bar, &words, Duration::ZERO).contains(" left"));
        for (done, all, is_known) in [
            (0, 4, false),
            (1, 4, false),
            (2, 4, true),
            (2, 10, true),
            (13, 66, false),
            (14, 66, true),
            (20, 1000, true),
        ] {
            assert_eq!(is_pace_known(done, all), is_known, "{done} of {all}");
        }
    }

    #[test]
    fn a_watch_prints_while_nothing_else_is_printed() {
        let (sender, lines) = mpsc::channel();
        let last = LastPrint::new();
        let pace = LinePace { first: Duration::from_millis(8), most: Duration::from_millis(40) };
        let watch = SilenceWatch::start("check", last.clone(), pace, move |line| sender.send(line.to_owned()).unwrap());
        assert!(lines.recv().unwrap().starts_with("check: at work for "));
        let first = Instant::now();
        lines.recv().unwrap();
        assert!(first.elapsed() >= Duration::from_millis(30), "{:?}", first.elapsed());
        // While others print, it is silent.
        let until = Instant::now() + Duration::from_millis(100);
        while Instant::now() < until {
            last.note_print();
            thread::sleep(Duration::from_millis(1));
        }
        let late = lines.try_iter().count();
        assert!(late <= 1, "{late}");
        drop(watch);
    }
}
