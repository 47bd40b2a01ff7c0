//! Finds better prepositions for how the walk passes a place: "walk to the sofa" for "walk past the sofa".

use super::{MOST_PLACES, Site, Source, best_first, is_stairs};
use crate::{
    guide::{Guide, Mention},
    one_walk::OneWalk,
};
use wayword_core::Alternative;
use wayword_language::{
    reading::steps::Relation,
    rewording::{Spelt, in_capitals_of},
};

/// The relations of a walk to a place, each as one preposition.
const WAYS: [(Relation, &str); 6] = [
    (Relation::To, "to"),
    (Relation::Past, "past"),
    (Relation::Into, "into"),
    (Relation::OutOf, "out of"),
    (Relation::Through, "through"),
    (Relation::Along, "along"),
];

pub(super) fn sites(spelt: &Spelt<'_>, guide: &Guide, walk: &OneWalk<'_>) -> Vec<Site> {
    if guide.is_goal {
        return Vec::new();
    }
    let as_told = walk.score(guide);
    let mut sites = Vec::new();
    for (step, place) in guide.places().take(MOST_PLACES) {
        let told = &guide.steps[step];
        let mention = &told.mentions[place];
        let is_way = WAYS.iter().any(|(relation, _)| *relation == mention.relation);
        let way = mention.span.filter(|_| is_way).and_then(|span| spelt.way(told.step.span, span));
        let Some(way) = way else { continue };
        let alternative = |(relation, preposition): &(Relation, &str)| {
            let mut changed = guide.clone();
            changed.steps[step].change_relation(place, *relation);
            let gain = walk.score(&changed) - as_told;
            let words = in_capitals_of(spelt.words(way.span), &format!("{}{preposition}", way.verb));
            Alternative { words: Some(words), gain: Some(gain) }
        };
        let others = WAYS.iter().filter(|(other, _)| *other != mention.relation && is_way_by(mention, *other));
        let alternatives = best_first(others.map(alternative));
        sites.extend(Site::of(Source::Way, way.span, alternatives));
    }
    sites
}

/// Whether a relation is possible for a place: a walker does not go into a chair.
fn is_way_by(mention: &Mention, relation: Relation) -> bool {
    let is_room = mention.meanings.first().is_some_and(|what| what.is_room && !is_stairs(&what.name));
    is_room || matches!(relation, Relation::To | Relation::Past)
}
