//! Turns the head's outputs into boxes with scores, as the original implementation does.
//!
//! Each position of each level has an anchor, a square around it. The head moves and resizes the anchor. Of boxes that
//! overlap too much, the best one for each phrase stays.

use super::{head::GlipLevelOutputs, prompt::GlipPrompt};
use wayword_core::{DetectedBox, MAX_BOXES_PER_PHRASE};

/// A phrase with a lower probability at a position gets no box there.
const MIN_PHRASE_PROBABILITY: f64 = 0.05;

/// The most candidates of a level; those with lower scores are dropped. A candidate is a pair of position and phrase.
const MAX_LEVEL_CANDIDATES: usize = 1000;

/// A box that overlaps with a better one of the same phrase by more than this share of their union is left out.
const MAX_BOX_OVERLAP: f64 = 0.6;

/// The logarithm of how many times larger than its anchor a box may be: ln(1000 / 16).
const MAX_LOG_BOX_GROWTH: f64 = 4.135_166_556_742_356;

/// Width and height of a picture as the model gets it, without padding (`shown`), and of the picture itself.
#[derive(Debug, Clone, Copy)]
pub(super) struct GlipPictureSizes {
    pub(super) shown: (usize, usize),
    pub(super) picture: (usize, usize),
}

/// A box [x1, y1, x2, y2] in the picture as the model sees it, with its score and its phrase.
struct GlipCandidate {
    edges: [f64; 4],
    score: f64,
    phrase: usize,
}

/// For each phrase of a prompt, in their order, its boxes in the picture, the best first, at most [`MAX_BOXES_PER_PHRASE`].
pub(super) fn phrase_boxes(
    outputs: &[GlipLevelOutputs],
    prompt: &GlipPrompt,
    sizes: GlipPictureSizes,
) -> Vec<Vec<DetectedBox>> {
    let mut candidates: Vec<GlipCandidate> = outputs
        .iter()
        .enumerate()
        .flat_map(|(level, outputs)| level_candidates(level, outputs, prompt, sizes))
        .collect();
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut kept: Vec<Vec<GlipCandidate>> = prompt.phrases.iter().map(|_| Vec::new()).collect();
    for candidate in candidates {
        let better_boxes = &mut kept[candidate.phrase];
        if better_boxes.len() < MAX_BOXES_PER_PHRASE
            && better_boxes.iter().all(|better| box_overlap(&better.edges, &candidate.edges) <= MAX_BOX_OVERLAP)
        {
            better_boxes.push(candidate);
        }
    }
    let (across, down) =
        (sizes.picture.0 as f64 / sizes.shown.0.max(1) as f64, sizes.picture.1 as f64 / sizes.shown.1.max(1) as f64);
    let to_detected_box = |candidate: GlipCandidate| DetectedBox {
        box_px: [(0, across), (1, down), (2, across), (3, down)].map(|(edge, by)| (candidate.edges[edge] * by) as f32),
        score: candidate.score as f32,
    };
    kept.into_iter().map(|better_boxes| better_boxes.into_iter().map(to_detected_box).collect()).collect()
}

/// The best candidates of a level.
fn level_candidates(
    level: usize,
    outputs: &GlipLevelOutputs,
    prompt: &GlipPrompt,
    sizes: GlipPictureSizes,
) -> Vec<GlipCandidate> {
    let count = outputs.height * outputs.width;
    let tokens = outputs.logits.len() / count.max(1);
    let mut values = Vec::new();
    for (position, (logits, boxes)) in
        outputs.logits.chunks_exact(tokens.max(1)).zip(outputs.boxes.chunks_exact(5)).enumerate()
    {
        let centre = sigmoid(boxes[4]);
        for (phrase, (_, phrase_tokens)) in prompt.phrases.iter().enumerate() {
            let sum: f64 =
                phrase_tokens.iter().filter_map(|&token| logits.get(token)).map(|&logit| sigmoid(logit)).sum();
            let probability = sum / phrase_tokens.len().max(1) as f64;
            if probability > MIN_PHRASE_PROBABILITY {
                values.push((probability * centre, position, phrase));
            }
        }
    }
    // Among equals the first stay first.
    values.sort_by(|a, b| b.0.total_cmp(&a.0));
    values.truncate(MAX_LEVEL_CANDIDATES);
    let candidate = |(value, position, phrase): (f64, usize, usize)| {
        let deltas = &outputs.boxes[position * 5..position * 5 + 4];
        let edges = box_edges(level, position % outputs.width, position / outputs.width, deltas, sizes.shown);
        GlipCandidate { edges, score: value.sqrt(), phrase }
    };
    values.into_iter().map(candidate).collect()
}

/// The edges of the box at a column and row of a level, clamped to the picture as the model sees it.
fn box_edges(level: usize, column: usize, row: usize, deltas: &[f32], (width, height): (usize, usize)) -> [f64; 4] {
    // The distance between two positions of the level, and the side of an anchor, pixels.
    let (stride, side) = ((8_usize << level) as f64, (64_usize << level) as f64);
    // `moved` is in tenths of the side, and `grown` in fifths of the logarithm of the growth, as in the original.
    let axis = |at: usize, moved: f32, grown: f32, length: usize| {
        let centre = f64::from(moved) / 10.0 * side + at as f64 * stride + (stride - 1.0) / 2.0;
        let half = ((f64::from(grown) / 5.0).min(MAX_LOG_BOX_GROWTH).exp() * side - 1.0) / 2.0;
        let last_pixel = length.saturating_sub(1) as f64;
        [(centre - half).clamp(0.0, last_pixel), (centre + half).clamp(0.0, last_pixel)]
    };
    let ([left, right], [top, bottom]) =
        (axis(column, deltas[0], deltas[2], width), axis(row, deltas[1], deltas[3], height));
    [left, top, right, bottom]
}

/// The area that two boxes share, divided by the area that they cover together. The pixels at both edges belong to a
/// box, so that a box from 3 to 5 is 3 pixels long.
fn box_overlap(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    let length = |from: f64, to: f64| (to - from + 1.0).max(0.0);
    let area = |edges: &[f64; 4]| length(edges[0], edges[2]) * length(edges[1], edges[3]);
    let shared = length(a[0].max(b[0]), a[2].min(b[2])) * length(a[1].max(b[1]), a[3].min(b[3]));
    shared / (area(a) + area(b) - shared)
}

fn sigmoid(x: f32) -> f64 {
    1.0 / (1.0 + (-f64::from(x)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prompt(phrases: usize) -> GlipPrompt {
        GlipPrompt { ids: Vec::new(), phrases: (0..phrases).map(|at| (at, vec![at])).collect() }
    }

    /// A level of `width` x 1 positions.
    fn said(logits: Vec<f32>, boxes: Vec<f32>) -> GlipLevelOutputs {
        GlipLevelOutputs { height: 1, width: boxes.len() / 5, logits, boxes }
    }

    const SIZES: GlipPictureSizes = GlipPictureSizes { shown: (100, 100), picture: (200, 100) };

    #[test]
    fn an_unmoved_box_is_its_anchor_in_picture_pixels() {
        let found = phrase_boxes(&[said(vec![0.0], vec![0.0; 5])], &prompt(1), SIZES);
        // The anchor of 64 pixels around 3.5 goes to 35, twice as far in the picture; probability and centreness are
        // 0.5.
        assert_eq!(found, [[DetectedBox { box_px: [0.0, 0.0, 70.0, 35.0], score: 0.5 }]]);
    }

    #[test]
    fn an_improbable_phrase_gets_no_box() {
        // 0.05 itself is not enough; centreness does not count here.
        let p = |p: f32| (p / (1.0 - p)).ln();
        let found =
            phrase_boxes(&[said(vec![p(0.0499), p(0.0501)], [0.0, 0.0, 0.0, 0.0, -20.0].to_vec())], &prompt(2), SIZES);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [0, 1]);
    }

    #[test]
    fn a_phrase_is_the_mean_of_its_tokens() {
        let prompt = GlipPrompt { ids: Vec::new(), phrases: vec![(0, vec![0, 1])] };
        let found = phrase_boxes(&[said(vec![50.0, -50.0], [0.0, 0.0, 0.0, 0.0, 50.0].to_vec())], &prompt, SIZES);
        assert!((found[0][0].score - 0.5_f32.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn of_overlapping_boxes_the_best_of_each_phrase_stays() {
        // Two neighbouring positions: the same box, moved by 8 pixels.
        let found = phrase_boxes(&[said(vec![0.0, 1.0, 1.0, 0.0], vec![0.0; 10])], &prompt(2), SIZES);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1]);
        assert!(found[0][0].box_px[2] > found[1][0].box_px[2]);
    }

    #[test]
    fn boxes_drop_numbers_that_are_not_finite() {
        let found = phrase_boxes(&[said(vec![f32::NAN], vec![f32::NAN; 5])], &prompt(1), SIZES);
        assert!(found[0].is_empty());
        let found = phrase_boxes(&[said(vec![f32::INFINITY], vec![f32::INFINITY; 5])], &prompt(1), SIZES);
        assert!(found[0].iter().flat_map(|found| found.box_px).all(|edge| (0.0..=200.0).contains(&edge)));
    }

    #[test]
    fn the_boxes_of_a_phrase_are_bounded() {
        // 40 x 40 positions of a coarse level that shrink their boxes to points.
        let count = 1600;
        let boxes_px: Vec<f32> = (0..count).flat_map(|_| [0.0, 0.0, -40.0, -40.0, 0.0]).collect();
        let said = GlipLevelOutputs { height: 40, width: 40, logits: vec![0.0; count], boxes: boxes_px };
        let sizes = GlipPictureSizes { shown: (10_000, 10_000), picture: (10_000, 10_000) };
        assert_eq!(phrase_boxes(&[said], &prompt(1), sizes)[0].len(), MAX_BOXES_PER_PHRASE);
    }
}
