//! Reads the output of a child process or a socket up to a size limit, and makes it safe to show to a person.

use std::{
    borrow::Cow,
    io::{BufRead, Read},
    sync::Arc,
};

/// Receives each line that a platform prints in addition to its answers, for example the error output of a world program.
/// The lines have no control characters.
pub type OutputListener = Arc<dyn Fn(&str) + Send + Sync>;

/// The outcome of reading one line from a pipe.
#[derive(Debug, PartialEq, Eq)]
pub enum OutputLine {
    /// A line without its end.
    Whole(Vec<u8>),
    /// Bytes without the end of a line, because the pipe ended.
    Half(Vec<u8>),
    /// A line that is longer than the limit.
    TooLong,
    /// The pipe's end.
    End,
}

/// Reads the next line, up to `max_bytes` of it.
#[must_use]
pub fn read_line(from: &mut impl BufRead, max_bytes: usize) -> OutputLine {
    let mut line = Vec::new();
    // A pipe that cannot be read any more has ended, whatever the reason is.
    let read = from.take(max_bytes as u64 + 1).read_until(b'\n', &mut line);
    match line.last() {
        _ if read.is_err() => OutputLine::End,
        None => OutputLine::End,
        Some(b'\n') => {
            line.pop();
            OutputLine::Whole(line)
        }
        Some(_) if line.len() > max_bytes => OutputLine::TooLong,
        Some(_) => OutputLine::Half(line),
    }
}

/// Whether a character is invisible and yet changes a terminal or the text around it: it moves the cursor, changes the
/// direction of writing, or has no width. The two joiners are an exception: they have no width either, but words of
/// Hindi, Telugu or Persian need them. [`show_unseen`] shows them where no such word can be.
#[must_use]
pub fn is_unseen(c: char) -> bool {
    c.is_control()
        || matches!(c,
            // Soft hyphen, and characters that only join, separate or reverse others (Unicode's category Cf).
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}'
            // Tags and further selectors of variants, in which a whole text can hide.
            | '\u{e0000}'..='\u{e0fff}'
            // Letters and marks without a shape.
            | '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{3164}' | '\u{ffa0}'
            // Ends of lines and paragraphs.
            | '\u{2028}' | '\u{2029}')
}

/// A text in which unseen characters are shown by their numbers, as in `\u{202e}`, so that a reader sees what is there. Ends of lines
/// and tabs stay, and so do joiners within words of scripts that need them.
#[must_use]
pub fn show_unseen(text: &str) -> Cow<'_, str> {
    let is_joiner = |c: char| matches!(c, '\u{200c}' | '\u{200d}');
    if !text.chars().any(|c| is_joiner(c) || is_unseen(c) && !matches!(c, '\n' | '\t')) {
        return Cow::Borrowed(text);
    }
    let (mut shown, mut before) = (String::with_capacity(text.len()), ' ');
    for c in text.chars() {
        let is_hidden = if is_joiner(c) { before.is_ascii() } else { is_unseen(c) && !matches!(c, '\n' | '\t') };
        if is_hidden {
            shown.extend(c.escape_unicode());
        } else {
            shown.push(c);
        }
        before = c;
    }
    Cow::Owned(shown)
}

/// A text without characters that could move a cursor, break a line or reverse it, cut to `max_chars` characters.
#[must_use]
pub fn to_safe_text(text: &str, max_chars: usize) -> String {
    text.chars().filter(|c| !is_unseen(*c)).take(max_chars).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn to_safe_text_removes_characters_that_reverse_or_hide_text() {
        assert_eq!(to_safe_text("a\u{202e}b\u{200b}c\u{1b}[31m\u{2066}d\u{feff}", 100), "abc[31md");
        assert_eq!(to_safe_text("Stra\u{df}e \u{4e2d} \u{627}", 100), "Stra\u{df}e \u{4e2d} \u{627}");
    }

    #[test]
    fn to_safe_text_keeps_joiners_for_words_that_need_them() {
        // Persian "I want" and a Hindi half letter.
        for word in ["\u{645}\u{6cc}\u{200c}\u{62e}\u{648}\u{627}\u{647}\u{645}", "\u{915}\u{94d}\u{200d}\u{937}"] {
            assert_eq!(to_safe_text(word, 100), word);
        }
        assert_eq!(to_safe_text("a\u{200b}b\u{200e}c\u{200f}d", 100), "abcd");
    }

    #[test]
    fn show_unseen_shows_what_hides_and_keeps_what_words_need() {
        for (text, shown) in [
            ("turn \u{202e}tfel\u{2069}\u{200b}!\n\t", "turn \\u{202e}tfel\\u{2069}\\u{200b}!\n\t"),
            ("a\u{1b}[31mb\r\u{7f}\u{9b}", "a\\u{1b}[31mb\\u{d}\\u{7f}\\u{9b}"),
            ("pass\u{200d}word\u{e0041}\u{e0100}\u{3164}", "pass\\u{200d}word\\u{e0041}\\u{e0100}\\u{3164}"),
        ] {
            assert_eq!(show_unseen(text), shown);
        }
        for text in ["caf\u{e9} \u{4e2d}\u{6587} \u{627}", "\u{915}\u{94d}\u{200d}\u{937}", "\u{2764}\u{fe0f}"] {
            assert_eq!(show_unseen(text), text);
        }
    }

    #[test]
    fn read_line_stops_at_its_limit_and_reports_half_lines() {
        let mut pipe = Cursor::new(b"one\n\ntwelve chars\nhalf".to_vec());
        assert_eq!(read_line(&mut pipe, 12), OutputLine::Whole(b"one".to_vec()));
        assert_eq!(read_line(&mut pipe, 12), OutputLine::Whole(Vec::new()));
        assert_eq!(
            read_line(&mut pipe, 12),
            OutputLine::Whole(b"twelve chars".to_vec()),
            "the end of a line does not count"
        );
        assert_eq!(read_line(&mut pipe, 12), OutputLine::Half(b"half".to_vec()));
        assert_eq!(read_line(&mut pipe, 12), OutputLine::End);
        assert_eq!(read_line(&mut Cursor::new(b"thirteen char\n"), 12), OutputLine::TooLong);
        assert_eq!(read_line(&mut std::io::BufReader::new(std::io::repeat(b'x')), 12), OutputLine::TooLong);
    }
}
