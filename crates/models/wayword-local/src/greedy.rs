//! Greedy decoding: a language model writes a text token by token, and the most likely token is always taken.

use candle_core::{D, DType, Result, Tensor};

/// Writes at most `most` tokens, and stops at the token `end`, which is not returned.
///
/// `step` takes the latest token (`None` at first) and returns the logits [.., words] of the next one. If it returns
/// several rows, as for a whole prompt, the last row is the one that counts.
pub(crate) fn decode_greedily(
    most: usize,
    end: u32,
    mut step: impl FnMut(Option<u32>) -> Result<Tensor>,
) -> Result<Vec<u32>> {
    let mut said = Vec::new();
    while said.len() < most {
        let logits = step(said.last().copied())?.to_dtype(DType::F32)?;
        let likeliest = logits.argmax(D::Minus1)?.flatten_all()?.to_vec1::<u32>()?;
        match likeliest.last() {
            Some(&token) if token != end => said.push(token),
            _ => break,
        }
    }
    Ok(said)
}
