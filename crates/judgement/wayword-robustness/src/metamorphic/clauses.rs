//! Splits a text into clauses with the frames that each clause may be about, and compares the clauses of two texts.
//!
//! After a local change of the world, such as a removed lamp, only clauses about frames that see the change may differ. Most clauses
//! have mentions with frames; for the others the range is inferred from their neighbours.

use super::AnnotatedText;
use std::{collections::BTreeSet, ops::RangeInclusive};
use wayword_core::{MentionKind, TextMention};
use wayword_language::reading::{EventContent, TextReading, read_instruction};

/// A clause, as the reader of the language crate divides sentences.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FramedClause {
    /// Its words in lower case, without the conjunctions at its beginning.
    pub(super) words: String,
    /// The first and the last frame that it may be about. These are the frames of its mentions. For a room, the frame before it is
    /// included, from which one enters. If the clause ends with a thing, the range reaches up to the next turn or climb. Without
    /// mentions, it reaches from the clause before to the clause behind. A clause about stopping has the last frame.
    pub(super) frames: RangeInclusive<usize>,
    /// Whether its last mention is a thing.
    ends_with_thing: bool,
}

impl FramedClause {
    /// Whether it may be about one of these frames.
    pub(super) fn speaks_of(&self, frames: &[usize]) -> bool {
        frames.iter().any(|frame| self.frames.contains(frame))
    }
}

/// The clauses of a text, in order. Clauses of conjunctions alone are left out.
pub(super) fn clauses_with_frames(written: AnnotatedText<'_>) -> Vec<FramedClause> {
    let reading = read_instruction(written.text, &BTreeSet::new());
    // For each clause: its number, its words, and its byte range.
    let mut parts: Vec<(usize, Vec<&str>, [usize; 2])> = Vec::new();
    for (token, number) in reading.tokens().iter().zip(reading.token_clauses().iter().copied()) {
        match parts.last_mut() {
            Some((last, words, span)) if *last == number => {
                words.push(&token.word);
                span[1] = token.span[1];
            }
            _ => parts.push((number, vec![&token.word], token.span)),
        }
    }
    let stops = stop_positions(&reading);
    let mut drafts: Vec<ClauseDraft> = Vec::new();
    for (_, words, span) in parts {
        let content: Vec<&str> = words.into_iter().skip_while(|word| is_joining_word(word)).collect();
        if content.is_empty() {
            continue;
        }
        let mentions_here = || written.mentions.iter().filter(|mention| (span[0]..span[1]).contains(&mention.span[0]));
        let last = mentions_here().next_back().map(|mention| mention.kind);
        let first_frame = |mention: &TextMention| match mention.kind {
            MentionKind::Room => mention.frame.saturating_sub(1),
            _ => mention.frame,
        };
        let range = mentions_here().map(first_frame).min().zip(mentions_here().map(|mention| mention.frame).max());
        let is_stop = stops.iter().any(|stop| (span[0]..span[1]).contains(stop));
        drafts.push(match is_stop {
            true => ClauseDraft {
                words: content.join(" "),
                range: Some((written.last_frame, written.last_frame)),
                ending: ClauseEnding::Motion,
            },
            false => ClauseDraft { words: content.join(" "), range, ending: ClauseEnding::from_last_mention(last) },
        });
    }
    (0..drafts.len())
        .map(|at| {
            // A clause without mentions is about frames between those of its neighbours.
            let before = drafts[..at].iter().rev().find_map(|draft| draft.range).map_or(0, |(_, last)| last);
            let behind = drafts[at + 1..].iter().find_map(|draft| draft.range).map_or(usize::MAX, |(first, _)| first);
            let mut later = drafts[at + 1..].iter().filter(|draft| draft.ending == ClauseEnding::Motion);
            let next_motion = later.find_map(|draft| draft.range).map_or(usize::MAX, |(_, last)| last);
            let (first, last) = match drafts[at].range {
                // A mention of a thing has the first frame that shows it, but the walker may reach it only later.
                Some((first, last)) if drafts[at].ending == ClauseEnding::Thing => (first, last.max(next_motion)),
                Some(range) => range,
                None => (before.min(behind), before.max(behind)),
            };
            let ends_with_thing = drafts[at].ending == ClauseEnding::Thing;
            FramedClause { words: drafts[at].words.clone(), frames: first..=last, ends_with_thing }
        })
        .collect()
}

/// The byte positions of the words that ask the walker to stop.
fn stop_positions(reading: &TextReading) -> Vec<usize> {
    let stops = reading.events.iter().filter(|event| event.what == EventContent::Stop);
    stops.map(|event| event.span[0]).collect()
}

/// A clause before its range is final.
struct ClauseDraft {
    words: String,
    /// The first and the last frame of its mentions; `None` without mentions.
    range: Option<(usize, usize)>,
    /// The kind of its last mention.
    ending: ClauseEnding,
}

/// The kind of a clause's last mention.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ClauseEnding {
    /// A landmark.
    Thing,
    /// A turn, a climb or a stop. Its frame is known exactly.
    Motion,
    /// Anything else, or no mention.
    Other,
}

impl ClauseEnding {
    fn from_last_mention(last: Option<MentionKind>) -> Self {
        match last {
            Some(MentionKind::Landmark) => Self::Thing,
            Some(MentionKind::Turn | MentionKind::Floor) => Self::Motion,
            _ => Self::Other,
        }
    }
}

/// Whether a word only joins clauses: a conjunction or a punctuation mark.
fn is_joining_word(word: &str) -> bool {
    matches!(word, "and" | "then") || !word.starts_with(char::is_alphanumeric)
}

/// A clause that differs although it must not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum UnexpectedClause {
    /// It is missing in the changed text.
    Lost(String),
    /// The changed text has it in addition.
    New(String),
}

/// Finds the first clause that differs although it is not about any of the frames in `may_change`.
pub(super) fn find_unexpected_clause(
    before: &[FramedClause],
    after: &[FramedClause],
    may_change: &[usize],
) -> Option<UnexpectedClause> {
    let shared = shared_clauses(before, after, may_change);
    // The clauses between two shared ones are compared; the ends of both texts close the last gap.
    let ends = [(before.len(), after.len())];
    let (mut from, mut to) = (0, 0);
    for (next_from, next_to) in shared.into_iter().chain(ends) {
        let (gone, new) = (&before[from..next_from], &after[to..next_to]);
        let may_differ = |clause: &&FramedClause| clause.speaks_of(may_change);
        let is_swap = gone.len() == new.len();
        // One text may mention a turn or a place together with a thing, and the other one without it.
        let is_rewording = |clause: &&FramedClause, others: &[FramedClause]| {
            is_swap && !clause.ends_with_thing && others.iter().all(|other| may_differ(&other))
        };
        if let Some(lost) = gone.iter().find(|clause| !may_differ(clause) && !is_rewording(clause, new)) {
            return Some(UnexpectedClause::Lost(lost.words.clone()));
        }
        if let Some(added) = new.iter().find(|clause| !may_differ(clause) && !is_rewording(clause, gone)) {
            return Some(UnexpectedClause::New(added.words.clone()));
        }
        (from, to) = (next_from + 1, next_to + 1);
    }
    None
}

/// The clauses that both texts have, in order, as pairs of indices: a longest common subsequence, in which clauses that must not change
/// count more than all others together.
fn shared_clauses(before: &[FramedClause], after: &[FramedClause], may_change: &[usize]) -> Vec<(usize, usize)> {
    let worth = |clause: &FramedClause| if clause.speaks_of(may_change) { 1 } else { before.len() + 1 };
    // `best[i][j]` is the highest worth of a common subsequence of the clauses from `i` and from `j` on.
    let mut best = vec![vec![0; after.len() + 1]; before.len() + 1];
    for i in (0..before.len()).rev() {
        for j in (0..after.len()).rev() {
            let skipped = best[i + 1][j].max(best[i][j + 1]);
            let is_same = before[i].words == after[j].words;
            best[i][j] = skipped.max(if is_same { best[i + 1][j + 1] + worth(&before[i]) } else { 0 });
        }
    }
    let (mut pairs, mut i, mut j) = (Vec::new(), 0, 0);
    while i < before.len() && j < after.len() {
        if before[i].words == after[j].words && best[i][j] == best[i + 1][j + 1] + worth(&before[i]) {
            pairs.push((i, j));
            (i, j) = (i + 1, j + 1);
        } else if best[i + 1][j] >= best[i][j + 1] {
            i += 1;
        } else {
            j += 1;
        }
    }
    pairs
}
