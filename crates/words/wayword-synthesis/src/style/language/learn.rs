//! Learns from texts of a language how they say what clauses say.
//!
//! A text is read through its English words, which show the kind of each clause. The clause's own words, with slots for its names, are the
//! shape that texts of the language have for this kind.

use super::super::way::{
    ALLOWED_SHAPE_WORDS, ClauseJoint, ClauseKind, ENOUGH_CLAUSES, MIN_SHAPE_TEXTS, WayWording,
    shapes::{ShapedClause, has_its_slots, shape_clauses},
};
use super::LanguageWording;
use std::{collections::BTreeSet, sync::Arc};
use wayword_core::Side;
use wayword_language::{
    languages::{NameSense, ReadableText, names_within},
    lexicon::{find_thing, room_name},
    reading::{EventContent, TextReading, read_instruction},
};

/// A name is used if at least this share of the mentions of the room or thing use it.
const MIN_NAME_SHARE: f64 = 0.1;
/// Most characters of a shape, slots counted as one.
const MAX_SHAPE_CHARACTERS: usize = 14;
/// A shape is used if at least this share of the clauses of its kind have it.
const MIN_SHAPE_SHARE: f64 = 0.01;

/// The wording of texts in a language; what they show too little of is that of the built-in wording.
#[must_use]
pub(in crate::style) fn learn_wording<'a>(
    built_in: &LanguageWording,
    texts: impl IntoIterator<Item = (&'a ReadableText<'a>, &'a TextReading)>,
) -> LanguageWording {
    let (mut way, count) = counted_way(built_in, texts);
    if count < ENOUGH_CLAUSES {
        way.stop_share = built_in.way.stop_share;
    }
    keep_common(built_in, &mut way);
    fill_from(built_in, &mut way);
    LanguageWording { way: Arc::new(way), ..built_in.clone() }
}

/// Counts all shapes, joints and names of texts in a language that the program writes, also those that are too rare to be used.
#[must_use]
pub fn count_shapes(language: &LanguageWording, texts: &[String]) -> WayWording {
    let texts: Vec<ReadableText<'_>> = texts.iter().map(|text| ReadableText::new(text, Some(language.tag))).collect();
    let readings: Vec<TextReading> =
        texts.iter().map(|text| read_instruction(text.english(), &BTreeSet::new())).collect();
    counted_way(language, texts.iter().zip(&readings)).0
}

/// The counts of texts, and their number.
fn counted_way<'a>(
    language: &LanguageWording,
    texts: impl IntoIterator<Item = (&'a ReadableText<'a>, &'a TextReading)>,
) -> (WayWording, f64) {
    let mut way = WayWording::default();
    let (mut count, mut stops) = (0.0, 0.0);
    for (text, reading) in texts {
        add_text(language, &mut way, text, reading);
        count += 1.0;
        stops += f64::from(u8::from(reading.events.iter().any(|event| event.what == EventContent::Stop)));
    }
    way.stop_share = stops / f64::max(count, 1.0);
    (way, count)
}

/// Counts the shapes, joints and names of one text.
fn add_text(language: &LanguageWording, way: &mut WayWording, text: &ReadableText<'_>, reading: &TextReading) {
    let clauses = shape_clauses(text.english(), reading, &ALLOWED_SHAPE_WORDS);
    let regions: Vec<Option<[usize; 2]>> = clauses.iter().map(|clause| clause_region(text, clause)).collect();
    let mut before: Option<[usize; 2]> = None;
    let mut after_turn = false;
    for (at, (clause, region)) in clauses.iter().zip(&regions).enumerate() {
        let apart = |other: &Option<[usize; 2]>| {
            let (Some(own), Some(other)) = (region, other) else { return true };
            own[1] <= other[0] || other[1] <= own[0]
        };
        let stands_alone = regions.iter().enumerate().all(|(other, region)| other == at || apart(region));
        if let (Some(before), Some(region)) = (before, region)
            && before[1] <= region[0]
        {
            let joint = joint_of(language, &text.text()[before[1]..region[0]]);
            let joints = match () {
                () if clause.stops => &mut way.stop_joints,
                () if after_turn => &mut way.turn_joints,
                () => &mut way.joints,
            };
            *joints.entry(joint).or_default() += 1.0;
        }
        before = region.or(before);
        after_turn = clause.kind.is_some_and(ClauseKind::is_bare_turn);
        let Some(kind) = clause.kind else { continue };
        *way.kinds.entry(kind).or_default() += 1.0;
        if let Some(shape) =
            region.filter(|_| stands_alone).and_then(|region| own_shape(language, text, clause, region))
        {
            let shapes = if at == 0 { &mut way.first_shapes } else { &mut way.shapes };
            *shapes.entry(kind).or_default().entry(shape).or_default() += 1.0;
        }
    }
    for event in &reading.events {
        let EventContent::Place(place) = &event.what else { continue };
        if place.several {
            continue;
        }
        let [from, to] = text.source_span(event.span);
        let Some(said) = text.text().get(from..to) else { continue };
        if let Some(room) = room_name(&place.name).filter(|_| place.is_room) {
            *way.rooms.entry(room.to_owned()).or_default().entry(said.to_owned()).or_default() += 1.0;
        } else if let Some(thing) = find_thing(&place.name) {
            *way.things.entry(thing.name.to_owned()).or_default().entry(said.to_owned()).or_default() += 1.0;
        }
    }
}

/// The bytes of a text that the words of a clause stand for.
fn clause_region(text: &ReadableText<'_>, clause: &ShapedClause) -> Option<[usize; 2]> {
    let sources = clause.words.iter().filter_map(|span| text.source_of_word(*span));
    sources.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])])
}

/// The shape of a clause in the words of its text; `None` where a name is no run of words there.
fn own_shape(
    language: &LanguageWording,
    text: &ReadableText<'_>,
    clause: &ShapedClause,
    [from, to]: [usize; 2],
) -> Option<String> {
    let kind = clause.kind?;
    let mut names: Vec<([usize; 2], &str)> =
        clause.names.iter().map(|(span, slot)| (text.source_span(*span), *slot)).collect();
    names.sort_unstable();
    let (mut shape, mut at) = (String::new(), from);
    for (span, slot) in names {
        shape += &with_side_slots(language, kind, text.text().get(at..span[0])?);
        shape += slot;
        at = span[1];
    }
    shape += &with_side_slots(language, kind, text.text().get(at..to)?);
    let slots = shape.matches('{').count();
    let names_more = || names_within(language.tag, &shape).iter().any(|name| name != "room");
    if language.has_trait(&shape, "broken") || names_more() {
        return None;
    }
    let is_plain = |c: char| c.is_alphabetic() && !c.is_ascii() || "{}slrap".contains(c);
    let is_short = shape.chars().count() - 2 * slots <= MAX_SHAPE_CHARACTERS;
    (is_short && shape.chars().all(is_plain) && has_its_slots(kind, &shape)).then_some(shape)
}

/// Words with a slot for each side. A turn's side is `{s}`, that of a place `{p}`.
fn with_side_slots(language: &LanguageWording, kind: ClauseKind, words: &str) -> String {
    let slot = if kind.turns() { "{s}" } else { "{p}" };
    language.words.sides.iter().fold(words.to_owned(), |words, side| words.replace(side.as_str(), slot))
}

/// The joint that the words between two clauses make.
fn joint_of(language: &LanguageWording, between: &str) -> ClauseJoint {
    let has = |name: &str| language.has_trait(between, name);
    match (has("joint_stop"), has("joint_comma"), has("joint_then")) {
        (true, _, true) => ClauseJoint::StopThen,
        (true, _, false) => ClauseJoint::Stop,
        (false, true, true) => ClauseJoint::CommaThen,
        (false, true, false) => ClauseJoint::Comma,
        (false, false, true) => ClauseJoint::Then,
        (false, false, false) => ClauseJoint::And,
    }
}

/// Keeps the shapes that several texts have and that are read as the same kind; likewise the names.
fn keep_common(language: &LanguageWording, way: &mut WayWording) {
    for (kind, shapes) in way.shapes.iter_mut().chain(&mut way.first_shapes) {
        let all: f64 = shapes.values().sum();
        shapes.retain(|shape, texts| {
            *texts >= (all * MIN_SHAPE_SHARE).max(MIN_SHAPE_TEXTS) && is_read_as(language, *kind, shape)
        });
    }
    way.shapes.retain(|_, shapes| !shapes.is_empty());
    way.first_shapes.retain(|_, shapes| shapes.values().sum::<f64>() >= ENOUGH_CLAUSES);
    for (usual, names) in way.rooms.iter_mut().chain(way.things.iter_mut()) {
        let total: f64 = names.values().sum();
        let is_known = total >= ENOUGH_CLAUSES;
        names.retain(|name, texts| is_known && *texts >= total * MIN_NAME_SHARE && is_name_of(name, usual));
    }
    way.rooms.retain(|_, names| !names.is_empty());
    way.things.retain(|_, names| !names.is_empty());
}

/// Takes from the built-in wording what the texts show too few of.
fn fill_from(built_in: &LanguageWording, way: &mut WayWording) {
    let own = &built_in.way;
    if way.kinds.values().sum::<f64>() < ENOUGH_CLAUSES * ENOUGH_CLAUSES {
        way.kinds = own.kinds.clone();
    }
    for (kind, shapes) in &own.shapes {
        let measured = way.shapes.entry(*kind).or_default();
        if measured.values().sum::<f64>() < ENOUGH_CLAUSES {
            *measured = shapes.clone();
        }
    }
    for (kind, joined) in &built_in.words.joined_shapes {
        let measured = way.shapes.entry(*kind).or_default();
        let own: f64 = measured.values().sum();
        let rest = (1.0 - joined.values().sum::<f64>()).max(f64::EPSILON);
        measured.extend(joined.iter().map(|(shape, share)| (shape.clone(), own * share / rest)));
    }
    for (measured, own) in [
        (&mut way.joints, &own.joints),
        (&mut way.turn_joints, &own.turn_joints),
        (&mut way.stop_joints, &own.stop_joints),
    ] {
        if measured.values().sum::<f64>() < ENOUGH_CLAUSES {
            *measured = own.clone();
        }
    }
    way.rooms_by_label = own.rooms_by_label.clone();
    for (measured, own) in [(&mut way.rooms, &own.rooms), (&mut way.things, &own.things)] {
        for (usual, names) in own {
            let seen = measured.entry(usual.clone()).or_default();
            if seen.values().sum::<f64>() < ENOUGH_CLAUSES {
                *seen = names.clone();
            }
        }
    }
}

/// Whether a name alone is read as the name of this thing or room.
fn is_name_of(name: &str, usual: &str) -> bool {
    let readable = ReadableText::new(name, None);
    let reading = read_instruction(readable.english(), &BTreeSet::new());
    let places: Vec<&str> = reading
        .events
        .iter()
        .filter_map(|event| if let EventContent::Place(place) = &event.what { Some(place.name.as_str()) } else { None })
        .collect();
    let is_it =
        |place: &str| room_name(place) == Some(usual) || find_thing(place).is_some_and(|thing| thing.name == usual);
    matches!(places.as_slice(), [place] if is_it(place))
}

/// A shape filled with names and with this side: the text, and its English names for `{l}`, `{r}` and `{a}`.
pub(super) fn filled_shape(
    language: &LanguageWording,
    kind: ClauseKind,
    shape: &str,
    side: Side,
) -> (String, [&'static str; 3]) {
    let in_hall = matches!(kind, ClauseKind::Along | ClauseKind::AlongToEnd | ClauseKind::TurnAtEnd);
    let names = ["sofa", if in_hall { "hallway" } else { "bedroom" }, "kitchen"];
    let senses = [NameSense::Thing, NameSense::Room, NameSense::Room];
    let own = ["{l}", "{r}", "{a}"].iter().zip(names.iter().zip(senses));
    let text = own.fold(shape.to_owned(), |text, (slot, (name, sense))| {
        text.replace(slot, language.usual_name(name, sense).unwrap_or_default())
    });
    (text.replace("{s}", language.side(side)).replace("{p}", language.side(side)), names)
}

/// Whether a shape, filled with names, is read as one clause of its kind, whole and with the same side.
pub(super) fn is_read_as(language: &LanguageWording, kind: ClauseKind, shape: &str) -> bool {
    [Side::Left, Side::Right].into_iter().all(|side| {
        let (filled, _) = filled_shape(language, kind, shape, side);
        let readable = ReadableText::new(&filled, Some(language.tag));
        let reading = read_instruction(readable.english(), &BTreeSet::new());
        let clauses = shape_clauses(readable.english(), &reading, &ALLOWED_SHAPE_WORDS);
        let is_whole = reading.clauses.iter().all(|clause| clause.understood);
        is_whole && matches!(clauses.as_slice(), [one] if one.kind == Some(kind))
    })
}
