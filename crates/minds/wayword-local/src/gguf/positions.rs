//! Positions: queries and keys are turned by angles that grow with them (<https://arxiv.org/abs/2104.09864>).

use super::{
    file::GgufFile,
    sizes::{Architecture, Sizes},
};
use crate::LocalError;
use candle_core::{Device, Tensor};
use candle_nn::rotary_emb::{rope, rope_i};

/// The angles of every position.
pub(super) struct Positions {
    /// [context, half a head].
    cosines: Tensor,
    sines: Tensor,
    neighbours: bool,
}

/// The angles of a few positions.
pub(super) struct Turn {
    cosines: Tensor,
    sines: Tensor,
    /// Whether numbers that are turned together lie beside each other, else half a head apart.
    neighbours: bool,
}

impl Positions {
    /// Reckons them; Llama 3 has a divisor for each angle in the tensor `rope_freqs.weight`.
    pub(super) fn load(file: &GgufFile, sizes: &Sizes, device: &Device) -> Result<Self, LocalError> {
        let half = sizes.head / 2;
        let divisors = match file.shape("rope_freqs.weight") {
            None => vec![1.0; half],
            Some(_) => {
                let divisors = file.wide("rope_freqs.weight", &[half], &Device::Cpu)?;
                divisors.to_vec1().map_err(|error| file.wrong(format!("rope_freqs.weight: {error}")))?
            }
        };
        // In 32 bits, as transformers reckons them.
        let step = |(at, divisor): (usize, &f32)| {
            (1.0 / sizes.base.powf((2 * at) as f64 / sizes.head as f64) / sizes.stretch) as f32 / divisor
        };
        let steps: Vec<f32> = divisors.iter().enumerate().map(step).collect();
        let angles = (0..sizes.context).flat_map(|position| steps.iter().map(move |step| position as f32 * step));
        let angles: Vec<f32> = angles.collect();
        let table = |of: fn(f32) -> f32| {
            Tensor::from_vec(angles.iter().copied().map(of).collect(), (sizes.context, half), device)
                .map_err(|error| file.wrong(error.to_string()))
        };
        let neighbours = sizes.architecture == Architecture::Llama;
        Ok(Self { cosines: table(f32::cos)?, sines: table(f32::sin)?, neighbours })
    }

    /// Those of `count` positions from `from` on.
    pub(super) fn at(&self, from: usize, count: usize) -> candle_core::Result<Turn> {
        let (cosines, sines) = (self.cosines.narrow(0, from, count)?, self.sines.narrow(0, from, count)?);
        Ok(Turn { cosines, sines, neighbours: self.neighbours })
    }
}

impl Turn {
    /// Of x [1, count, heads, head]: the same, turned.
    pub(super) fn of(&self, x: &Tensor) -> candle_core::Result<Tensor> {
        let x = x.transpose(1, 2)?.contiguous()?;
        let turn = if self.neighbours { rope_i } else { rope };
        turn(&x, &self.cosines, &self.sines)?.transpose(1, 2)
    }
}
