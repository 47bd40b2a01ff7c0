//! Makes each call of an in-process detector once, and keeps its answer in the ledger.

use super::LoadedDetector;
use crate::{
    call_ledger::{CallLedger, picture_hash},
    picture::picture_of_view,
};
use serde_json::{Value, json};
use std::{cell::RefCell, collections::VecDeque};
use wayword_core::{DetectedBox, DetectorScoring, MAX_BOXES_PER_PHRASE, ModelError, ObjectDetector, View};
use wayword_ledger::LedgerRun;

/// An in-process detector behind the ledger.
///
/// With some detectors the other phrases do not change a phrase's score. Then the ledger has one call for each view
/// and phrase, so that another list with the same phrase finds the answer; the phrases that the ledger lacks are
/// computed together. With the other detectors there is one call for each view and list of phrases. An answer is the
/// boxes as JSON.
pub struct LocalDetector {
    calls: CallLedger,
    /// The detector itself, for views and phrases that the ledger lacks.
    loaded: LoadedDetector,
}

/// The boxes in which one phrase was found.
type PhraseBoxes = Vec<DetectedBox>;

impl LocalDetector {
    pub(crate) fn new(name: &str, origin: String, ready: LoadedDetector, run: LedgerRun) -> Self {
        Self { calls: CallLedger::new(name, origin, run), loaded: ready }
    }

    /// The identity of the weights, and their precision.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.calls.origin
    }

    /// The boxes of each phrase in one view. `phrases_meet` is true for detectors in which the phrases of a call
    /// influence each other's scores.
    fn detect_in_view(&self, view: &View, phrases: &[&str]) -> Result<Vec<PhraseBoxes>, ModelError> {
        let picture = picture_hash(picture_of_view(view, &self.calls.name)?);
        match phrases {
            [] => Ok(Vec::new()),
            _ if self.scoring().phrases_interact => self.detect_together(view, &picture, phrases),
            _ => self.detect_separately(view, &picture, phrases),
        }
    }

    /// One call for the view and all phrases.
    fn detect_together(&self, view: &View, picture: &str, phrases: &[&str]) -> Result<Vec<PhraseBoxes>, ModelError> {
        let answer = self.calls.answer_once(self.request_json(picture, phrases), 0, || {
            let found = self.compute_boxes(view, phrases)?;
            serde_json::to_string(&found).map_err(|error| self.model_error(&error.to_string()))
        })?;
        let found: Vec<PhraseBoxes> = self.parse_answer(&answer.text)?;
        if found.len() != phrases.len() {
            return Err(self.model_error(&format!("an answer for {} phrases, not {}", found.len(), phrases.len())));
        }
        Ok(found)
    }

    /// One call for each phrase. Phrases that the ledger lacks are computed together nevertheless.
    fn detect_separately(&self, view: &View, picture: &str, phrases: &[&str]) -> Result<Vec<PhraseBoxes>, ModelError> {
        // The first phrase that the ledger lacks computes all phrases from there on. The boxes of those
        // that follow wait in `ahead` until their own call.
        let ahead: RefCell<VecDeque<PhraseBoxes>> = RefCell::default();
        let detect_one = |(at, phrase): (usize, &&str)| {
            let answer = self.calls.answer_once(self.request_json(picture, &[phrase]), 0, || {
                if ahead.borrow().is_empty() {
                    *ahead.borrow_mut() = self.compute_boxes(view, &phrases[at..])?.into();
                }
                let places = ahead.borrow_mut().front().cloned().unwrap_or_default();
                serde_json::to_string(&places).map_err(|error| self.model_error(&error.to_string()))
            })?;
            ahead.borrow_mut().pop_front();
            self.parse_answer(&answer.text)
        };
        phrases.iter().enumerate().map(detect_one).collect()
    }

    /// The boxes that the detector finds, one list per phrase.
    fn compute_boxes(&self, view: &View, phrases: &[&str]) -> Result<Vec<PhraseBoxes>, ModelError> {
        let found = self.loaded.detector.detect_phrases(&[view], phrases).pop();
        let mut found = found.unwrap_or_else(|| Err(self.model_error("it gave no result")))?;
        if found.len() != phrases.len() {
            return Err(self.model_error(&format!("it gave {} results for {} phrases", found.len(), phrases.len())));
        }
        found.iter_mut().for_each(|places| places.truncate(MAX_BOXES_PER_PHRASE));
        Ok(found)
    }

    /// The key of a call in the ledger: everything that may change an answer, except the weights.
    fn request_json(&self, picture: &str, phrases: &[&str]) -> Value {
        json!({ "image_sha256": picture, "size": self.loaded.size, "phrases": phrases })
    }

    fn parse_answer<T: serde::de::DeserializeOwned>(&self, text: &str) -> Result<T, ModelError> {
        let wrong = |error: serde_json::Error| {
            self.model_error(&format!(
                "its answer in the ledger is no list of boxes: {error}; drop it with `wayword ledger prune --changed`"
            ))
        };
        serde_json::from_str(text).map_err(wrong)
    }

    fn model_error(&self, reason: &str) -> ModelError {
        ModelError::Failed { model: self.calls.name.clone(), reason: reason.to_owned() }
    }
}

impl ObjectDetector for LocalDetector {
    fn name(&self) -> &str {
        &self.calls.name
    }

    fn scoring(&self) -> DetectorScoring {
        self.loaded.detector.scoring()
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        views.iter().map(|view| self.detect_in_view(view, phrases)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        f64::consts::FRAC_PI_2,
        sync::{Arc, Mutex},
    };
    use wayword_core::{DVec3, Heading, Image, Pose};
    use wayword_ledger::{Ledger, RunLimits};

    /// The lists of phrases that were computed.
    type Asked = Arc<Mutex<Vec<Vec<String>>>>;

    /// Finds each phrase once, with its length as the left edge.
    struct Scripted {
        meets: bool,
        asked: Asked,
    }

    impl ObjectDetector for Scripted {
        fn name(&self) -> &str {
            "hf/test/scripted"
        }

        fn scoring(&self) -> DetectorScoring {
            DetectorScoring { means: "made up", find_threshold: 0.5, phrases_interact: self.meets }
        }

        fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
            self.asked.lock().unwrap().push(phrases.iter().map(|&phrase| phrase.to_owned()).collect());
            let places =
                |phrase: &&str| vec![DetectedBox { box_px: [phrase.len() as f32, 0.1, 9.0, 9.0], score: 0.3 }; 150];
            let found: Vec<PhraseBoxes> = phrases.iter().filter(|phrase| **phrase != "lost").map(places).collect();
            views.iter().map(|_| Ok(found.clone())).collect()
        }
    }

    fn detector(folder: &std::path::Path, meets: bool) -> (LocalDetector, Asked) {
        let asked = Asked::default();
        let run = Ledger::open(&folder.join("ledger.db")).unwrap().start_run("run", RunLimits::default()).unwrap();
        let detector = Box::new(Scripted { meets, asked: Arc::clone(&asked) });
        let ready = LoadedDetector { detector, size: "8 px".to_owned() };
        (LocalDetector::new("hf/test/scripted", "in process: here".to_owned(), ready, run), asked)
    }

    fn view() -> View {
        let image = Image::new(2, 2, vec![7; 12]).unwrap();
        View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), FRAC_PI_2, Some(Arc::new(image)), None)
    }

    fn lefts(found: &Result<Vec<PhraseBoxes>, ModelError>) -> Vec<f32> {
        found.as_ref().unwrap().iter().map(|places| places[0].box_px[0]).collect()
    }

    #[test]
    fn independent_phrases_are_stored_singly_and_computed_together() {
        let folder = tempfile::tempdir().unwrap();
        let (detector, asked) = detector(folder.path(), false);
        assert_eq!(lefts(&detector.detect_phrases(&[&view()], &["bb"])[0]), [2.0]);
        let found = detector.detect_phrases(&[&view()], &["a", "bb", "ccc", "a"]);
        assert_eq!(lefts(&found[0]), [1.0, 2.0, 3.0, 1.0]);
        assert_eq!(found[0].as_ref().unwrap()[0].len(), MAX_BOXES_PER_PHRASE);
        assert_eq!(lefts(&detector.detect_phrases(&[&view()], &["ccc", "a"])[0]), [3.0, 1.0]);
        assert_eq!(*asked.lock().unwrap(), [vec!["bb"], vec!["a", "bb", "ccc", "a"]]);
        assert_eq!(detector.detect_phrases(&[&view()], &[]), [Ok(Vec::new())]);
    }

    #[test]
    fn dependent_phrases_are_stored_by_their_list() {
        let folder = tempfile::tempdir().unwrap();
        let (detector, asked) = detector(folder.path(), true);
        for _ in 0..2 {
            assert_eq!(lefts(&detector.detect_phrases(&[&view()], &["a", "bb"])[0]), [1.0, 2.0]);
        }
        assert_eq!(lefts(&detector.detect_phrases(&[&view()], &["bb", "a"])[0]), [2.0, 1.0]);
        assert_eq!(*asked.lock().unwrap(), [["a", "bb"], ["bb", "a"]]);
    }

    #[test]
    fn a_wrong_number_of_results_is_not_stored() {
        let folder = tempfile::tempdir().unwrap();
        for meets in [false, true] {
            let (detector, asked) = detector(folder.path(), meets);
            for _ in 0..2 {
                let error = detector.detect_phrases(&[&view()], &["a", "lost"])[0].clone().unwrap_err().to_string();
                assert!(error.contains("1 results for 2 phrases"), "{error}");
            }
            assert_eq!(asked.lock().unwrap().len(), 2);
        }
    }

    #[test]
    fn a_view_without_a_picture_is_not_asked_about() {
        let folder = tempfile::tempdir().unwrap();
        let (detector, asked) = detector(folder.path(), false);
        let blank = View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), FRAC_PI_2, None, None);
        let found = detector.detect_phrases(&[&blank, &view()], &["a"]);
        assert!(matches!(found[0], Err(ModelError::NothingToSee { .. })));
        assert_eq!((lefts(&found[1]), asked.lock().unwrap().len()), (vec![1.0], 1));
    }
}
