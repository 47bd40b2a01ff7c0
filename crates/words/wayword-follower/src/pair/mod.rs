//! Judges a pair of a film and a text, whoever made them: which stretch of the film each part of the text describes, how its claims fit
//! there, and how likely the pair is wrong.
//!
//! The film ([`FilmedWalk`]) is a walk as it is known: what a model, a detector or labels saw at each place, and how the camera moved,
//! by poses or by its pictures. The unknown decides nothing.
//!
//! The chance that a pair is wrong is a logistic function of features of the best way to cut the film among the parts. Its weights were
//! fitted to pairs that were made wrong in known ways.

mod claims;
mod cut;
mod features;
mod film;
mod weights;

pub use claims::FilmClaimFit;
pub use film::{FilmedHop, FilmedPlace, FilmedWalk, PairMotion};
pub use weights::{PairEye, PairWeights, PairWeightsError, chances_with_mean};

use crate::alignment::PartedText;
use claims::FilmClaimKind;
use cut::FilmedText;
use wayword_core::ClimbDirection;
use wayword_language::lexicon::with_article;

/// A pair of a film and a text, judged part by part.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedPair {
    /// The parts of the text, in order.
    pub parts: Vec<JudgedPart>,
    /// What the motion of its film is known from.
    pub motion: PairMotion,
    /// The features by which its chance to be wrong is computed: names and values.
    pub features: Vec<(String, f64)>,
}

/// A part of a text with its stretch of the film.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedPart {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// The places where its stretch begins and ends.
    pub stretch: [usize; 2],
    /// Its claims.
    pub claims: Vec<JudgedClaim>,
}

/// A claim of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgedClaim {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// What it claims, in words: "a turn to the left", "a sofa".
    pub what: String,
    /// Whether it is about the motion, and not about things and rooms.
    pub is_motion: bool,
    /// How it fits the stretch.
    pub fit: FilmClaimFit,
}

impl JudgedPair {
    /// Judges a text on a film; `None` where the text has no part that is understood, or the film has fewer than two places.
    #[must_use]
    pub fn new(text: &PartedText, walk: &FilmedWalk) -> Option<Self> {
        if text.parts.is_empty() || walk.places.len() < 2 || walk.hops.len() + 1 != walk.places.len() {
            return None;
        }
        let filmed = FilmedText::new(text, walk);
        let cuts = filmed.cuts();
        let stretches = cuts.best_cut();
        let fits: Vec<FilmClaimFit> = filmed
            .claims
            .iter()
            .zip(&filmed.sights)
            .map(|(claim, sights)| claim.fit(walk, sights, stretches[claim.part]))
            .collect();
        let features = features::pair_features(&filmed, &stretches, &fits, cuts.total());
        let judged_claims = |part: usize| {
            let own = filmed.claims.iter().zip(&fits).filter(move |(claim, _)| claim.part == part);
            own.map(|(claim, fit)| JudgedClaim {
                span: claim.span,
                what: claim_words(&claim.kind),
                is_motion: !matches!(claim.kind, FilmClaimKind::Place { .. }),
                fit: *fit,
            })
            .collect()
        };
        let parts = text.parts.iter().zip(&stretches).enumerate();
        let parts = parts.map(|(number, (part, stretch))| JudgedPart {
            span: part.span,
            stretch: *stretch,
            claims: judged_claims(number),
        });
        Some(Self { parts: parts.collect(), motion: walk.motion(), features })
    }
}

fn claim_words(kind: &FilmClaimKind) -> String {
    match kind {
        FilmClaimKind::Turn { right: true } => "a turn to the right".to_owned(),
        FilmClaimKind::Turn { right: false } => "a turn to the left".to_owned(),
        FilmClaimKind::Around => "a turn around".to_owned(),
        FilmClaimKind::Climb(ClimbDirection::Up) => "stairs up".to_owned(),
        FilmClaimKind::Climb(ClimbDirection::Down) => "stairs down".to_owned(),
        FilmClaimKind::Climb(ClimbDirection::Level) => "level ground".to_owned(),
        FilmClaimKind::Place { meanings, .. } => {
            meanings.first().map(|(_, name)| with_article(name)).unwrap_or_default()
        }
    }
}

#[cfg(test)]
mod tests;
