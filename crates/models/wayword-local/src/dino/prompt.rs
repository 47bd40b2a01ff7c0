//! Phrases as the prompts of the family: `a red door. stairs.`, in lower case, each phrase closed by a dot.
//!
//! Phrases do not see each other in the text encoder: a token sees the tokens of its own phrase and the dot that closes
//! it, and positions begin again behind each dot. They do meet in the picture's features, so the other phrases of a
//! prompt change a phrase's scores.

use crate::{LocalError, text::Tokenizer};
use candle_core::{Device, Result as Computed, Tensor};
use std::ops::Range;

/// BERT's ids of the first and the last token of a text, of a dot and of a question mark. The checkpoints of the family
/// know them by number.
const FIRST: u32 = 101;
const LAST: u32 = 102;
const DOT: u32 = 1012;
const QUESTION: u32 = 1029;

/// Some phrases in one text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Prompt {
    pub(super) ids: Vec<u32>,
    /// For each phrase, by its place among all phrases, its tokens without the dot.
    pub(super) phrases: Vec<(usize, Range<usize>)>,
}

impl Prompt {
    fn new() -> Self {
        Self { ids: vec![FIRST], phrases: Vec::new() }
    }

    fn push(&mut self, phrase: usize, ids: &[u32]) {
        let begin = self.ids.len();
        self.ids.extend_from_slice(ids);
        self.phrases.push((phrase, begin..self.ids.len()));
        self.ids.push(DOT);
    }

    /// How many tokens it has with another phrase of `more` tokens, its dot and the last token.
    fn with(&self, more: usize) -> usize {
        self.ids.len() + more + 2
    }

    fn closed(mut self) -> Self {
        self.ids.push(LAST);
        self
    }

    /// The position of each token within its phrase. That of the first and the last token is 0.
    pub(super) fn places(&self) -> Vec<u32> {
        let mut places = vec![0; self.ids.len()];
        for (_, tokens) in &self.phrases {
            for (place, at) in (tokens.start..=tokens.end).enumerate() {
                places[at] = place as u32;
            }
        }
        places
    }

    /// What is added to the scores of attention, [tokens, tokens]: 0 where a token sees another one, else -inf.
    pub(super) fn mask(&self, device: &Device) -> Computed<Tensor> {
        let count = self.ids.len();
        let mut phrase_of: Vec<usize> = (0..count).collect();
        for (_, tokens) in &self.phrases {
            phrase_of[tokens.start..=tokens.end].fill(tokens.end);
        }
        let sees = |at: usize| if phrase_of[at / count] == phrase_of[at % count] { 0.0 } else { f32::NEG_INFINITY };
        Tensor::from_vec((0..count * count).map(sees).collect(), (count, count), device)
    }
}

/// All phrases in as few prompts as hold them in their order, with at most `longest` tokens each. A phrase without
/// letters is in none. `name` is the model's, for errors. Dots and question marks within a phrase are left out, because they would cut it in two.
///
/// # Errors
/// When a phrase alone is too long.
pub(super) fn prompts(
    name: &str,
    tokenizer: &Tokenizer,
    phrases: &[&str],
    longest: usize,
) -> Result<Vec<Prompt>, LocalError> {
    let mut done = Vec::new();
    let mut open = Prompt::new();
    for (at, phrase) in phrases.iter().enumerate() {
        let mut ids = tokenizer.inner_ids(&phrase.trim().to_lowercase())?;
        ids.retain(|id| ![FIRST, LAST, DOT, QUESTION].contains(id));
        if ids.is_empty() {
            continue;
        }
        if Prompt::new().with(ids.len()) > longest {
            return Err(LocalError::Compute {
                model: name.to_owned(),
                problem: format!(
                    "a phrase of {} tokens is too long, {} are the most: {phrase:?}",
                    ids.len(),
                    longest - 3
                ),
            });
        }
        if open.with(ids.len()) > longest {
            done.push(std::mem::replace(&mut open, Prompt::new()).closed());
        }
        open.push(at, &ids);
    }
    if !open.phrases.is_empty() {
        done.push(open.closed());
    }
    Ok(done)
}
