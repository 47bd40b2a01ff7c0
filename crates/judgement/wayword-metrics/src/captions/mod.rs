//! Figures that compare a text with people's texts, as the field's papers print them: BLEU, ROUGE-L and CIDEr-D, and how
//! diverse texts are.

mod ptb;

pub use ptb::ptb;

/// White space collapsed to single blanks, without any at the ends. Line breaks within a text shift all later texts
/// in a tokenizer that reads line by line, so this comes before any tokenizer. What counts is what Python's `str.split` splits at.
#[must_use]
pub fn collapsed(text: &str) -> String {
    let words = text.split(is_white).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

fn is_white(c: char) -> bool {
    c.is_whitespace() || ('\u{1c}'..='\u{1f}').contains(&c)
}
