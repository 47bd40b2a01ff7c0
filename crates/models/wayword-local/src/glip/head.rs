//! The head. First several rounds of fusion, text layer and convolutions; then, for each position, a logit for each
//! token, a box, and the position's centreness, which is high in the middle of a thing.

use super::{config::GlipConfig, fusion::GlipFusion, pyramid::LEVEL_COUNT, read_numbers, tower::GlipTower};
use crate::{
    LocalError, bert,
    ops::{LinearLayer, conv3::FeatureMap, matrix::multiply_matrices},
    weights::WeightScope,
};
use candle_core::{DType, Result, Tensor};

/// The head: rounds that join picture and text, then the output layers.
pub(super) struct GlipHead {
    rounds: Vec<GlipRound>,
    /// Brings the states of tokens to the width of the features of positions.
    words: LinearLayer,
    /// The bias of a token's logits: a vector for the product with its state, and a constant.
    word_bias: (Tensor, f64),
    /// Divides the products of position and token.
    divisor: f64,
    /// The layer for the four distances of a box, and for the centreness.
    boxes: LinearLayer,
    /// The factor for the distances of each level.
    scales: Vec<f32>,
}

/// One round of the head.
struct GlipRound {
    /// The fusion and the text layer. Variant A has none.
    fusion: Option<(GlipFusion, bert::BertLayer)>,
    tower: GlipTower,
}

/// The head's outputs for the positions of a level.
pub(super) struct GlipLevelOutputs {
    pub(super) height: usize,
    pub(super) width: usize,
    /// The logit of each token at each position, [positions * tokens].
    pub(super) logits: Vec<f32>,
    /// [positions * 5]: the four distances of a box, and the logit of the centreness.
    pub(super) boxes: Vec<f32>,
}

impl GlipHead {
    pub(super) fn from_weights(
        weights: &WeightScope<'_>,
        config: &GlipConfig,
    ) -> std::result::Result<Self, LocalError> {
        let (width, text) = (config.head.width, config.text.hidden_size());
        let tower = weights.sub_scope("dyhead_tower");
        let fuses = tower.sub_scope("0").has_tensor("b_attn.gamma_v");
        let round = |at: usize| {
            let part = |within: usize| tower.sub_scope(if fuses { 3 * at + within } else { at });
            let fusion = || {
                let fusion = GlipFusion::from_weights(&part(0).sub_scope("b_attn"), &config.head, text)?;
                Ok::<_, LocalError>((fusion, bert::BertLayer::from_weights(&part(1), &config.text)?))
            };
            Ok::<_, LocalError>(GlipRound {
                fusion: fuses.then(fusion).transpose()?,
                tower: GlipTower::from_weights(&part(2), &config.head)?,
            })
        };
        let wrong = |error: candle_core::Error| weights.tensor_error("bbox_pred.weight", &error);
        let joined = |part: &str| {
            let shape = |outputs: usize| if part == "weight" { vec![outputs, width, 1, 1] } else { vec![outputs] };
            let distances = weights.read_tensor(&format!("bbox_pred.{part}"), &shape(4))?;
            let centre = weights.read_tensor(&format!("centerness.{part}"), &shape(1))?;
            Tensor::cat(&[distances, centre], 0).map_err(wrong)
        };
        let kernel = joined("weight")?.flatten_from(1).map_err(wrong)?;
        let read_scalar = |name: &str| Ok::<_, LocalError>(read_numbers(weights, name, &[1])?[0]);
        Ok(Self {
            rounds: (0..config.head.rounds).map(round).collect::<std::result::Result<_, _>>()?,
            words: weights.read_linear("dot_product_projection_text", text, width)?,
            word_bias: (weights.read_state("bias_lang", &[text])?, f64::from(read_scalar("bias0")?)),
            divisor: f64::from(read_scalar("log_scale")?).exp(),
            boxes: LinearLayer::new(&kernel, Some(joined("bias")?)).map_err(wrong)?,
            scales: (0..LEVEL_COUNT)
                .map(|level| read_scalar(&format!("scales.{level}.scale")))
                .collect::<std::result::Result<_, _>>()?,
        })
    }

    /// Computes the outputs for the levels of a picture and the states of a text [tokens, size].
    pub(super) fn run_rounds(&self, levels: &[FeatureMap], text: &Tensor) -> Result<Vec<GlipLevelOutputs>> {
        let (mut levels, mut text) = (levels.to_vec(), text.clone());
        for round in &self.rounds {
            if let Some((fusion, layer)) = &round.fusion {
                let joined = Tensor::cat(&levels.iter().map(|level| &level.x).collect::<Vec<_>>(), 0)?;
                let (vision, new) = fusion.fuse_states(&joined, &text)?;
                text = layer.apply_to(&new.unsqueeze(0)?, None)?.squeeze(0)?;
                let mut begin = 0;
                for level in &mut levels {
                    level.x = vision.narrow(0, begin, level.position_count())?;
                    begin += level.position_count();
                }
            }
            levels = round.tower.update_levels(&levels)?;
        }
        self.read_outputs(&levels, &text)
    }

    /// Computes logits and boxes of all levels from their features after the last round.
    fn read_outputs(&self, levels: &[FeatureMap], text: &Tensor) -> Result<Vec<GlipLevelOutputs>> {
        let length = text.sqr()?.sum_keepdim(1)?.sqrt()?.maximum(1e-12)?;
        let unit_text = text.broadcast_div(&length)?;
        let words = (self.words.apply_to(&(&unit_text / 2.0)?)? / self.divisor)?.t()?.contiguous()?;
        let bias =
            (unit_text.broadcast_mul(&self.word_bias.0.unsqueeze(0)?)?.sum(1)? + self.word_bias.1)?.unsqueeze(0)?;
        let numbers = |x: Tensor| x.to_dtype(DType::F32)?.flatten_all()?.to_vec1::<f32>();
        let level_outputs = |(level, scale): (&FeatureMap, &f32)| {
            let mut boxes = numbers(self.boxes.apply_to(&level.x)?)?;
            boxes.chunks_exact_mut(5).for_each(|row| row[..4].iter_mut().for_each(|distance| *distance *= scale));
            let logits = numbers(multiply_matrices(&level.x, &words)?.broadcast_add(&bias)?)?;
            Ok(GlipLevelOutputs { height: level.height, width: level.width, logits, boxes })
        };
        levels.iter().zip(&self.scales).map(level_outputs).collect()
    }
}
