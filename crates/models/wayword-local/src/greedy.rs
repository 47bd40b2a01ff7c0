//! Greedy decoding: a language model writes a text token by token, and the most likely token is always taken.

use candle_core::{D, DType, Result, Tensor};

/// Writes at most `max_tokens` tokens, and stops at the token `end`, which is not returned.
///
/// `step` takes the latest token (`None` at first) and returns the logits of the next one, [.., words]: an unnormalised
/// score for each word of the vocabulary. If it returns several rows, as for a whole prompt, the last row counts.
pub(crate) fn decode_greedily(
    max_tokens: usize,
    end: u32,
    mut step: impl FnMut(Option<u32>) -> Result<Tensor>,
) -> Result<Vec<u32>> {
    let mut tokens = Vec::new();
    while tokens.len() < max_tokens {
        let logits = step(tokens.last().copied())?.to_dtype(DType::F32)?;
        let likeliest = logits.argmax(D::Minus1)?.flatten_all()?.to_vec1::<u32>()?;
        match likeliest.last() {
            Some(&token) if token != end => tokens.push(token),
            _ => break,
        }
    }
    Ok(tokens)
}
