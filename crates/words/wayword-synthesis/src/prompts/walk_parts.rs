//! Describes a walk for the writing prompt, part by part: how it goes on, and each thing once, where it matters. A part begins where the
//! walk turns, enters a room or climbs.

use super::{
    detail::PromptDetail,
    looks::{ThingLooks, is_picture},
    move_words::{climb_words, turn_words},
};
use crate::writer::WritingBrief;
use minijinja::{Value, context};
use std::{
    collections::{BTreeMap, BTreeSet},
    ops::RangeInclusive,
};
use wayword_checks::memory::{RememberedThing, ThingGlimpse, ThingPassing, WalkBend, WalkMemory};
use wayword_core::{ClimbDirection, FrameObservation, Side, TurnKind, ViewThird, WayOut, WitnessAnswer};
use wayword_language::lexicon::{find_thing, is_fabric, names_agree, with_article};

/// Most frames of a part of a walk whose motion is not known.
const MAX_PART_FRAMES: usize = 5;
/// A thing may be one that was told at most so many parts before.
const MAX_GAP_PARTS: usize = 2;
/// A word of fewer letters says little of what a picture shows.
const MIN_SHARED_LETTERS: usize = 4;
/// A walker does not turn at a thing farther ahead than this, metres.
const AT_TURN_M: f64 = 2.5;
/// Most guesses of a part.
const MAX_GUESSES: usize = 3;
/// What lies within this angle of the heading is ahead, degrees.
const AHEAD_DEG: f64 = 22.0;
/// A thing nearer to the end than this is told with its distance from there, metres.
const NEAR_END_M: f64 = 3.0;

/// A part of the walk.
struct WalkPart {
    /// Its frames.
    first: usize,
    last: usize,
    /// The frames whose views it tells. What is seen from where the walk turns is told before the turn: a walker looks ahead on arriving.
    views: RangeInclusive<usize>,
    /// Whether the walk goes on from its last frame.
    goes_on: bool,
    /// Whether it begins with a turn.
    turns: bool,
}

/// The things that the lines so far told, by their number in the memory, each with the part that told it last.
#[derive(Default)]
struct ToldThings {
    parts: BTreeMap<usize, usize>,
    /// The number of the part that is told.
    part: usize,
    /// The rooms to which ways out were told.
    ways: BTreeSet<String>,
}

impl ToldThings {
    /// Whether a thing was told, or one a short way before that may be the same: of its name and looks, and never seen beside it.
    fn has(&self, memory: &WalkMemory, number: usize) -> bool {
        let thing = &memory.things[number];
        self.parts.iter().any(|(other, part)| {
            *other == number || (part + MAX_GAP_PARTS >= self.part && may_be_one(&memory.things[*other], thing))
        })
    }
}

/// Whether two things may be one that was seen twice. Pictures are told apart by what they show, other things hardly.
fn may_be_one(a: &RememberedThing, b: &RememberedThing) -> bool {
    let are_seen_together = a.glimpses.iter().any(|glimpse| b.glimpse_from(glimpse.frame).is_some());
    let differ = |a: &Option<String>, b: &Option<String>| a.as_ref().zip(b.as_ref()).is_some_and(|(a, b)| a != b);
    let are_apart = a.object.is_some() && b.object.is_some();
    let show_others = is_picture(&a.name) && differ(&a.detail, &b.detail) && !share_word(&a.detail, &b.detail);
    names_agree(&a.name, &b.name) && !are_apart && !are_seen_together && !differ(&a.colour, &b.colour) && !show_others
}

/// Whether two details have a word in common: "abstract shapes", "abstract oval shapes".
fn share_word(a: &Option<String>, b: &Option<String>) -> bool {
    let words = |detail: &Option<String>| -> BTreeSet<String> {
        let words = detail.iter().flat_map(|detail| detail.split(' '));
        words.filter(|word| word.len() >= MIN_SHARED_LETTERS).map(str::to_owned).collect()
    };
    !words(a).is_disjoint(&words(b))
}

/// The parts of a walk as the template writes them: a heading, and lines of things.
pub(super) fn walk_parts(brief: &WritingBrief<'_>, detail: PromptDetail) -> Vec<Value> {
    let mut told = ToldThings::default();
    let parts = cut_walk(brief);
    let describe = |(number, part): (usize, &WalkPart)| {
        told.part = number;
        let lines = part_lines(brief, (part, parts.get(number + 1)), detail, &mut told);
        context! { heading => part_heading(brief, part), lines }
    };
    parts.iter().enumerate().map(describe).collect()
}

/// Cuts a walk where it turns, enters a room or climbs; where its motion is not known, after a few frames too.
fn cut_walk(brief: &WritingBrief<'_>) -> Vec<WalkPart> {
    let (memory, last) = (brief.memory, brief.walk.path.frames.len().saturating_sub(1));
    let mut starts = BTreeSet::from([0]);
    starts.extend(memory.bends.iter().map(|bend| bend.first));
    starts.extend(memory.stays.iter().map(|stay| stay.entered));
    starts.extend(memory.flights.iter().flat_map(|flight| [flight.from, flight.to]));
    // Where no motion cuts a walk, a long part would tell too little of each frame.
    if !brief.walk.path.motion.is_known() {
        starts.extend((MAX_PART_FRAMES..=last).step_by(MAX_PART_FRAMES));
    }
    let starts: Vec<usize> = starts.into_iter().filter(|start| *start <= last).collect();
    let end = |at: usize| starts.get(at + 1).map_or(last, |next| next - 1);
    let turns_at = |frame: usize| frame > 0 && memory.bends.iter().any(|bend| bend.first == frame);
    let part = |(at, first): (usize, &usize)| {
        let (first, last) = (*first, end(at));
        let goes_on = starts.get(at + 1).is_some();
        let views = first + usize::from(turns_at(first))..=last + usize::from(goes_on && turns_at(last + 1));
        WalkPart { first, last, views, goes_on, turns: turns_at(first) }
    };
    starts.iter().enumerate().map(part).collect()
}

/// "Frames 4 to 7, kitchen: turn left (85 degrees), 3.4 metres".
fn part_heading(brief: &WritingBrief<'_>, part: &WalkPart) -> String {
    let WalkPart { first, last, goes_on, .. } = *part;
    let (memory, walk) = (brief.memory, brief.walk);
    let rooms: Vec<&str> = memory
        .stays
        .iter()
        .filter(|stay| stay.entered <= last && stay.left >= first)
        .map(|stay| stay.room.as_str())
        .collect();
    let room = if rooms.is_empty() { String::new() } else { format!(", {}", rooms.join(" and ")) };
    let mut way: Vec<String> = memory.bends.iter().filter(|bend| bend.first == first).map(bend_words).collect();
    let to = if goes_on { last + 1 } else { last };
    let moves = walk.moves.get(first..to).unwrap_or_default();
    let rise_m: f64 = moves.iter().map(|step| step.rise_m).sum();
    let length_m: f64 = moves.iter().map(|step| step.distance_m).sum();
    if way.is_empty() && !moves.is_empty() {
        way.push("straight on".to_owned());
    }
    if !moves.is_empty() {
        way.push(format!("{length_m:.1} metres{}", climb_words(ClimbDirection::from_rise(rise_m), rise_m)));
    }
    let opening = memory.openings.iter().find(|opening| opening.before == last && opening.has_door);
    way.extend(opening.map(|opening| format!("then through a door into the {}", opening.to)));
    if !goes_on {
        way.push("the end".to_owned());
    }
    let way = if way.is_empty() { String::new() } else { format!(": {}", way.join(", ")) };
    format!("{}{room}{way}", frame_range(first, last))
}

/// "turn left (85 degrees)", in the imperative.
fn bend_words(bend: &WalkBend) -> String {
    let deg = bend.turn_rad.to_degrees().abs().round();
    match TurnKind::from_rad(bend.turn_rad) {
        TurnKind::Straight => "straight on".to_owned(),
        turn => format!("{} ({deg} degrees)", turn_words(turn).replacen("turns", "turn", 1)),
    }
}

/// The lines that tell the things of a part, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum PartLine {
    PassedLeft,
    PassedRight,
    Ahead,
    AtEnd,
    Others,
}

impl PartLine {
    fn label(self, knows_motion: bool) -> &'static str {
        match self {
            Self::PassedLeft => "passed on the left",
            Self::PassedRight => "passed on the right",
            Self::Ahead => "ahead at its end",
            Self::AtEnd => "seen from the last frame",
            Self::Others if knows_motion => "also in sight",
            Self::Others => "in sight",
        }
    }

    /// Whether its things have their sides behind them.
    fn tells_sides(self) -> bool {
        matches!(self, Self::AtEnd | Self::Others)
    }
}

/// The line of a part that tells a thing, with its rank there: the least comes first. `None` for a thing that the part does not tell.
fn line_of_thing(
    brief: &WritingBrief<'_>,
    (part, next): (&WalkPart, Option<&WalkPart>),
    told: &ToldThings,
    number: usize,
) -> Option<(PartLine, f64)> {
    let memory = brief.memory;
    let thing = &memory.things[number];
    let knows_motion = brief.walk.path.motion.is_known();
    let rank = |glimpse: &ThingGlimpse| {
        let far_m = glimpse.distance_m.unwrap_or(if glimpse.is_far { 6.0 } else { 2.0 });
        far_m - if thing.stands_out { 4.0 } else { 0.0 }
    };
    // What is seen on arrival is told there even if it was told before.
    if let Some(glimpse) = thing.glimpse_from(part.last).filter(|_| !part.goes_on) {
        return Some((PartLine::AtEnd, rank(glimpse)));
    }
    if told.has(memory, number) {
        return None;
    }
    let passes = told_passing(memory, thing).filter(|_| knows_motion);
    if let Some(by) = passes.filter(|by| part.views.contains(&by.frame)) {
        let line = if by.side == Side::Right { PartLine::PassedRight } else { PartLine::PassedLeft };
        return Some((line, by.along_m));
    }
    let glimpse = thing.glimpses.iter().find(|glimpse| part.views.contains(&glimpse.frame))?;
    // A walker who goes straight on to a thing passes it in the next part.
    let is_passed_next =
        next.is_some_and(|next| !next.turns && passes.is_some_and(|by| next.views.contains(&by.frame)));
    let at_end = thing.glimpse_from(*part.views.end()).and_then(|glimpse| glimpse.turn_rad);
    match knows_motion && at_end.is_some_and(|rad| rad.to_degrees().abs() <= AHEAD_DEG) {
        true => (!is_passed_next).then(|| (PartLine::Ahead, rank(glimpse))),
        false => passes.is_none().then(|| (PartLine::Others, rank(glimpse))),
    }
}

/// How a walker passes a thing that was seen before, from the room in which the walk passes it. A witness who does not name a thing any
/// more has passed it. Floors and walls are all around, so one passes none.
fn told_passing(memory: &WalkMemory, thing: &RememberedThing) -> Option<ThingPassing> {
    let by = thing.passed.filter(|_| !is_fabric(&thing.name))?;
    let seen = thing.glimpses.iter().rev().find(|glimpse| glimpse.frame <= by.frame)?;
    let entered = |frame: usize| memory.stay_at(frame).map(|stay| stay.entered);
    let is_one_room = entered(seen.frame).zip(entered(by.frame)).is_none_or(|(seen, by)| seen == by);
    let is_there = is_one_room && memory.shares_room(thing, by.frame.saturating_sub(1)..=by.frame + 1);
    is_there.then(|| ThingPassing { frame: by.frame.min(seen.frame + 1), ..by })
}

/// The lines of a part.
fn part_lines(
    brief: &WritingBrief<'_>,
    (part, next): (&WalkPart, Option<&WalkPart>),
    detail: PromptDetail,
    told: &mut ToldThings,
) -> Vec<String> {
    let memory = brief.memory;
    let knows_motion = brief.walk.path.motion.is_known();
    let mut by_line: BTreeMap<PartLine, Vec<(f64, usize)>> = BTreeMap::new();
    for number in (0..memory.things.len()).filter(|number| is_worth_telling(memory, &memory.things[*number])) {
        if let Some((line, rank)) = line_of_thing(brief, (part, next), told, number) {
            by_line.entry(line).or_default().push((rank, number));
        }
    }
    if detail != PromptDetail::Full && knows_motion {
        by_line.remove(&PartLine::Others);
    }
    let mut lines = Vec::new();
    let mut fabrics: BTreeSet<&str> = BTreeSet::new();
    for (line, mut list) in by_line {
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        // One floor is seen in several parts of a picture.
        list.retain(|(_, number)| {
            let name = memory.things[*number].name.as_str();
            !is_fabric(name) || fabrics.insert(name)
        });
        list.truncate(detail.max_line_things());
        told.parts.extend(list.iter().map(|(_, number)| (*number, told.part)));
        let names: Vec<String> =
            list.iter().map(|(_, number)| thing_words(brief, &memory.things[*number], part, line)).collect();
        if !names.is_empty() {
            lines.push(format!("{}: {}", line.label(knows_motion), names.join("; ")));
        }
    }
    if detail == PromptDetail::Full {
        lines.extend(ways_line(brief, part, &mut told.ways));
        lines.extend(guesses_line(brief, part));
    }
    if lines.is_empty() {
        lines.extend(caption_line(brief, part));
    }
    lines
}

/// Whether a text can name a thing: the checks know it, every room has no such, and it is no part of another thing that is told.
fn is_worth_telling(memory: &WalkMemory, thing: &RememberedThing) -> bool {
    let has_looks = thing.colour.is_some() || thing.material.is_some() || thing.detail.is_some() || thing.stands_out;
    let holds_it = |other: &RememberedThing| {
        names_agree(&other.name, "bookshelf")
            && thing.glimpses.iter().any(|glimpse| other.glimpse_from(glimpse.frame).is_some())
    };
    let is_in_shelf = names_agree(&thing.name, "book") && memory.things.iter().any(holds_it);
    let is_known = thing.object.is_some() || find_thing(&thing.name).is_some();
    is_known && !is_in_shelf && (has_looks || !is_fabric(&thing.name))
}

/// The looks of a thing, its name, and where it is: "black-and-white checkered floor", "picture of a ship (far)".
fn thing_words(brief: &WritingBrief<'_>, thing: &RememberedThing, part: &WalkPart, line: PartLine) -> String {
    let (memory, looks) = (brief.memory, ThingLooks::of_thing(thing));
    let mut notes: Vec<String> = looks.remark().map(str::to_owned).into_iter().collect();
    let glimpse = match line {
        PartLine::AtEnd => thing.glimpse_from(part.last),
        _ => thing.glimpses.iter().find(|glimpse| part.views.contains(&glimpse.frame)),
    };
    if line.tells_sides() && brief.walk.path.motion.is_known() {
        let side = glimpse.and_then(|glimpse| glimpse.turn_rad).map(side_of_turn);
        notes.extend(side.map(str::to_owned));
    }
    let end = memory.frame_count().saturating_sub(1);
    // What witnesses see has no distance that could be told in metres.
    let is_there = thing.object.is_some() && (line == PartLine::AtEnd || !part.goes_on);
    let is_there = is_there && memory.shares_room(thing, end..=end);
    let from_end_m = memory.distance_m(thing, end).filter(|far_m| is_there && *far_m < NEAR_END_M);
    if glimpse.is_some_and(|glimpse| glimpse.is_far) && thing.passed.is_none() && from_end_m.is_none() {
        notes.push("far".to_owned());
    }
    // Witnesses may name one thing twice, so only what labels list is counted.
    let ordinal = memory.ordinal_among_alike(thing).filter(|(_, all)| *all > 1 && thing.object.is_some());
    let is_farther_on = memory.distance_m(thing, *part.views.end()).is_some_and(|far_m| far_m > AT_TURN_M);
    if line == PartLine::Ahead && is_farther_on && !notes.iter().any(|note| note == "far") {
        notes.push("farther on".to_owned());
    }
    if let Some((place, all)) = ordinal {
        notes.push(format!("number {place} of {all} on that side"));
    }
    notes.extend(from_end_m.map(|far_m| format!("{far_m:.1} metres from where it ends")));
    with_notes(looks.to_words(), &notes)
}

/// "picture of a ship (left, far)".
fn with_notes(words: String, notes: &[impl AsRef<str>]) -> String {
    let notes: Vec<&str> = notes.iter().map(AsRef::as_ref).collect();
    if notes.is_empty() { words } else { format!("{words} ({})", notes.join(", ")) }
}

/// The word for a direction from the heading.
fn side_of_turn(turn_rad: f64) -> &'static str {
    match turn_rad.to_degrees() {
        deg if deg.abs() <= AHEAD_DEG => "ahead",
        deg if deg.abs() >= 135.0 => "behind",
        deg if deg < 0.0 => "left",
        _ => "right",
    }
}

/// What was observed in the views of a part.
fn observed<'a>(brief: &WritingBrief<'a>, part: &WalkPart) -> impl Iterator<Item = &'a FrameObservation> {
    brief.walk.observations.get(part.views.clone()).unwrap_or_default().iter()
}

/// The ways out that lead to a room of which no part before told: "door on the left to a bathroom".
fn ways_line(brief: &WritingBrief<'_>, part: &WalkPart, told: &mut BTreeSet<String>) -> Option<String> {
    let mut ways: Vec<String> = Vec::new();
    let looks = observed(brief, part).flat_map(|seen| &seen.looks);
    for WayOut { name, place, leads_to } in looks.flat_map(|look| &look.caption.ways) {
        let Some(room) = leads_to else { continue };
        let side = match place.filter(|_| brief.walk.path.motion.is_known()) {
            Some(ViewThird::Left) => " on the left",
            Some(ViewThird::Middle) => " ahead",
            Some(ViewThird::Right) => " on the right",
            None => "",
        };
        // One way is seen from several frames.
        if ways.len() < MAX_GUESSES && told.insert(room.clone()) {
            ways.push(format!("{name}{side} to {}", with_article(room)));
        }
    }
    (!ways.is_empty()).then(|| format!("ways out: {}", ways.join("; ")))
}

/// Things that the witnesses were not sure of, with their side and looks.
fn guesses_line(brief: &WritingBrief<'_>, part: &WalkPart) -> Option<String> {
    let mut guesses: Vec<(String, String)> = Vec::new();
    for look in observed(brief, part).flat_map(|seen| &seen.looks) {
        for sighting in &look.caption.sightings {
            let is_known = |thing: &RememberedThing| names_agree(&thing.name, &sighting.name);
            let is_new = !guesses.iter().any(|(name, _)| names_agree(name, &sighting.name));
            let is_guess = sighting.witness == WitnessAnswer::Unsure && find_thing(&sighting.name).is_some();
            if !is_guess || !is_new || guesses.len() == MAX_GUESSES || brief.memory.things.iter().any(is_known) {
                continue;
            }
            let looks = ThingLooks::of_sighting(sighting);
            let off_rad = sighting.place.map(|place| place.turn_rad(look.gaze.horizontal_fov_rad));
            let side = off_rad.filter(|_| brief.walk.path.motion.is_known()).map(side_of_turn);
            let notes: Vec<&str> = looks.remark().into_iter().chain(side).collect();
            guesses.push((sighting.name.clone(), with_notes(looks.to_words(), &notes)));
        }
    }
    let words: Vec<String> = guesses.into_iter().map(|(_, words)| words).collect();
    (!words.is_empty()).then(|| format!("perhaps: {}", words.join("; ")))
}

/// The caption of a part's last frame, where no thing of it is known by itself.
fn caption_line(brief: &WritingBrief<'_>, part: &WalkPart) -> Option<String> {
    let captions = observed(brief, part).map(|seen| seen.summary.trim());
    let caption = captions.filter(|caption| !caption.is_empty()).last()?;
    Some(format!("described as: {caption}"))
}

/// "Frame 2", "Frames 2 to 4".
pub(super) fn frame_range(first: usize, last: usize) -> String {
    if first == last { format!("Frame {first}") } else { format!("Frames {first} to {last}") }
}
