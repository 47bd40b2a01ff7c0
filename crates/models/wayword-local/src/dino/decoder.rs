//! The decoder: in each layer the queries look at each other, at the text and at the picture, and then move their
//! boxes.

use super::{
    LoadResult,
    config::DinoConfig,
    deformable::{DeformableAttention, SamplingOrigin},
    features::FeatureLevel,
    heads::DinoHeads,
    layers::{NormedFeedForward, ProjectedAttention, ReluPerceptron},
    position,
    queries::{rows_of_four, sigmoid},
};
use crate::{ops::LayerNorm, weights::WeightScope};
use candle_core::{Result, Tensor};

/// The numbers of a box are kept this far from 0 and 1 before it is moved, so that their logits stay finite.
const BOX_SHARE_EPSILON: f32 = 1e-5;

/// All layers of the decoder.
pub(super) struct DinoDecoder {
    /// The learned first states of the queries, the same for all pictures, [queries, size].
    begin: Tensor,
    layers: Vec<DinoDecoderLayer>,
    norm: LayerNorm,
    /// Turns the encoded position of a query's box into a vector that is added to its state.
    places: ReluPerceptron,
    heads: DinoHeads,
    size: usize,
}

/// One layer: queries look at each other (`mix`), at the text (`read`) and at the picture (`look`), then comes a
/// feed-forward network (`feed`). A norm follows each step.
struct DinoDecoderLayer {
    mix: ProjectedAttention,
    mix_norm: LayerNorm,
    read: ProjectedAttention,
    read_norm: LayerNorm,
    look: DeformableAttention,
    look_norm: LayerNorm,
    feed: NormedFeedForward,
}

/// The result of the queries: scores for each token, and boxes.
pub(super) struct DinoPredictions {
    /// The logits [queries, tokens] that score how well each query fits each token.
    pub(super) logits: Tensor,
    /// The box of each query: middle, width and height, as shares of the picture's width and height.
    pub(super) boxes: Vec<[f32; 4]>,
}

impl DinoDecoder {
    /// Reads the decoder from a whole checkpoint.
    pub(super) fn from_weights(all: &WeightScope<'_>, config: &DinoConfig) -> LoadResult<Self> {
        let (size, model) = (config.size, all.sub_scope("model"));
        let decoder = model.sub_scope("decoder");
        let layer = |at: usize| DinoDecoderLayer::from_weights(&decoder.sub_scope("layers").sub_scope(at), config);
        Ok(Self {
            begin: model.read_state("query_position_embeddings.weight", &[config.queries, size])?,
            layers: (0..config.decoder.count).map(layer).collect::<LoadResult<_>>()?,
            norm: decoder.read_layer_norm("layer_norm", size, config.epsilon)?,
            places: ReluPerceptron::from_weights(&decoder.sub_scope("reference_points_head"), &[2 * size, size, size])?,
            heads: DinoHeads::from_weights(all, config)?,
            size,
        })
    }

    /// Refines the queries' first boxes, the best first, with the encoder's cells [1, cells, size] and text
    /// [1, tokens, size].
    pub(super) fn refine_boxes(
        &self,
        mut boxes: Vec<[f32; 4]>,
        cells: &Tensor,
        text: &Tensor,
        levels: &[FeatureLevel],
    ) -> Result<DinoPredictions> {
        let mut states = self.begin.narrow(0, 0, boxes.len())?.unsqueeze(0)?;
        let last = self.layers.len() - 1;
        for (at, layer) in self.layers.iter().enumerate() {
            let places = Tensor::from_vec(
                position::box_positions(&boxes, self.size),
                (1, boxes.len(), 2 * self.size),
                states.device(),
            )?;
            let places = self.places.apply_to(&places.to_dtype(states.dtype())?)?;
            states = layer.apply_to(&states, &places, &boxes, (cells, levels), text)?;
            // Between layers the states move the boxes as they are. At the end the normalised states do.
            if at < last {
                boxes = move_boxes(&boxes, &self.heads.box_moves(at, &states)?)?;
            }
        }
        let states = self.norm.apply_to(&states)?;
        let boxes = move_boxes(&boxes, &self.heads.box_moves(last, &states)?)?;
        Ok(DinoPredictions { logits: self.heads.contrast.token_logits(&states, text)?, boxes })
    }
}

/// Moves boxes. The movement is added to the logits of their numbers, so that they stay between 0 and 1.
fn move_boxes(boxes: &[[f32; 4]], moves: &Tensor) -> Result<Vec<[f32; 4]>> {
    let logit = |share: f32| {
        let share = share.clamp(BOX_SHARE_EPSILON, 1.0 - BOX_SHARE_EPSILON);
        (share / (1.0 - share)).ln()
    };
    let move_one =
        |(from, by): (&[f32; 4], [f32; 4])| std::array::from_fn(|edge| sigmoid(by[edge] + logit(from[edge])));
    Ok(boxes.iter().zip(rows_of_four(moves)?).map(move_one).collect())
}

impl DinoDecoderLayer {
    fn from_weights(weights: &WeightScope<'_>, config: &DinoConfig) -> LoadResult<Self> {
        let (size, heads, epsilon) = (config.size, config.decoder.heads, config.epsilon);
        let norm = |name: &str| weights.read_layer_norm(name, size, epsilon);
        let widths = (size, config.decoder.inner);
        Ok(Self {
            mix: ProjectedAttention::from_weights(&weights.sub_scope("self_attn"), size, heads)?,
            mix_norm: norm("self_attn_layer_norm")?,
            read: ProjectedAttention::from_weights(&weights.sub_scope("encoder_attn_text"), size, heads)?,
            read_norm: norm("encoder_attn_text_layer_norm")?,
            look: DeformableAttention::from_weights(
                &weights.sub_scope("encoder_attn"),
                size,
                config.levels,
                config.decoder,
            )?,
            look_norm: norm("encoder_attn_layer_norm")?,
            feed: NormedFeedForward::from_weights(weights, "final_layer_norm", widths, config.activation, epsilon)?,
        })
    }

    fn apply_to(
        &self,
        states: &Tensor,
        places: &Tensor,
        boxes: &[[f32; 4]],
        (cells, levels): (&Tensor, &[FeatureLevel]),
        text: &Tensor,
    ) -> Result<Tensor> {
        let placed = (states + places)?;
        let mixed = self.mix.attend_to(&placed, &placed, states, None)?;
        let states = self.mix_norm.apply_to(&(states + mixed)?)?;
        let read = self.read.attend_to(&(&states + places)?, text, text, None)?;
        let states = self.read_norm.apply_to(&(states + read)?)?;
        let seen = self.look.sample_cells(&(&states + places)?, cells, levels, SamplingOrigin::Boxes(boxes))?;
        self.feed.apply_to(&self.look_norm.apply_to(&(states + seen)?)?)
    }
}
