//! Text to tokens.
//!
//! candle has this for GPT-2's kind alone, without the name that Llama 3's files have (`llama-bpe`), and cuts texts of unknown
//! kinds in GPT-2's way, which makes a model stammer and nobody wonder. Here what is not known is refused.

use super::{
    file::GgufFile,
    vocabulary::{Kind, Spelling, Vocabulary},
};
use crate::LocalError;
use std::collections::BTreeMap;
use tokenizers::{
    AddedToken, NormalizerWrapper, PreTokenizerWrapper, SplitDelimiterBehavior,
    models::bpe::{BPE, BpeBuilder, Merges, Vocab},
    normalizers::{Prepend, Replace, Sequence as Normalizers, unicode::NFC},
    pre_tokenizers::{
        byte_level::ByteLevel,
        digits::Digits,
        sequence::Sequence,
        split::{Split, SplitPattern},
    },
};

/// How Qwen2 cuts a text, from its `tokenizer.json`.
const QWEN2: &str =
    r"(?i:'s|'t|'re|'ve|'m|'ll|'d)|[^\r\n\p{L}\p{N}]?\p{L}+|\p{N}| ?[^\s\p{L}\p{N}]+[\r\n]*|\s*[\r\n]+|\s+(?!\S)|\s+";
/// How Llama 3 does: up to three digits stay together.
const LLAMA3: &str = r"(?i:'s|'t|'re|'ve|'m|'ll|'d)|[^\r\n\p{L}\p{N}]?\p{L}+|\p{N}{1,3}| ?[^\s\p{L}\p{N}]+[\r\n]*|\s*[\r\n]+|\s+(?!\S)|\s+";
/// Longest piece, letters: longer ones are not looked through for the two that they were merged of.
const LONGEST_PIECE: usize = 128;

/// Makes tokens of texts.
pub(super) struct Tokenizer {
    inner: tokenizers::Tokenizer,
}

impl Tokenizer {
    /// Builds it from a file's metadata.
    ///
    /// # Errors
    /// When the metadata has not what is needed, or is not known.
    pub(super) fn read(file: &GgufFile, vocabulary: &Vocabulary) -> Result<Self, LocalError> {
        let mut inner = match vocabulary.spelling {
            Spelling::Bytes => by_bytes(file, vocabulary)?,
            Spelling::Spaces => by_spaces(file, vocabulary)?,
        };
        let marked = |kind: Kind| -> Vec<AddedToken> {
            let of_kind = vocabulary.kinds.iter().zip(&vocabulary.tokens).filter(|(one, _)| **one == kind);
            of_kind.map(|(_, token)| AddedToken::from(token.clone(), kind == Kind::Control).normalized(false)).collect()
        };
        inner.add_special_tokens(&marked(Kind::Control));
        inner.add_tokens(&marked(Kind::Whole));
        Ok(Self { inner })
    }

    /// The tokens of a text, in which the spelling of a token that steers the model is that token.
    pub(super) fn ids(&self, text: &str) -> tokenizers::Result<Vec<u32>> {
        Ok(self.inner.encode_fast(text, false)?.get_ids().to_vec())
    }
}

fn builder(vocabulary: &Vocabulary, merges: Merges) -> BpeBuilder {
    // Of tokens that are spelt alike the first counts, as in llama.cpp the piece does before the control.
    let ids = vocabulary.tokens.iter().cloned().zip(0..vocabulary.tokens.len() as u32).rev();
    BPE::builder().vocab_and_merges(ids.collect::<Vocab>(), merges)
}

fn built(file: &GgufFile, builder: BpeBuilder) -> Result<tokenizers::Tokenizer, LocalError> {
    let model = builder.build().map_err(|error| file.wrong(format!("tokenizer.ggml.merges: {error}")))?;
    Ok(tokenizers::Tokenizer::new(model))
}

/// GPT-2's kind: bytes, merged in the order of a list.
fn by_bytes(file: &GgufFile, vocabulary: &Vocabulary) -> Result<tokenizers::Tokenizer, LocalError> {
    let wrong = |problem: String| file.wrong(problem);
    let merges =
        file.texts("tokenizer.ggml.merges")?.ok_or_else(|| wrong("tokenizer.ggml.merges is missing".into()))?;
    let pair = |merge: &String| {
        let pair = merge.split_once(' ').map(|(left, right)| (left.to_owned(), right.to_owned()));
        pair.ok_or_else(|| wrong(format!("tokenizer.ggml.merges: {:?} is no pair", shown(merge))))
    };
    let merges: Merges = merges.iter().map(pair).collect::<Result<_, _>>()?;
    let kind = file.text("tokenizer.ggml.pre")?.unwrap_or("(none)");
    let llama3 = matches!(kind, "llama-bpe" | "llama3" | "llama-v3");
    let cuts = cuts(kind).map_err(|problem| wrong(format!("tokenizer.ggml.pre: {problem}")))?;
    let mut tokenizer = built(file, builder(vocabulary, merges).ignore_merges(llama3))?;
    if kind == "qwen2" {
        tokenizer.with_normalizer(Some(NormalizerWrapper::from(NFC)));
    }
    tokenizer.with_pre_tokenizer(Some(cuts));
    Ok(tokenizer)
}

/// How a text is cut before its bytes are merged.
fn cuts(kind: &str) -> Result<PreTokenizerWrapper, String> {
    let bytes = |regex: bool| PreTokenizerWrapper::from(ByteLevel::new(false, true, regex));
    let first: PreTokenizerWrapper = match kind {
        "qwen2" => split(QWEN2)?,
        "llama-bpe" | "llama3" | "llama-v3" => split(LLAMA3)?,
        "smollm" => Digits::new(true).into(),
        "gpt-2" | "gpt2" => return Ok(bytes(true)),
        other => return Err(format!("{other} is not known, only qwen2, llama-bpe, smollm and gpt-2")),
    };
    Ok(Sequence::new(vec![first, bytes(kind == "smollm")]).into())
}

fn split(regex: &str) -> Result<PreTokenizerWrapper, String> {
    let split = Split::new(SplitPattern::Regex(regex.to_owned()), SplitDelimiterBehavior::Isolated, false);
    split.map(PreTokenizerWrapper::from).map_err(|error| error.to_string())
}

/// Sentencepiece's kind: pieces with scores, and bytes for letters that are in none. What merges first is what makes the piece with
/// the best score.
fn by_spaces(file: &GgufFile, vocabulary: &Vocabulary) -> Result<tokenizers::Tokenizer, LocalError> {
    let key = "tokenizer.ggml.scores";
    let scores = file.numbers(key)?.ok_or_else(|| file.wrong(format!("{key} is missing")))?;
    if scores.len() != vocabulary.tokens.len() || scores.iter().any(|score| score.is_nan()) {
        return Err(file.wrong(format!(
            "{key}: {} for {} tokens, or not numbers",
            scores.len(),
            vocabulary.tokens.len()
        )));
    }
    let unknown = file.whole("tokenizer.ggml.unknown_token_id", 0, vocabulary.tokens.len() - 1)?;
    let mut builder = builder(vocabulary, merges(vocabulary, scores)).byte_fallback(true).fuse_unk(true);
    if let Some(unknown) = unknown {
        builder = builder.unk_token(vocabulary.spelt(Some(unknown as u32)).to_owned());
    }
    let mut tokenizer = built(file, builder)?;
    let spaces = Replace::new(" ", "▁").map_err(|error| file.wrong(error.to_string()))?;
    let mut steps = vec![NormalizerWrapper::from(spaces)];
    if file.flag("tokenizer.ggml.add_space_prefix")?.unwrap_or(true) {
        steps.insert(0, Prepend::new("▁".to_owned()).into());
    }
    tokenizer.with_normalizer(Some(NormalizerWrapper::from(Normalizers::new(steps))));
    Ok(tokenizer)
}

/// All pairs of pieces that make a piece, those of the best piece first, as transformers derives them from a sentencepiece model.
fn merges(vocabulary: &Vocabulary, scores: &[f64]) -> Merges {
    let pieces = || (0..).zip(&vocabulary.tokens).zip(&vocabulary.kinds).filter(|(_, kind)| **kind == Kind::Piece);
    let ids: BTreeMap<&str, usize> = pieces().map(|((at, token), _)| (&token[..], at)).collect();
    let mut merges: Vec<(usize, usize, usize)> = Vec::new();
    for ((at, token), _) in pieces().filter(|((_, token), _)| token.chars().count() <= LONGEST_PIECE) {
        for (cut, _) in token.char_indices().skip(1) {
            if let (Some(&left), Some(&right)) = (ids.get(&token[..cut]), ids.get(&token[cut..])) {
                merges.push((at, left, right));
            }
        }
    }
    merges.sort_by(|a, b| scores[b.0].total_cmp(&scores[a.0]).then(a.cmp(b)));
    let spelt = |at: usize| vocabulary.tokens[at].clone();
    merges.into_iter().map(|(_, left, right)| (spelt(left), spelt(right))).collect()
}

/// As much of a text from a file as an error shows.
fn shown(text: &str) -> &str {
    text.char_indices().nth(40).map_or(text, |(end, _)| &text[..end])
}
