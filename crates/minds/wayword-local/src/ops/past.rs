//! Keys and values of the tokens so far, so that each is computed once.

use candle_core::{Result, Tensor};

/// One layer's keys and values [batch, tokens, width].
#[derive(Debug, Clone, Default)]
pub(crate) struct Past(Option<(Tensor, Tensor)>);

impl Past {
    /// How many tokens there are.
    pub(crate) fn len(&self) -> Result<usize> {
        self.0.as_ref().map_or(Ok(0), |(keys, _)| keys.dim(1))
    }

    /// Puts those of the next tokens behind them; returns all.
    pub(crate) fn grow(&mut self, keys: Tensor, values: Tensor) -> Result<(Tensor, Tensor)> {
        let grown = match self.0.take() {
            None => (keys, values),
            Some((old_keys, old_values)) => {
                (Tensor::cat(&[old_keys, keys], 1)?, Tensor::cat(&[old_values, values], 1)?)
            }
        };
        self.0 = Some(grown.clone());
        Ok(grown)
    }
}
