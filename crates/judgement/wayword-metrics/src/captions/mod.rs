//! The usual figures that compare a text with people's texts: BLEU, ROUGE-L and CIDEr-D. Also measures how diverse a set of
//! texts is.
//!
//! All figures equal those of `pycocoevalcap` to the last digit that it prints. A figure can only be compared with others of
//! the same protocol: the tokens ([`ptb`] or [`split`]), the references, and whether texts were cut off.

mod bleu;
mod cider;
mod compared;
mod diversity;
mod ptb;
mod rouge;
mod split;
mod text;

pub use bleu::Counts;
pub use cider::cider_d;
pub use compared::{Anchored, Described, Figures, Sets, anchored, elsewhere};
pub use diversity::{Diversity, diversity};
pub use ptb::ptb;
pub use rouge::rouge_l;
pub use split::split;
pub use text::{Text, Vocabulary};

/// A text and the references that it is compared with.
#[derive(Debug, Clone)]
pub struct Row<'a> {
    /// The text.
    pub text: &'a Text,
    /// People's texts about the same item; at least one.
    pub references: Vec<&'a Text>,
}

/// The figures of one text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scores {
    /// The counts for BLEU. [`Counts::bleu`] gives the text's own BLEU; of the sum of several counts it gives the corpus's BLEU.
    pub counts: Counts,
    /// ROUGE-L.
    pub rouge_l: f64,
    /// CIDEr-D among the texts that were scored together.
    pub cider_d: f64,
}

/// The figures of each text.
#[must_use]
pub fn scores(rows: &[Row<'_>]) -> Vec<Scores> {
    let of_row = |(row, cider_d): (&Row<'_>, f64)| Scores {
        counts: Counts::of(row.text, &row.references),
        rouge_l: rouge_l(row.text, &row.references),
        cider_d,
    };
    rows.iter().zip(cider_d(rows)).map(of_row).collect()
}

/// White space collapsed to single blanks, without any at the ends. Line breaks within a text shift all later texts
/// in a tokenizer that reads line by line, so this comes before any tokenizer. White space is what Python's `str.split` splits at.
#[must_use]
pub fn collapsed(text: &str) -> String {
    let words = text.split(is_white).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

fn is_white(c: char) -> bool {
    c.is_whitespace() || ('\u{1c}'..='\u{1f}').contains(&c)
}

#[cfg(test)]
mod tests;
