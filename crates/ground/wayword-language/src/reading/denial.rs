//! What a text says not to do, and not to be there.

use crate::text::Token;

/// For each token, whether it stands behind a "not" of its clause: "do not turn right", "without going up the stairs".
pub(super) fn denied(tokens: &[Token], clauses: &[usize]) -> Vec<bool> {
    let mut denied = false;
    let mut clause = 0;
    let mut is_denied = |at: usize, token: &Token| {
        let word = token.word.as_str();
        if clauses[at] != clause || matches!(word, "but" | "until" | "till") {
            (denied, clause) = (false, clauses[at]);
        }
        let replaced = matches!(word, "instead" | "rather")
            && tokens.get(at + 1).is_some_and(|next| matches!(next.word.as_str(), "of" | "than"));
        denied |= replaced
            || matches!(word, "not" | "never" | "without" | "neither" | "nor" | "avoid" | "cannot" | "dont")
            || word.ends_with("n't")
            || word.ends_with("n’t");
        denied
    };
    tokens.iter().enumerate().map(|(at, token)| is_denied(at, token)).collect()
}
