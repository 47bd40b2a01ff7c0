//! Denials: what an instruction says not to do, or says is not there.

use super::tokens::Tokens;

/// For each token, whether it follows a "not" of its clause: "do not turn right", "without going up the stairs".
pub(super) fn denied(tokens: Tokens<'_>, clauses: &[usize]) -> Vec<bool> {
    let mut denied = false;
    let mut clause = 0;
    let is_denied = |at: usize| {
        let word = tokens.word(at);
        if clauses[at] != clause || matches!(word, "but" | "until" | "till") {
            (denied, clause) = (false, clauses[at]);
        }
        let replaced = matches!(word, "instead" | "rather") && matches!(tokens.word(at + 1), "of" | "than");
        denied |= replaced
            || matches!(word, "not" | "never" | "without" | "neither" | "nor" | "avoid" | "cannot" | "dont")
            || word.ends_with("n't")
            || word.ends_with("n’t");
        denied
    };
    (0..tokens.len()).map(is_denied).collect()
}
