//! Escapes text from participants and files, so that it cannot act as markup, a formula or a command in any output format.

/// Longest name in a table, characters. A longer one, which a file may contain, is cut off.
const MAX_TABLE_NAME_CHARS: usize = 80;

/// Replaces characters that act instead of being seen: control characters, and those that reverse the direction of the text around
/// them. Ends of lines become `\n`, and tabs stay.
pub(super) fn strip_active_characters(text: &str) -> String {
    let lines = text.replace("\r\n", "\n").replace('\r', "\n");
    lines
        .chars()
        .map(|c| if is_active(c) && c != '\n' && c != '\t' { char::REPLACEMENT_CHARACTER } else { c })
        .collect()
}

/// Plain text on one line.
pub(super) fn to_single_line(text: &str) -> String {
    strip_active_characters(text).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A name from a file: plain, on one line, and not too long for a table.
pub(super) fn to_table_name(text: &str) -> String {
    let name = to_single_line(text);
    match name.char_indices().nth(MAX_TABLE_NAME_CHARS) {
        Some((at, _)) => format!("{}…", &name[..at]),
        None if name.is_empty() => "(no name)".to_owned(),
        None => name,
    }
}

/// Whether a character acts instead of being seen: a control, a change of the text's direction, or an invisible separator.
fn is_active(c: char) -> bool {
    let is_direction =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{061c}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_separator = matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}');
    c.is_control() || is_direction || is_separator
}

/// Escapes text for Markdown, on one line.
pub(super) fn escape_markdown(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in to_single_line(text).chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '&' => escaped.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '|' | '~' | '$' | '[' | ']' | '#' | '!' | '{' | '}' => escaped.extend(['\\', c]),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Escapes text for LaTeX, on one line.
pub(super) fn escape_latex(text: &str) -> String {
    wayword_metrics::escape_latex(&to_single_line(text))
}

/// Writes text as a cell of a CSV file (RFC 4180).
///
/// A spreadsheet would compute a cell that begins like a formula (ASVS 5.0, 1.2.10), so that cell gets an apostrophe in front. A cell
/// that already begins with an apostrophe gets one as well, so that a reader of the file can always take exactly one away.
pub(super) fn escape_csv_cell(text: &str) -> String {
    let begins_formula = |c: char| matches!(c, '=' | '+' | '-' | '@' | '＝' | '＋' | '－' | '＠' | '−' | '\'');
    let is_formula = text.starts_with(['\t', '\r', '\n', '\0']) || text.trim_start().starts_with(begins_formula);
    let text = format!("{}{}", if is_formula { "'" } else { "" }, strip_active_characters(text));
    if text.contains([',', '"', '\n', '\'', ';', '\t']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}
