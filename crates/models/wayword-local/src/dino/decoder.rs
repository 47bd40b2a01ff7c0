//! The decoder: in each layer the queries look at each other, at the text and at the picture, and then move their
//! boxes.

use super::{
    config::Config,
    deformable::{Deformable, Origin},
    features::Level,
    heads::Heads,
    layers::{Feed, Mixing, Perceptron},
    position,
    queries::{rows, sigmoid},
};
use crate::{LocalError, ops::LayerNorm, weights::Scope};
use candle_core::{Result, Tensor};

type Loaded<T> = std::result::Result<T, LocalError>;

/// The numbers of a box are kept this far from 0 and 1 before it is moved, so that their logits stay finite.
const EPSILON: f32 = 1e-5;

/// All layers of the decoder.
pub(super) struct Decoder {
    /// The learned first states of the queries, the same for all pictures, [queries, size].
    begin: Tensor,
    layers: Vec<Layer>,
    norm: LayerNorm,
    places: Perceptron,
    heads: Heads,
    size: usize,
}

struct Layer {
    mix: Mixing,
    mix_norm: LayerNorm,
    read: Mixing,
    read_norm: LayerNorm,
    look: Deformable,
    look_norm: LayerNorm,
    feed: Feed,
}

/// The result of the queries: scores for each token, and boxes.
pub(super) struct Seen {
    /// The logits [queries, tokens] that score how well each query fits each token.
    pub(super) logits: Tensor,
    /// The box of each query: middle, width and height, as shares of the picture's width and height.
    pub(super) boxes: Vec<[f32; 4]>,
}

impl Decoder {
    /// Reads the decoder from a whole checkpoint.
    pub(super) fn load(all: &Scope<'_>, config: &Config) -> Loaded<Self> {
        let (size, model) = (config.size, all.sub("model"));
        let decoder = model.sub("decoder");
        let layer = |at: usize| Layer::load(&decoder.sub("layers").sub(at), config);
        Ok(Self {
            begin: model.state("query_position_embeddings.weight", &[config.queries, size])?,
            layers: (0..config.decoder.count).map(layer).collect::<Loaded<_>>()?,
            norm: decoder.layer_norm("layer_norm", size, config.epsilon)?,
            places: Perceptron::load(&decoder.sub("reference_points_head"), &[2 * size, size, size])?,
            heads: Heads::load(all, config)?,
            size,
        })
    }

    /// Refines the queries' first boxes, the best first, with the encoder's cells [1, cells, size] and text
    /// [1, tokens, size].
    pub(super) fn of(&self, mut boxes: Vec<[f32; 4]>, cells: &Tensor, text: &Tensor, levels: &[Level]) -> Result<Seen> {
        let mut states = self.begin.narrow(0, 0, boxes.len())?.unsqueeze(0)?;
        let last = self.layers.len() - 1;
        for (at, layer) in self.layers.iter().enumerate() {
            let places = Tensor::from_vec(
                position::of_boxes(&boxes, self.size),
                (1, boxes.len(), 2 * self.size),
                states.device(),
            )?;
            let places = self.places.of(&places.to_dtype(states.dtype())?)?;
            states = layer.of(&states, &places, &boxes, (cells, levels), text)?;
            // Between layers the states move the boxes as they are. At the end the normalised states do.
            if at < last {
                boxes = moved(&boxes, &self.heads.moves(at, &states)?)?;
            }
        }
        let states = self.norm.of(&states)?;
        let boxes = moved(&boxes, &self.heads.moves(last, &states)?)?;
        Ok(Seen { logits: self.heads.contrast.of(&states, text)?, boxes })
    }
}

/// Moves boxes. The movement is added to the logits of their numbers, so that they stay between 0 and 1.
fn moved(boxes: &[[f32; 4]], moves: &Tensor) -> Result<Vec<[f32; 4]>> {
    let logit = |share: f32| {
        let share = share.clamp(EPSILON, 1.0 - EPSILON);
        (share / (1.0 - share)).ln()
    };
    let one = |(from, by): (&[f32; 4], [f32; 4])| std::array::from_fn(|edge| sigmoid(by[edge] + logit(from[edge])));
    Ok(boxes.iter().zip(rows(moves)?).map(one).collect())
}

impl Layer {
    fn load(weights: &Scope<'_>, config: &Config) -> Loaded<Self> {
        let (size, heads, epsilon) = (config.size, config.decoder.heads, config.epsilon);
        let norm = |name: &str| weights.layer_norm(name, size, epsilon);
        let widths = (size, config.decoder.inner);
        Ok(Self {
            mix: Mixing::load(&weights.sub("self_attn"), size, heads)?,
            mix_norm: norm("self_attn_layer_norm")?,
            read: Mixing::load(&weights.sub("encoder_attn_text"), size, heads)?,
            read_norm: norm("encoder_attn_text_layer_norm")?,
            look: Deformable::load(&weights.sub("encoder_attn"), size, config.levels, config.decoder)?,
            look_norm: norm("encoder_attn_layer_norm")?,
            feed: Feed::load(weights, "final_layer_norm", widths, config.activation, epsilon)?,
        })
    }

    fn of(
        &self,
        states: &Tensor,
        places: &Tensor,
        boxes: &[[f32; 4]],
        (cells, levels): (&Tensor, &[Level]),
        text: &Tensor,
    ) -> Result<Tensor> {
        let placed = (states + places)?;
        let mixed = self.mix.of(&placed, &placed, states, None)?;
        let states = self.mix_norm.of(&(states + mixed)?)?;
        let read = self.read.of(&(&states + places)?, text, text, None)?;
        let states = self.read_norm.of(&(states + read)?)?;
        let seen = self.look.of(&(&states + places)?, cells, levels, Origin::Boxes(boxes))?;
        self.feed.of(&self.look_norm.of(&(states + seen)?)?)
    }
}
