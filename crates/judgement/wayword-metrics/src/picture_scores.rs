//! How well texts agree with pictures, after CLIPScore (Hessel et al. 2021, arXiv 2104.08718).
//!
//! CLIPScore rates one caption for one picture. An instruction is longer than CLIP's input, and its path has several pictures, so
//! there are two figures: one rates each part of the text with the picture that it fits best, the other rates the whole text.

use crate::{MeanEstimate, ResamplingOptions, clustered_interval};
use serde::Serialize;

/// The factor by which CLIPScore multiplies a cosine, so that most scores lie between 0 and 1.
const CLIP_SCORE_FACTOR: f64 = 2.5;

/// The words that CLIPScore puts before a text.
pub const CLIP_PROMPT_PREFIX: &str = "A photo depicts ";

/// The score of a text and a picture, from the cosine of their vectors.
#[must_use]
pub fn clip_score(cosine: f64) -> f64 {
    CLIP_SCORE_FACTOR * cosine.max(0.0)
}

/// How well a text agrees with the pictures of a path.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PictureScores {
    /// The mean over the text's parts of the score with the picture that each part fits best.
    pub parts: f64,
    /// The mean over the pictures of the score of the whole text, of which CLIP reads the beginning.
    pub whole: f64,
}

impl PictureScores {
    /// From the cosines of the whole text, and of each of its parts, with each picture. `None` without a picture or a part.
    #[must_use]
    pub fn from_cosines(whole: &[f64], parts: &[Vec<f64>]) -> Option<Self> {
        let best = |cosines: &Vec<f64>| cosines.iter().copied().reduce(f64::max).map(clip_score);
        let best: Vec<f64> = parts.iter().map(best).collect::<Option<_>>()?;
        let whole: Vec<f64> = whole.iter().copied().map(clip_score).collect();
        Some(Self { parts: mean(&best)?, whole: mean(&whole)? })
    }
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The scores of one item's texts with the pictures of the item's path.
#[derive(Debug, Clone, PartialEq)]
pub struct PicturedItem<'a> {
    /// The path: items of one path are not independent.
    pub cluster: &'a str,
    /// Scores of the text that is judged.
    pub text: PictureScores,
    /// Another person's text of the item.
    pub person: Option<PictureScores>,
    /// A person's text of another path.
    pub other_path: Option<PictureScores>,
}

/// Both figures of a set of texts, with intervals that draw paths.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PictureFigures {
    /// Of the texts' parts.
    pub parts: MeanEstimate,
    /// Of the texts as a whole.
    pub whole: MeanEstimate,
}

/// Figures of a set of texts and of the two anchors, all with the pictures of the items' own paths.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnchoredPictureFigures {
    /// The texts.
    pub text: Option<PictureFigures>,
    /// Another person's text of each item that has one.
    pub person: Option<PictureFigures>,
    /// A person's text of another path. `None` where there is a single path.
    pub other_path: Option<PictureFigures>,
}

/// The figures of items' texts, and of the anchors.
#[must_use]
pub fn anchored_picture_figures(items: &[PicturedItem<'_>], drawing: &ResamplingOptions) -> AnchoredPictureFigures {
    let figures = |select: fn(&PicturedItem<'_>) -> Option<PictureScores>| -> Option<PictureFigures> {
        let scored: Vec<(&str, PictureScores)> =
            items.iter().filter_map(|item| select(item).map(|scores| (item.cluster, scores))).collect();
        let estimate = |value: fn(&PictureScores) -> f64| {
            let values: Vec<(&str, f64)> = scored.iter().map(|(cluster, scores)| (*cluster, value(scores))).collect();
            clustered_interval(&values, drawing.resamples, drawing.level, drawing.seed)
        };
        Some(PictureFigures { parts: estimate(|scores| scores.parts)?, whole: estimate(|scores| scores.whole)? })
    };
    AnchoredPictureFigures {
        text: figures(|item| Some(item.text)),
        person: figures(|item| item.person),
        other_path: figures(|item| item.other_path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_counts_with_its_best_picture_and_the_whole_with_all() {
        // Two pictures. The second part fits none of them: a cosine below zero is no score.
        let found = PictureScores::from_cosines(&[0.2, -0.4], &[vec![0.1, 0.3], vec![-0.2, -0.1]]).unwrap();
        assert!((found.whole - 2.5 * 0.2 / 2.0).abs() < 1e-12, "{found:?}");
        assert!((found.parts - 2.5 * 0.3 / 2.0).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn without_pictures_or_parts_there_is_no_score() {
        assert_eq!(PictureScores::from_cosines(&[], &[vec![]]), None);
        assert_eq!(PictureScores::from_cosines(&[0.5], &[]), None);
    }

    #[test]
    fn anchors_are_of_the_items_that_have_them() {
        let agreed = |value: f64| PictureScores { parts: value, whole: value / 2.0 };
        let seen = |cluster, text: f64, person: Option<f64>| PicturedItem {
            cluster,
            text: agreed(text),
            person: person.map(agreed),
            other_path: None,
        };
        let items = [seen("a", 0.5, Some(0.8)), seen("b", 0.7, None)];
        let found = anchored_picture_figures(&items, &ResamplingOptions { resamples: 100, level: 0.95, seed: 0 });
        let text = found.text.unwrap();
        assert!((text.parts.mean - 0.6).abs() < 1e-12 && (text.whole.mean - 0.3).abs() < 1e-12);
        assert_eq!((text.parts.values, found.person.unwrap().parts.values), (2, 1));
        assert_eq!(found.other_path, None);
    }
}
