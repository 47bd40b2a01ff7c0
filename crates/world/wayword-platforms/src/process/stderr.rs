//! Reads a child's standard error. Each line is passed on at once, and the last lines are stored for error messages.

use std::{
    collections::VecDeque,
    io::{BufRead, BufReader, Read},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_world::output_lines::{OutputListener, to_safe_text};

/// Number of last lines that are stored for error messages.
const MAX_STORED_LINES: usize = 12;
/// Most characters of a line that are passed on and stored.
const MAX_LINE_CHARS: usize = 400;
/// Most lines of one child that are passed on. Later lines are not passed on, but the last ones are still stored.
const MAX_HEARD_LINES: usize = 2000;

/// The last lines of a child's standard error.
#[derive(Clone, Default)]
pub(crate) struct LastWords(Arc<Mutex<VecDeque<String>>>);

impl LastWords {
    /// Reads until the pipe ends.
    pub(crate) fn listen(&self, pipe: impl Read, hear: &OutputListener) {
        let mut pipe = BufReader::new(pipe);
        let mut heard = 0;
        loop {
            let mut line = Vec::new();
            // A longer line is read in pieces.
            let read = (&mut pipe).take(4 * MAX_LINE_CHARS as u64).read_until(b'\n', &mut line);
            if !matches!(read, Ok(1..)) {
                return;
            }
            let line = to_safe_text(&String::from_utf8_lossy(&line), MAX_LINE_CHARS);
            heard += 1;
            if heard <= MAX_HEARD_LINES {
                hear(&line);
            } else if heard == MAX_HEARD_LINES + 1 {
                hear("(further lines of this program are not shown)");
            }
            self.keep_line(line);
        }
    }

    fn keep_line(&self, line: String) {
        if line.trim().is_empty() {
            return;
        }
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        lines.push_back(line);
        if lines.len() > MAX_STORED_LINES {
            lines.pop_front();
        }
    }

    /// The lines, in the form for the end of an error message; empty if there are none.
    pub(crate) fn in_words(&self) -> String {
        let lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if lines.is_empty() {
            return String::new();
        }
        let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
        format!("; its last error output: {}", lines.join(" | "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stderr_passes_on_the_first_lines_and_stores_the_last() {
        let (words, heard) = (LastWords::default(), Arc::new(Mutex::new(Vec::new())));
        let hear: OutputListener = {
            let heard = Arc::clone(&heard);
            Arc::new(move |line: &str| heard.lock().unwrap().push(line.to_owned()))
        };
        let said: String = (0..5000).map(|n| format!("line {n}\u{1b}[2J\n\n")).collect();
        words.listen(said.as_bytes(), &hear);
        let heard = heard.lock().unwrap();
        assert_eq!((heard.len(), heard[0].as_str()), (MAX_HEARD_LINES + 1, "line 0[2J"));
        let words = words.in_words();
        assert!(words.contains("line 4999") && words.contains("line 4988") && !words.contains("line 4987"), "{words}");
    }
}
