//! What a child or a socket says: read with a bound, and made harmless before a person is shown it.

use std::{
    io::{BufRead, Read},
    sync::Arc,
};

/// Who is told what a world says beside its answers, line by line, without control characters.
pub type Hear = Arc<dyn Fn(&str) + Send + Sync>;

/// What came out of a pipe.
#[derive(Debug, PartialEq, Eq)]
pub enum Line {
    /// A line without its end.
    Whole(Vec<u8>),
    /// Bytes, and then the pipe's end.
    Half(Vec<u8>),
    /// A line without an end in sight.
    TooLong,
    /// The pipe's end.
    End,
}

/// The next line. No more than `max_bytes` of it are ever held.
#[must_use]
pub fn read_line(from: &mut impl BufRead, max_bytes: usize) -> Line {
    let mut line = Vec::new();
    // A pipe that cannot be read any more has ended, whatever the reason is.
    let read = from.take(max_bytes as u64 + 1).read_until(b'\n', &mut line);
    match line.last() {
        _ if read.is_err() => Line::End,
        None => Line::End,
        Some(b'\n') => {
            line.pop();
            Line::Whole(line)
        }
        Some(_) if line.len() > max_bytes => Line::TooLong,
        Some(_) => Line::Half(line),
    }
}

/// A text without what could move a cursor or break a line, and not too long.
#[must_use]
pub fn plain(text: &str, max_chars: usize) -> String {
    text.chars().filter(|c| !c.is_control()).take(max_chars).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    #[test]
    fn lines_are_cut_at_their_bound_and_half_lines_are_told_from_whole_ones() {
        let mut pipe = Cursor::new(b"one\n\ntwelve chars\nhalf".to_vec());
        assert_eq!(read_line(&mut pipe, 12), Line::Whole(b"one".to_vec()));
        assert_eq!(read_line(&mut pipe, 12), Line::Whole(Vec::new()));
        assert_eq!(read_line(&mut pipe, 12), Line::Whole(b"twelve chars".to_vec()), "the end of a line does not count");
        assert_eq!(read_line(&mut pipe, 12), Line::Half(b"half".to_vec()));
        assert_eq!(read_line(&mut pipe, 12), Line::End);
        assert_eq!(read_line(&mut Cursor::new(b"thirteen char\n"), 12), Line::TooLong);
        assert_eq!(read_line(&mut std::io::BufReader::new(std::io::repeat(b'x')), 12), Line::TooLong);
    }
}
