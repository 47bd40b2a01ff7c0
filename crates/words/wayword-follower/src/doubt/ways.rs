//! Finds better prepositions for how the walk passes a place: "walk to the sofa" for "walk past the sofa".

use super::{DoubtSite, DoubtSource, MAX_EXAMINED_PLACES, best_first, is_stairs};
use crate::{
    guide::{Guide, GuideMention},
    one_walk::OneWalk,
};
use wayword_core::DoubtAlternative;
use wayword_language::{
    reading::steps::StepRelation,
    rewording::{TokenisedText, in_capitals_of},
};

/// The relations of a walk to a place, each as one preposition.
const WAY_PREPOSITIONS: [(StepRelation, &str); 6] = [
    (StepRelation::To, "to"),
    (StepRelation::Past, "past"),
    (StepRelation::Into, "into"),
    (StepRelation::OutOf, "out of"),
    (StepRelation::Through, "through"),
    (StepRelation::Along, "along"),
];

/// Tries other prepositions for each place that the walk passes, enters or leaves by the text.
pub(super) fn way_sites(spelt: &TokenisedText<'_>, guide: &Guide, walk: &OneWalk<'_>) -> Vec<DoubtSite> {
    if guide.is_goal {
        return Vec::new();
    }
    let base_score = walk.score(guide);
    let mut sites = Vec::new();
    for (step, place) in guide.named_places().take(MAX_EXAMINED_PLACES) {
        let guide_step = &guide.steps[step];
        let mention = &guide_step.mentions[place];
        let is_way = WAY_PREPOSITIONS.iter().any(|(relation, _)| *relation == mention.relation);
        let way = mention.span.filter(|_| is_way).and_then(|span| spelt.way_words(guide_step.step.span, span));
        let Some(way) = way else { continue };
        let alternative = |(relation, preposition): &(StepRelation, &str)| {
            let mut changed = guide.clone();
            changed.steps[step].change_relation(place, *relation);
            let gain = walk.score(&changed) - base_score;
            let words = in_capitals_of(spelt.words_of(way.span), &format!("{}{preposition}", way.verb));
            DoubtAlternative { words: Some(words), gain: Some(gain) }
        };
        let others =
            WAY_PREPOSITIONS.iter().filter(|(other, _)| *other != mention.relation && is_possible_way(mention, *other));
        let alternatives = best_first(others.map(alternative));
        sites.extend(DoubtSite::from_alternatives(DoubtSource::Way, way.span, alternatives));
    }
    sites
}

/// Whether a relation is possible for a place: a walker does not go into a chair.
fn is_possible_way(mention: &GuideMention, relation: StepRelation) -> bool {
    let is_room = mention.meanings.first().is_some_and(|what| what.is_room && !is_stairs(&what.name));
    is_room || matches!(relation, StepRelation::To | StepRelation::Past)
}

#[cfg(test)]
mod tests;
