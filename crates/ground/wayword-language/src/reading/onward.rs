//! Finds commands to walk on ("walk straight ahead").

use super::{EventContent, TextEvent, tokens::TokenSlice, vocabulary as v};

/// "Walk straight ahead", "continue through the hallway": commands that an agent cannot follow by staying at its
/// place.
pub(super) fn onward_commands(tokens: TokenSlice<'_>, clauses: &[usize]) -> Vec<TextEvent> {
    let word = |at: usize| tokens.word_at(at);
    let command_at = |verb: usize| {
        let end = (verb + 1..verb + 3).find(|at| v::ONWARD.contains(&word(*at)))?;
        let directly =
            (verb + 1..end).all(|at| matches!(word(at), "on" | "back" | "right" | "all" | "going" | "walking"));
        let span = tokens.span_of(verb, end);
        directly.then(|| TextEvent { what: EventContent::Onward, span, clause: clauses[verb], denied: false })
    };
    (0..tokens.len()).filter(|at| v::CLIMBING.contains(&word(*at))).filter_map(command_at).collect()
}
