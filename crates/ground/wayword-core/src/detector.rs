//! Detectors: models that look for phrases in pictures and give boxes with scores, and an adapter that scores whole
//! views by their best box.

use crate::{ModelError, ObjectId, ObjectLabel, PhraseGrounder, View};
use serde::{Deserialize, Serialize};

/// The most boxes that a detector gives for a phrase in a view; it leaves out those with lower scores.
pub const MAX_BOXES_PER_PHRASE: usize = 100;

/// The least share of its union with an object's outline that a box must cover to be a box of that object.
const MIN_OVERLAP_SHARE: f64 = 0.1;

/// A place in a picture at which a phrase was found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DetectedBox {
    /// Left, top, right and bottom edge in the view's picture, pixels from its upper left corner, within the picture.
    pub box_px: [f32; 4],
    /// How sure the detector is, 0 to 1, on the scale that [`DetectorScoring`] explains.
    pub score: f32,
}

impl DetectedBox {
    /// The area that two boxes share, as a share of the area that they cover together, 0 to 1.
    #[must_use]
    pub fn overlap_share(&self, other: &Self) -> f64 {
        box_overlap_share(self.box_edges(), other.box_edges())
    }

    fn box_edges(&self) -> [f64; 4] {
        self.box_px.map(f64::from)
    }
}

/// Leaves out every detection that overlaps a better one by more than `most_overlap` (0 to 1). The rest come in their
/// order, which must be the best first.
pub fn without_overlaps(
    detections: impl IntoIterator<Item = DetectedBox>,
    most_overlap: f64,
) -> impl Iterator<Item = DetectedBox> {
    let mut kept: Vec<DetectedBox> = Vec::new();
    detections.into_iter().filter(move |detection| {
        let is_apart = kept.iter().all(|better| better.overlap_share(detection) <= most_overlap);
        if is_apart {
            kept.push(*detection);
        }
        is_apart
    })
}

/// The meaning of a detector's scores.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DetectorScoring {
    /// The definition of a score, with the prompt that it belongs to, in words for provenance.
    pub means: &'static str,
    /// The score from which its makers count a box as a find.
    pub find_threshold: f32,
    /// Whether the phrases that are looked for together change each other's scores. Then scores of different phrases
    /// can be compared only where each phrase was looked for by itself.
    pub phrases_interact: bool,
}

/// Finds things in pictures by phrases.
///
/// Scores of one detector and phrase can be compared between views, because every view is looked at by itself. Between
/// phrases they can be compared under the condition of [`DetectorScoring::phrases_interact`]; between detectors they cannot.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait ObjectDetector: Send + Sync {
    /// `provider/model`.
    fn name(&self) -> &str;

    /// The meaning of its scores.
    fn scoring(&self) -> DetectorScoring;

    /// One result per view, in their order: for each phrase, in their order, where it was found, the best first, at most
    /// [`MAX_BOXES_PER_PHRASE`]. A phrase that was not found has none. A view that fails does not fail the others.
    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>>;
}

impl<D: ObjectDetector + ?Sized> ObjectDetector for std::sync::Arc<D> {
    fn name(&self) -> &str {
        (**self).name()
    }

    fn scoring(&self) -> DetectorScoring {
        (**self).scoring()
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        (**self).detect_phrases(views, phrases)
    }
}

/// A detector as a [`PhraseGrounder`]: a phrase scores as its best box does, or 0 where it was not found. Where phrases change
/// each other's scores, each is looked for by itself.
#[derive(Debug)]
pub struct DetectorGrounder<D> {
    detector: D,
}

impl<D: ObjectDetector> DetectorGrounder<D> {
    /// A grounder that asks a detector.
    #[must_use]
    pub fn new(detector: D) -> Self {
        Self { detector }
    }

    /// The meaning of its scores.
    #[must_use]
    pub fn scoring(&self) -> DetectorScoring {
        self.detector.scoring()
    }
}

impl<D: ObjectDetector> PhraseGrounder for DetectorGrounder<D> {
    fn name(&self) -> &str {
        self.detector.name()
    }

    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let best_score = |boxes: &Vec<DetectedBox>| boxes.iter().map(|found| found.score).fold(0.0, f32::max);
        let batch_size = if self.detector.scoring().phrases_interact { 1 } else { phrases.len().max(1) };
        let mut scores: Vec<Result<Vec<f32>, ModelError>> = views.iter().map(|_| Ok(Vec::new())).collect();
        for batch in phrases.chunks(batch_size) {
            for (scores, detected) in scores.iter_mut().zip(self.detector.detect_phrases(views, batch)) {
                match (scores.as_mut(), detected) {
                    (Ok(scores), Ok(detected)) => scores.extend(detected.iter().map(best_score)),
                    (Ok(_), Err(error)) => *scores = Err(error),
                    (Err(_), _) => {}
                }
            }
        }
        scores
    }

    /// The object of which the outline is covered best by the best box of all views. A view without outlines has no
    /// objects.
    fn point_to_object(&self, views: &[&View], phrase: &str) -> Result<Option<ObjectId>, ModelError> {
        let mut best: Option<(DetectedBox, &View)> = None;
        for (view, detected) in views.iter().zip(self.detector.detect_phrases(views, &[phrase])) {
            for detection in detected?.into_iter().flatten() {
                if best.is_none_or(|(best, _)| detection.score > best.score) {
                    best = Some((detection, view));
                }
            }
        }
        Ok(best.and_then(|(detection, view)| best_outlined_object(view, detection)))
    }
}

/// The object of a view that a box covers best, judged by the outlines; `None` below [`MIN_OVERLAP_SHARE`].
fn best_outlined_object(view: &View, detection: DetectedBox) -> Option<ObjectId> {
    let overlap = |label: &ObjectLabel| {
        label.box_px.map_or(0.0, |[x, y, width, height]| {
            box_overlap_share(detection.box_edges(), [x, y, x + width, y + height])
        })
    };
    let best = view.outlined_labels().map(|label| (overlap(label), label)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 >= MIN_OVERLAP_SHARE).then(|| best.1.object.clone())
}

/// The area that two boxes share, as a share of the area that they cover together. Each is given by its left, top, right and
/// bottom edge.
fn box_overlap_share(a: [f64; 4], b: [f64; 4]) -> f64 {
    let across = (a[2].min(b[2]) - a[0].max(b[0])).max(0.0);
    let down = (a[3].min(b[3]) - a[1].max(b[1])).max(0.0);
    let area = |[left, top, right, bottom]: [f64; 4]| (right - left) * (bottom - top);
    let shared = across * down;
    let all = area(a) + area(b) - shared;
    if all > 0.0 { shared / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DVec3, GroundTruth, Heading, Pose};

    /// Finds `sink` with 0.5 on the left half of a picture of 10 pixels, and with 0.9 where it is alone.
    struct Meets {
        meets: bool,
    }

    impl ObjectDetector for Meets {
        fn name(&self) -> &str {
            "meets"
        }

        fn scoring(&self) -> DetectorScoring {
            DetectorScoring { means: "made up", find_threshold: 0.5, phrases_interact: self.meets }
        }

        fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
            let score = if phrases.len() == 1 { 0.9 } else { 0.5 };
            let one = |phrase: &&str| match *phrase {
                "sink" => vec![
                    DetectedBox { box_px: [0.0, 0.0, 5.0, 10.0], score },
                    DetectedBox { box_px: [0.0; 4], score: 0.1 },
                ],
                _ => Vec::new(),
            };
            let of_view = |view: &&View| match view.is_blank() {
                false => Ok(phrases.iter().map(one).collect()),
                true => Err(ModelError::Failed { model: "meets".into(), reason: "no picture".into() }),
            };
            views.iter().map(of_view).collect()
        }
    }

    fn view(outlines: &[(&str, [f64; 4])]) -> View {
        let heading = Heading::new(0.0).unwrap();
        let label = |(id, outline): &(&str, [f64; 4])| ObjectLabel {
            object: ObjectId::new(*id).unwrap(),
            name: "thing".into(),
            heading,
            elevation_rad: 0.0,
            box_px: Some(*outline),
            distance_m: None,
            position: None,
            colour: None,
            room: None,
        };
        let truth = GroundTruth { labels: outlines.iter().map(label).collect(), lists_objects: true, room: None };
        View::new(Pose::looking_level(DVec3::ZERO, heading), 1.5, None, Some(truth))
    }

    #[test]
    fn a_phrase_scores_as_its_best_box_does() {
        let shown = view(&[]);
        let scores = DetectorGrounder::new(Meets { meets: false }).score_phrases(&[&shown], &["sink", "bed"]);
        assert_eq!(scores, [Ok(vec![0.5, 0.0])]);
    }

    #[test]
    fn phrases_that_change_each_other_are_looked_for_one_by_one() {
        let shown = view(&[]);
        let scores = DetectorGrounder::new(Meets { meets: true }).score_phrases(&[&shown], &["sink", "bed"]);
        assert_eq!(scores, [Ok(vec![0.9, 0.0])]);
    }

    #[test]
    fn a_view_that_fails_does_not_fail_the_others() {
        let (shown, mut blank) = (view(&[]), view(&[]));
        blank = View::new(blank.pose, 1.5, None, None);
        let scores = DetectorGrounder::new(Meets { meets: true }).score_phrases(&[&blank, &shown], &["sink", "bed"]);
        assert!(scores[0].is_err());
        assert_eq!(scores[1], Ok(vec![0.9, 0.0]));
        assert_eq!(DetectorGrounder::new(Meets { meets: false }).score_phrases(&[&shown], &[]), [Ok(Vec::new())]);
    }

    #[test]
    fn a_find_that_covers_a_better_one_is_left_out() {
        let find = |left: f32, score: f32| DetectedBox { box_px: [left, 0.0, left + 10.0, 10.0], score };
        // The second shares 9 of 11 parts with the first; the third would share as much with the second, and 8 of 12 with the first.
        let all = [find(0.0, 0.9), find(1.0, 0.8), find(2.0, 0.7), find(10.0, 0.6)];
        let left: Vec<DetectedBox> = without_overlaps(all, 0.7).collect();
        assert_eq!(left, [all[0], all[2], all[3]]);
    }

    #[test]
    fn a_box_points_to_the_object_that_it_covers_best() {
        let near = view(&[("left", [0.0, 0.0, 4.0, 10.0]), ("all", [0.0, 0.0, 10.0, 10.0])]);
        let grounder = DetectorGrounder::new(Meets { meets: false });
        assert_eq!(grounder.point_to_object(&[&near], "sink").unwrap().unwrap().as_str(), "left");
        assert_eq!(grounder.point_to_object(&[&near], "bed").unwrap(), None);
        let elsewhere = view(&[("right", [6.0, 0.0, 4.0, 10.0])]);
        assert_eq!(grounder.point_to_object(&[&elsewhere], "sink").unwrap(), None);
    }
}
