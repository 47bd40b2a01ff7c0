//! Turns instructions into the token ids that navigation agents were trained on. The data loaders of VLN-DUET and
//! VLN-HAMT read instructions in this form.

use crate::{LocalError, tokenizer::TextTokenizer};
use std::path::Path;
use wayword_core::contain_panics::run_decoder;

/// The most ids that these agents read of an instruction, the first and the last token included. More are cut off.
const MAX_INSTRUCTION_IDS: usize = 512;

/// The family of a tokenizer. The agents' files are named after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TokenizerKind {
    /// BERT's: `[CLS]` before a text and `[SEP]` behind it.
    Bert,
    /// XLM-RoBERTa's: `<s>` and `</s>`.
    XlmRoberta,
}

/// Turns instructions into ids with the tokenizer of an agent.
pub struct InstructionTokenizer {
    inner: TextTokenizer,
    kind: TokenizerKind,
    /// The id of the token before every text.
    begin: u32,
    /// The id of the token behind every text.
    end: u32,
}

impl InstructionTokenizer {
    /// Reads a tokenizer from a file in the format of `tokenizer.json`.
    ///
    /// # Errors
    /// When it is missing or damaged, or has the special tokens of neither family.
    pub fn load(file: &Path) -> Result<Self, LocalError> {
        let inner = TextTokenizer::load_file(file.to_owned())?;
        let families = [(TokenizerKind::Bert, "[CLS]", "[SEP]"), (TokenizerKind::XlmRoberta, "<s>", "</s>")];
        let with_ids = |(kind, begin, end)| Some((kind, inner.token_id(begin)?, inner.token_id(end)?));
        let (kind, begin, end) = families.into_iter().find_map(with_ids).ok_or_else(|| LocalError::File {
            file: file.to_owned(),
            problem: "it has neither [CLS] and [SEP] nor <s> and </s>, one of which these agents need".to_owned(),
            hint: "give the tokenizer that the agent was trained with: that of bert-base-uncased, or of xlm-roberta-base",
        })?;
        Ok(Self { inner, kind, begin, end })
    }

    /// The family of the tokenizer.
    #[must_use]
    pub fn kind(&self) -> TokenizerKind {
        self.kind
    }

    /// The ids of a text between the family's first and last token. A text that is too long is cut, so that there are
    /// 512 ids with these two.
    ///
    /// # Errors
    /// When the tokenizer fails on the text.
    pub fn instruction_ids(&self, text: &str) -> Result<Vec<u32>, LocalError> {
        let encode = || self.inner.inner_ids(text).map_err(|error| error.to_string());
        let ids = run_decoder(encode).map_err(|problem| self.inner.file_error(&format!("on {text:?}: {problem}")))?;
        let ids = ids.into_iter().take(MAX_INSTRUCTION_IDS - 2);
        Ok([self.begin].into_iter().chain(ids).chain([self.end]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn tokenizer(begin: &str, end: &str) -> (tempfile::TempDir, std::path::PathBuf) {
        let words = [begin, end, "[UNK]", "walk", "on", "##ward"];
        let vocabulary: Value = words.iter().enumerate().map(|(id, word)| ((*word).to_owned(), json!(id))).collect();
        let file = json!({
            "version": "1.0", "truncation": {"direction": "Right", "max_length": 3, "strategy": "LongestFirst", "stride": 0},
            "padding": null, "added_tokens": [],
            "normalizer": {"type": "BertNormalizer", "clean_text": true, "handle_chinese_chars": true,
                "strip_accents": null, "lowercase": true},
            "pre_tokenizer": {"type": "BertPreTokenizer"}, "post_processor": null, "decoder": null,
            "model": {"type": "WordPiece", "unk_token": "[UNK]", "continuing_subword_prefix": "##",
                "max_input_chars_per_word": 100, "vocab": vocabulary},
        });
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("words.json");
        std::fs::write(&path, file.to_string()).unwrap();
        (folder, path)
    }

    #[test]
    fn ids_begin_and_end_with_the_tokens_of_the_family() {
        for (begin, end, kind) in [("[CLS]", "[SEP]", TokenizerKind::Bert), ("<s>", "</s>", TokenizerKind::XlmRoberta)]
        {
            let (_folder, file) = tokenizer(begin, end);
            let tokenizer = InstructionTokenizer::load(&file).unwrap();
            assert_eq!(tokenizer.kind(), kind);
            // The file's own truncation, to 3, does not count.
            assert_eq!(tokenizer.instruction_ids("Walk onward, w\u{e1}lk").unwrap(), [0, 3, 4, 5, 2, 3, 1]);
            assert_eq!(tokenizer.instruction_ids("").unwrap(), [0, 1]);
        }
    }

    #[test]
    fn ids_of_a_long_text_still_end_with_the_last_token() {
        let (_folder, file) = tokenizer("[CLS]", "[SEP]");
        let tokenizer = InstructionTokenizer::load(&file).unwrap();
        for (words, length) in [(509, 511), (510, 512), (511, 512), (2000, 512)] {
            let ids = tokenizer.instruction_ids(&"walk ".repeat(words)).unwrap();
            assert_eq!((ids.len(), ids[0], ids[length - 2], ids[length - 1]), (length, 0, 3, 1), "{words}");
        }
    }

    #[test]
    fn a_tokenizer_of_another_family_is_refused() {
        let (_folder, file) = tokenizer("<bos>", "<eos>");
        let error = InstructionTokenizer::load(&file).err().unwrap().to_string();
        assert!(error.contains("words.json") && error.contains("[CLS]") && error.contains("hint: "), "{error}");
        std::fs::write(&file, "{}").unwrap();
        assert!(InstructionTokenizer::load(&file).is_err());
        let error = InstructionTokenizer::load(&file.with_file_name("none")).err().unwrap().to_string();
        assert!(error.contains("the tokenizer is missing"), "{error}");
    }
}
