//! Makes untrusted text safe for a prompt: one line, no angle brackets, bounded length. Otherwise an instruction could close the
//! marks around it and pose as a part of the prompt.

/// A text as one line without angle brackets, so that it cannot end its marks in a prompt.
pub(crate) fn one_line(text: &str) -> String {
    text.split(|c: char| c.is_whitespace() || c.is_control() || matches!(c, '<' | '>'))
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

/// As [`one_line`], but cut after `most_chars` characters. A text that was cut ends in " ...".
pub(crate) fn shorten_line(text: &str, most_chars: usize) -> String {
    let line = one_line(text);
    match line.char_indices().nth(most_chars) {
        Some((at, _)) => format!("{} ...", &line[..at]),
        None => line,
    }
}
