//! The ways to say a step. `{s}` is a side, `{l}` a landmark with its article, `{r}` a room with its article.

use super::{
    landmarks::Landmark,
    route::{Step, Within, side_word},
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Climb, Motion, Side, Turn};
use wayword_language::lexicon::room_name;

const TURN: &[&str] = &["turn {s}", "take a {s}", "make a {s}", "go {s}", "make a {s} turn", "head {s}", "hang a {s}"];
const TURN_AGAIN: &[&str] = &["turn {s} again", "take another {s}", "make another {s}", "go {s} again"];
const TURN_SLIGHTLY: &[&str] = &["bear {s}", "veer {s}", "turn slightly {s}", "make a slight {s}", "veer slightly {s}"];
const TURN_AT: &[&str] = &[
    "turn {s} at {l}",
    "take a {s} at {l}",
    "make a {s} at {l}",
    "turn {s} when you reach {l}",
    "turn {s} by {l}",
    "go {s} at {l}",
    "at {l} turn {s}",
    "turn {s} once you get to {l}",
    "make a {s} near {l}",
    "when you get to {l} turn {s}",
];
const TURN_INTO: &[&str] = &[
    "turn {s} into {r}",
    "take a {s} into {r}",
    "make a {s} into {r}",
    "go {s} into {r}",
    "head {s} into {r}",
    "turn {s} and enter {r}",
    "turn {s} to enter {r}",
];
const TURN_WITHIN: &[&str] =
    &["turn {s} in {r}", "take a {s} in {r}", "in {r} turn {s}", "in {r} take a {s}", "make a {s} in {r}"];
const TURN_OUT: &[&str] = &[
    "turn {s} out of {r}",
    "take a {s} out of {r}",
    "make a {s} out of {r}",
    "leave {r} and turn {s}",
    "exit {r} and go {s}",
];
const AROUND: &[&str] = &["turn around", "turn 180 degrees", "turn back around"];
const UP: &[&str] = &[
    "go up the stairs",
    "walk up the stairs",
    "climb the stairs",
    "head up the stairs",
    "ascend the stairs",
    "go upstairs",
    "go up the steps",
];
const DOWN: &[&str] = &[
    "go down the stairs",
    "walk down the stairs",
    "head down the stairs",
    "descend the stairs",
    "go downstairs",
    "go down the steps",
];
const ENTER: &[&str] = &[
    "enter {r}",
    "walk into {r}",
    "go into {r}",
    "step into {r}",
    "continue into {r}",
    "head into {r}",
    "move into {r}",
    "proceed into {r}",
];
const LEAVE: &[&str] = &[
    "leave {a} and enter {r}",
    "exit {a} into {r}",
    "walk out of {a} and into {r}",
    "go from {a} into {r}",
    "exit {a} and go into {r}",
    "leave {a} and walk into {r}",
];
const THROUGH: &[&str] = &[
    "walk through {r}",
    "go through {r}",
    "pass through {r}",
    "cross {r}",
    "continue through {r}",
    "head through {r}",
];
const PASS: &[&str] = &[
    "walk past {l}",
    "go past {l}",
    "pass {l}",
    "walk by {l}",
    "continue past {l}",
    "walk towards {l}",
    "head towards {l}",
    "keep going past {l}",
    "move past {l}",
    "go towards {l}",
    "walk straight past {l}",
];
const ALONG: &[&str] = &[
    "walk across {r}",
    "go through {r}",
    "cross {r}",
    "walk through {r}",
    "continue through {r}",
    "keep going through {r}",
    "go across {r}",
];
const ALONG_HALL: &[&str] = &[
    "walk down {r}",
    "continue down {r}",
    "go down {r}",
    "walk along {r}",
    "follow {r}",
    "head down {r}",
    "continue along {r}",
    "go straight down {r}",
];
const ON: &[&str] = &[
    "walk straight ahead",
    "continue straight",
    "go straight",
    "keep going straight",
    "walk forward",
    "walk straight",
    "continue forward",
];
const ON_SOMEHOW: &[&str] = &["keep going", "walk on", "go on", "continue on your way", "carry on"];
const STAY: &[&str] = &["stay where you are", "remain where you are", "stay here", "remain here"];
const STAY_IN: &[&str] = &["stay in {r}", "remain in {r}", "stay here in {r}"];
const STOP_BY: &[&str] = &[
    "stop next to {l}",
    "wait by {l}",
    "stop in front of {l}",
    "stop at {l}",
    "stop near {l}",
    "wait near {l}",
    "stop when you reach {l}",
    "stop beside {l}",
    "wait next to {l}",
    "stop by {l}",
];
const STOP_IN: &[&str] = &[
    "stop in {r}",
    "wait in {r}",
    "stop once you are in {r}",
    "stop inside {r}",
    "wait inside {r}",
    "stop when you are in {r}",
];
const STOP_THERE: &[&str] = &["stop there", "wait there", "stop right there", "stop"];
const STOP_UP: &[&str] =
    &["stop at the top of the stairs", "wait at the top of the stairs", "stop at the top of the steps"];
const STOP_DOWN: &[&str] =
    &["stop at the bottom of the stairs", "wait at the bottom of the stairs", "stop at the foot of the stairs"];

/// One of several, by chance.
pub(super) fn pick<'a, T: ?Sized>(rng: &mut ChaCha8Rng, of: &[&'a T]) -> &'a T {
    of[rng.random_range(0..of.len())]
}

/// The ways to say a step that fit a motion: where the motion is unknown, none says "straight".
pub(super) fn unbent(of: &[&'static str], motion: Motion) -> Vec<&'static str> {
    of.iter().copied().filter(|way| motion.is_known() || !way.contains("straight")).collect()
}

/// A room with its article.
pub(super) fn the(room: &str) -> String {
    format!("the {room}")
}

/// A step in words, in lower case and without a mark at its end.
pub(super) fn phrase(step: &Step, told_room: Option<&str>, motion: Motion, rng: &mut ChaCha8Rng) -> String {
    match step {
        Step::Turn { turn, at, into, within } => {
            let within = within.as_ref().filter(|within| told_room != Some(&*within.room) || within.out);
            turn_phrase(*turn, at.as_ref(), into.as_deref(), within, rng)
        }
        Step::Climb { climb, to_level } => climb_phrase(*climb, *to_level, rng),
        Step::Room { from: Some(from), to, through: false } => {
            fill(pick(rng, LEAVE), &[("{a}", &the(from)), ("{r}", &the(to))])
        }
        Step::Room { to, through, .. } => fill(pick(rng, if *through { THROUGH } else { ENTER }), &[("{r}", &the(to))]),
        Step::Pass(landmark) => pass_phrase(landmark, motion, rng),
        Step::Along { room } => {
            let hall = room_name(room) == Some("hallway");
            let ways = unbent(if hall { ALONG_HALL } else { ALONG }, motion);
            fill(pick(rng, &ways), &[("{r}", &the(room))])
        }
        Step::On => pick(rng, if motion.is_known() { ON } else { ON_SOMEHOW }).to_owned(),
        Step::Stay => stay_phrase(None, rng),
        Step::Stop { by, room, climbed } => {
            let room = room.as_deref().filter(|room| told_room != Some(*room));
            stop_phrase(by.as_ref(), room, *climbed, rng)
        }
    }
}

fn turn_phrase(
    turn: Turn,
    at: Option<&Landmark>,
    into: Option<&str>,
    within: Option<&Within>,
    rng: &mut ChaCha8Rng,
) -> String {
    let Some(side) = turn.side() else { return pick(rng, AROUND).to_owned() };
    let side = side_word(side);
    match (at, into, within) {
        (_, Some(room), _) => fill(pick(rng, TURN_INTO), &[("{s}", side), ("{r}", &the(room))]),
        (Some(landmark), None, _) => fill(pick(rng, TURN_AT), &[("{s}", side), ("{l}", &landmark.phrase)]),
        (None, None, Some(Within { room, out })) => {
            fill(pick(rng, if *out { TURN_OUT } else { TURN_WITHIN }), &[("{s}", side), ("{r}", &the(room))])
        }
        (None, None, None) => {
            let slight = matches!(turn, Turn::SlightLeft | Turn::SlightRight);
            fill(pick(rng, if slight { TURN_SLIGHTLY } else { TURN }), &[("{s}", side)])
        }
    }
}

fn climb_phrase(climb: Climb, to_level: Option<u32>, rng: &mut ChaCha8Rng) -> String {
    let stairs = pick(rng, if climb == Climb::Up { UP } else { DOWN });
    match to_level.filter(|_| rng.random_bool(0.3)) {
        Some(level) => format!("{stairs} to {}", level_phrase(level, rng)),
        None => stairs.to_owned(),
    }
}

/// A bare turn to the side that the last turn went to.
pub(super) fn turn_again(side: Side, rng: &mut ChaCha8Rng) -> String {
    fill(pick(rng, TURN_AGAIN), &[("{s}", side_word(side))])
}

/// A storey in words: "level 2", "the second floor".
pub(super) fn level_phrase(level: u32, rng: &mut ChaCha8Rng) -> String {
    match ordinal(level).filter(|_| rng.random_bool(0.5)) {
        Some(ordinal) => format!("the {ordinal} floor"),
        None => format!("level {level}"),
    }
}

/// The ordinal of a storey.
pub(super) fn ordinal(level: u32) -> Option<&'static str> {
    ["first", "second", "third", "fourth", "fifth"].get(level.checked_sub(1)? as usize).copied()
}

fn pass_phrase(landmark: &Landmark, motion: Motion, rng: &mut ChaCha8Rng) -> String {
    let pass = fill(pick(rng, &unbent(PASS, motion)), &[("{l}", &landmark.phrase)]);
    let side = landmark.side.filter(|side| matches!(side, Side::Left | Side::Right));
    match side.filter(|_| rng.random_bool(0.3)) {
        Some(side) => format!("{pass} on {} {}", pick(rng, &["your", "the"]), side_word(side)),
        None => pass,
    }
}

/// A phrase for a path that goes nowhere, with its room where the name is known.
pub(super) fn stay_phrase(room: Option<&str>, rng: &mut ChaCha8Rng) -> String {
    match room {
        Some(room) => fill(pick(rng, STAY_IN), &[("{r}", &the(room))]),
        None => pick(rng, STAY).to_owned(),
    }
}

fn stop_phrase(by: Option<&Landmark>, room: Option<&str>, climbed: Option<Climb>, rng: &mut ChaCha8Rng) -> String {
    let by = by.map(|landmark| fill(pick(rng, STOP_BY), &[("{l}", &landmark.phrase)]));
    match (by, room, climbed) {
        (Some(by), Some(room), _) if rng.random_bool(0.4) => format!("{by} in {}", the(room)),
        (Some(by), ..) => by,
        (None, Some(room), _) => fill(pick(rng, STOP_IN), &[("{r}", &the(room))]),
        (None, None, Some(Climb::Up)) => pick(rng, STOP_UP).to_owned(),
        (None, None, Some(Climb::Down)) => pick(rng, STOP_DOWN).to_owned(),
        (None, None, _) => pick(rng, STOP_THERE).to_owned(),
    }
}

/// A template with its gaps filled. One is "on" a balcony or porch, not "in" it.
pub(super) fn fill(template: &str, gaps: &[(&str, &str)]) -> String {
    let text = gaps.iter().fold(template.to_owned(), |text, (gap, value)| text.replace(gap, value));
    let open_air = gaps.iter().any(|(gap, room)| {
        *gap == "{r}" && matches!(room_name(room.trim_start_matches("the ")), Some("porch" | "balcony"))
    });
    if open_air {
        text.replace("into the", "onto the").replace(" inside the", " on the").replace(" in the", " on the")
    } else {
        text
    }
}
