//! Calls of a detector in process, each made once and kept in the ledger.

use super::Ready;
use crate::kept::{Kept, hash};
use serde_json::{Value, json};
use std::{cell::RefCell, collections::VecDeque};
use wayword_core::{Detector, Found, MOST_BOXES, ModelError, Scoring, View};
use wayword_ledger::Run;

/// A detector in process behind the ledger.
///
/// Where phrases do not change each other's scores, there is one call for each view and phrase, so that other lists of
/// phrases find its answer; those that the ledger lacks are computed together. Otherwise there is one call for each view
/// and list of phrases. An answer is the boxes as JSON.
pub struct LocalDetector {
    kept: Kept,
    ready: Ready,
}

/// Where one phrase was found.
type Places = Vec<Found>;

impl LocalDetector {
    pub(crate) fn new(name: &str, origin: String, ready: Ready, run: Run) -> Self {
        Self { kept: Kept::new(name, origin, run), ready }
    }

    /// The identity of its weights, and their precision.
    #[must_use]
    pub fn origin(&self) -> &str {
        &self.kept.origin
    }

    fn in_view(&self, view: &View, phrases: &[&str]) -> Result<Vec<Places>, ModelError> {
        let image = view.image.as_deref().filter(|image| !image.rgb().is_empty());
        let image = image.ok_or_else(|| ModelError::NothingToSee {
            name: self.kept.name.clone(),
            needs: "a picture",
            hint: "use a platform or data folder with pictures",
        })?;
        let picture = hash(image);
        match phrases {
            [] => Ok(Vec::new()),
            _ if self.scoring().phrases_meet => self.together(view, &picture, phrases),
            _ => self.one_by_one(view, &picture, phrases),
        }
    }

    fn together(&self, view: &View, picture: &str, phrases: &[&str]) -> Result<Vec<Places>, ModelError> {
        let answer = self.kept.once(self.asked(picture, phrases), 0, || {
            let found = self.computed(view, phrases)?;
            serde_json::to_string(&found).map_err(|error| self.failed(&error.to_string()))
        })?;
        let found: Vec<Places> = self.read(&answer.text)?;
        if found.len() != phrases.len() {
            return Err(self.failed(&format!("an answer for {} phrases, not {}", found.len(), phrases.len())));
        }
        Ok(found)
    }

    fn one_by_one(&self, view: &View, picture: &str, phrases: &[&str]) -> Result<Vec<Places>, ModelError> {
        // What was computed with the first phrase that the ledger lacks, for the phrases after it.
        let ahead: RefCell<VecDeque<Places>> = RefCell::default();
        let one = |(at, phrase): (usize, &&str)| {
            let answer = self.kept.once(self.asked(picture, &[phrase]), 0, || {
                if ahead.borrow().is_empty() {
                    *ahead.borrow_mut() = self.computed(view, &phrases[at..])?.into();
                }
                let places = ahead.borrow_mut().front().cloned().unwrap_or_default();
                serde_json::to_string(&places).map_err(|error| self.failed(&error.to_string()))
            })?;
            ahead.borrow_mut().pop_front();
            self.read(&answer.text)
        };
        phrases.iter().enumerate().map(one).collect()
    }

    /// What the detector finds, one list per phrase.
    fn computed(&self, view: &View, phrases: &[&str]) -> Result<Vec<Places>, ModelError> {
        let found = self.ready.detector.detect(&[view], phrases).pop();
        let mut found = found.unwrap_or_else(|| Err(self.failed("it gave no result")))?;
        if found.len() != phrases.len() {
            return Err(self.failed(&format!("it gave {} results for {} phrases", found.len(), phrases.len())));
        }
        found.iter_mut().for_each(|places| places.truncate(MOST_BOXES));
        Ok(found)
    }

    /// What could change an answer, beside the weights, for the ledger.
    fn asked(&self, picture: &str, phrases: &[&str]) -> Value {
        json!({ "image_sha256": picture, "size": self.ready.size, "phrases": phrases })
    }

    fn read<T: serde::de::DeserializeOwned>(&self, text: &str) -> Result<T, ModelError> {
        let wrong = |error: serde_json::Error| {
            self.failed(&format!(
                "its answer in the ledger is no list of boxes: {error}; drop it with `wayword ledger prune --changed`"
            ))
        };
        serde_json::from_str(text).map_err(wrong)
    }

    fn failed(&self, reason: &str) -> ModelError {
        ModelError::Failed { model: self.kept.name.clone(), reason: reason.to_owned() }
    }
}

impl Detector for LocalDetector {
    fn name(&self) -> &str {
        &self.kept.name
    }

    fn scoring(&self) -> Scoring {
        self.ready.detector.scoring()
    }

    fn detect(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<Found>>, ModelError>> {
        views.iter().map(|view| self.in_view(view, phrases)).collect()
    }
}
