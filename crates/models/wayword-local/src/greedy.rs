//! Greedy decoding.

use candle_core::{D, DType, Result, Tensor};

/// At most `most` tokens, each the most likely one, up to the token `end`, which is left out. `step` takes the latest
/// token (none at first) and gives the logits [.., words] of the next one. If it gives several rows, the last one
/// counts.
pub(crate) fn greedy(most: usize, end: u32, mut step: impl FnMut(Option<u32>) -> Result<Tensor>) -> Result<Vec<u32>> {
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
