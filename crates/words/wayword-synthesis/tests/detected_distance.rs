//! Checks that the distances of a detector's finds agree with the labels, on a platform with depth pictures.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use wayword_checks::{
    Evidence,
    detection::{DetectorFigures, DetectorRates},
};
use wayword_core::{
    DetectedBox, DetectorScoring, ModelError, ObjectDetector, ObjectLabel, Path, PathRequest, Platform, View,
};
use wayword_house::{HouseOptions, HousePlatform};
use wayword_language::lexicon::{names_agree, normalise_name};
use wayword_synthesis::{
    detection::{CaptionDetector, seek_claims},
    observe::gazes_around,
};
use wayword_testkit::PlayedDetector;

/// A label's distance is that of a thing's middle, a find's that of its visible part: the front of a bed, the near end
/// of a rug.
const TOLERANCE_M: f64 = 1.0;

/// A detector that finds exactly the things that labels list.
const PLAYED: PlayedDetector = PlayedDetector { same: names_agree, recall: 1.0, alarms: 0.0, repeats: false, seed: 1 };

/// The played detector with boxes around the visible parts of each thing.
struct Outlined;

impl ObjectDetector for Outlined {
    fn name(&self) -> &str {
        PLAYED.name()
    }

    fn scoring(&self) -> DetectorScoring {
        PLAYED.scoring()
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        let outlined = |(view, found): (&&View, Result<Vec<Vec<DetectedBox>>, ModelError>)| {
            let of_phrase = |(phrase, found): (&&str, Vec<DetectedBox>)| {
                let labels =
                    view.ground_truth().unwrap().labels.iter().filter(|label| names_agree(&label.name, phrase));
                let boxed = |(label, found): (&ObjectLabel, DetectedBox)| {
                    let [x, y, width, height] = label.box_px.unwrap();
                    DetectedBox { box_px: [x, y, x + width, y + height].map(|edge| edge as f32), ..found }
                };
                labels.zip(found).map(boxed).collect()
            };
            Ok(phrases.iter().zip(found?).map(of_phrase).collect())
        };
        views.iter().zip(PLAYED.detect_phrases(views, phrases)).map(outlined).collect()
    }
}

fn figures() -> DetectorFigures {
    let all = DetectorRates {
        shown: 2000,
        found: 1600,
        absent: 20_000,
        alarms: 1,
        runs: vec![1; 8],
        ..DetectorRates::default()
    };
    DetectorFigures { found_from: 0.5, all, ..DetectorFigures::default() }
}

/// All labels around a frame.
fn labels(platform: &dyn Platform, path: &Path, at: usize) -> Vec<ObjectLabel> {
    let look = |gaze| platform.look_from(&path.scene, &path.frames[at], gaze).unwrap();
    let views = gazes_around(path, &path.frames[at]).into_iter().map(look);
    views.flat_map(|view| view.ground_truth().unwrap().labels.clone()).collect()
}

/// The errors of the distances of finds compared with the labels, metres: one for each find of a name that the view's
/// labels have once.
fn errors_m(platform: &dyn Platform, path: &Path) -> Vec<f64> {
    let all: Vec<Vec<ObjectLabel>> = (0..path.frames.len()).map(|at| labels(platform, path, at)).collect();
    let names: BTreeSet<String> = all.iter().flatten().map(|label| normalise_name(&label.name)).collect();
    let seeker = CaptionDetector { detector: &Outlined, figures: &figures(), nouns: &[] };
    let seen = seek_claims(platform, path, &names, seeker).unwrap();
    let evidence = Evidence::from_detector(path, &seen).unwrap();
    let mut errors = Vec::new();
    for (labels, frame) in all.iter().zip(&evidence.frames) {
        for thing in &frame.things {
            let alike: Vec<&ObjectLabel> =
                labels.iter().filter(|label| names_agree(&label.name, &thing.name)).collect();
            if let [only] = alike[..] {
                let level_m = only.distance_m.unwrap() * only.elevation_rad.cos();
                // A door has none.
                errors.extend(thing.distance_m.map(|far_m| (far_m - level_m).abs()));
            }
        }
    }
    errors
}

#[test]
fn distances_of_finds_agree_with_labels() {
    let platform = HousePlatform::new(HouseOptions { width_px: 320, height_px: 240, ..HouseOptions::default() });
    let mut errors: Vec<f64> = Vec::new();
    for seed in 0..4 {
        let scene = HousePlatform::scene_of(seed).unwrap();
        let path = platform.sample_path(&scene, &PathRequest::default(), seed).unwrap();
        errors.extend(errors_m(&platform, &path));
    }
    errors.sort_by(f64::total_cmp);
    let share = errors.partition_point(|metres| *metres <= TOLERANCE_M) as f64 / errors.len() as f64;
    let median_m = errors[errors.len() / 2];
    println!("{} finds, median {median_m:.2} m, {:.0} % within {TOLERANCE_M} m", errors.len(), 100.0 * share);
    assert!(errors.len() >= 50, "{} finds", errors.len());
    assert!(median_m <= 0.3, "median {median_m:.2} m");
    assert!(share >= 0.9, "{share:.2} within {TOLERANCE_M} m");
}
