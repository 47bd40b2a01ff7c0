//! Turns the logits and boxes of patches into finds in the picture's own pixels.

use wayword_core::{DetectedBox, MAX_BOXES_PER_PHRASE, without_overlaps};

/// The lowest score of a box that is reported; others are dropped. The examples of transformers count a box as a find
/// from 0.1.
const MIN_REPORTED_SCORE: f32 = 0.01;

/// A box that overlaps with a better one by more than this share of their union counts as the same box. transformers
/// drops none, but neighbouring patches often give nearly the same box for one thing.
const SAME_BOX_OVERLAP: f64 = 0.7;

/// The finds of a phrase, the best first, from its logits and the boxes of the picture's patches. Boxes are given as
/// centre, width and height, in shares of the longer edge, because black at the right or at the bottom made the picture
/// a square.
pub(super) fn boxes_from_logits(logits: &[f32], boxes: &[[f32; 4]], (width, height): (u32, u32)) -> Vec<DetectedBox> {
    let (width, height) = (width as f32, height as f32);
    let edge = width.max(height);
    let picture_box = |(&logit, &[x, y, across, down]): (&f32, &[f32; 4])| {
        let score = 1.0 / (1.0 + (-logit).exp());
        let (left, right) = ((x - across / 2.0) * edge, (x + across / 2.0) * edge);
        let (top, bottom) = ((y - down / 2.0) * edge, (y + down / 2.0) * edge);
        let box_px =
            [left.clamp(0.0, width), top.clamp(0.0, height), right.clamp(0.0, width), bottom.clamp(0.0, height)];
        let is_there = box_px[2] > box_px[0] && box_px[3] > box_px[1];
        (score >= MIN_REPORTED_SCORE && is_there).then_some(DetectedBox { box_px, score })
    };
    let mut all: Vec<DetectedBox> = logits.iter().zip(boxes).filter_map(picture_box).collect();
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    without_overlaps(all, SAME_BOX_OVERLAP).take(MAX_BOXES_PER_PHRASE).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_in_the_pictures_own_pixels_and_within_it() {
        let boxes = [[0.25, 0.25, 0.5, 0.5], [0.9, 0.5, 0.4, 0.2], [0.5, 0.9, 0.2, 0.1]];
        let told = boxes_from_logits(&[1.0, 3.0, 2.0], &boxes, (100, 50));
        // The third lies in the black below the picture.
        assert_eq!(told.len(), 2);
        let near = |ours: [f32; 4], theirs: [f32; 4]| ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-4);
        assert!(near(told[0].box_px, [70.0, 40.0, 100.0, 50.0]), "{told:?}");
        assert!(near(told[1].box_px, [0.0, 0.0, 50.0, 50.0]), "{told:?}");
        assert!((told[0].score - 0.952_574).abs() < 1e-5 && told[0].score > told[1].score);
    }

    #[test]
    fn a_box_that_repeats_a_better_one_is_dropped() {
        let boxes = [[0.3, 0.3, 0.2, 0.2], [0.302, 0.3, 0.2, 0.2], [0.4, 0.3, 0.2, 0.2]];
        let told = boxes_from_logits(&[0.0, 1.0, -1.0], &boxes, (80, 80));
        assert_eq!(told.len(), 2);
        assert!(told[0].score > 0.7 && told[1].score < 0.3, "{told:?}");
    }

    #[test]
    fn boxes_are_limited_in_number_and_by_score() {
        let boxes: Vec<[f32; 4]> = (0..300).map(|at| [at as f32 / 300.0, 0.5, 0.001, 0.001]).collect();
        assert_eq!(boxes_from_logits(&vec![0.0; 300], &boxes, (1000, 1000)).len(), MAX_BOXES_PER_PHRASE);
        assert!(boxes_from_logits(&vec![-5.0; 300], &boxes, (1000, 1000)).is_empty());
        assert!(boxes_from_logits(&vec![f32::NAN; 300], &boxes, (1000, 1000)).is_empty());
    }
}
