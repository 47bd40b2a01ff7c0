//! Saying the likeliest words.

use candle_core::{D, DType, Result, Tensor};

/// At most `most` tokens, each the likeliest one, up to the one that ends them, which is left out. `step` is given the latest
/// token, none at first, and gives the logits [.., words] of the next; of several rows the last counts.
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
