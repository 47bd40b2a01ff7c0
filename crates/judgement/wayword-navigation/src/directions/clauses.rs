//! Splits a text into clauses. It takes the clauses of the language reader and joins those that the reader separated at an "and" or a
//! mark within a noun phrase ("a white couch and stripey chairs").

use std::{collections::BTreeSet, ops::Range};
use wayword_language::{
    directions::{AFTER_VERB, JOINING, TELLING},
    reading::{clause_numbers, read_instruction},
    text::{TextToken, split_tokens},
};

/// A clause, as ranges of tokens without the words and marks that join it to others.
#[derive(Debug, Clone)]
pub(super) struct MendedClause {
    /// The whole clause.
    pub(super) all: Range<usize>,
    /// Without the parts that only describe a place further.
    pub(super) head: Range<usize>,
}

/// The clauses of a text that have words. `numbers` has the reader's number of each token's clause.
pub(super) fn mend_clauses(text: &str, tokens: &[TextToken], numbers: &[usize]) -> Vec<MendedClause> {
    let ranges = clause_ranges(tokens, numbers);
    let mut mended: Vec<MendedClause> = Vec::new();
    for (at, range) in ranges.iter().enumerate() {
        let continues = || {
            let from = at.checked_sub(1).map_or(0, |before| ranges[before].end);
            continues_clause(tokens, from..range.start, range)
                || (at + 1 < ranges.len() && is_adjective(text, tokens, from, range))
        };
        match mended.last_mut() {
            Some(before) if continues() => before.all.end = range.end,
            _ => mended.push(MendedClause { all: range.clone(), head: range.clone() }),
        }
    }
    mended
}

/// The clauses of a text in its own words, without the words and marks that join them.
pub(crate) fn clause_texts(text: &str) -> Vec<&str> {
    let tokens = split_tokens(text);
    let words = |clause: MendedClause| &text[tokens[clause.all.start].span[0]..tokens[clause.all.end - 1].span[1]];
    mend_clauses(text, &tokens, &clause_numbers(&tokens)).into_iter().map(words).collect()
}

/// Whether a text by itself ends in a task.
pub(super) fn ends_in_task(text: &str) -> bool {
    read_instruction(text, &BTreeSet::new()).task.is_some()
}

/// Whether the second word of a clause is one that follows a verb.
pub(super) fn has_object(tokens: &[TextToken], clause: &Range<usize>) -> bool {
    clause.len() > 1 && AFTER_VERB.contains(&tokens[clause.start + 1].word.as_str())
}

/// Whether a clause continues the one before: no mark ends the one before, and either no word joins the two or the clause begins by
/// describing a place further. `between` is the tokens between the two.
fn continues_clause(tokens: &[TextToken], between: Range<usize>, clause: &Range<usize>) -> bool {
    let between = &tokens[between];
    let is_mark = |token: &TextToken| matches!(token.word.as_str(), "." | "!" | "?" | "," | ";" | ":");
    let has_word = between.iter().any(TextToken::is_word);
    let describes = TELLING.contains(&tokens[clause.start].word.as_str());
    !between.iter().any(is_mark) && (describes || !has_word)
}

/// Whether the first word of a clause, which the reader takes for a verb, is an adjective: "stripey" in "with a white couch and
/// stripey chairs". The clause before ends at token `from`.
fn is_adjective(text: &str, tokens: &[TextToken], from: usize, clause: &Range<usize>) -> bool {
    tokens[from..clause.start].iter().all(|token| token.word == "and")
        && !has_object(tokens, clause)
        && ends_in_task(&text[tokens[clause.start].span[0]..tokens[clause.end - 1].span[1]])
}

/// The reader's clauses that have words, as ranges of tokens without the words and marks that join them.
fn clause_ranges(tokens: &[TextToken], numbers: &[usize]) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut from = 0;
    for clause in numbers.chunk_by(|a, b| a == b) {
        let mut range = from..from + clause.len();
        from = range.end;
        range.start += tokens[range.clone()].iter().take_while(|token| is_joint(token)).count();
        if !range.is_empty() {
            ranges.push(without_joints(tokens, range));
        }
    }
    ranges
}

/// A range without the words and marks at its end that join it to what follows.
pub(super) fn without_joints(tokens: &[TextToken], mut range: Range<usize>) -> Range<usize> {
    while range.len() > 1 && is_joint(&tokens[range.end - 1]) {
        range.end -= 1;
    }
    range
}

/// Whether a token is a mark or a word that joins clauses.
fn is_joint(token: &TextToken) -> bool {
    !token.is_word() || JOINING.contains(&token.word.as_str())
}
