//! Finds the words of a text that a reader should doubt, because the known walk fits better with other words, and
//! suggests these.
//!
//! [`find_sites`] computes the gain of each possible change. [`find_doubts`] selects those with enough gain, by [`DoubtBounds`];
//! [`from_checks`] adds the doubts from checks and ambiguity. [`wayword_core::doubt::separate_doubts`] combines all of them.

mod bounds;
pub mod from_checks;
mod other_places;
mod ways;

use crate::{
    change::{StepChange, StepChangeKind, rank_changes},
    guide::Guide,
    one_walk::OneWalk,
    route::{KnownWalk, MAX_FOLLOWED_STEPS},
    swap::best_swap,
    weights::FeatureWeights,
};
pub use bounds::{DoubtBound, DoubtBounds};
use wayword_core::{
    CheckFinding, ClimbDirection, DoubtAlternative, DoubtCause, DoubtGrade, TextDoubt, doubt::MAX_ALTERNATIVES,
};
use wayword_language::{
    lexicon::room_name,
    rewording::{TokenisedText, in_capitals_of},
};

/// Most places of a text that are examined, because the work grows with their number. Later places are ignored.
const MAX_EXAMINED_PLACES: usize = 14;

/// The kind of change that led to a doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DoubtSource {
    /// A turn, to the other side.
    Turn,
    /// A turn, left out.
    NoTurn,
    /// The side on which a place is.
    Side,
    /// A climb, the other way.
    Climb,
    /// A step, left out.
    NoStep,
    /// How the walk goes by a place: past it, to it, into it.
    Way,
    /// A place that the building has, replaced by another place.
    Place,
    /// A place that the building does not have, replaced by one that it has.
    Unknown,
    /// Two places, each replaced by the other.
    Swap,
}

impl DoubtSource {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Turn,
        Self::NoTurn,
        Self::Side,
        Self::Climb,
        Self::NoStep,
        Self::Way,
        Self::Place,
        Self::Unknown,
        Self::Swap,
    ];

    /// Its name, on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Turn => "turn",
            Self::NoTurn => "turn left out",
            Self::Side => "side",
            Self::Climb => "climb",
            Self::NoStep => "step left out",
            Self::Way => "way by a place",
            Self::Place => "place",
            Self::Unknown => "unknown place",
            Self::Swap => "places swapped",
        }
    }

    /// Why words of this kind are doubted.
    fn doubt_reason(self) -> &'static str {
        match self {
            Self::Turn => "the path may turn to the other side here",
            Self::NoTurn => "the path may not turn here",
            Self::Side => "it may be on the other side",
            Self::Climb => "the path may go the other way on the stairs",
            Self::NoStep => "the path may have no stretch for this",
            Self::Way => "the path may go by it in another way",
            Self::Place => "something else would fit the path better here",
            Self::Unknown => "the building may not have this",
            Self::Swap => "the path may come to these two places the other way round",
        }
    }
}

/// Words of a text that can be changed, and the gains of the changes.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubtSite {
    /// The kind of change.
    pub source: DoubtSource,
    /// The byte range of the words.
    pub span: [usize; 2],
    /// The replacements, the highest gain first. There is at least one.
    pub alternatives: Vec<DoubtAlternative>,
}

impl DoubtSite {
    /// A site; `None` if there is no alternative.
    fn from_alternatives(source: DoubtSource, span: [usize; 2], alternatives: Vec<DoubtAlternative>) -> Option<Self> {
        (!alternatives.is_empty()).then_some(Self { source, span, alternatives })
    }

    /// Whether it is about a turn or a climb.
    fn concerns_motion(&self) -> bool {
        matches!(self.source, DoubtSource::Turn | DoubtSource::NoTurn | DoubtSource::Climb)
    }

    /// The doubt about it, with the alternatives that gain anything.
    fn to_doubt(&self, grade: DoubtGrade) -> TextDoubt {
        let gains = |alternative: &&DoubtAlternative| alternative.gain.is_some_and(|gain| gain > 0.0);
        let alternatives = self.alternatives.iter().filter(gains).cloned().collect();
        let reason = self.source.doubt_reason().to_owned();
        TextDoubt { span: self.span, grade, cause: DoubtCause::Change, reason, alternatives }
    }

    /// The gain of the best alternative, natural logs; negative if all fit worse.
    #[must_use]
    pub fn best_gain(&self) -> f64 {
        self.alternatives.iter().filter_map(|alternative| alternative.gain).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The doubted words of a text: those with enough gain by a change, and those that a check found wrong or could not
/// decide, with suggestions. They may overlap.
#[must_use]
pub fn find_doubts(
    spelt: &TokenisedText<'_>,
    guide: &Guide,
    known: KnownWalk<'_>,
    weights: &FeatureWeights,
    (bounds, findings): (&DoubtBounds, &[CheckFinding]),
) -> Vec<TextDoubt> {
    let sites = find_sites(spelt, guide, known, weights);
    let mut doubts = from_checks::doubts_from_findings(findings);
    for doubt in &mut doubts {
        let is_wrong = doubt.cause == DoubtCause::Wrong;
        let motion = sites.iter().filter(|site| site.concerns_motion() && is_within(doubt.span, site.span));
        // A check only marks the side of a turn; the suggestion replaces all of "turn left".
        if let Some(motion) = motion.min_by_key(|site| site.span[1] - site.span[0]).filter(|_| is_wrong) {
            doubt.span = motion.span;
        }
        let turns =
            |site: &DoubtSite| site.concerns_motion() && is_within(site.span, doubt.span) && site.best_gain() > 0.0;
        if is_wrong && !sites.iter().any(turns) && guide.has_step_without(doubt.span) {
            doubt.alternatives.push(DoubtAlternative { words: None, gain: None });
        }
        for site in &sites {
            if let Some(weaker) = offered_doubt(site, doubt) {
                doubt.take_over(spelt.text(), &weaker);
            }
        }
    }
    doubts.extend(
        sites.into_iter().filter_map(|site| Some(site.to_doubt(bounds.grade_gain(site.source, site.best_gain())?))),
    );
    doubts
}

/// Whether a byte range lies in another.
fn is_within(inner: [usize; 2], outer: [usize; 2]) -> bool {
    outer[0] <= inner[0] && inner[1] <= outer[1]
}

/// The suggestions of a site for words that a check doubts. If a check found the way by a place wrong, any other way
/// may be right.
fn offered_doubt(site: &DoubtSite, doubt: &TextDoubt) -> Option<TextDoubt> {
    let is_wrong = doubt.cause == DoubtCause::Wrong;
    let is_name = matches!(site.source, DoubtSource::Place | DoubtSource::Unknown);
    if is_wrong && site.source == DoubtSource::Way {
        let DoubtSite { span, alternatives, .. } = site.clone();
        let best = alternatives
            .into_iter()
            .take(1)
            .map(|alternative| DoubtAlternative { gain: None, ..alternative })
            .collect();
        return (span == doubt.span).then_some(TextDoubt { span, alternatives: best, ..doubt.clone() });
    }
    let fits = is_name || (is_wrong && (site.span == doubt.span || site.concerns_motion()));
    fits.then(|| site.to_doubt(doubt.grade))
}

/// Whether a text has too many steps to examine its changes.
#[must_use]
pub fn is_too_long(guide: &Guide) -> bool {
    guide.len() > MAX_FOLLOWED_STEPS
}

/// The gains of single changes of a text for a walk; empty if the text has too many steps.
#[must_use]
pub fn find_sites(
    spelt: &TokenisedText<'_>,
    guide: &Guide,
    known: KnownWalk<'_>,
    weights: &FeatureWeights,
) -> Vec<DoubtSite> {
    if guide.is_empty() || is_too_long(guide) {
        return Vec::new();
    }
    let walk = OneWalk::new(known.building, known.walk, known.heading_rad, weights);
    let mut sites = step_sites(spelt, guide, known, weights);
    sites.extend(ways::way_sites(spelt, guide, &walk));
    sites.extend(other_places::other_place_sites(spelt, guide, known, &walk));
    sites.extend(swap_sites(spelt, guide, known, weights));
    sites
}

/// The sites of changes of one step: its turn, the side of a place, its climb, or the whole step left out.
fn step_sites(
    spelt: &TokenisedText<'_>,
    guide: &Guide,
    known: KnownWalk<'_>,
    weights: &FeatureWeights,
) -> Vec<DoubtSite> {
    let site = |change: StepChange| {
        let step = &guide.steps[change.step].step;
        let turn = || Some(spelt.turn_words(step.span, step.turn_span?));
        let (source, span, words) = match change.kind {
            StepChangeKind::Turn => (DoubtSource::Turn, turn()?, Some(spelt.other_side(turn()?)?)),
            StepChangeKind::NoTurn => (DoubtSource::NoTurn, turn()?, None),
            StepChangeKind::Side => {
                let span = spelt.side_words(step.span)?;
                (DoubtSource::Side, span, Some(spelt.other_side(span)?))
            }
            StepChangeKind::Climb => {
                let (span, other) = spelt.climb_word(step.span, step.climb == Some(ClimbDirection::Up))?;
                (DoubtSource::Climb, span, Some(other))
            }
            StepChangeKind::NoStep => (DoubtSource::NoStep, spelt.step_words(step.span)?, None),
        };
        DoubtSite::from_alternatives(source, span, vec![DoubtAlternative { words, gain: Some(change.gain) }])
    };
    rank_changes(guide, known.building, known.walk, known.heading_rad, weights).into_iter().filter_map(site).collect()
}

/// The two places with the highest gain from swapping: each may be named where the other is.
fn swap_sites(
    spelt: &TokenisedText<'_>,
    guide: &Guide,
    known: KnownWalk<'_>,
    weights: &FeatureWeights,
) -> Vec<DoubtSite> {
    let swap = best_swap(guide, known.building, known.walk, known.heading_rad, weights);
    let site = |(gain, here, there)| {
        let words = Some(in_capitals_of(spelt.words_of(here), &spelt.words_of(there).to_lowercase()));
        DoubtSite::from_alternatives(DoubtSource::Swap, here, vec![DoubtAlternative { words, gain: Some(gain) }])
    };
    let both = swap.map(|swap| [(swap.gain, swap.spans[0], swap.spans[1]), (swap.gain, swap.spans[1], swap.spans[0])]);
    both.into_iter().flatten().filter_map(site).collect()
}

/// Whether a name means stairs, which are neither entered nor replaced.
fn is_stairs(name: &str) -> bool {
    room_name(name) == Some("stairs")
}

/// The alternatives that gain most, the best first.
fn best_first(alternatives: impl Iterator<Item = DoubtAlternative>) -> Vec<DoubtAlternative> {
    let gain = |alternative: &DoubtAlternative| alternative.gain.filter(|gain| gain.is_finite());
    let mut best: Vec<DoubtAlternative> = alternatives.filter(|alternative| gain(alternative).is_some()).collect();
    best.sort_by(|a, b| gain(b).unwrap_or(0.0).total_cmp(&gain(a).unwrap_or(0.0)));
    best.truncate(MAX_ALTERNATIVES);
    best
}

#[cfg(test)]
mod tests;
