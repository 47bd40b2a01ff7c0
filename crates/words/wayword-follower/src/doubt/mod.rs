//! Finds the words of a text that a reader should doubt, because the known walk fits better with other words, and
//! suggests these.
//!
//! [`sites`] computes the gain of each possible change. [`doubts`] selects those with enough gain, by [`Bounds`];
//! [`said`] adds the doubts from checks and ambiguity. [`wayword_core::doubt::apart_in`] combines all of them.

mod bounds;
mod others;
pub mod said;
mod ways;

use crate::{
    change::{Change, Kind, changes},
    guide::Guide,
    one_walk::OneWalk,
    route::{Known, MOST_STEPS},
    swap::best_swap,
    weights::Weights,
};
pub use bounds::{Bound, Bounds};
use wayword_core::{Alternative, Cause, Climb, Doubt, Finding, Grade, doubt::MOST_ALTERNATIVES};
use wayword_language::{
    lexicon::room_name,
    rewording::{Spelt, in_capitals_of},
};

/// Most places of a text that are examined. The work grows with their number.
const MOST_PLACES: usize = 14;

/// The kind of change that led to a doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
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
    /// A place that the building has, to another one.
    Place,
    /// A place that the building does not have, to one that it has.
    Unknown,
    /// Two places, each to the other.
    Swap,
}

impl Source {
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
    fn reason(self) -> &'static str {
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
pub struct Site {
    /// The kind of change.
    pub source: Source,
    /// The byte range of the words.
    pub span: [usize; 2],
    /// The replacements, the highest gain first. There is at least one.
    pub alternatives: Vec<Alternative>,
}

impl Site {
    /// A site; `None` if there is no alternative.
    fn of(source: Source, span: [usize; 2], alternatives: Vec<Alternative>) -> Option<Self> {
        (!alternatives.is_empty()).then_some(Self { source, span, alternatives })
    }

    /// Whether it is about a turn or a climb.
    fn tells_motion(&self) -> bool {
        matches!(self.source, Source::Turn | Source::NoTurn | Source::Climb)
    }

    /// The doubt about it, with the alternatives that gain anything.
    fn doubt(&self, grade: Grade) -> Doubt {
        let gains = |one: &&Alternative| one.gain.is_some_and(|gain| gain > 0.0);
        let alternatives = self.alternatives.iter().filter(gains).cloned().collect();
        let reason = self.source.reason().to_owned();
        Doubt { span: self.span, grade, cause: Cause::Change, reason, alternatives }
    }

    /// The gain of the best alternative, natural logs; negative if all fit worse.
    #[must_use]
    pub fn gain(&self) -> f64 {
        self.alternatives.iter().filter_map(|one| one.gain).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The doubted words of a text: those with enough gain by a change, and those that a check found wrong or could not
/// decide, with suggestions. They may overlap.
#[must_use]
pub fn doubts(
    text: &str,
    guide: &Guide,
    known: Known<'_>,
    weights: &Weights,
    (bounds, findings): (&Bounds, &[Finding]),
) -> Vec<Doubt> {
    let sites = sites(text, guide, known, weights);
    let mut doubts = said::of_findings(findings);
    for doubt in &mut doubts {
        let is_wrong = doubt.cause == Cause::Wrong;
        let motion = sites.iter().filter(|site| site.tells_motion() && is_within(doubt.span, site.span));
        // A check only marks the side of a turn; the suggestion replaces all of "turn left".
        if let Some(motion) = motion.min_by_key(|site| site.span[1] - site.span[0]).filter(|_| is_wrong) {
            doubt.span = motion.span;
        }
        let turns = |site: &Site| site.tells_motion() && is_within(site.span, doubt.span) && site.gain() > 0.0;
        if is_wrong && !sites.iter().any(turns) && guide.stands_without(doubt.span) {
            doubt.alternatives.push(Alternative { words: None, gain: None });
        }
        for site in &sites {
            if let Some(weaker) = offered(site, doubt) {
                doubt.take_over(text, &weaker);
            }
        }
    }
    doubts.extend(sites.into_iter().filter_map(|site| Some(site.doubt(bounds.grade(site.source, site.gain())?))));
    doubts
}

/// Whether a byte range lies in another.
fn is_within(inner: [usize; 2], outer: [usize; 2]) -> bool {
    outer[0] <= inner[0] && inner[1] <= outer[1]
}

/// The suggestions of a site for words that a check doubts. If a check found the way by a place wrong, any other way
/// may be right.
fn offered(site: &Site, doubt: &Doubt) -> Option<Doubt> {
    let is_wrong = doubt.cause == Cause::Wrong;
    let is_name = matches!(site.source, Source::Place | Source::Unknown);
    if is_wrong && site.source == Source::Way {
        let Site { span, alternatives, .. } = site.clone();
        let best = alternatives.into_iter().take(1).map(|one| Alternative { gain: None, ..one }).collect();
        return (span == doubt.span).then_some(Doubt { span, alternatives: best, ..doubt.clone() });
    }
    let fits = is_name || (is_wrong && (site.span == doubt.span || site.tells_motion()));
    fits.then(|| site.doubt(doubt.grade))
}

/// Whether a text has too many steps to examine its changes.
#[must_use]
pub fn is_too_long(guide: &Guide) -> bool {
    guide.len() > MOST_STEPS
}

/// The gains of single changes of a text for a walk; empty if the text has too many steps.
#[must_use]
pub fn sites(text: &str, guide: &Guide, known: Known<'_>, weights: &Weights) -> Vec<Site> {
    if guide.is_empty() || is_too_long(guide) {
        return Vec::new();
    }
    let spelt = Spelt::of(text);
    let walk = OneWalk::new(known.building, known.walk, known.heading_rad, weights);
    let mut sites = single(&spelt, guide, known, weights);
    sites.extend(ways::sites(&spelt, guide, &walk));
    sites.extend(others::sites(&spelt, guide, known, &walk));
    sites.extend(swapped(&spelt, guide, known, weights));
    sites
}

/// Turns, sides, climbs and steps.
fn single(spelt: &Spelt<'_>, guide: &Guide, known: Known<'_>, weights: &Weights) -> Vec<Site> {
    let site = |change: Change| {
        let step = &guide.steps[change.step].step;
        let turn = || Some(spelt.turn(step.span, step.turn_span?));
        let (source, span, words) = match change.kind {
            Kind::Turn => (Source::Turn, turn()?, Some(spelt.other_side(turn()?)?)),
            Kind::NoTurn => (Source::NoTurn, turn()?, None),
            Kind::Side => {
                let span = spelt.side(step.span)?;
                (Source::Side, span, Some(spelt.other_side(span)?))
            }
            Kind::Climb => {
                let (span, other) = spelt.climb(step.span, step.climb == Some(Climb::Up))?;
                (Source::Climb, span, Some(other))
            }
            Kind::NoStep => (Source::NoStep, spelt.step(step.span)?, None),
        };
        Site::of(source, span, vec![Alternative { words, gain: Some(change.gain) }])
    };
    changes(guide, known.building, known.walk, known.heading_rad, weights).into_iter().filter_map(site).collect()
}

/// The two places with the highest gain from swapping: each may be named where the other is.
fn swapped(spelt: &Spelt<'_>, guide: &Guide, known: Known<'_>, weights: &Weights) -> Vec<Site> {
    let swap = best_swap(guide, known.building, known.walk, known.heading_rad, weights);
    let site = |(gain, here, there)| {
        let words = Some(in_capitals_of(spelt.words(here), &spelt.words(there).to_lowercase()));
        Site::of(Source::Swap, here, vec![Alternative { words, gain: Some(gain) }])
    };
    let both = swap.map(|swap| [(swap.gain, swap.spans[0], swap.spans[1]), (swap.gain, swap.spans[1], swap.spans[0])]);
    both.into_iter().flatten().filter_map(site).collect()
}

/// Whether a name means stairs, which are neither entered nor replaced.
fn is_stairs(name: &str) -> bool {
    room_name(name) == Some("stairs")
}

/// The alternatives that gain most, the best first.
fn best_first(alternatives: impl Iterator<Item = Alternative>) -> Vec<Alternative> {
    let gain = |one: &Alternative| one.gain.filter(|gain| gain.is_finite());
    let mut best: Vec<Alternative> = alternatives.filter(|one| gain(one).is_some()).collect();
    best.sort_by(|a, b| gain(b).unwrap_or(0.0).total_cmp(&gain(a).unwrap_or(0.0)));
    best.truncate(MOST_ALTERNATIVES);
    best
}

#[cfg(test)]
mod tests;
