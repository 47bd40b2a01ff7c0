//! ROUGE-L as `pycocoevalcap`'s `rouge.py` computes it: from the length of the longest subsequence of words that a text has in common
//! with a reference.

use super::numbered_text::NumberedText;

/// How much more recall counts than precision.
const ROUGE_BETA: f64 = 1.2;

/// ROUGE-L of a text, from its best precision and its best recall. The two may come from different references.
#[must_use]
pub fn rouge_l(text: &NumberedText, references: &[&NumberedText]) -> f64 {
    let mut row_buffer = Vec::new();
    let [mut precision, mut recall] = [0.0, 0.0];
    for reference in references {
        let common = longest_common(text.pieces(), reference.pieces(), &mut row_buffer) as f64;
        precision = f64::max(precision, common / text.pieces().len() as f64);
        recall = f64::max(recall, common / reference.pieces().len() as f64);
    }
    if precision == 0.0 || recall == 0.0 {
        return 0.0;
    }
    (1.0 + ROUGE_BETA * ROUGE_BETA) * precision * recall / (recall + ROUGE_BETA * ROUGE_BETA * precision)
}

/// The length of the longest common subsequence. `row` is a buffer that the caller reuses.
fn longest_common(a: &[u32], b: &[u32], row: &mut Vec<u32>) -> u32 {
    row.clear();
    row.resize(b.len(), 0);
    for word in a {
        let (mut left, mut above_left) = (0, 0);
        for (other, here) in b.iter().zip(row.iter_mut()) {
            let above = *here;
            *here = if word == other { above_left + 1 } else { above.max(left) };
            (left, above_left) = (*here, above);
        }
    }
    row.last().copied().unwrap_or(0)
}
