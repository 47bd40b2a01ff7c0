//! Finds other places along the walk that would fit it better than the ones in the text.

use super::{DoubtSite, DoubtSource, MAX_EXAMINED_PLACES, best_first, is_stairs};
use crate::{
    building::KnownBuilding,
    guide::{Guide, GuideMention, GuideTrial},
    nearness::PlaceQuery,
    one_walk::OneWalk,
    route::KnownWalk,
};
use std::{cmp::Reverse, collections::BTreeMap};
use wayword_core::DoubtAlternative;
use wayword_language::{
    lexicon::{find_thing, is_plural, means_several, names_agree, same_room, to_plural, with_article},
    rewording::{TokenisedText, in_capitals_of},
};

/// Most names of rooms, and of things, that are tried for each place.
const MAX_TRIED_NAMES: usize = 20;
/// Least salience in the lexicon (how easily one notices a thing) of a thing that is suggested to readers.
const MIN_SALIENCE: u8 = 2;

/// Tries the rooms and things along the walk in place of each place that the text names.
pub(super) fn other_place_sites(
    spelt: &TokenisedText<'_>,
    guide: &Guide,
    known: KnownWalk<'_>,
    walk: &OneWalk<'_>,
) -> Vec<DoubtSite> {
    let names = names_along(known.building, known.walk);
    let trial = GuideTrial::new(guide, known.building);
    let base_score = walk.score(guide);
    let mut sites = Vec::new();
    for (step, place) in guide.named_places().take(MAX_EXAMINED_PLACES) {
        let mention = &guide.steps[step].mentions[place];
        // A word before the name may belong to the old thing alone: "the water fountain".
        let Some(span) = mention.span.filter(|span| spelt.is_bare(*span)) else { continue };
        let is_found = trial.located[step].iter().any(|found| std::ptr::eq(found.mention, mention));
        let whole = spelt.with_its_article(span);
        let alternative = |name: &PlaceQuery| {
            let mut changed = guide.clone();
            changed.steps[step].mentions[place].meanings = vec![name.clone()];
            let gain = walk.score(&changed) - base_score;
            DoubtAlternative { words: Some(replacement_words(spelt, span, whole, &name.name)), gain: Some(gain) }
        };
        let alternatives = best_first(names.iter().filter(|name| can_replace(mention, name)).map(alternative));
        let source = if is_found { DoubtSource::Place } else { DoubtSource::Unknown };
        sites.extend(DoubtSite::from_alternatives(source, whole, alternatives));
    }
    sites
}

/// The rooms of a walk, and the things that are seen from it: the most salient things first.
fn names_along(building: &KnownBuilding, walk: &[usize]) -> Vec<PlaceQuery> {
    let mut rooms: Vec<&str> = walk.iter().filter_map(|at| building.viewpoints[*at].room.as_deref()).collect();
    rooms.sort_unstable();
    rooms.dedup();
    let mut things: BTreeMap<&str, u8> = BTreeMap::new();
    for seen in &building.things {
        let salience = find_thing(&seen.name).map_or(0, |thing| thing.salience);
        if salience >= MIN_SALIENCE && seen.seen_from.iter().any(|at| walk.contains(at)) {
            things.insert(&seen.name, salience);
        }
    }
    let mut things: Vec<(&str, u8)> = things.into_iter().collect();
    things.sort_by_key(|(name, salience)| (Reverse(*salience), *name));
    let room = rooms.into_iter().map(|name| PlaceQuery { is_room: true, name: name.to_owned() });
    let thing = things.into_iter().map(|(name, _)| PlaceQuery { is_room: false, name: name.to_owned() });
    room.take(MAX_TRIED_NAMES).chain(thing.take(MAX_TRIED_NAMES)).collect()
}

/// Whether a name can replace a mention: it means something else, and is a room for a room and a thing for a thing.
fn can_replace(mention: &GuideMention, name: &PlaceQuery) -> bool {
    let is_alike = mention.meanings.iter().any(|what| what.is_room == name.is_room);
    let is_same = |what: &PlaceQuery| {
        names_agree(&what.name, &name.name) || names_agree(&name.name, &what.name) || same_room(&what.name, &name.name)
    };
    let is_climbed = is_stairs(&name.name) || mention.meanings.iter().any(|what| is_stairs(&what.name));
    is_alike && !is_climbed && !mention.meanings.iter().any(is_same)
}

/// A replacement for the name in the range `old`, in its number, with its article and capitals. `whole` is the range of the old
/// name with its article "a" or "an", if it has one.
fn replacement_words(spelt: &TokenisedText<'_>, old: [usize; 2], whole: [usize; 2], name: &str) -> String {
    let has_article = whole != old;
    let name = match name {
        name if means_several(spelt.words_of(old)) => to_plural(name),
        name if has_article && !is_plural(name) => with_article(name),
        name => name.to_owned(),
    };
    in_capitals_of(spelt.words_of(whole), &name)
}

#[cfg(test)]
mod tests;
