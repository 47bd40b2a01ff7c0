//! Describes a walk for the writing prompt, part by part: how it goes on, and each thing once, where it matters. A part begins where the
//! walk turns, enters a room or climbs.

use super::move_words::{climb_words, turn_words};
use crate::writer::WritingBrief;
use minijinja::{Value, context};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::memory::{RememberedThing, WalkBend, WalkMemory};
use wayword_core::{ClimbDirection, Side, TurnKind, ViewThird, WayOut, WitnessAnswer};
use wayword_language::lexicon::{find_thing, is_fabric, names_agree, to_plural};

/// Most things of a line; the later ones are left out.
const MAX_LINE_THINGS: usize = 5;
/// Most colours of a thing.
const MAX_COLOURS: usize = 2;
/// Words with which a detail begins that stands behind the name of its thing.
const BEHIND_LEADS: [&str; 14] = [
    "of",
    "with",
    "showing",
    "depicting",
    "in",
    "on",
    "at",
    "by",
    "outside",
    "behind",
    "full",
    "from",
    "under",
    "above",
];
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
    /// Whether the walk goes on from its last frame.
    goes_on: bool,
}

/// The things that the lines so far told, by their number in the memory, each with the part that told it last.
#[derive(Default)]
struct ToldThings {
    parts: BTreeMap<usize, usize>,
    /// The number of the part that is told.
    part: usize,
}

impl ToldThings {
    /// Whether a thing was told, or one a short way before that may be the same: of its name and looks, and never seen beside it.
    fn has(&self, memory: &WalkMemory, number: usize) -> bool {
        let thing = &memory.things[number];
        self.parts.iter().any(|(other, part)| {
            *other == number || (part + 1 >= self.part && may_be_one(&memory.things[*other], thing))
        })
    }
}

/// Whether two things may be one that was seen twice.
fn may_be_one(a: &RememberedThing, b: &RememberedThing) -> bool {
    let are_seen_together = a.glimpses.iter().any(|glimpse| b.glimpse_from(glimpse.frame).is_some());
    let differ = |a: &Option<String>, b: &Option<String>| a.as_ref().zip(b.as_ref()).is_some_and(|(a, b)| a != b);
    let are_apart = a.object.is_some() && b.object.is_some();
    names_agree(&a.name, &b.name)
        && !are_apart
        && !are_seen_together
        && !differ(&a.colour, &b.colour)
        && !differ(&a.detail, &b.detail)
}

/// The parts of a walk as the template writes them: a heading, and lines of things.
pub(super) fn walk_parts(brief: &WritingBrief<'_>) -> Vec<Value> {
    let mut told = ToldThings::default();
    let parts = cut_walk(brief.memory, brief.walk.path.frames.len());
    let describe = |(number, part): (usize, &WalkPart)| {
        told.part = number;
        let lines = part_lines(brief, part, &mut told);
        context! { heading => part_heading(brief, part), lines }
    };
    parts.iter().enumerate().map(describe).collect()
}

/// Cuts a walk where it turns, enters a room or climbs.
fn cut_walk(memory: &WalkMemory, frames: usize) -> Vec<WalkPart> {
    let last = frames.saturating_sub(1);
    let mut starts = BTreeSet::from([0]);
    starts.extend(memory.bends.iter().map(|bend| bend.first));
    starts.extend(memory.stays.iter().map(|stay| stay.entered));
    starts.extend(memory.flights.iter().flat_map(|flight| [flight.from, flight.to]));
    let starts: Vec<usize> = starts.into_iter().filter(|start| *start <= last).collect();
    let end = |at: usize| starts.get(at + 1).map_or(last, |next| next - 1);
    let part = |(at, first): (usize, &usize)| WalkPart { first: *first, last: end(at), goes_on: end(at) < last };
    starts.iter().enumerate().map(part).collect()
}

/// "Frames 4 to 7, kitchen: turn left (85 degrees), 3.4 metres".
fn part_heading(brief: &WritingBrief<'_>, part: &WalkPart) -> String {
    let WalkPart { first, last, goes_on } = *part;
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

/// A thing by its number in the memory, with its rank in a line: the least comes first.
type RankedThing = (f64, usize);

/// The things of a part, by the line that tells them.
#[derive(Default)]
struct PartThings {
    passed_left: Vec<RankedThing>,
    passed_right: Vec<RankedThing>,
    ahead: Vec<RankedThing>,
    others: Vec<RankedThing>,
}

impl PartThings {
    fn of_part(brief: &WritingBrief<'_>, part: &WalkPart, told: &ToldThings) -> Self {
        let (memory, frames) = (brief.memory, part.first..=part.last);
        let knows_motion = brief.walk.path.motion.is_known();
        let mut things = Self::default();
        for (number, thing) in memory.things.iter().enumerate().filter(|(_, thing)| is_worth_telling(thing)) {
            // Floors and walls are all around, so one passes none.
            let passes = thing.passed.filter(|by| {
                let around = by.frame.saturating_sub(1)..=by.frame + 1;
                let was_seen = by.frame >= thing.first_seen() && memory.shares_room(thing, around);
                knows_motion && !is_fabric(&thing.name) && was_seen
            });
            if let Some(by) = passes.filter(|by| frames.contains(&by.frame)) {
                let line = if by.side == Side::Right { &mut things.passed_right } else { &mut things.passed_left };
                line.push((by.along_m, number));
                continue;
            }
            let glimpse = thing.glimpses.iter().find(|glimpse| frames.contains(&glimpse.frame));
            let Some(glimpse) = glimpse.filter(|_| !told.has(memory, number)) else { continue };
            let far_m = glimpse.distance_m.unwrap_or(if glimpse.is_far { 6.0 } else { 2.0 });
            let rank = far_m - if thing.stands_out { 4.0 } else { 0.0 };
            let at_end = thing.glimpse_from(part.last).and_then(|glimpse| glimpse.turn_rad);
            if knows_motion && at_end.is_some_and(|rad| rad.to_degrees().abs() <= AHEAD_DEG) {
                things.ahead.push((rank, number));
            } else if passes.is_none() {
                things.others.push((rank, number));
            }
        }
        things
    }
}

/// The lines of a part.
fn part_lines(brief: &WritingBrief<'_>, part: &WalkPart, told: &mut ToldThings) -> Vec<String> {
    let memory = brief.memory;
    let knows_motion = brief.walk.path.motion.is_known();
    let PartThings { passed_left, passed_right, ahead, others } = PartThings::of_part(brief, part, told);
    let mut lines = Vec::new();
    let mut fabrics: BTreeSet<&str> = BTreeSet::new();
    for (label, mut list) in [
        ("passed on the left", passed_left),
        ("passed on the right", passed_right),
        ("ahead at its end", ahead),
        ("also in sight", others),
    ] {
        list.sort_by(|a, b| a.0.total_cmp(&b.0));
        // One floor is seen in several parts of a picture.
        list.retain(|(_, number)| {
            let name = memory.things[*number].name.as_str();
            !is_fabric(name) || fabrics.insert(name)
        });
        list.truncate(MAX_LINE_THINGS);
        told.parts.extend(list.iter().map(|(_, number)| (*number, told.part)));
        let words =
            |(_, number): &RankedThing| thing_words(brief, &memory.things[*number], part, label.starts_with("also"));
        let names: Vec<String> = list.iter().map(words).collect();
        if !names.is_empty() {
            lines.push(format!("{}: {}", if knows_motion { label } else { "in sight" }, names.join("; ")));
        }
    }
    lines.extend(ways_line(brief, part));
    lines.extend(guesses_line(brief, part));
    if lines.is_empty() {
        lines.extend(caption_line(brief, part));
    }
    lines
}

/// Whether a text can name a thing: the checks know it, and every room has no such.
fn is_worth_telling(thing: &RememberedThing) -> bool {
    let has_looks = thing.colour.is_some() || thing.material.is_some() || thing.detail.is_some() || thing.stands_out;
    (thing.object.is_some() || find_thing(&thing.name).is_some()) && (has_looks || !is_fabric(&thing.name))
}

/// The looks of a thing, its name, and where it is: "black-and-white checkered floor", "picture of a ship (far)".
fn thing_words(brief: &WritingBrief<'_>, thing: &RememberedThing, part: &WalkPart, with_side: bool) -> String {
    let memory = brief.memory;
    let mut notes = Vec::new();
    let glimpse = thing.glimpses.iter().find(|glimpse| (part.first..=part.last).contains(&glimpse.frame));
    if with_side && brief.walk.path.motion.is_known() {
        let side = glimpse.and_then(|glimpse| glimpse.turn_rad).map(side_of_turn);
        notes.extend(side.map(str::to_owned));
    }
    if glimpse.is_some_and(|glimpse| glimpse.is_far) && thing.passed.is_none() {
        notes.push("far".to_owned());
    }
    if let Some((place, all)) = memory.ordinal_among_alike(thing).filter(|(_, all)| *all > 1) {
        notes.push(format!("number {place} of {all} on that side"));
    }
    let end = memory.frame_count().saturating_sub(1);
    let at_end = memory.distance_m(thing, end).filter(|far_m| *far_m < NEAR_END_M && !part.goes_on);
    notes.extend(at_end.map(|far_m| format!("{far_m:.1} metres from the end")));
    let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join(", ")) };
    let looks = Looks {
        name: &thing.name,
        colours: thing.colour.iter().chain(&thing.more_colours).map(String::as_str).collect(),
        material: thing.material.as_deref(),
        detail: thing.detail.as_deref(),
        several: thing.several,
    };
    format!("{}{notes}", looks.name_with_looks())
}

/// The looks of a thing, and its name.
struct Looks<'a> {
    name: &'a str,
    colours: Vec<&'a str>,
    material: Option<&'a str>,
    detail: Option<&'a str>,
    several: bool,
}

impl Looks<'_> {
    /// "several white-and-grey fabric pillows", "checkered floor", "picture of a ship", "towel with blue stripes".
    fn name_with_looks(&self) -> String {
        let Self { name, colours, material, detail, several } = self;
        let colours: Vec<&str> =
            colours.iter().copied().filter(|colour| !name.contains(colour)).take(MAX_COLOURS).collect();
        // One word stands before the name, and more behind it.
        let before = detail.filter(|detail| !detail.contains(' '));
        let behind = detail.filter(|detail| detail.contains(' ')).map(|detail| {
            let first = detail.split(' ').next().unwrap_or_default();
            if BEHIND_LEADS.contains(&first) { detail.to_owned() } else { format!("with {detail}") }
        });
        let words = [
            several.then(|| "several".to_owned()),
            (!colours.is_empty()).then(|| colours.join("-and-")),
            before.map(str::to_owned),
            material.filter(|material| !name.contains(material)).map(str::to_owned),
            Some(if *several { to_plural(name) } else { (*name).to_owned() }),
            behind,
        ];
        words.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }
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

/// The ways out that lead to a room: "door on the left to a bathroom".
fn ways_line(brief: &WritingBrief<'_>, part: &WalkPart) -> Option<String> {
    let mut ways: Vec<String> = Vec::new();
    let looks = brief.walk.observations.get(part.first..=part.last)?.iter().flat_map(|seen| &seen.looks);
    for WayOut { name, place, leads_to } in looks.flat_map(|look| &look.caption.ways) {
        let Some(room) = leads_to else { continue };
        let side = match place.filter(|_| brief.walk.path.motion.is_known()) {
            Some(ViewThird::Left) => " on the left",
            Some(ViewThird::Middle) => " ahead",
            Some(ViewThird::Right) => " on the right",
            None => "",
        };
        let way = format!("{name}{side} to a {room}");
        // One way is seen from several frames.
        if !ways.iter().any(|other| other.ends_with(&format!("to a {room}"))) && ways.len() < MAX_GUESSES {
            ways.push(way);
        }
    }
    (!ways.is_empty()).then(|| format!("ways out: {}", ways.join("; ")))
}

/// Things that the witnesses were not sure of, with their side and looks.
fn guesses_line(brief: &WritingBrief<'_>, part: &WalkPart) -> Option<String> {
    let mut guesses: Vec<(String, String)> = Vec::new();
    for frame in part.first..=part.last {
        let seen = brief.walk.observations.get(frame)?;
        for (look, sighting) in
            seen.looks.iter().flat_map(|look| look.caption.sightings.iter().map(move |seen| (look, seen)))
        {
            let is_known = |thing: &RememberedThing| names_agree(&thing.name, &sighting.name);
            let is_new = !guesses.iter().any(|(name, _)| names_agree(name, &sighting.name));
            let is_guess = sighting.witness == WitnessAnswer::Unsure && find_thing(&sighting.name).is_some();
            if !is_guess || !is_new || guesses.len() == MAX_GUESSES || brief.memory.things.iter().any(is_known) {
                continue;
            }
            let looks = Looks {
                name: &sighting.name,
                colours: sighting.colour.iter().chain(&sighting.more_colours).map(String::as_str).collect(),
                material: sighting.material.as_deref(),
                detail: sighting.detail.as_deref(),
                several: sighting.several,
            };
            let off_rad = sighting.place.map(|place| place.turn_rad(look.gaze.horizontal_fov_rad));
            let side = off_rad.filter(|_| brief.walk.path.motion.is_known()).map(side_of_turn);
            let side = side.map_or(String::new(), |side| format!(" ({side})"));
            guesses.push((sighting.name.clone(), format!("{}{side}", looks.name_with_looks())));
        }
    }
    let words: Vec<String> = guesses.into_iter().map(|(_, words)| words).collect();
    (!words.is_empty()).then(|| format!("perhaps: {}", words.join("; ")))
}

/// The caption of a part's last frame, where no thing of it is known by itself.
fn caption_line(brief: &WritingBrief<'_>, part: &WalkPart) -> Option<String> {
    let seen = brief.walk.observations.get(part.first..=part.last)?.iter().rev();
    let caption = seen.map(|seen| seen.summary.trim()).find(|caption| !caption.is_empty())?;
    Some(format!("described as: {caption}"))
}

/// "Frame 2", "Frames 2 to 4".
pub(super) fn frame_range(first: usize, last: usize) -> String {
    if first == last { format!("Frame {first}") } else { format!("Frames {first} to {last}") }
}
