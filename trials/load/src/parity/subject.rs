//! A detector of this program under test, and the comparison of its numbers with the expected ones.

use super::{
    NumberDifference, ParityDetector,
    oracle::{CaseNumbers, ParityCase},
    test_picture,
};
use std::path::Path;
use wayword_core::{DetectedBox, Image};
use wayword_local::{GlipDetector, GlipFiles, GroundingDino, ModelDevice, OwlDetector, WeightPrecision};
use wayword_run::error::CommandError;

/// A detector of one kind.
pub(super) enum ParitySubject {
    /// GLIP.
    Glip(Box<GlipDetector>),
    /// Grounding DINO or MM Grounding DINO.
    Dino(Box<GroundingDino>),
    /// OWLv2.
    Owl(Box<OwlDetector>),
}

/// Boxes of two implementations with edges further apart than this, pixels, are different finds.
const MAX_SAME_FIND_PX: f32 = 1.0;

impl ParitySubject {
    /// Loads a detector from a folder. `short_px` is the short edge of pictures, for models with no such setting of their own.
    pub(super) fn load_detector(
        kind: ParityDetector,
        folder: &Path,
        short_px: Option<usize>,
    ) -> Result<Self, CommandError> {
        let (device, precision) = (ModelDevice::cpu(), WeightPrecision::F32);
        Ok(match kind {
            ParityDetector::GlipT => {
                let weights = folder.join("glip.pth");
                let files = GlipFiles { weights, tokenizer: folder.to_owned(), identity: String::new() };
                let short_px = short_px.unwrap_or(GlipDetector::SHORT_EDGE_PX);
                Self::Glip(Box::new(GlipDetector::load("glip", &files, short_px, &device, precision)?))
            }
            ParityDetector::Owlv2Base => Self::Owl(Box::new(OwlDetector::load("owl", folder, &device, precision)?)),
            _ => Self::Dino(Box::new(GroundingDino::load("dino", folder, &device, precision)?)),
        })
    }

    /// Finds phrases in a picture.
    pub(super) fn find_phrases(&self, image: &Image, phrases: &[&str]) -> Result<Vec<Vec<DetectedBox>>, CommandError> {
        Ok(match self {
            Self::Glip(glip) => glip.find_phrases(image, phrases)?,
            Self::Dino(dino) => dino.find_phrases(image, phrases)?,
            Self::Owl(owl) => owl.find_phrases(image, phrases)?,
        })
    }

    /// How far this detector's numbers for a case are from PyTorch's.
    pub(super) fn compare_case(
        &self,
        case: &ParityCase,
        theirs: &CaseNumbers<'_>,
    ) -> Result<NumberDifference, CommandError> {
        let (image, phrases) =
            (test_picture(case.size, 0)?, case.phrases.iter().map(String::as_str).collect::<Vec<_>>());
        let (width, height) = (case.size.0 as f32, case.size.1 as f32);
        match self {
            Self::Glip(glip) => {
                let (logits, _) = glip.raw_outputs(&image, &phrases)?;
                let boxes_px = largest_find_difference(&glip.find_phrases(&image, &phrases)?, &case.expected_finds());
                Ok(NumberDifference { logits: largest_difference(&logits, &theirs.tensor_values("logits")?), boxes_px })
            }
            Self::Dino(dino) => {
                let order: Vec<u32> = theirs.tensor_values("picked")?.iter().map(|&at| at as u32).collect();
                let ours = dino.raw_outputs(&image, &phrases, Some(&order))?;
                let boxes = scale_to_pixels(&ours.boxes.concat(), [width, height]);
                Ok(NumberDifference {
                    logits: largest_difference(&ours.logits.concat(), &theirs.tensor_values("logits")?),
                    // Different candidates have different boxes, so boxes are compared only if the candidates are the same.
                    boxes_px: match same_set(&ours.picked, &order) {
                        true => largest_difference(
                            &boxes,
                            &scale_to_pixels(&theirs.tensor_values("boxes")?, [width, height]),
                        ),
                        false => f32::INFINITY,
                    },
                })
            }
            Self::Owl(owl) => {
                let ours = owl.raw_outputs(&image, &phrases)?;
                let edge = [width.max(height); 2];
                let boxes = scale_to_pixels(&ours.boxes.concat(), edge);
                Ok(NumberDifference {
                    logits: largest_difference(&ours.logits.concat(), &theirs.tensor_values("logits")?),
                    boxes_px: largest_difference(&boxes, &scale_to_pixels(&theirs.tensor_values("boxes")?, edge)),
                })
            }
        }
    }
}

/// The largest absolute difference of two lists; infinite if their lengths differ or a value is not a number.
fn largest_difference(ours: &[f32], theirs: &[f32]) -> f32 {
    if ours.len() != theirs.len() {
        return f32::INFINITY;
    }
    let differences = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs());
    differences.map(|off| if off.is_nan() { f32::INFINITY } else { off }).fold(0.0, f32::max)
}

/// Converts coordinates that are shares of a picture's edges, x and y in turn, to pixels.
fn scale_to_pixels(shares: &[f32], edges: [f32; 2]) -> Vec<f32> {
    shares.iter().zip(edges.iter().cycle()).map(|(share, edge)| share * edge).collect()
}

/// Whether two lists contain the same numbers, in any order.
fn same_set(ours: &[u32], theirs: &[u32]) -> bool {
    let sorted = |picked: &[u32]| {
        let mut picked = picked.to_vec();
        picked.sort_unstable();
        picked
    };
    sorted(ours) == sorted(theirs)
}

/// The largest difference between the edges of finds. Finds with nearly equal scores may come in another order. A find without a
/// counterpart gives an infinite difference.
fn largest_find_difference(ours: &[Vec<DetectedBox>], theirs: &[Vec<DetectedBox>]) -> f32 {
    if ours.len() != theirs.len() {
        return f32::INFINITY;
    }
    let phrase_difference = |(ours, theirs): (&Vec<DetectedBox>, &Vec<DetectedBox>)| {
        let nearest = |find: &DetectedBox| {
            ours.iter().map(|our| largest_difference(&our.box_px, &find.box_px)).fold(f32::INFINITY, f32::min)
        };
        let largest = theirs.iter().map(nearest).fold(0.0, f32::max);
        if ours.len() == theirs.len() && largest <= MAX_SAME_FIND_PX { largest } else { f32::INFINITY }
    };
    ours.iter().zip(theirs).map(phrase_difference).fold(0.0, f32::max)
}
