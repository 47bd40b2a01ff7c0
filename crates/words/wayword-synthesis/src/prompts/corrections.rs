//! Explains to the model why its text failed, and what would be right, as far as the walk shows it.

use super::{
    move_words::{frame_name, turn_words},
    walk_parts::frame_range,
};
use crate::writer::{TextComplaint, WritingBrief};
use wayword_checks::{
    WalkMemory,
    memory::{RememberedThing, is_way_through},
};
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, PathMove, Side, TurnKind, Verdict};
use wayword_language::{
    languages::ReadableText,
    lexicon::{is_fabric, names_agree, same_room},
    reading::{EventContent, read_instruction},
};

/// Most things that one correction names.
const MAX_NAMED_THINGS: usize = 3;
/// Most things that a correction names of what is seen from the end.
const MAX_SEEN_THINGS: usize = 8;

/// The reasons why a text failed, each with the words concerned and with a correction.
pub(super) fn refusal_reasons(brief: &WritingBrief<'_>, complaint: &TextComplaint) -> Vec<String> {
    let failed = complaint.findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    failed.map(|finding| explain_finding(brief, &complaint.text, finding)).collect()
}

/// The reason of one finding, with the words concerned before it and the correction behind it.
fn explain_finding(brief: &WritingBrief<'_>, text: &str, finding: &CheckFinding) -> String {
    let words = finding.span.and_then(|[from, to]| text.get(from..to));
    // "Here" is where the clause is.
    let quoted = match finding.reason.contains("here") {
        true => finding.span.map(|span| clause_around(text, span)),
        false => words.filter(|words| !finding.reason.contains(*words)),
    };
    let reason = match quoted {
        Some(quoted) => format!("you wrote {quoted:?}: {}", finding.reason),
        None => finding.reason.clone(),
    };
    match describe_right(brief, text, finding, words) {
        Some(right) => format!("{reason} ({right})"),
        None => reason,
    }
}

/// The correction for a finding, if the walk shows it.
fn describe_right(brief: &WritingBrief<'_>, text: &str, finding: &CheckFinding, words: Option<&str>) -> Option<String> {
    if !brief.walk.path.motion.is_known()
        && matches!(finding.check, CheckKind::Turns | CheckKind::Floors | CheckKind::Order)
    {
        return None;
    }
    match finding.check {
        CheckKind::Turns => Some(describe_turns(brief, text, finding.span)),
        CheckKind::Floors => Some(describe_climbs(brief.memory)),
        CheckKind::Landmarks | CheckKind::Order => where_seen(brief, words?),
        CheckKind::Task => seen_at_end(brief),
        CheckKind::Leak => Some("say it in other words".to_owned()),
        CheckKind::Coverage => Some("use plain words for ways, rooms and things".to_owned()),
        CheckKind::Form | CheckKind::Route => None,
    }
}

/// The clause of a text around a span.
fn clause_around(text: &str, [from, to]: [usize; 2]) -> &str {
    let is_mark = |c: char| matches!(c, '.' | ',' | ';' | '。' | '，' | '；');
    let behind = |mark: usize| mark + text[mark..].chars().next().map_or(0, char::len_utf8);
    let start = text.get(..from).and_then(|before| before.rfind(is_mark)).map_or(0, behind);
    let end = text.get(to..).and_then(|behind| behind.find(is_mark)).map_or(text.len(), |mark| to + mark);
    text.get(start..end).unwrap_or_default().trim()
}

/// The turn of the walk that corresponds to this turn of the text; all turns of the walk if the text has more or fewer.
fn describe_turns(brief: &WritingBrief<'_>, text: &str, span: Option<[usize; 2]>) -> String {
    let moves = brief.walk.moves.iter().enumerate().filter(|(_, step)| step.turn() != TurnKind::Straight);
    let walked: Vec<(usize, &PathMove)> = moves.collect();
    let readable = ReadableText::new(text, None);
    let reading = read_instruction(readable.english(), &std::collections::BTreeSet::new());
    let turns = reading.events.iter().filter(|event| matches!(event.what, EventContent::Turn(_)) && !event.denied);
    let turns: Vec<[usize; 2]> = turns.map(|event| readable.source_span(event.span)).collect();
    let overlaps = |other: &[usize; 2]| span.is_some_and(|span| span[0] < other[1] && other[0] < span[1]);
    let at = turns.iter().position(overlaps).filter(|_| turns.len() == walked.len());
    if let Some((frame, step)) = at.and_then(|at| walked.get(at)) {
        return format!("the walk {} there, at {}", turn_words(step.turn()), frame_name(*frame));
    }
    if walked.is_empty() {
        return "the walk goes straight on and never turns".to_owned();
    }
    let all = walked.iter().map(|(frame, step)| format!("{} at {}", turn_words(step.turn()), frame_name(*frame)));
    format!("the turns of the walk are, in order: {}", all.collect::<Vec<_>>().join(", "))
}

/// Where the walk climbs.
fn describe_climbs(memory: &WalkMemory) -> String {
    let climbs = memory.flights.iter().map(|flight| {
        let way = if flight.climb == ClimbDirection::Down { "down" } else { "up" };
        format!("it goes {way} stairs from {} to {}", frame_name(flight.from), frame_name(flight.to))
    });
    let climbs: Vec<String> = climbs.collect();
    if climbs.is_empty() { "the walk stays on one floor".to_owned() } else { climbs.join(", ") }
}

/// What a task can be about.
fn seen_at_end(brief: &WritingBrief<'_>) -> Option<String> {
    let last = brief.memory.frame_count().saturating_sub(1);
    let seen = brief.memory.things.iter().filter(|thing| thing.glimpse_from(last).is_some() && !is_fabric(&thing.name));
    let mut names: Vec<&str> = seen.map(|thing| thing.name.as_str()).collect();
    names.dedup();
    names.truncate(MAX_SEEN_THINGS);
    (!names.is_empty() && brief.walk.path.target.is_none()).then(|| format!("it shows: {}", names.join(", ")))
}

/// Where the named place is along the walk, and how a thing looks; advice if it is nowhere.
fn where_seen(brief: &WritingBrief<'_>, words: &str) -> Option<String> {
    let readable = ReadableText::new(words, None);
    let name = readable.english().trim_start_matches("the ").trim();
    let stays = brief.known.stays.iter().filter(|stay| same_room(&stay.room, name));
    let stays: Vec<String> = stays.map(|stay| frame_range(stay.entered, stay.left)).collect();
    if !stays.is_empty() {
        return Some(format!("the walk is in the {name} in {}", stays.join(" and in ")));
    }
    if brief.known.knows_doors() && is_way_through(name) {
        let ways = brief.known.openings.iter().filter(|opening| opening.has_door);
        let ways: Vec<String> =
            ways.map(|way| format!("after {} into the {}", frame_name(way.before), way.to)).collect();
        return (!ways.is_empty()).then(|| format!("the walk goes through a door {}", ways.join(", ")));
    }
    let knows_motion = brief.walk.path.motion.is_known();
    let place = |thing: &RememberedThing| {
        let colour = thing.colour.as_ref().map_or(String::new(), |colour| format!("{colour} "));
        let passed = thing.passed.filter(|_| knows_motion).map(|by| {
            let side = if by.side == Side::Left { "left" } else { "right" };
            format!("is passed on the {side} at {}", frame_name(by.frame))
        });
        let seen = || format!("is seen from {}", frame_range(thing.first_seen(), thing.last_seen()));
        format!("the {colour}{} {}", thing.name, passed.unwrap_or_else(seen))
    };
    let alike = brief.memory.things.iter().filter(|thing| names_agree(&thing.name, name));
    let places: Vec<String> = alike.take(MAX_NAMED_THINGS).map(place).collect();
    Some(if places.is_empty() { "name something that the parts show".to_owned() } else { places.join("; ") })
}
