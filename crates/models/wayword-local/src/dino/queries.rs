//! Chooses the queries: the cells that fit the text best, each with a first box.
//!
//! Every cell has a box of its own around its middle, with a size that depends on the level. The network moves this box
//! a little.

use super::{config::DinoConfig, features::FeatureLevel, heads::TokenContrast, layers::ReluPerceptron};
use crate::{
    LocalError,
    ops::{LayerNorm, LinearLayer},
    weights::WeightScope,
};
use candle_core::{Result, Tensor};

/// The width and height of a cell's own box on the finest level, as a share of the picture. Each level doubles them.
const FINEST_BOX_SHARE: f32 = 0.05;

/// A cell's own box is valid if all its numbers lie between these two shares of the picture.
const MIN_BOX_SHARE: f32 = 0.01;
const MAX_BOX_SHARE: f32 = 0.99;

/// Chooses the cells that become queries.
pub(super) struct QueryChooser {
    layer: LinearLayer,
    norm: LayerNorm,
    /// Computes how far a cell's own box is moved.
    boxes: ReluPerceptron,
    contrast: TokenContrast,
    /// The most cells that become queries.
    queries: usize,
}

/// All cells as candidates.
pub(super) struct QueryCandidates {
    /// The states of the cells, [1, cells, size].
    states: Tensor,
    /// The logits of each cell's own box; infinite for a cell that cannot be chosen for lack of a valid box.
    box_logits: Vec<[f32; 4]>,
    /// The logit of each cell's best token.
    pub(super) scores: Vec<f32>,
}

impl QueryChooser {
    pub(super) fn from_weights(model: &WeightScope<'_>, config: &DinoConfig) -> std::result::Result<Self, LocalError> {
        let size = config.size;
        Ok(Self {
            layer: model.read_linear("enc_output", size, size)?,
            norm: model.read_layer_norm("enc_output_norm", size, config.epsilon)?,
            boxes: ReluPerceptron::from_weights(&model.sub_scope("encoder_output_bbox_embed"), &[size, size, size, 4])?,
            contrast: TokenContrast::from_weights(&model.sub_scope("encoder_output_class_embed"), config)?,
            queries: config.queries,
        })
    }

    /// Scores all cells [1, cells, size] by how well they fit the text [1, tokens, size].
    pub(super) fn score_candidates(
        &self,
        cells: &Tensor,
        text: &Tensor,
        levels: &[FeatureLevel],
    ) -> Result<QueryCandidates> {
        let own: Vec<[f32; 4]> = levels.iter().enumerate().flat_map(|(at, &level)| own_boxes(at, level)).collect();
        let is_valid = own.iter().map(|own| if own[0].is_finite() { 1.0_f32 } else { 0.0 }).collect();
        let is_valid = Tensor::from_vec(is_valid, (1, own.len(), 1), cells.device())?.to_dtype(cells.dtype())?;
        let states = self.norm.apply_to(&self.layer.apply_to(&cells.broadcast_mul(&is_valid)?)?)?;
        let logits = self.contrast.token_logits(&states, text)?;
        let scores = logits.max(candle_core::D::Minus1)?.flatten_all()?.to_dtype(candle_core::DType::F32)?.to_vec1()?;
        Ok(QueryCandidates { states, box_logits: own, scores })
    }

    /// The cells with the best scores, the best first. Cells with equal scores stay in their order.
    pub(super) fn best_candidates(&self, candidates: &QueryCandidates) -> Vec<u32> {
        let scores = &candidates.scores;
        let mut order: Vec<u32> = (0..scores.len() as u32).collect();
        order.sort_by(|&a, &b| scores[b as usize].total_cmp(&scores[a as usize]));
        order.truncate(self.queries);
        order
    }

    /// The boxes of the picked cells: middle, width and height, as shares of the picture's width and height.
    pub(super) fn candidate_boxes(&self, candidates: &QueryCandidates, picked: &[u32]) -> Result<Vec<[f32; 4]>> {
        let at = Tensor::from_slice(picked, picked.len(), candidates.states.device())?;
        let states = candidates.states.index_select(&at, 1)?;
        let moved = rows_of_four(&self.boxes.apply_to(&states)?)?;
        let place = |(moved, &at): ([f32; 4], &u32)| {
            let own = candidates.box_logits[at as usize];
            std::array::from_fn(|edge| sigmoid(moved[edge] + own[edge]))
        };
        Ok(moved.into_iter().zip(picked).map(place).collect())
    }
}

/// The logits of the own boxes of a level's cells; infinite for a box that is not valid.
fn own_boxes(at: usize, level: FeatureLevel) -> impl Iterator<Item = [f32; 4]> {
    let share = FINEST_BOX_SHARE * (at as f32).exp2();
    level.cell_middles().map(move |[x, y]| {
        let own = [x, y, share, share];
        let is_valid = own.iter().all(|edge| (MIN_BOX_SHARE..MAX_BOX_SHARE).contains(edge) && *edge > MIN_BOX_SHARE);
        if is_valid { own.map(|edge| (edge / (1.0 - edge)).ln()) } else { [f32::INFINITY; 4] }
    })
}

/// The rows of a tensor [1, rows, 4], four numbers each.
pub(super) fn rows_of_four(x: &Tensor) -> Result<Vec<[f32; 4]>> {
    let numbers: Vec<f32> = x.to_dtype(candle_core::DType::F32)?.flatten_all()?.to_vec1()?;
    Ok(numbers.chunks_exact(4).map(|row| [row[0], row[1], row[2], row[3]]).collect())
}

pub(super) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}
