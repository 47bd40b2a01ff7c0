//! The tokens of a language model: their spellings, their kinds, and which of them end a reply.

use super::file::GgufFile;
use crate::LocalError;
use std::collections::{BTreeMap, BTreeSet};

/// Tokens that end a turn, by the names that models give them; files name only one of them as the end.
const ENDS: &[&str] =
    &["<|im_end|>", "<|eot_id|>", "<|eom_id|>", "<|end_of_text|>", "<|endoftext|>", "<|end|>", "<end_of_turn>", "</s>"];
/// Where a file says which tokens end a reply.
const END_KEYS: &[&str] = &["eos_token_id", "eot_token_id", "eom_token_id"];
/// Most tokens that steer a model: Llama 3 has 256.
const MOST_CONTROLS: usize = 1 << 13;

/// What a token stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A piece of text.
    Piece,
    /// A byte, as `<0x0A>`.
    Byte,
    /// A text that is always one token.
    Whole,
    /// It steers the model and is never said.
    Control,
}

/// How pieces are spelt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spelling {
    /// A letter for each byte, as GPT-2 has it.
    Bytes,
    /// As they are, with `▁` for a space, as sentencepiece has it.
    Spaces,
}

/// The tokens.
pub(super) struct Vocabulary {
    pub(super) tokens: Vec<String>,
    pub(super) kinds: Vec<Kind>,
    pub(super) spelling: Spelling,
    /// What stands before a text, and what ends a reply, as templates name them.
    pub(super) begin: Option<u32>,
    pub(super) end: Option<u32>,
    /// All that end a reply.
    pub(super) ends: BTreeSet<u32>,
    letters: BTreeMap<char, u8>,
}

impl Vocabulary {
    /// Reads them, for a model with so many scores.
    ///
    /// # Errors
    /// When the metadata has none, too many, or what does not fit.
    pub(super) fn read(file: &GgufFile, scores: usize) -> Result<Self, LocalError> {
        let key = |rest: &str| format!("tokenizer.ggml.{rest}");
        let spelling = match file.text(&key("model"))? {
            Some("gpt2") => Spelling::Bytes,
            Some("llama") => Spelling::Spaces,
            other => {
                let other = other.unwrap_or("(none)");
                return Err(file.wrong(format!("tokenizer.ggml.model: {other} is not known, only gpt2 and llama")));
            }
        };
        let tokens = file.texts(&key("tokens"))?.ok_or_else(|| file.wrong("tokenizer.ggml.tokens is missing"))?;
        if tokens.is_empty() || tokens.len() > scores {
            let problem = format!("{}: {} for a model that scores {scores}", key("tokens"), tokens.len());
            return Err(file.wrong(problem));
        }
        let kinds = match file.numbers(&key("token_type"))? {
            None => vec![Kind::Piece; tokens.len()],
            Some(kinds) if kinds.len() == tokens.len() => kinds.iter().map(|&kind| Kind::of(kind)).collect(),
            Some(kinds) => {
                return Err(file.wrong(format!("{}: {} for {} tokens", key("token_type"), kinds.len(), tokens.len())));
            }
        };
        let id = |name: &str| -> Result<Option<u32>, LocalError> {
            Ok(file.whole(&key(name), 0, tokens.len() - 1)?.map(|id| id as u32))
        };
        let mut vocabulary = Self {
            tokens: tokens.to_vec(),
            kinds,
            spelling,
            begin: id("bos_token_id")?,
            end: id("eos_token_id")?,
            ends: BTreeSet::new(),
            letters: (0..=u8::MAX).map(|byte| (letter(byte), byte)).collect(),
        };
        for name in END_KEYS {
            vocabulary.ends.extend(id(name)?);
        }
        vocabulary.mark_special();
        if vocabulary.controls().count() > MOST_CONTROLS {
            return Err(file.wrong(format!("{}: more than {MOST_CONTROLS} steer the model", key("token_type"))));
        }
        Ok(vocabulary)
    }

    /// Begin and ends steer the model, whatever the file says of their kind.
    fn mark_special(&mut self) {
        let named = self.tokens.iter().enumerate().filter(|(_, token)| ENDS.contains(&&token[..]));
        self.ends.extend(named.map(|(at, _)| at as u32));
        for &id in self.ends.iter().chain(&self.begin) {
            if let Some(kind) = self.kinds.get_mut(id as usize) {
                *kind = Kind::Control;
            }
        }
    }

    /// Spellings of the tokens that steer the model.
    pub(super) fn controls(&self) -> impl Iterator<Item = &str> {
        let kinds = self.kinds.iter().zip(&self.tokens);
        kinds.filter(|(kind, token)| **kind == Kind::Control && !token.is_empty()).map(|(_, token)| &token[..])
    }

    /// How a token is spelt.
    pub(super) fn spelt(&self, id: Option<u32>) -> &str {
        id.and_then(|id| self.tokens.get(id as usize)).map_or("", |token| &token[..])
    }

    pub(super) fn has(&self, token: &str) -> bool {
        self.tokens.iter().any(|one| one == token)
    }

    /// What a token says, in bytes that may be a part of a letter.
    pub(super) fn bytes(&self, id: u32) -> Vec<u8> {
        let token = self.spelt(Some(id));
        let pieces = |token: &str| match self.spelling {
            Spelling::Bytes => self.bytes_of_letters(token),
            Spelling::Spaces => token.replace('▁', " ").into_bytes(),
        };
        match self.kinds.get(id as usize) {
            None | Some(Kind::Control) => Vec::new(),
            Some(Kind::Whole) => token.as_bytes().to_vec(),
            Some(Kind::Byte) => byte(token).map_or_else(|| pieces(token), |byte| vec![byte]),
            Some(Kind::Piece) => pieces(token),
        }
    }

    fn bytes_of_letters(&self, token: &str) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(token.len());
        for letter in token.chars() {
            match self.letters.get(&letter) {
                Some(&byte) => bytes.push(byte),
                None => bytes.extend(letter.encode_utf8(&mut [0; 4]).bytes()),
            }
        }
        bytes
    }
}

impl Kind {
    /// By llama.cpp's numbers: unknown (2) and unused (5) tokens say nothing either.
    fn of(kind: f64) -> Self {
        match kind as i64 {
            2 | 3 | 5 => Self::Control,
            4 => Self::Whole,
            6 => Self::Byte,
            _ => Self::Piece,
        }
    }
}

/// The byte of `<0x0A>`.
fn byte(token: &str) -> Option<u8> {
    u8::from_str_radix(token.strip_prefix("<0x")?.strip_suffix('>')?, 16).ok()
}

/// The letter that GPT-2 writes for a byte: itself where it can be printed, else one from 256 on.
fn letter(byte: u8) -> char {
    let printed = |byte: u8| matches!(byte, b'!'..=b'~' | 0xa1..=0xac | 0xae..=0xff);
    if printed(byte) {
        return char::from(byte);
    }
    let before = (0..byte).filter(|&byte| !printed(byte)).count() as u32;
    char::from_u32(256 + before).unwrap_or(char::REPLACEMENT_CHARACTER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_bytes_are_gpt_2s() {
        let expected = [(b'A', 'A'), (b' ', 'Ġ'), (b'\n', 'Ċ'), (0, 'Ā'), (0x7f, 'ġ'), (0xad, 'Ń'), (0xff, 'ÿ')];
        expected.into_iter().for_each(|(byte, expected)| assert_eq!(letter(byte), expected, "{byte:#x}"));
        let all: BTreeSet<char> = (0..=u8::MAX).map(letter).collect();
        assert_eq!(all.len(), 256);
    }

    #[test]
    fn bytes_have_two_digits_at_most() {
        assert_eq!(byte("<0x0A>"), Some(10));
        [byte("<0x>"), byte("<0x100>"), byte("0x0A"), byte("<0x0A")]
            .into_iter()
            .for_each(|none| assert_eq!(none, None));
    }
}
