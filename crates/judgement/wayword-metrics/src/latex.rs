//! Text in the LaTeX tables that comparisons and studies write.

/// Escapes text for LaTeX.
#[must_use]
pub fn escape_latex(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '|' => escaped.push_str("\\textbar{}"),
            '"' => escaped.push_str("\\textquotedbl{}"),
            '†' => escaped.push_str("\\textdagger{}"),
            '−' => escaped.push_str("$-$"),
            '≥' => escaped.push_str("$\\geq$"),
            '…' => escaped.push_str("\\ldots{}"),
            // At the beginning of a table row, `[` would begin an option of the `\\` before it.
            '[' => escaped.push_str("{[}"),
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => escaped.extend(['\\', c]),
            char::REPLACEMENT_CHARACTER => escaped.push('?'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escape_latex_leaves_no_command() {
        assert_eq!(escape_latex(r"50 % of \input{a}"), r"50 \% of \textbackslash{}input\{a\}");
        assert_eq!(escape_latex("[a]_1 ≥ −2 †"), r"{[}a]\_1 $\geq$ $-$2 \textdagger{}");
    }
}
