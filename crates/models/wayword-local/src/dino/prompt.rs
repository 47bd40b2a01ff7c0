//! Puts phrases into the prompts of the Grounding DINO family: `a red door. stairs.`, in lower case, each phrase closed
//! by a dot.
//!
//! Phrases do not see each other in the text encoder: a token sees the tokens of its own phrase and the dot that closes
//! it, and positions count from 0 again after each dot. But all phrases change the picture's features, so the scores of
//! a phrase depend on the other phrases of its prompt.

use crate::{LocalError, tokenizer::TextTokenizer};
use candle_core::{Device, Result as Computed, Tensor};
use std::ops::Range;

/// BERT's ids of the first and the last token of a text, of a dot and of a question mark. The checkpoints of the family
/// know them by number.
const CLS_TOKEN_ID: u32 = 101;
const SEP_TOKEN_ID: u32 = 102;
const DOT_TOKEN_ID: u32 = 1012;
const QUESTION_MARK_TOKEN_ID: u32 = 1029;

/// One text of one or more phrases.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct DinoPrompt {
    pub(super) ids: Vec<u32>,
    /// For each phrase its number among all phrases, and the range of its tokens, without the dot.
    pub(super) phrases: Vec<(usize, Range<usize>)>,
}

impl DinoPrompt {
    fn new() -> Self {
        Self { ids: vec![CLS_TOKEN_ID], phrases: Vec::new() }
    }

    fn push_phrase(&mut self, phrase: usize, ids: &[u32]) {
        let begin = self.ids.len();
        self.ids.extend_from_slice(ids);
        self.phrases.push((phrase, begin..self.ids.len()));
        self.ids.push(DOT_TOKEN_ID);
    }

    /// The length of the prompt, tokens, if a phrase of `more` tokens, its dot and the last token were added.
    fn length_with(&self, more: usize) -> usize {
        self.ids.len() + more + 2
    }

    fn close_prompt(mut self) -> Self {
        self.ids.push(SEP_TOKEN_ID);
        self
    }

    /// The position of each token within its phrase. The first and the last token of the prompt have position 0.
    pub(super) fn token_places(&self) -> Vec<u32> {
        let mut places = vec![0; self.ids.len()];
        for (_, tokens) in &self.phrases {
            for (place, at) in (tokens.start..=tokens.end).enumerate() {
                places[at] = place as u32;
            }
        }
        places
    }

    /// The mask [tokens, tokens] that is added to attention scores: 0 where a token sees another one, else -inf.
    pub(super) fn attention_mask(&self, device: &Device) -> Computed<Tensor> {
        let count = self.ids.len();
        let mut phrase_of: Vec<usize> = (0..count).collect();
        for (_, tokens) in &self.phrases {
            phrase_of[tokens.start..=tokens.end].fill(tokens.end);
        }
        let sees = |at: usize| if phrase_of[at / count] == phrase_of[at % count] { 0.0 } else { f32::NEG_INFINITY };
        Tensor::from_vec((0..count * count).map(sees).collect(), (count, count), device)
    }
}

/// Puts all phrases, in their order, into as few prompts as possible, with at most `longest` tokens each. A phrase
/// without tokens is in none. Dots and question marks within a phrase are left out, because they would cut it in two.
/// `name` is the model's name, for errors.
///
/// # Errors
/// When a phrase alone is too long.
pub(super) fn build_prompts(
    name: &str,
    tokenizer: &TextTokenizer,
    phrases: &[&str],
    longest: usize,
) -> Result<Vec<DinoPrompt>, LocalError> {
    let mut prompts = Vec::new();
    let mut open = DinoPrompt::new();
    for (at, phrase) in phrases.iter().enumerate() {
        let mut ids = tokenizer.inner_ids(&phrase.trim().to_lowercase())?;
        ids.retain(|id| ![CLS_TOKEN_ID, SEP_TOKEN_ID, DOT_TOKEN_ID, QUESTION_MARK_TOKEN_ID].contains(id));
        if ids.is_empty() {
            continue;
        }
        if DinoPrompt::new().length_with(ids.len()) > longest {
            return Err(LocalError::Compute {
                model: name.to_owned(),
                problem: format!(
                    "a phrase of {} tokens is too long, {} are the most: {phrase:?}",
                    ids.len(),
                    longest - 3
                ),
            });
        }
        if open.length_with(ids.len()) > longest {
            prompts.push(std::mem::replace(&mut open, DinoPrompt::new()).close_prompt());
        }
        open.push_phrase(at, &ids);
    }
    if !open.phrases.is_empty() {
        prompts.push(open.close_prompt());
    }
    Ok(prompts)
}
