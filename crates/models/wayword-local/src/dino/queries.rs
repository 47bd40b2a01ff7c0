//! Chooses the queries: the cells that fit the text best, each with a first box.
//!
//! Every cell has an own box around its middle, with a size that depends on the level. The network moves this box a
//! little.

use super::{config::Config, features::Level, heads::Contrast, layers::Perceptron};
use crate::{
    LocalError,
    ops::{LayerNorm, Linear},
    weights::Scope,
};
use candle_core::{Result, Tensor};

/// The width and height of a cell's own box on the finest level, as a share of the picture. Each level doubles them.
const SHARE: f32 = 0.05;

/// A cell's own box counts if all its numbers lie within these.
const LEAST: f32 = 0.01;
const MOST: f32 = 0.99;

/// Chooses the cells that become queries.
pub(super) struct Chooser {
    layer: Linear,
    norm: LayerNorm,
    boxes: Perceptron,
    contrast: Contrast,
    queries: usize,
}

/// All cells as candidates.
pub(super) struct Candidates {
    /// [1, cells, size].
    states: Tensor,
    /// The logits of each cell's own box; infinite for a cell that cannot be chosen for lack of a valid box.
    own: Vec<[f32; 4]>,
    /// The logit of each cell's best token.
    pub(super) scores: Vec<f32>,
}

impl Chooser {
    pub(super) fn load(model: &Scope<'_>, config: &Config) -> std::result::Result<Self, LocalError> {
        let size = config.size;
        Ok(Self {
            layer: model.linear("enc_output", size, size)?,
            norm: model.layer_norm("enc_output_norm", size, config.epsilon)?,
            boxes: Perceptron::load(&model.sub("encoder_output_bbox_embed"), &[size, size, size, 4])?,
            contrast: Contrast::load(&model.sub("encoder_output_class_embed"), config)?,
            queries: config.queries,
        })
    }

    /// Scores all cells [1, cells, size] by how well they fit the text [1, tokens, size].
    pub(super) fn candidates(&self, cells: &Tensor, text: &Tensor, levels: &[Level]) -> Result<Candidates> {
        let own: Vec<[f32; 4]> = levels.iter().enumerate().flat_map(|(at, &level)| own_boxes(at, level)).collect();
        let counts = own.iter().map(|own| if own[0].is_finite() { 1.0_f32 } else { 0.0 }).collect();
        let counts = Tensor::from_vec(counts, (1, own.len(), 1), cells.device())?.to_dtype(cells.dtype())?;
        let states = self.norm.of(&self.layer.of(&cells.broadcast_mul(&counts)?)?)?;
        let logits = self.contrast.of(&states, text)?;
        let scores = logits.max(candle_core::D::Minus1)?.flatten_all()?.to_dtype(candle_core::DType::F32)?.to_vec1()?;
        Ok(Candidates { states, own, scores })
    }

    /// The cells with the best scores, the best first. Cells with equal scores stay in their order.
    pub(super) fn best(&self, candidates: &Candidates) -> Vec<u32> {
        let scores = &candidates.scores;
        let mut order: Vec<u32> = (0..scores.len() as u32).collect();
        order.sort_by(|&a, &b| scores[b as usize].total_cmp(&scores[a as usize]));
        order.truncate(self.queries);
        order
    }

    /// The boxes of the picked cells: middle, width and height, as shares of the picture's width and height.
    pub(super) fn boxes(&self, candidates: &Candidates, picked: &[u32]) -> Result<Vec<[f32; 4]>> {
        let at = Tensor::from_slice(picked, picked.len(), candidates.states.device())?;
        let states = candidates.states.index_select(&at, 1)?;
        let moved = rows(&self.boxes.of(&states)?)?;
        let place = |(moved, &at): ([f32; 4], &u32)| {
            let own = candidates.own[at as usize];
            std::array::from_fn(|edge| sigmoid(moved[edge] + own[edge]))
        };
        Ok(moved.into_iter().zip(picked).map(place).collect())
    }
}

/// The logits of the own boxes of a level's cells.
fn own_boxes(at: usize, level: Level) -> impl Iterator<Item = [f32; 4]> {
    let share = SHARE * (at as f32).exp2();
    level.middles().map(move |[x, y]| {
        let own = [x, y, share, share];
        let counts = own.iter().all(|edge| (LEAST..MOST).contains(edge) && *edge > LEAST);
        if counts { own.map(|edge| (edge / (1.0 - edge)).ln()) } else { [f32::INFINITY; 4] }
    })
}

/// The rows of a tensor [1, rows, 4], four numbers each.
pub(super) fn rows(x: &Tensor) -> Result<Vec<[f32; 4]>> {
    let numbers: Vec<f32> = x.to_dtype(candle_core::DType::F32)?.flatten_all()?.to_vec1()?;
    Ok(numbers.chunks_exact(4).map(|row| [row[0], row[1], row[2], row[3]]).collect())
}

pub(super) fn sigmoid(x: f32) -> f32 {
    1.0 / (1.0 + (-x).exp())
}
