//! The output layers of OWLv2. For each patch they compute a class vector, the two numbers that turn its product with a
//! text's vector into a logit, and a box.

use crate::{
    LocalError,
    ops::{Activation, LinearLayer},
    weights::WeightScope,
};
use candle_core::{DType, Device, Result, Tensor};

/// Small numbers that are added to a length before a division by it (the first), and to a share before its logarithm
/// (the second), so that the result is finite.
const LENGTH_AND_LOGIT_EPSILONS: (f64, f64) = (1e-6, 1e-4);

/// Gives each patch a class.
pub(super) struct ClassHead {
    /// Computes the class vector, before it is scaled to length 1.
    class: LinearLayer,
    /// Computes the number that is added to a product with a text's vector.
    shift: LinearLayer,
    /// Computes the factor for the sum.
    scale: LinearLayer,
}

/// Gives each patch a box.
pub(super) struct BoxHead {
    first: LinearLayer,
    second: LinearLayer,
    last: LinearLayer,
    /// The logits of each patch's own box, [patches, 4]. The network's output is added to them.
    bias: Tensor,
}

/// The classes of a picture's patches.
pub(super) struct PatchClasses {
    /// Unit vectors [patches, size].
    pub(super) vectors: Tensor,
    /// The number that is added to the product with a text's vector, for each patch.
    pub(super) shifts: Vec<f32>,
    /// The factor by which the sum is then multiplied, for each patch.
    pub(super) scales: Vec<f32>,
}

impl ClassHead {
    /// Reads the head. The widths are those of the states of the two towers.
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        vision_width: usize,
        text_width: usize,
    ) -> std::result::Result<Self, LocalError> {
        Ok(Self {
            class: weights.read_linear("dense0", vision_width, text_width)?,
            shift: weights.read_linear("logit_shift", vision_width, 1)?,
            scale: weights.read_linear("logit_scale", vision_width, 1)?,
        })
    }

    /// The classes of patches [1, patches, size].
    pub(super) fn classify_patches(&self, patches: &Tensor) -> Result<PatchClasses> {
        let vectors = self.class.apply_to(patches)?.squeeze(0)?.to_dtype(DType::F32)?;
        let numbers =
            |layer: &LinearLayer| layer.apply_to(patches)?.flatten_all()?.to_dtype(DType::F32)?.to_vec1::<f32>();
        // ELU plus 1. It is positive for every number.
        let positive = |number: f32| if number > 0.0 { number + 1.0 } else { number.exp() };
        Ok(PatchClasses {
            vectors: unit_vectors(&vectors)?,
            shifts: numbers(&self.shift)?,
            scales: numbers(&self.scale)?.into_iter().map(positive).collect(),
        })
    }
}

impl PatchClasses {
    /// The logit of each patch for each text's unit vector [texts, size]: one list per text.
    pub(super) fn text_logits(&self, texts: &Tensor) -> Result<Vec<Vec<f32>>> {
        let similarity = texts.matmul(&self.vectors.t()?)?.to_vec2::<f32>()?;
        let logits = |row: Vec<f32>| {
            let patches = row.iter().zip(&self.shifts).zip(&self.scales);
            patches.map(|((similarity, shift), scale)| (similarity + shift) * scale).collect()
        };
        Ok(similarity.into_iter().map(logits).collect())
    }
}

/// Vectors [.., size] at length 1, in 32 bits.
pub(super) fn unit_vectors(vectors: &Tensor) -> Result<Tensor> {
    let vectors = vectors.to_dtype(DType::F32)?;
    let length = (vectors.sqr()?.sum_keepdim(candle_core::D::Minus1)?.sqrt()? + LENGTH_AND_LOGIT_EPSILONS.0)?;
    vectors.broadcast_div(&length)
}

impl BoxHead {
    /// Reads the head. `size` is the width of the vision tower, and `side` the number of patches along an edge.
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        size: usize,
        side: usize,
        device: &Device,
    ) -> std::result::Result<Self, LocalError> {
        let last = weights.read_linear("dense2", size, 4)?;
        let bias = Tensor::from_vec(patch_box_logits(side), (side * side, 4), device);
        let bias = bias.map_err(|error| weights.tensor_error("dense2.bias", &error))?;
        Ok(Self {
            first: weights.read_linear("dense0", size, size)?,
            second: weights.read_linear("dense1", size, size)?,
            last,
            bias,
        })
    }

    /// The boxes of patches [1, patches, size]: centre, width and height, from 0 to 1, as shares of the square's edge.
    pub(super) fn predict_boxes(&self, patches: &Tensor) -> Result<Vec<[f32; 4]>> {
        let x = self.first.apply_and_activate(patches, Activation::Gelu)?;
        let x = self.last.apply_to(&self.second.apply_and_activate(&x, Activation::Gelu)?)?;
        let boxes = candle_nn::ops::sigmoid(&(x.squeeze(0)?.to_dtype(DType::F32)? + &self.bias)?)?;
        let flat = boxes.flatten_all()?.to_vec1::<f32>()?;
        Ok(flat.chunks_exact(4).map(|numbers| std::array::from_fn(|at| numbers[at])).collect())
    }
}

/// The logits of each patch's own box, rows from the top. The centre of the box is the lower right corner of the patch,
/// and it is as large as the patch.
fn patch_box_logits(side: usize) -> Vec<f32> {
    let logit = |share: f32| {
        (share + LENGTH_AND_LOGIT_EPSILONS.1 as f32).ln() - (1.0 - share + LENGTH_AND_LOGIT_EPSILONS.1 as f32).ln()
    };
    let corner = |at: usize| logit((at + 1) as f32 / side as f32);
    let size = logit(1.0 / side as f32);
    (0..side * side).flat_map(|at| [corner(at % side), corner(at / side), size, size]).collect()
}
