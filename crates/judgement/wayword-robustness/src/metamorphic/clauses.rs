//! The clauses of a text with the frames of which they speak.

use super::Written;
use std::ops::RangeInclusive;
use wayword_core::MentionKind;
use wayword_language::{reading, text::tokens};

/// A part of a sentence, as the reader takes texts apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Clause {
    /// Its words in lower case, without what joins it to the clause before.
    pub(super) words: String,
    /// The first and the last frame of which it may speak: those of its mentions, where it ends with a thing up to the next turn
    /// or room, and, where it has no mention, those from the clause before it to the one behind it.
    pub(super) frames: RangeInclusive<usize>,
}

impl Clause {
    /// Whether it speaks of one of these frames.
    pub(super) fn speaks_of(&self, frames: &[usize]) -> bool {
        frames.iter().any(|frame| self.frames.contains(frame))
    }
}

/// The clauses of a text, in order. Those without words of their own are left out.
pub(super) fn clauses(written: Written<'_>) -> Vec<Clause> {
    let tokens = tokens(written.text);
    let numbers = reading::clauses(&tokens);
    let mut parts: Vec<(usize, Vec<&str>, [usize; 2])> = Vec::new();
    for (token, number) in tokens.iter().zip(numbers) {
        match parts.last_mut() {
            Some((last, words, span)) if *last == number => {
                words.push(&token.word);
                span[1] = token.span[1];
            }
            _ => parts.push((number, vec![&token.word], token.span)),
        }
    }
    let mut told: Vec<Told> = Vec::new();
    for (_, words, span) in parts {
        let own: Vec<&str> = words.into_iter().skip_while(|word| is_joint(word)).collect();
        if own.is_empty() {
            continue;
        }
        let here = || written.mentions.iter().filter(|mention| (span[0]..span[1]).contains(&mention.span[0]));
        let frames: Vec<usize> = here().map(|mention| mention.frame).collect();
        let range = frames.iter().min().zip(frames.iter().max()).map(|(first, last)| (*first, *last));
        let is_thing = here().next_back().is_some_and(|mention| mention.kind == MentionKind::Landmark);
        told.push(Told { words: own.join(" "), range, is_thing });
    }
    (0..told.len())
        .map(|at| {
            let before = told[..at].iter().rev().find_map(|told| told.range).map_or(0, |(_, last)| last);
            let behind = told[at + 1..].iter().find_map(|told| told.range).map_or(usize::MAX, |(first, _)| first);
            let mut later = told[at + 1..].iter().filter(|told| !told.is_thing);
            let fixed = later.find_map(|told| told.range).map_or(usize::MAX, |(first, _)| first);
            let (first, last) = match told[at].range {
                // A thing is mapped to the first frame that shows it, and may be reached only later.
                Some((first, last)) if told[at].is_thing => (first, last.max(fixed)),
                Some(range) => range,
                None => (before.min(behind), before.max(behind)),
            };
            Clause { words: told[at].words.clone(), frames: first..=last }
        })
        .collect()
}

/// A clause in the making: its words, the first and last frame of its mentions, and whether the last of these is a thing.
struct Told {
    words: String,
    range: Option<(usize, usize)>,
    is_thing: bool,
}

fn is_joint(word: &str) -> bool {
    matches!(word, "and" | "then") || !word.starts_with(char::is_alphanumeric)
}

/// The first of the clauses that speak of none of these frames and that the other text does not have, in order.
pub(super) fn lost(of: &[Clause], in_other: &[Clause], may_change: &[usize]) -> Option<String> {
    let mut rest = in_other.iter();
    let kept = of.iter().filter(|clause| !clause.speaks_of(may_change));
    kept.into_iter().find(|clause| !rest.any(|other| other.words == clause.words)).map(|clause| clause.words.clone())
}
