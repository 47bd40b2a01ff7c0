//! Turns texts into token ids and back, with a checkpoint's `tokenizer.json`.

use crate::{LocalError, error::FETCH_AGAIN};
use std::path::{Path, PathBuf};
use wayword_core::contain_panics::run_decoder;

/// The longest `tokenizer.json` that is read, bytes. A longer one is refused.
const MAX_TOKENIZER_BYTES: u64 = 64 << 20;

/// The begin and end of a token in a text, bytes.
pub(crate) type TokenSpan = (usize, usize);

/// A checkpoint's tokenizer.
pub(crate) struct TextTokenizer {
    file: PathBuf,
    inner: tokenizers::Tokenizer,
}

impl TextTokenizer {
    /// Reads `tokenizer.json` of a model's folder. Padding and truncation are turned off.
    ///
    /// # Errors
    /// When it is missing or damaged.
    pub(crate) fn load(folder: &Path) -> Result<Self, LocalError> {
        Self::load_file(folder.join("tokenizer.json"))
    }

    /// Like [`TextTokenizer::load`], for a file of any name.
    pub(crate) fn load_file(file: PathBuf) -> Result<Self, LocalError> {
        let metadata = std::fs::metadata(&file).map_err(|_| LocalError::Missing {
            file: file.clone(),
            what: "the tokenizer",
            hint: "fetch the whole model: wayword models fetch NAME".to_owned(),
        })?;
        let wrong = |problem: String| LocalError::File { file: file.clone(), problem, hint: FETCH_AGAIN };
        if metadata.len() > MAX_TOKENIZER_BYTES {
            return Err(wrong(format!("it is too long for a tokenizer: {} bytes", metadata.len())));
        }
        if file.extension().is_none_or(|ending| ending != "json") {
            return Err(wrong("it is no tokenizer.json; a vocabulary alone does not say how words are cut".to_owned()));
        }
        let read = || tokenizers::Tokenizer::from_file(&file).map_err(|error| error.to_string());
        let mut inner = run_decoder(read).map_err(wrong)?;
        inner.with_padding(None);
        inner.with_truncation(None).map_err(|error| wrong(error.to_string()))?;
        Ok(Self { file, inner })
    }

    /// The ids of a text, with the special ids that the tokenizer puts around it. If there are more than
    /// `max_ids`, the text is cut, and the last id is still the one that ends a text.
    pub(crate) fn text_ids(&self, text: &str, max_ids: usize) -> Result<Vec<u32>, LocalError> {
        let encoding = self.inner.encode(text, true).map_err(|error| self.file_error(&error.to_string()))?;
        let mut ids = encoding.get_ids().to_vec();
        if let Some(&end) = ids.get(max_ids.max(1)..).and_then(<[u32]>::last) {
            ids.truncate(max_ids);
            if let Some(last) = ids.last_mut() {
                *last = end;
            }
        }
        Ok(ids)
    }

    /// The ids of a text with the special ones, and for each id the bytes of the text that it comes from. The span of a
    /// special id is empty.
    pub(crate) fn ids_and_spans(&self, text: &str) -> Result<(Vec<u32>, Vec<TokenSpan>), LocalError> {
        let encoding = self.inner.encode(text, true).map_err(|error| self.file_error(&error.to_string()))?;
        Ok((encoding.get_ids().to_vec(), encoding.get_offsets().to_vec()))
    }

    /// The number of tokens of the vocabulary.
    pub(crate) fn vocabulary_size(&self) -> usize {
        self.inner.get_vocab_size(true)
    }

    /// The ids of a text, without the special ids that mark its beginning and end.
    pub(crate) fn inner_ids(&self, text: &str) -> Result<Vec<u32>, LocalError> {
        let encoding = self.inner.encode(text, false).map_err(|error| self.file_error(&error.to_string()))?;
        Ok(encoding.get_ids().to_vec())
    }

    /// The id of a token; `None` if the vocabulary lacks it.
    pub(crate) fn token_id(&self, token: &str) -> Option<u32> {
        self.inner.token_to_id(token)
    }

    /// The text of ids, without the special ones.
    pub(crate) fn decode_ids(&self, ids: &[u32]) -> Result<String, LocalError> {
        let text = self.inner.decode(ids, true).map_err(|error| self.file_error(&error.to_string()))?;
        Ok(text.trim().to_owned())
    }

    /// The error for a problem with this tokenizer's file.
    pub(crate) fn file_error(&self, problem: &str) -> LocalError {
        LocalError::File { file: self.file.clone(), problem: problem.to_owned(), hint: FETCH_AGAIN }
    }
}
