//! Small instruct models from GGUF files: Qwen2.5, Qwen3 and Llama.

mod decoder;
mod draw;
mod file;
mod header;
mod positions;
mod product;
mod sieve;
mod sizes;
mod template;
mod tokenizer;
mod vocabulary;

#[cfg(test)]
mod tests;

use crate::{Device, LocalError};
use decoder::Decoder;
use draw::Draw;
use file::GgufFile;
use sieve::Sieve;
use sizes::Sizes;
use std::path::Path;
use template::Template;
use tokenizer::Tokenizer;
use vocabulary::Vocabulary;
use wayword_core::{Finish, Message, Reply, Sampling};

/// Most bytes of a conversation: no model here reads so much, and tokens are made of all of it before they are counted.
const LONGEST_CONVERSATION: usize = 1 << 20;

/// A model that talks.
///
/// It keeps nothing between calls, so that a reply does not depend on what was asked before; calls may come from several threads,
/// but each uses all of the processor.
pub struct GgufModel {
    name: String,
    decoder: Decoder,
    sizes: Sizes,
    vocabulary: Vocabulary,
    tokenizer: Tokenizer,
    template: Template,
}

/// A reply, and what it took.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spoken {
    /// Its words.
    pub reply: Reply,
    /// Tokens that were read.
    pub tokens_in: u64,
    /// Tokens that were made, with thoughts and the one that ends a reply.
    pub tokens_out: u64,
}

impl GgufModel {
    /// Reads a model of one file.
    ///
    /// Quantised weights stay as they are; on the processor, weights of 16 bits take twice the memory of the file.
    ///
    /// # Errors
    /// When the file is missing, damaged, or holds another kind of model; the error names the field or tensor.
    pub fn load(file: &Path, device: &Device) -> Result<Self, LocalError> {
        let gguf = GgufFile::open(file)?;
        let sizes = Sizes::read(&gguf)?;
        let vocabulary = Vocabulary::read(&gguf, sizes.vocabulary)?;
        Ok(Self {
            name: file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned(),
            decoder: Decoder::load(&gguf, &sizes, &device.0)?,
            tokenizer: Tokenizer::read(&gguf, &vocabulary)?,
            template: Template::read(&gguf, &vocabulary)?,
            sizes,
            vocabulary,
        })
    }

    /// Goes on with a conversation. The pieces given to `on_piece` while it speaks are the reply's text, in whole letters.
    ///
    /// At temperature 0 the likeliest tokens are taken, else they are drawn by the seed among those that have 95 % of the
    /// probability. What the model thinks aloud is no part of the reply, and Qwen3 is told not to.
    ///
    /// # Errors
    /// When a message has a picture, the template refuses the conversation, or it is longer than the model can read.
    pub fn reply(
        &self,
        messages: &[Message],
        sampling: &Sampling,
        on_piece: &mut dyn FnMut(&str),
    ) -> Result<Spoken, LocalError> {
        let mut draw = Draw::new(sampling).map_err(|problem| self.wrong(problem))?;
        let (ids, thinking) = self.read(messages)?;
        let mut sieve = Sieve::new(thinking, on_piece);
        let (finish, tokens_out) = self.speak(&ids, sampling.max_tokens, &mut draw, &mut sieve)?;
        let reply = Reply { text: sieve.end(), finish };
        Ok(Spoken { reply, tokens_in: ids.len() as u64, tokens_out })
    }

    /// The tokens of a conversation, and whether it ends within a thought.
    fn read(&self, messages: &[Message]) -> Result<(Vec<u32>, bool), LocalError> {
        if messages.iter().any(|message| message.image.is_some()) {
            return Err(
                self.wrong("a message has a picture, and this model does not see; name one that does to look at it")
            );
        }
        let length = messages.iter().map(|message| message.text.len()).sum::<usize>();
        if length > LONGEST_CONVERSATION {
            return Err(self.wrong(format!("a conversation of {length} bytes is too long")));
        }
        let text =
            self.template.render(messages).map_err(|said| self.wrong(format!("its template refuses: {said}")))?;
        let ids = self.tokenizer.ids(&text).map_err(|error| self.wrong(error.to_string()))?;
        if ids.is_empty() || ids.len() >= self.sizes.context {
            let problem =
                format!("{} tokens are not from 1 to {}, which it can read", ids.len(), self.sizes.context - 1);
            return Err(self.wrong(problem));
        }
        Ok((ids, text.trim_end().ends_with("<think>")))
    }

    fn speak(
        &self,
        ids: &[u32],
        most: u32,
        draw: &mut Draw,
        sieve: &mut Sieve<'_>,
    ) -> Result<(Finish, u64), LocalError> {
        let computes = |error: candle_core::Error| self.wrong(error.to_string());
        let mut conversation = self.decoder.begin();
        let mut next = ids.to_vec();
        for made in 0..most {
            if conversation.length + next.len() > self.sizes.context {
                return Ok((Finish::Length, made.into()));
            }
            let scores = self.decoder.read(&next, &mut conversation).map_err(computes)?;
            let known = scores.get(..self.vocabulary.tokens.len()).unwrap_or_default();
            let token =
                draw.next(known).ok_or_else(|| self.wrong("its scores are not numbers: the weights are damaged"))?;
            if self.vocabulary.ends.contains(&token) || !sieve.take(&self.vocabulary.bytes(token)) {
                return Ok((Finish::Stop, u64::from(made) + 1));
            }
            next = vec![token];
        }
        Ok((Finish::Length, most.into()))
    }

    fn wrong(&self, problem: impl Into<String>) -> LocalError {
        LocalError::Compute { model: self.name.clone(), problem: problem.into() }
    }
}
