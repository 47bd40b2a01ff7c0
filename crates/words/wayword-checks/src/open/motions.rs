//! Finds motions by places ("walk past the sofa") that a text repeats although the path has one of them, and those
//! that contradict the stop of the text.

use super::{
    claims::{PlaceClaim, read_claims},
    phrase::motion_span,
    relation::WalkerRelation,
    stretches::PathStretches,
};
use wayword_core::ClimbDirection;
use wayword_language::{
    lexicon::{ThingClass, is_room, is_thing, kinds_of, normal_word, room_name},
    reading::{EventContent, PlaceMention, PlaceMotion, TextReading, motion_words::TAKING_UP},
    text::TextToken,
};

/// How far before a place the words may be that identify it, words.
const IDENTIFYING_REACH_WORDS: usize = 3;

/// A motion by a place: it goes into it, out of it, through it or past it.
struct TextMotion<'a> {
    /// The place among the claims of the text.
    at: usize,
    relation: WalkerRelation,
    /// The name by which the place is compared ([`compared_name`]).
    name: String,
    /// The words that identify it: those right before the place, and those of its name.
    which: Vec<&'a str>,
    /// Up or down, where the motion goes over stairs.
    climb: Option<ClimbDirection>,
    /// The number of its clause.
    clause: usize,
    is_room: bool,
    /// Whether the same place may be meant again: "walk around the table".
    may_go_on: bool,
    /// The byte range from its verb to the name of the place.
    span: [usize; 2],
}

/// The byte ranges of repeated motions, where the path has one stretch of them.
pub(super) fn repeated_motions(reading: &TextReading, stretches: &PathStretches<'_>) -> Vec<[usize; 2]> {
    let tokens = reading.tokens();
    let claims = read_claims(reading);
    let motions = find_motions(reading, &claims);
    let repeated_span = |(at, motion): (usize, &TextMotion<'_>)| {
        let climbs_alike = |before: &TextMotion<'_>| match (before.climb, motion.climb) {
            (Some(before), Some(again)) => before == again,
            _ => true,
        };
        let same = |before: &&TextMotion<'_>| {
            before.relation == motion.relation && before.name == motion.name && climbs_alike(before)
        };
        let before = motions[..at].iter().rposition(|before| same(&before))?;
        let is_other = motions[before].clause == motion.clause
            || motion.may_go_on
            || motion.which.iter().any(|word| !motions[before].which.contains(word))
            || refers_back(tokens, &claims[motion.at])
            || is_restated(reading, &motions[before], motion)
            || leaves_between(&motions[before..=at]);
        // A thing that the labels do not list is passed no more than once, either.
        let passes_thing =
            motion.relation == WalkerRelation::Past && !motion.is_room && claims[motion.at].class != ThingClass::Fabric;
        let is_once = match stretches.count_places(&claims[motion.at]) {
            0 => passes_thing,
            count => count == 1,
        };
        (!is_other && is_once).then_some(motion.span)
    };
    motions.iter().enumerate().filter_map(repeated_span).collect()
}

/// The byte range of a motion past the place at which the text stops next: "walk past the sofa and stop by the sofa".
pub(super) fn past_the_stop(reading: &TextReading) -> Option<[usize; 2]> {
    let tokens = reading.tokens();
    let claims = read_claims(reading);
    let stop = claims.iter().rposition(|claim| claim.relation == WalkerRelation::Stop)?;
    let before = stop.checked_sub(1).filter(|at| claims[*at].relation == WalkerRelation::Past)?;
    let place = |at: usize| match &reading.events[claims[at].event].what {
        EventContent::Place(place) => Some(place),
        _ => None,
    };
    let (passed, stopped) = (place(before)?, place(stop)?);
    let (from, to) = (claims[before].event, claims[stop].event);
    let goes_on = reading.events[from..to].iter().any(|event| is_turn_or_climb(&event.what));
    let (first, last) = (claims[before].span, claims[stop].span);
    let (words, at_stop) = (identifying_words(tokens, &claims[before]), identifying_words(tokens, &claims[stop]));
    // "Walk past the closet and stop in the closet doorway".
    let is_its_door = || at_stop.last().is_some_and(|word| matches!(*word, "door" | "doorway" | "entrance"));
    let is_same =
        at_stop == words || (at_stop.starts_with(&words) && at_stop.len() == words.len() + 1 && is_its_door());
    let between = || tokens.iter().filter(|token| first[1] <= token.span[0] && token.span[1] <= last[0]);
    let is_part = || between().any(|token| matches!(token.word.as_str(), "between" | "end" | "past" | "behind"));
    let is_apart = claims[before].clause_in(reading) != claims[stop].clause_in(reading);
    let is_wrong = is_same && is_apart && !goes_on && !tells_which(passed) && !tells_which(stopped) && !is_part();
    // The finding marks the motion alone, because the place is there.
    let way = tokens.iter().rev().filter(|token| token.span[1] <= first[0]).find(|token| is_way(&token.word))?;
    is_wrong.then(|| motion_span(tokens, way.span, |_| false))
}

/// Whether the text identifies a place among several, or names several of them.
fn tells_which(place: &PlaceMention) -> bool {
    place.ordinal.is_some() || place.several || place.side.is_some()
}

/// Whether an event is a turn or a climb.
fn is_turn_or_climb(what: &EventContent) -> bool {
    matches!(what, EventContent::Turn(_) | EventContent::Climb(_) | EventContent::Steps(_))
}

/// The motions of a text by its places, except by places of which the text counts several.
fn find_motions<'a>(reading: &'a TextReading, claims: &[PlaceClaim]) -> Vec<TextMotion<'a>> {
    let tokens = reading.tokens();
    let place = |claim: &PlaceClaim| match &reading.events[claim.event].what {
        EventContent::Place(place) => Some((place.ordinal.is_some() || place.several, place.going)),
        _ => None,
    };
    // "Into the next hallway": the text itself counts several, so another motion by that name is no repetition.
    let is_one_of_several_places =
        |claim: &&PlaceClaim| place(claim).is_some_and(|(is_one_of_several, _)| is_one_of_several);
    let several: Vec<String> = claims.iter().filter(is_one_of_several_places).map(compared_name).collect();
    let motion = |(at, claim): (usize, &PlaceClaim)| {
        let moves = matches!(
            claim.relation,
            WalkerRelation::Enter | WalkerRelation::Exit | WalkerRelation::Through | WalkerRelation::Past
        );
        let (_, going) = place(claim)?;
        let name = compared_name(claim);
        let is_motion = moves
            && !several.contains(&name)
            && !only_locates_something(tokens, claim)
            && !stops_before(reading, claim);
        let motion = TextMotion {
            at,
            relation: claim.relation,
            name,
            which: identifying_words(tokens, claim),
            climb: stair_climb(reading, claim),
            clause: claim.clause_in(reading),
            is_room: claim.is_room,
            may_go_on: going == Some(PlaceMotion::Around),
            span: motion_span(tokens, claim.span, |_| false),
        };
        is_motion.then_some(motion)
    };
    claims.iter().enumerate().filter_map(motion).collect()
}

/// Which way the words before the stairs of a claim climb them.
fn stair_climb(reading: &TextReading, claim: &PlaceClaim) -> Option<ClimbDirection> {
    let is_stairs = claim.class == ThingClass::Stairs || room_name(&claim.name) == Some("stairs");
    let clause = claim.clause_in(reading);
    let before = reading.events[..claim.event].iter().rev().take_while(|event| event.clause == clause);
    before.filter(|_| is_stairs).find_map(|event| match event.what {
        EventContent::Climb(climb) | EventContent::Steps(climb) => Some(climb),
        _ => None,
    })
}

/// The name by which a place is compared.
fn compared_name(claim: &PlaceClaim) -> String {
    // One text calls a room by one name, so the name itself is compared; only hallways and stairs go by several.
    match room_name(&claim.name).filter(|_| claim.is_room) {
        Some(room @ ("hallway" | "stairs")) => room.to_owned(),
        Some(_) => claim.name.clone(),
        None => kinds_of(&claim.name).swap_remove(0),
    }
}

/// The words that identify a place: those before it, back to its article, and those of its name.
fn identifying_words<'a>(tokens: &'a [TextToken], claim: &PlaceClaim) -> Vec<&'a str> {
    let at = tokens.partition_point(|token| token.span[0] < claim.span[0]);
    let end = tokens.partition_point(|token| token.span[1] <= claim.span[1]);
    let before = || tokens[..at].iter().rev().take(IDENTIFYING_REACH_WORDS);
    let article = before().position(|token| is_article(&token.word)).unwrap_or(0);
    // "The plant in the orange pot", "the picture of a ship".
    let behind = tokens[end..].iter().take_while(|token| token.is_word()).take(IDENTIFYING_REACH_WORDS + 1);
    let is_described = tokens.get(end).is_some_and(|token| matches!(token.word.as_str(), "in" | "of" | "with"));
    let behind = behind.filter(|_| is_described);
    before().take(article).chain(&tokens[at..end]).chain(behind).map(|token| token.word.as_str()).collect()
}

/// Whether a word expresses how a motion goes by a place.
fn is_way(word: &str) -> bool {
    matches!(word, "past" | "pass" | "passed" | "passing" | "by" | "through" | "down" | "up" | "into" | "out")
}

fn is_article(word: &str) -> bool {
    matches!(word, "the" | "a" | "an" | "your")
}

/// Whether the words before a place only locate something: "the door just past the sofa", "the hallway that is past
/// the stairs", "halfway down the stairs".
fn only_locates_something(tokens: &[TextToken], claim: &PlaceClaim) -> bool {
    let at = tokens.partition_point(|token| token.span[0] < claim.span[0]);
    let word = |at: usize| tokens.get(at).map_or("", |token| token.word.as_str());
    let of_at = at.saturating_sub(1 + usize::from(at > 0 && is_article(word(at - 1))));
    if word(of_at) == "of" && of_at > 0 && word(of_at - 1) != "out" {
        // "Past the foot of the bed".
        return true;
    }
    let Some(way) = (at.saturating_sub(IDENTIFYING_REACH_WORDS + 1)..at).rev().find(|at| is_way(word(*at))) else {
        return false;
    };
    let before = way.checked_sub(1).map_or("", word);
    let is_side = || matches!(before, "left" | "right") && way > 1 && is_ordinal(word(way - 2));
    let name = normal_word(before);
    is_thing(&name)
        || is_room(&name)
        || matches!(before, "is" | "are" | "just" | "halfway" | "feet" | "steps")
        || is_side()
}

/// Whether a word before "left" or "right" makes a noun of it: "the left", "second left".
fn is_ordinal(word: &str) -> bool {
    matches!(word, "first" | "second" | "third" | "next" | "last" | "the" | "1st" | "2nd" | "3rd")
}

/// "Stop just past the sofa", "wait halfway down the stairs": no motion.
fn stops_before(reading: &TextReading, claim: &PlaceClaim) -> bool {
    let clause = claim.clause_in(reading);
    reading.events[..claim.event].iter().any(|event| event.what == EventContent::Stop && event.clause == clause)
}

/// Whether a motion into, out of or along a place is repeated at once, in other words: "exit the room and turn right
/// out of the room", "down the hallway. Go down the hallway until ...".
fn is_restated(reading: &TextReading, before: &TextMotion<'_>, again: &TextMotion<'_>) -> bool {
    let is_between = |clause: usize| before.clause < clause && clause < again.clause;
    let goes_on = |event: &wayword_language::reading::TextEvent| match &event.what {
        EventContent::Place(place) => matches!(
            place.going,
            Some(
                PlaceMotion::Leaving
                    | PlaceMotion::Entering
                    | PlaceMotion::Through
                    | PlaceMotion::Along
                    | PlaceMotion::Past
                    | PlaceMotion::Towards
            )
        ),
        what => is_turn_or_climb(what),
    };
    let moved = reading.events.iter().filter(|event| is_between(event.clause)).any(goes_on);
    again.relation != WalkerRelation::Past && !moved
}

/// Whether the walk gets elsewhere between two motions by places of one name: people call two rooms by one name.
fn leaves_between(motions: &[TextMotion<'_>]) -> bool {
    let (Some(first), Some(last)) = (motions.first(), motions.last()) else { return false };
    let elsewhere = |between: &TextMotion<'_>| match last.relation {
        WalkerRelation::Exit => between.name == first.name && between.relation == WalkerRelation::Enter,
        _ => between.name != first.name || between.relation == WalkerRelation::Exit,
    };
    let between = &motions[1..motions.len() - 1];
    last.is_room && between.iter().any(|motion| motion.relation != WalkerRelation::Past && elsewhere(motion))
}

/// Whether one of the nine words before a place refers back: "once past the sofa", "another door".
fn refers_back(tokens: &[TextToken], claim: &PlaceClaim) -> bool {
    let at = tokens.partition_point(|token| token.span[0] < claim.span[0]);
    let clause = tokens[..at].iter().rev().take_while(|token| token.is_word()).take(9);
    clause.into_iter().any(|token| TAKING_UP.contains(&token.word.as_str()))
}
