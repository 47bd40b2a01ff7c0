//! Lines of a list that cannot be read: what they tell is left out and told, and a list of which most lines are such is refused.

use std::path::Path;

/// Most lines that a warning lists.
const MAX_TOLD_LINES: usize = 4;

/// Returns the first broken line as an error if most of the lines are broken.
pub(super) fn refuse_if_most_broken(broken_lines: &[String], read_lines: usize) -> Result<(), String> {
    match broken_lines.first() {
        Some(first) if broken_lines.len() > read_lines => Err(first.clone()),
        _ => Ok(()),
    }
}

/// The warning about lines of a file that cannot be read; `None` if there are none.
pub(super) fn describe_broken_lines(file: &Path, lines: &[String]) -> Option<String> {
    let told: Vec<&str> = lines.iter().take(MAX_TOLD_LINES).map(String::as_str).collect();
    let more = lines.len().saturating_sub(MAX_TOLD_LINES);
    let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
    (!lines.is_empty())
        .then(|| format!("{}: what these lines tell is left out: {}{rest}", file.display(), told.join("; ")))
}
