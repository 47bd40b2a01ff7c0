//! The only place that writes to the terminal: data to standard output, talk and progress to standard error.
#![allow(clippy::print_stdout, clippy::print_stderr)] // This is the place where that is done.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::{
    fmt::Display,
    io::{self, IsTerminal, Write},
};

/// How the program speaks.
#[derive(Debug, Clone, Copy)]
pub struct Output {
    json: bool,
    quiet: bool,
}

/// Longest error that is printed, characters: parsers quote the line that they choke on, however long.
const MOST_ERROR_CHARS: usize = 1000;

/// A text that may hold anything, made fit for a terminal.
pub(crate) fn tame(text: &str) -> String {
    let mut tamed: String =
        text.chars().take(MOST_ERROR_CHARS).map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(MOST_ERROR_CHARS).is_some() {
        tamed.push_str(" ...");
    }
    tamed
}

/// A line of a child process, beside this program's own talk.
pub(crate) fn pass_on(line: &str) {
    eprintln!("{}", tame(line));
}

impl Output {
    /// `json`: data as JSON; `quiet`: no talk, no progress.
    #[must_use]
    pub fn new(json: bool, quiet: bool) -> Self {
        Self { json, quiet }
    }

    /// Whether data is wanted as JSON.
    #[must_use]
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Data: `value` as JSON where that is wanted, else the text. A reader that has gone away is no error.
    pub fn data(&self, value: &impl Serialize, text: impl Display) {
        let line = if self.json { serde_json::to_string(value).unwrap_or_default() } else { text.to_string() };
        let _ = writeln!(io::stdout(), "{}", line.trim_end());
    }

    /// Talk.
    pub fn say(&self, text: impl Display) {
        if !self.quiet {
            eprintln!("{text}");
        }
    }

    /// An error.
    pub fn error(&self, error: &impl Display) {
        let red = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
        eprintln!("{}: {}", if red { "\x1b[31merror\x1b[0m" } else { "error" }, tame(&error.to_string()));
    }

    /// A progress bar; hidden where nobody looks.
    #[must_use]
    pub fn progress(&self, total: usize, what: &'static str) -> ProgressBar {
        self.bar(total as u64, "{prefix} {bar:32} {pos}/{len}  {msg}  {eta} left").with_prefix(what)
    }

    /// A progress bar for bytes, whose number is told later; hidden where nobody looks.
    #[cfg(feature = "local")]
    #[must_use]
    pub fn bytes(&self) -> ProgressBar {
        self.bar(0, "{prefix} {bar:32} {bytes}/{total_bytes}  {bytes_per_sec}  {eta} left")
    }

    fn bar(&self, total: u64, template: &str) -> ProgressBar {
        let bar = ProgressBar::new(total);
        if self.quiet || !io::stderr().is_terminal() {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        bar.with_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_fit_for_a_terminal() {
        assert_eq!(tame("a\x1b[31mb\nc"), "a\u{fffd}[31mb\nc");
        assert_eq!(tame(&"x".repeat(5000)).chars().count(), MOST_ERROR_CHARS + 4);
    }
}
