//! The usual figures that compare a text with people's texts: BLEU, ROUGE-L and CIDEr-D. Also measures how diverse a set of
//! texts is.
//!
//! All figures equal those of `pycocoevalcap` to the last digit that it prints. A figure can only be compared with others of
//! the same protocol: the tokens ([`ptb_tokens`], [`split_tokens`] or [`character_tokens`]), the references, and whether texts were cut off.

mod anchored;
mod bleu;
mod character_tokens;
mod cider;
mod diversity;
mod numbered_text;
mod ptb;
mod rouge;
mod split_tokens;

pub use anchored::{
    AnchoredCaptionFigures, CaptionFigures, CaptionItem, CaptionRowSets, anchored_caption_figures, draw_other_paths,
};
pub use bleu::BleuCounts;
pub use character_tokens::{character_tokens, stands_alone};
pub use cider::cider_d;
pub use diversity::{TextDiversity, measure_diversity};
pub use numbered_text::{CaptionVocabulary, NumberedText};
pub use ptb::ptb_tokens;
pub use rouge::rouge_l;
pub use split_tokens::split_tokens;

/// A text and the references that it is compared with.
#[derive(Debug, Clone)]
pub struct CaptionRow<'a> {
    /// The text.
    pub text: &'a NumberedText,
    /// People's texts about the same item; at least one.
    pub references: Vec<&'a NumberedText>,
}

/// The figures of one text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CaptionScores {
    /// The counts for BLEU. [`BleuCounts::bleu_scores`] gives the text's own BLEU; of the sum of several counts it gives the corpus's BLEU.
    pub counts: BleuCounts,
    /// ROUGE-L.
    pub rouge_l: f64,
    /// CIDEr-D among the texts that were scored together.
    pub cider_d: f64,
}

/// The figures of each text.
#[must_use]
pub fn score_rows(rows: &[CaptionRow<'_>]) -> Vec<CaptionScores> {
    let scores = |(row, cider_d): (&CaptionRow<'_>, f64)| CaptionScores {
        counts: BleuCounts::for_text(row.text, &row.references),
        rouge_l: rouge_l(row.text, &row.references),
        cider_d,
    };
    rows.iter().zip(cider_d(rows)).map(scores).collect()
}

/// The text with each run of white space as a single blank, and without any at the ends. White space means the characters at which
/// Python's `str.split` splits.
///
/// A tokenizer that reads line by line would take a line break within a text for the end of that text, so this comes before any
/// tokenizer.
#[must_use]
pub fn collapse_white_space(text: &str) -> String {
    let words = text.split(is_white).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

/// Whether Python's `str.split` splits at a character.
fn is_white(c: char) -> bool {
    c.is_whitespace() || ('\u{1c}'..='\u{1f}').contains(&c)
}

#[cfg(test)]
mod tests;
