//! The output layers of OWLv2. For each patch they compute a class vector, the two numbers that turn its product with a
//! text's vector into a logit, and a box.

use crate::{
    LocalError,
    ops::{Activation, Linear},
    weights::Scope,
};
use candle_core::{DType, Device, Result, Tensor};

/// Keeps divisions by a length (the first), and logarithms of a share (the second) finite.
const SMALL: (f64, f64) = (1e-6, 1e-4);

/// Gives each patch a class.
pub(super) struct ClassHead {
    class: Linear,
    shift: Linear,
    scale: Linear,
}

/// Gives each patch a box.
pub(super) struct BoxHead {
    first: Linear,
    second: Linear,
    last: Linear,
    /// The logits of each patch's own box, [patches, 4]. The network's output is added to them.
    bias: Tensor,
}

/// The classes of a picture's patches.
pub(super) struct Classes {
    /// Unit vectors [patches, size].
    pub(super) vectors: Tensor,
    /// The number that is added to the product with a text's vector, for each patch.
    pub(super) shifts: Vec<f32>,
    /// The factor by which the sum is then multiplied, for each patch.
    pub(super) scales: Vec<f32>,
}

impl ClassHead {
    /// Reads the head. `seen` is the width of the vision tower, and `said` that of the text tower.
    pub(super) fn load(weights: &Scope<'_>, seen: usize, said: usize) -> std::result::Result<Self, LocalError> {
        Ok(Self {
            class: weights.linear("dense0", seen, said)?,
            shift: weights.linear("logit_shift", seen, 1)?,
            scale: weights.linear("logit_scale", seen, 1)?,
        })
    }

    /// The classes of patches [1, patches, size].
    pub(super) fn of(&self, patches: &Tensor) -> Result<Classes> {
        let vectors = self.class.of(patches)?.squeeze(0)?.to_dtype(DType::F32)?;
        let numbers = |layer: &Linear| layer.of(patches)?.flatten_all()?.to_dtype(DType::F32)?.to_vec1::<f32>();
        // ELU plus 1. It is positive for every number.
        let positive = |number: f32| if number > 0.0 { number + 1.0 } else { number.exp() };
        Ok(Classes {
            vectors: unit(&vectors)?,
            shifts: numbers(&self.shift)?,
            scales: numbers(&self.scale)?.into_iter().map(positive).collect(),
        })
    }
}

impl Classes {
    /// The logit of each patch for each text's unit vector [texts, size]: one list per text.
    pub(super) fn logits(&self, texts: &Tensor) -> Result<Vec<Vec<f32>>> {
        let alike = texts.matmul(&self.vectors.t()?)?.to_vec2::<f32>()?;
        let logits = |row: Vec<f32>| {
            let patches = row.iter().zip(&self.shifts).zip(&self.scales);
            patches.map(|((alike, shift), scale)| (alike + shift) * scale).collect()
        };
        Ok(alike.into_iter().map(logits).collect())
    }
}

/// Vectors [.., size] at length 1, in 32 bits.
pub(super) fn unit(vectors: &Tensor) -> Result<Tensor> {
    let vectors = vectors.to_dtype(DType::F32)?;
    let length = (vectors.sqr()?.sum_keepdim(candle_core::D::Minus1)?.sqrt()? + SMALL.0)?;
    vectors.broadcast_div(&length)
}

impl BoxHead {
    /// Reads the head. `size` is the width of the vision tower, and `side` the number of patches along an edge.
    pub(super) fn load(
        weights: &Scope<'_>,
        size: usize,
        side: usize,
        device: &Device,
    ) -> std::result::Result<Self, LocalError> {
        let last = weights.linear("dense2", size, 4)?;
        let bias = Tensor::from_vec(placed(side), (side * side, 4), device);
        let bias = bias.map_err(|error| weights.wrong("dense2.bias", &error))?;
        Ok(Self {
            first: weights.linear("dense0", size, size)?,
            second: weights.linear("dense1", size, size)?,
            last,
            bias,
        })
    }

    /// The boxes of patches [1, patches, size]: centre, width and height, from 0 to 1, as shares of the square's edge.
    pub(super) fn of(&self, patches: &Tensor) -> Result<Vec<[f32; 4]>> {
        let x = self.first.of_then(patches, Activation::Gelu)?;
        let x = self.last.of(&self.second.of_then(&x, Activation::Gelu)?)?;
        let boxes = candle_nn::ops::sigmoid(&(x.squeeze(0)?.to_dtype(DType::F32)? + &self.bias)?)?;
        let flat = boxes.flatten_all()?.to_vec1::<f32>()?;
        Ok(flat.chunks_exact(4).map(|numbers| std::array::from_fn(|at| numbers[at])).collect())
    }
}

/// The logits of each patch's own box, rows from the top. The centre of the box is the lower right corner of the patch,
/// and it is as large as the patch.
fn placed(side: usize) -> Vec<f32> {
    let logit = |share: f32| (share + SMALL.1 as f32).ln() - (1.0 - share + SMALL.1 as f32).ln();
    let corner = |at: usize| logit((at + 1) as f32 / side as f32);
    let size = logit(1.0 / side as f32);
    (0..side * side).flat_map(|at| [corner(at % side), corner(at / side), size, size]).collect()
}
