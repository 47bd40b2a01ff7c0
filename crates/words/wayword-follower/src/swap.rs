//! Finds two places of an instruction that fit its walk better in the opposite order: "past the sofa to the sink" where
//! the sink comes first.

use crate::{
    building::KnownBuilding,
    guide::{Guide, GuideMention, GuideTrial},
    one_walk::OneWalk,
    weights::FeatureWeights,
};
use wayword_language::reading::steps::StepRelation;

/// Two places of a text, and the gain of naming each where the other is named.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceSwap {
    /// Their names, in the order of the text.
    pub names: [String; 2],
    /// Their byte ranges in the text.
    pub spans: [[usize; 2]; 2],
    /// How much better the text fits the walk then, in natural logs; negative where it fits worse.
    pub gain: f64,
}

/// Most places of a text that are examined, because the work grows with their square. Later places are ignored.
const MAX_SWAPPED_PLACES: usize = 14;

/// The two places with the highest gain; `None` if the building has fewer than two of the named places.
///
/// `walk` lists the viewpoints of the walk, and `heading_rad` is the direction of the walker at its start (radians from
/// +y, clockwise).
#[must_use]
pub fn best_swap(
    guide: &Guide,
    building: &KnownBuilding,
    walk: &[usize],
    heading_rad: f64,
    weights: &FeatureWeights,
) -> Option<PlaceSwap> {
    let known = OneWalk::new(building, walk, heading_rad, weights);
    let places = met_places(guide, building);
    let base_score = known.score(guide);
    let mut best: Option<PlaceSwap> = None;
    for (number, a) in places.iter().enumerate() {
        for b in &places[number + 1..] {
            let (first, second) = (a.mention_in(guide), b.mention_in(guide));
            if a.step == b.step || first.meanings == second.meanings {
                continue;
            }
            let mut changed = guide.clone();
            changed.steps[a.step].mentions[a.place].meanings = second.meanings.clone();
            changed.steps[b.step].mentions[b.place].meanings = first.meanings.clone();
            let gain = known.score(&changed) - base_score;
            if gain.is_finite() && best.as_ref().is_none_or(|best| gain > best.gain) {
                let name =
                    |mention: &GuideMention| mention.meanings.first().map(|what| what.name.clone()).unwrap_or_default();
                best = Some(PlaceSwap { names: [name(first), name(second)], spans: [a.span, b.span], gain });
            }
        }
    }
    best
}

/// A place in a guide.
struct GuidePlace {
    /// The number of the step, and of the place among the step's mentions.
    step: usize,
    place: usize,
    /// The byte range of the place's name in the text.
    span: [usize; 2],
}

impl GuidePlace {
    fn mention_in<'a>(&self, guide: &'a Guide) -> &'a GuideMention {
        &guide.steps[self.step].mentions[self.place]
    }
}

/// Whether a walker comes to a place with this relation. A place that only identifies another one, as in "the table
/// with the lamp", has no position in the order.
fn is_met(relation: StepRelation) -> bool {
    use StepRelation::{Along, At, In, Into, OutOf, Past, Through, To};
    matches!(relation, OutOf | Into | In | Through | Past | To | Along | At)
}

/// The first places that a text names, the walker comes to, and the building has. A place that the building lacks
/// cannot be swapped meaningfully.
fn met_places(guide: &Guide, building: &KnownBuilding) -> Vec<GuidePlace> {
    let trial = GuideTrial::new(guide, building);
    let mut places = Vec::new();
    for (step, content) in guide.steps.iter().enumerate() {
        for (place, mention) in content.mentions.iter().enumerate() {
            let is_found = trial.located[step].iter().any(|found| std::ptr::eq(found.mention, mention));
            let is_met = is_found && is_met(mention.relation);
            places.extend(mention.span.filter(|_| is_met).map(|span| GuidePlace { step, place, span }));
        }
    }
    places.truncate(MAX_SWAPPED_PLACES);
    places
}

#[cfg(test)]
mod tests;
