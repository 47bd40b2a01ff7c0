//! A stand-in for a detector network. It looks at the ground-truth labels of a view and draws at random, from a seed, which
//! of them it finds and which absent things it reports. The test sets its recall and its share of false alarms.

use rand::Rng;
use wayword_core::{DetectedBox, DetectorScoring, ModelError, ObjectDetector, ObjectLabel, View, seeded_rng};

/// A detector that reports labelled things with a given recall and absent things with a given probability.
#[derive(Debug, Clone, Copy)]
pub struct PlayedDetector {
    /// Whether two names mean the same.
    pub same: fn(&str, &str) -> bool,
    /// The share of the labelled things in a view that it finds, 0 to 1.
    pub recall: f64,
    /// The share of false alarms, 0 to 1: how often it reports a phrase although no label in the view has that name.
    pub alarms: f64,
    /// Whether a miss is drawn once per thing, so that a missed thing is missed from every place. If false, a miss is drawn
    /// anew for each place.
    pub repeats: bool,
    /// Seed of all draws.
    pub seed: u64,
}

/// The score of every box that it reports, 0 to 1. It is above the threshold from which a box counts as a find.
const FIND_SCORE: f32 = 0.8;

/// Half the width of a reported box as a share of the picture's width. Half its height is twice this share of the height.
const BOX_HALF_WIDTH_SHARE: f64 = 0.05;

impl PlayedDetector {
    /// A draw that is true with probability `share`. Equal purposes draw the same.
    fn draw_chance(&self, share: f64, purpose: &[&str]) -> bool {
        seeded_rng(self.seed, purpose).random_bool(share.clamp(0.0, 1.0))
    }

    /// Whether it finds a labelled thing in a view when it looks for `phrase`.
    fn finds_label(&self, view: &View, label: &ObjectLabel, phrase: &str) -> bool {
        let position = position_key(view);
        let place = if self.repeats { "anywhere" } else { &position };
        self.draw_chance(self.recall, &["found", label.object.as_str(), phrase, place])
    }

    /// The boxes for one phrase in a view.
    fn detect_phrase(&self, view: &View, phrase: &str) -> Vec<DetectedBox> {
        let labels = view.ground_truth().map_or(&[][..], |truth| &truth.labels);
        let shown: Vec<&ObjectLabel> = labels.iter().filter(|label| (self.same)(&label.name, phrase)).collect();
        if shown.is_empty() && self.draw_chance(self.alarms, &["alarm", phrase, &position_key(view)]) {
            return vec![box_around(view, 0.0, 0.0)];
        }
        let off_rad = |label: &&ObjectLabel| view.pose.heading.turn_to(label.heading);
        let hits = shown.iter().filter(|label| self.finds_label(view, label, phrase));
        hits.map(|label| box_around(view, off_rad(label), label.elevation_rad)).collect()
    }
}

/// The position of the camera as text, rounded to the centimetre. It is part of the seed of a draw.
fn position_key(view: &View) -> String {
    view.pose.position.to_array().map(|metres| format!("{metres:.2}")).join(" ")
}

/// A box around the point that lies `off_rad` to the right of the middle of a view and `elevation_rad` above the horizon.
fn box_around(view: &View, off_rad: f64, elevation_rad: f64) -> DetectedBox {
    let (width, height) = view.image.as_ref().map_or((1, 1), |image| (image.width_px(), image.height_px()));
    let (width, height) = (f64::from(width), f64::from(height));
    let half_width = libm::tan(view.horizontal_fov_rad / 2.0);
    let across = 0.5 + 0.5 * libm::tan(off_rad) / half_width;
    let up = libm::tan(elevation_rad) / libm::cos(off_rad);
    let down = 0.5 - 0.5 * up / (half_width * height / width);
    let span = |middle: f64, half: f64, side: f64| [middle - half, middle + half].map(|at| at.clamp(0.0, 1.0) * side);
    let ([left, right], [top, bottom]) =
        (span(across, BOX_HALF_WIDTH_SHARE, width), span(down, 2.0 * BOX_HALF_WIDTH_SHARE, height));
    DetectedBox { box_px: [left, top, right, bottom].map(|edge| edge as f32), score: FIND_SCORE }
}

impl ObjectDetector for PlayedDetector {
    fn name(&self) -> &str {
        "played/detector"
    }

    fn scoring(&self) -> DetectorScoring {
        DetectorScoring { means: "drawn by labels", find_threshold: 0.5, phrases_interact: false }
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        views.iter().map(|view| Ok(phrases.iter().map(|phrase| self.detect_phrase(view, phrase)).collect())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DVec3, GroundTruth, Heading, ObjectId, Pose};

    fn view(at: f64, names: &[&str]) -> View {
        let label = |name: &&str| ObjectLabel {
            object: ObjectId::new(*name).unwrap(),
            name: (*name).to_owned(),
            heading: Heading::new(0.3).unwrap(),
            elevation_rad: 0.0,
            box_px: None,
            distance_m: None,
            position: None,
            colour: None,
            room: None,
        };
        let truth = GroundTruth { labels: names.iter().map(label).collect(), lists_objects: true, room: None };
        View::new(Pose::looking_level(DVec3::new(at, 0.0, 1.5), Heading::NORTH), 1.5, None, Some(truth))
    }

    /// The shares of places where the detector reports the sofa, which every view has, and the piano, which none has.
    fn shares(detector: PlayedDetector) -> (f64, f64) {
        let views: Vec<View> = (0..400).map(|at| view(f64::from(at), &["sofa"])).collect();
        let found = detector.detect_phrases(&views.iter().collect::<Vec<_>>(), &["sofa", "piano"]);
        let share =
            |of: usize| found.iter().filter(|found| !found.as_ref().unwrap()[of].is_empty()).count() as f64 / 400.0;
        (share(0), share(1))
    }

    #[test]
    fn detect_finds_and_alarms_at_the_given_shares() {
        let played = PlayedDetector { same: |a, b| a == b, recall: 0.8, alarms: 0.1, repeats: false, seed: 1 };
        let (found, alarms) = shares(played);
        assert!((found - 0.8).abs() < 0.07 && (alarms - 0.1).abs() < 0.05, "{found} {alarms}");
        let (always, _) = shares(PlayedDetector { repeats: true, ..played });
        assert!(always == 0.0 || always == 1.0, "{always}");
    }

    #[test]
    fn detect_puts_the_box_where_the_label_is() {
        let played = PlayedDetector { same: |a, b| a == b, recall: 1.0, alarms: 0.0, repeats: false, seed: 1 };
        let shown = view(0.0, &["sofa"]);
        let found = played.detect_phrases(&[&shown], &["sofa"])[0].as_ref().unwrap()[0][0];
        let middle = (found.box_px[0] + found.box_px[2]) / 2.0;
        assert!(middle > 0.6 && middle < 0.8, "{found:?}");
    }
}
