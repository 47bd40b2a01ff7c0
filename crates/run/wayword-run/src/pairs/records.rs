//! The records of judged pairs: a line for each film with all texts about it, and a line for each pair, the worst first.

use crate::pictures::WrittenPicture;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_follower::pair::{FilmClaimFit, FilmedWalk, JudgedClaim, JudgedPair, JudgedPart};

/// A film with the texts about it: a line of `films.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FilmRecord {
    /// Its place among the films of the file, from 0.
    pub at: usize,
    /// The scene: the recording, or the building of its path.
    pub scene: String,
    /// What was seen at its frames, and how it moves between them.
    pub walk: FilmedWalk,
    /// The pictures of some frames: files in the folder `pictures`, with their widths and heights in pixels.
    pub pictures: BTreeMap<usize, WrittenPicture>,
    /// The texts about it.
    pub pairs: Vec<PairRecord>,
    /// Why it could not be judged, where it could not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// A pair of a film and a text: a line of `pairs.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PairRecord {
    /// Its name: that of the text's item, with the text's number.
    pub pair: String,
    /// The scene of its film.
    pub scene: String,
    /// Its text.
    pub text: String,
    /// The chance that the pair is wrong, from 0 to 1; none where that cannot be judged.
    pub chance_wrong: Option<f64>,
    /// Why it cannot be judged, where it cannot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    /// The parts of the text, in order.
    pub parts: Vec<PairPartRecord>,
}

/// A part of a text with the frames that it describes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PairPartRecord {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// Its first and its last frame.
    pub frames: [usize; 2],
    /// Whether its claims fit.
    pub state: PairPartState,
    /// The claims that do not fit or were not decided, each with the reason.
    pub findings: Vec<PairFindingRecord>,
}

/// Whether the claims of a part fit its frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairPartState {
    /// All fit.
    Fits,
    /// None is wrong, and some were not decided.
    Unverified,
    /// Some do not fit.
    Wrong,
}

/// A claim that does not fit, or was not decided.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PairFindingRecord {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// Whether it is wrong, or undecided.
    pub state: PairPartState,
    /// Why, in a sentence.
    pub reason: String,
}

impl PairRecord {
    /// The record of a pair. `judged` is none for a text that tells no way.
    #[must_use]
    pub fn new(pair: &str, scene: &str, text: &str, judged: Result<(&JudgedPair, &FilmedWalk, f64), &str>) -> Self {
        let (parts, chance_wrong, problem) = match judged {
            Ok((judged, walk, chance)) => {
                (judged.parts.iter().map(|part| PairPartRecord::new(part, walk)).collect(), Some(chance), None)
            }
            Err(why) => (Vec::new(), None, Some(why.to_owned())),
        };
        Self { pair: pair.to_owned(), scene: scene.to_owned(), text: text.to_owned(), chance_wrong, problem, parts }
    }

    /// Its place among all pairs: those that tell no way come first, then those with the highest chance.
    #[must_use]
    pub fn suspicion(&self) -> f64 {
        self.chance_wrong.unwrap_or(2.0)
    }
}

impl PairPartRecord {
    /// The record of a part.
    #[must_use]
    pub fn new(part: &JudgedPart, walk: &FilmedWalk) -> Self {
        let findings: Vec<PairFindingRecord> = part.claims.iter().filter_map(finding).collect();
        let state = findings.iter().map(|finding| finding.state).max().unwrap_or(PairPartState::Fits);
        let frame = |place: usize| walk.places.get(place).map_or(place, |place| place.frame);
        Self { span: part.span, frames: part.stretch.map(frame), state, findings }
    }
}

fn finding(claim: &JudgedClaim) -> Option<PairFindingRecord> {
    let what = &claim.what;
    let (state, reason) = match (claim.fit, claim.is_motion) {
        (FilmClaimFit::Fits, _) => return None,
        (FilmClaimFit::Perhaps, true) => (PairPartState::Unverified, format!("the film bends a little here: {what}?")),
        (FilmClaimFit::Perhaps, false) => (PairPartState::Unverified, format!("somebody may have seen {what} here")),
        (FilmClaimFit::Unknown, _) => (PairPartState::Unverified, format!("not known: {what}")),
        (FilmClaimFit::Elsewhere, _) => (PairPartState::Wrong, format!("{what} was seen, but not here")),
        (FilmClaimFit::Nowhere, true) => (PairPartState::Wrong, format!("the film has no such motion here: {what}")),
        (FilmClaimFit::Nowhere, false) => (PairPartState::Wrong, format!("nobody saw {what} in this film")),
        (FilmClaimFit::Opposite, _) => (PairPartState::Wrong, format!("the film shows the opposite of {what}")),
    };
    Some(PairFindingRecord { span: claim.span, state, reason })
}
