//! The only place that writes to the terminal: results to standard output, messages and progress to standard error. Inside
//! another program (the Python package) a listener gets them instead.

use crate::command_progress::{LastPrint, LinePace, LineWords, is_pace_known};
use crate::error::CommandError;

pub use crate::command_progress::{CommandProgress, SilenceWatch};
pub use indicatif::ProgressBar;
use indicatif::{HumanDuration, ProgressDrawTarget, ProgressState, ProgressStyle};
use serde::Serialize;
use std::{
    fmt::{self, Display},
    io::{self, IsTerminal, Write},
    sync::{Arc, OnceLock},
    time::Duration,
};
use wayword_formats::OutputPlace;
use wayword_world::output_lines::is_unseen;
pub use wayword_world::{mask_credentials, output_lines::show_unseen};

/// How the program prints.
#[derive(Clone)]
pub struct CommandOutput {
    /// Whether results are printed as JSON.
    json: bool,
    /// Whether messages and progress are left out.
    quiet: bool,
    /// Whether standard output carries the data of the command. Then results are printed on standard error.
    carries_data: bool,
    /// Why a result could not be printed, if that happened.
    lost_result: Arc<OnceLock<io::Error>>,
    /// Gets everything in place of the terminal, if there is one.
    listener: Option<Arc<dyn CommandOutputListener>>,
    /// When something was printed last.
    last_print: LastPrint,
}

/// A program that this one runs in.
pub trait CommandOutputListener: Send + Sync {
    /// Takes a result, as JSON.
    fn take_result(&self, json: String);

    /// Takes a message.
    fn take_message(&self, text: String);

    /// Takes a progress bar and may read its position from then on. The bar itself is hidden.
    fn take_bar(&self, bar: &ProgressBar);
}

impl fmt::Debug for CommandOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { json, quiet, listener, .. } = self;
        let fields = ("json", json, "quiet", quiet, "is_heard", listener.is_some());
        f.debug_struct("Output").field(fields.0, fields.1).field(fields.2, fields.3).field(fields.4, &fields.5).finish()
    }
}

/// Longest error that is printed, characters, because parsers quote the whole line that they fail on. The rest is cut
/// off.
const MAX_ERROR_CHARS: usize = 1000;

/// A text without secrets of addresses, and in which unseen characters are shown. Every text from a model, a server, a child process
/// or a file goes through here before it is printed.
pub(crate) fn tame_text(text: &str) -> String {
    show_unseen(&mask_credentials(text)).into_owned()
}

/// As [`tame_text`], for an error; a long one is cut.
fn tame_error(text: &str) -> String {
    // Before the cut, which could leave a part of a secret that is no longer known as one.
    let text = mask_credentials(text);
    let mut tamed = tame_text(&text.chars().take(MAX_ERROR_CHARS).collect::<String>());
    if text.chars().nth(MAX_ERROR_CHARS).is_some() {
        tamed.push_str(" ...");
    }
    tamed
}

/// As [`tame_text`], for JSON: unseen characters become JSON escapes, so that the value stays the same.
fn tame_json(json: &str) -> String {
    let json = mask_credentials(json);
    let mut tamed = String::with_capacity(json.len());
    for c in json.chars() {
        if is_unseen(c) {
            let mut units = [0; 2];
            tamed.extend(c.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")));
        } else {
            tamed.push(c);
        }
    }
    tamed
}

/// Prints a line that comes from elsewhere, such as a child process or a platform, on standard error.
pub fn print_foreign_line(line: &str) {
    print_to_stderr(&tame_error(line));
}

/// Prints a line on standard error. Where that is closed or full the line is lost, and the program goes on: `eprintln!` would panic.
fn print_to_stderr(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

impl CommandOutput {
    /// `json`: results as JSON; `quiet`: no messages, no progress.
    #[must_use]
    pub fn new(json: bool, quiet: bool) -> Self {
        Self {
            json,
            quiet,
            carries_data: false,
            lost_result: Arc::default(),
            listener: None,
            last_print: LastPrint::new(),
        }
    }

    /// Results as JSON, messages and bars for a listener; the terminal stays empty.
    #[must_use]
    pub fn heard_by(listener: Arc<dyn CommandOutputListener>) -> Self {
        Self { listener: Some(listener), ..Self::new(true, false) }
    }

    /// The same output for a command that writes its data to `place`: where that is standard output, nothing else is printed there.
    #[must_use]
    pub fn beside_data(&self, place: &OutputPlace) -> Self {
        Self { carries_data: self.carries_data || *place == OutputPlace::StandardOutput, ..self.clone() }
    }

    /// The error of a result that could not be printed, because standard output is full.
    ///
    /// # Errors
    /// When a result could not be printed.
    pub fn expect_printed(&self) -> Result<(), CommandError> {
        let failed = CommandError::io("standard output", "write");
        self.lost_result.get().map_or(Ok(()), |error| Err(failed(error.kind().into())))
    }

    /// Whether results are printed as JSON.
    #[must_use]
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Prints a result: `value` as JSON if that is wanted, else the text. A closed standard output is no error; for a full one see
    /// [`CommandOutput::expect_printed`].
    pub fn print_result(&self, value: &impl Serialize, text: impl Display) {
        let json = || {
            // A file name that is not UTF-8 cannot be written as JSON.
            let json = serde_json::to_string(value);
            json.unwrap_or_else(|error| format!("{{\"error\":{:?}}}", error.to_string()))
        };
        if let Some(listener) = &self.listener {
            return listener.take_result(mask_credentials(&json()).into_owned());
        }
        let line = if self.json { tame_json(&json()) } else { tame_text(&text.to_string()) };
        let line = line.trim_end();
        if self.carries_data {
            if !self.quiet {
                print_to_stderr(line);
            }
        } else if let Err(error) = writeln!(io::stdout(), "{line}")
            && error.kind() != io::ErrorKind::BrokenPipe
        {
            // The first error is the one to report.
            let _ = self.lost_result.set(error);
        }
    }

    /// Prints a message.
    pub fn say(&self, text: impl Display) {
        self.last_print.note_print();
        if let Some(listener) = &self.listener {
            listener.take_message(tame_text(&text.to_string()));
        } else if !self.quiet {
            print_to_stderr(&tame_text(&text.to_string()));
        }
    }

    /// Prints an error.
    pub fn print_error(&self, error: &impl Display) {
        let red = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
        let head = if red { "\x1b[31merror\x1b[0m" } else { "error" };
        print_to_stderr(&format!("{head}: {}", tame_error(&error.to_string())));
    }

    /// The progress over `total` things, which `what` names, as in "items": a bar, or lines if standard error is not a terminal.
    /// Where nothing can be counted, `total` is 0 and `what` a phrase, as in "reading the scene".
    #[must_use]
    pub fn progress_bar(&self, total: usize, what: &'static str) -> CommandProgress {
        let template = match total {
            0 => "{prefix} {pos}  {msg}",
            _ => "{prefix} {bar:32} {pos}/{len}  {msg}{left}",
        };
        let bar = self.make_bar(total as u64, template).with_prefix(what);
        self.with_lines(bar, LineWords { what, message_has_time: false })
    }

    /// The progress over items that are slow because of calls to models: the message counts the calls and estimates how long they
    /// still take, the prefix counts the finished texts.
    #[must_use]
    pub fn call_progress_bar(&self, total: usize) -> CommandProgress {
        let bar = self.make_bar(total as u64, "items {bar:24} {pos}/{len}  {msg}  {prefix}");
        self.with_lines(bar, LineWords { what: "items", message_has_time: true })
    }

    /// Prints a line now and then while the command of this name prints nothing else, if standard error is not a terminal.
    #[must_use]
    pub fn watch_silence(&self, command: &'static str) -> SilenceWatch {
        if !self.prints_lines() {
            return SilenceWatch::none();
        }
        let output = self.clone();
        SilenceWatch::start(command, self.last_print.clone(), LinePace::SILENT, move |line| output.say(line))
    }

    /// Whether progress is printed as lines: nobody sees a bar, and messages are wanted.
    fn prints_lines(&self) -> bool {
        self.listener.is_none() && !self.quiet && !io::stderr().is_terminal()
    }

    /// Adds lines to a bar that nobody sees.
    fn with_lines(&self, bar: ProgressBar, words: LineWords) -> CommandProgress {
        if !self.prints_lines() {
            return CommandProgress::without_lines(bar);
        }
        let output = self.clone();
        CommandProgress::with_lines(bar, words, LinePace::COUNTED, move |line| output.say(line))
    }

    /// A progress bar for bytes; its length is set later. Hidden if standard error is not a terminal.
    #[must_use]
    pub fn bytes_bar(&self) -> ProgressBar {
        self.make_bar(0, "{prefix} {bar:32} {bytes}/{total_bytes}  {bytes_per_sec}{left}")
    }

    fn make_bar(&self, total: u64, template: &str) -> ProgressBar {
        let bar = ProgressBar::new(total);
        if self.listener.is_some() || self.quiet || !io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        if let Some(listener) = &self.listener {
            listener.take_bar(&bar);
        }
        bar.with_style(bar_style(template))
    }
}

/// The style of a bar. In the template, `{left}` is the time that is left.
fn bar_style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    style.with_key("left", |state: &ProgressState, out: &mut dyn fmt::Write| {
        // If this cannot be written, the rest of the bar cannot either.
        if is_pace_known(state.pos(), state.len().unwrap_or(0)) {
            let _ = out.write_str(&remaining_text(state.eta()));
        }
    })
}

/// The remaining time for the end of a bar, as in "  2m left". Empty before the first item is done, because it is not
/// known then.
fn remaining_text(eta: Duration) -> String {
    if eta.is_zero() { String::new() } else { format!("  {:#} left", HumanDuration(eta.max(Duration::from_secs(1)))) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use std::sync::{Arc, Mutex};

    /// A terminal that keeps the text that is written to it.
    #[derive(Debug, Clone, Default)]
    struct Screen(Arc<Mutex<String>>);

    impl TermLike for Screen {
        fn width(&self) -> u16 {
            100
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, line: &str) -> io::Result<()> {
            self.write_str(line)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_bar_says_nothing_of_the_time_that_nobody_knows_yet() {
        let screen = Screen::default();
        let bar = CommandOutput::new(false, true).progress_bar(8, "items");
        bar.set_draw_target(ProgressDrawTarget::term_like(Box::new(screen.clone())));
        bar.tick();
        let shown = screen.0.lock().unwrap().clone();
        assert!(shown.contains("0/8") && !shown.contains("left"), "{shown}");
        assert_eq!([remaining_text(Duration::ZERO), remaining_text(Duration::from_millis(300))], ["", "  1s left"]);
        assert_eq!(remaining_text(Duration::from_secs(90)), "  2m left");
    }

    #[test]
    fn errors_are_fit_for_a_terminal() {
        assert_eq!(tame_text("a\x1b[31mb\nc"), "a\\u{1b}[31mb\nc");
        assert_eq!(tame_error("https://me:geheim@h/: gone"), "https://***@h/: gone");
        assert_eq!(tame_error(&"x".repeat(5000)).chars().count(), MAX_ERROR_CHARS + 4);
    }

    #[test]
    fn nothing_turns_the_line_round_or_hides_in_it() {
        assert_eq!(
            tame_text("turn \u{202e}tfel\u{2069} now\u{200b}!\n"),
            "turn \\u{202e}tfel\\u{2069} now\\u{200b}!\n"
        );
        assert_eq!(tame_text("caf\u{e9} \u{4e2d}\u{6587}"), "caf\u{e9} \u{4e2d}\u{6587}");
        let joined = "\u{c15}\u{c4d}\u{200c}\u{c37} \u{915}\u{94d}\u{200d}\u{937}";
        assert_eq!((tame_text(joined), tame_json(joined)), (joined.to_owned(), joined.to_owned()));
        let json = serde_json::to_string("a\u{202e}b\u{7f}c\u{9b}d\u{e0041}\"").unwrap();
        let tamed = tame_json(&json);
        assert_eq!(tamed, r#""a\u202eb\u007fc\u009bd\udb40\udc41\"""#);
        assert_eq!(serde_json::from_str::<String>(&tamed).unwrap(), serde_json::from_str::<String>(&json).unwrap());
    }
}
