//! Cuts a filmed walk among the parts of a text: the stretches on which the claims of the parts fit best.

use super::{
    claims::{FilmClaim, FilmClaimKind, claims_of_text},
    film::{FilmedWalk, NameSight},
};
use crate::alignment::PartedText;
use wayword_core::walk_cuts::{WalkCuts, all_stretches, stretch_index};

/// A text on a filmed walk, with everything that all stretches share.
pub(super) struct FilmedText<'a> {
    pub(super) walk: &'a FilmedWalk,
    pub(super) text: &'a PartedText,
    pub(super) claims: Vec<FilmClaim>,
    /// For each claim, how well what it names was seen at each place.
    pub(super) sights: Vec<Vec<NameSight>>,
    /// For each place, its share of the way.
    way_shares: Vec<f64>,
}

/// How far the end of a part may be from its share of the words before that counts, as a share of the walk.
const SHARE_SPREAD: f64 = 0.18;
/// What a turn costs that its part does not tell, natural logarithm.
const UNTOLD_TURN_LOSS: f64 = 0.8;
/// A turn of at least this is one that people mostly tell, radians (55 degrees).
const TOLD_TURN_RAD: f64 = 0.96;

impl<'a> FilmedText<'a> {
    pub(super) fn new(text: &'a PartedText, walk: &'a FilmedWalk) -> Self {
        let claims = claims_of_text(text);
        let sights = claims.iter().map(|claim| claim.sights(walk)).collect();
        Self { walk, text, claims, sights, way_shares: walk.way_shares() }
    }

    /// All ways to cut the walk.
    pub(super) fn cuts(&self) -> WalkCuts {
        let tables = (0..self.text.parts.len()).map(|part| self.part_scores(part, None)).collect();
        WalkCuts::new(tables, self.walk.places.len())
    }

    /// How much better the text would fit with the side of one turn turned over: the most over its turns, natural logarithm; `None`
    /// where it has no turn.
    pub(super) fn best_flip_gain(&self) -> Option<f64> {
        let places = self.walk.places.len();
        let tables: Vec<Vec<f64>> = (0..self.text.parts.len()).map(|part| self.part_scores(part, None)).collect();
        let own = WalkCuts::new(tables.clone(), places).total();
        let flips = self.claims.iter().enumerate().filter_map(|(at, claim)| Some((at, claim.part, claim.flipped()?)));
        let gains = flips.map(|(at, part, flipped)| {
            let mut tables = tables.clone();
            tables[part] = self.part_scores(part, Some((at, &flipped)));
            WalkCuts::new(tables, places).total() - own
        });
        gains.max_by(f64::total_cmp)
    }

    /// The scores of a part on all stretches, with one claim in place of another.
    fn part_scores(&self, part: usize, other: Option<(usize, &FilmClaim)>) -> Vec<f64> {
        let places = self.walk.places.len();
        let mut scores = vec![f64::NEG_INFINITY; places * places];
        let own: Vec<usize> = (0..self.claims.len()).filter(|at| self.claims[*at].part == part).collect();
        let tells_turn =
            own.iter().any(|at| matches!(self.claims[*at].kind, FilmClaimKind::Turn { .. } | FilmClaimKind::Around));
        let end_share = self.word_share(part + 1);
        for stretch in all_stretches(places) {
            let fits = own.iter().map(|at| {
                let claim = other.filter(|(number, _)| number == at).map_or(&self.claims[*at], |(_, claim)| claim);
                claim.fit(self.walk, &self.sights[*at], stretch).loose_weight()
            });
            let off = (self.way_shares[stretch[1]] - end_share) / SHARE_SPREAD;
            let untold = if tells_turn { 0 } else { self.count_large_turns(stretch) };
            scores[stretch_index(places, stretch)] =
                fits.sum::<f64>() - off * off / 2.0 - UNTOLD_TURN_LOSS * untold as f64;
        }
        scores
    }

    /// The share of the text's words before a part.
    pub(super) fn word_share(&self, part: usize) -> f64 {
        let words = |parts: usize| self.text.parts[..parts].iter().map(|part| part.word_count).sum::<usize>() as f64;
        words(part) / words(self.text.parts.len()).max(1.0)
    }

    /// The share of the way up to a place.
    pub(super) fn way_share(&self, place: usize) -> f64 {
        self.way_shares[place]
    }

    /// Number of hops inside a stretch with a turn that people mostly tell.
    pub(super) fn count_large_turns(&self, [from, to]: [usize; 2]) -> usize {
        let hops = self.walk.hops.get(from..to).unwrap_or_default();
        hops.iter().filter(|hop| hop.turn_rad.is_some_and(|turn| turn.abs() >= TOLD_TURN_RAD)).count()
    }
}
