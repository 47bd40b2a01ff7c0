//! Stairs and storeys in an open world: they are held against floor heights along the path.

use crate::{evidence::Evidence, finding, floors};
use wayword_core::{Check, Climb, Finding, Motion, Verdict};
use wayword_language::{
    reading::{Reading, What},
    text::{Token, tokens},
};

/// A path that nowhere gains or loses this much goes up or down no step, metres.
const STEP_M: f64 = 0.1;
/// A path that goes this far the other way takes stairs there, metres.
const FLIGHT_M: f64 = 0.5;
/// Beside such stairs, what it gains is no climb if it is less than this share of them, in a text that tells both ways.
const SHARE_OF_BOTH: f64 = 0.15;
/// The same in a text that only tells this way.
const SHARE_OF_ONE: f64 = 0.45;

/// What is wrong with the climbs and storeys of a text.
pub(super) fn climbs(text: &str, reading: &Reading, evidence: &Evidence) -> Vec<Finding> {
    let tokens = tokens(text);
    let share = if tells_both_ways(reading) { SHARE_OF_BOTH } else { SHARE_OF_ONE };
    let mut found = Vec::new();
    for event in &reading.events {
        let told = told(&tokens, event.span);
        let (verdict, climb) = match event.what {
            What::Climb(climb) | What::Steps(climb) => (climbed(climb, evidence, share), climb),
            What::Storey(climb) => (storey(climb, evidence), climb),
            _ => continue,
        };
        // "Stop before you go up the stairs": the path may be level, but not go down instead.
        let may_be = told == Told::Moment && !goes_other_way(climb, evidence, share);
        if told == Told::Described || may_be {
            continue;
        }
        let way = if climb == Climb::Up { "up" } else { "down" };
        let reason = match verdict {
            Verdict::Pass => continue,
            Verdict::Fail => format!("the path nowhere goes {way}"),
            Verdict::Unverified => "the program cannot check whether the path goes up or down".to_owned(),
        };
        found.push(finding(Check::Floors, verdict, reason, Some(event.span)));
    }
    // People count storeys from the street or from the cellar, so a number alone refutes nothing.
    let numbers = floors::wrong_floors(reading, evidence).map(|finding| Finding {
        verdict: Verdict::Unverified,
        reason: "the program does not know from where the text counts storeys".into(),
        ..finding
    });
    found.extend(numbers);
    found
}

/// How a text tells of a climb.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Told {
    /// As a command.
    Command,
    /// As a moment, before which the path may end or after which it may begin: "before you go up the stairs". Also
    /// without stairs, where "down" may be along a hallway: "walk all the way down".
    Moment,
    /// As what stairs do: "the stairs going down".
    Described,
}

/// Words that make a climb a moment.
const MOMENT: &[&str] = &["before", "after", "until", "till", "when", "once", "if"];
/// Words that make a climb what stairs do.
const DESCRIBING: &[&str] = &["heading", "headed", "going", "goes", "that", "lead", "leads", "leading"];

fn told(tokens: &[Token], span: [usize; 2]) -> Told {
    let at = tokens.partition_point(|token| token.span[0] < span[0]);
    let before = || tokens[..at].iter().rev().take_while(|token| token.is_word()).take(5);
    let has = |list: &[&str]| before().any(|token| list.contains(&token.word.as_str()));
    // "The descending staircase".
    let is_adjective = tokens.get(at).is_some_and(|token| token.word.ends_with("ing"))
        && before().next().is_some_and(|token| matches!(token.word.as_str(), "the" | "a"));
    match () {
        () if is_adjective || (has(DESCRIBING) && !has(MOMENT)) => Told::Described,
        () if has(MOMENT) || !names_stairs(tokens, at) => Told::Moment,
        () => Told::Command,
    }
}

/// Whether a text tells of going up and of going down.
fn tells_both_ways(reading: &Reading) -> bool {
    let tells = |way: Climb| {
        reading.events.iter().any(|event| match event.what {
            What::Climb(climb) | What::Steps(climb) => climb == way,
            _ => false,
        })
    };
    tells(Climb::Up) && tells(Climb::Down)
}

/// Whether stairs or storeys are named beside a climb.
fn names_stairs(tokens: &[Token], at: usize) -> bool {
    let near = tokens.iter().take(at + 8).skip(at.saturating_sub(5));
    let is_stairs = |word: &str| {
        word.ends_with("stairs") || word.starts_with("stair") || word.starts_with("step") || word.starts_with("flight")
    };
    let is_storey =
        |word: &str| matches!(word, "floor" | "floors" | "level" | "levels" | "storey" | "story" | "landing");
    let is_climb = |word: &str| ["climb", "ascend", "descend"].iter().any(|verb| word.starts_with(verb));
    near.map(|token| token.word.as_str()).any(|word| is_stairs(word) || is_storey(word) || is_climb(word))
}

/// Whether the path takes stairs the other way, and next to none this way.
fn goes_other_way(climb: Climb, evidence: &Evidence, share: f64) -> bool {
    let other = if climb == Climb::Up { Climb::Down } else { Climb::Up };
    let away_m = rise_m(other, evidence);
    away_m >= FLIGHT_M && rise_m(climb, evidence) < share * away_m
}

fn climbed(climb: Climb, evidence: &Evidence, share: f64) -> Verdict {
    match evidence.motion {
        Motion::Unknown => Verdict::Unverified,
        Motion::Known if rise_m(climb, evidence) >= STEP_M && !goes_other_way(climb, evidence, share) => Verdict::Pass,
        Motion::Known => Verdict::Fail,
    }
}

/// "The bedroom upstairs" may lie on the storey on which the walker is already. It is wrong only if the path goes a
/// storey the other way.
fn storey(climb: Climb, evidence: &Evidence) -> Verdict {
    let other = if climb == Climb::Up { Climb::Down } else { Climb::Up };
    match evidence.motion {
        Motion::Known if rise_m(climb, evidence) >= STEP_M => Verdict::Pass,
        Motion::Known if rise_m(other, evidence) >= STEP_M => Verdict::Fail,
        _ => Verdict::Unverified,
    }
}

/// The most height that the path gains, or loses, between any two of its frames, metres.
pub(super) fn rise_m(climb: Climb, evidence: &Evidence) -> f64 {
    let way = if climb == Climb::Down { -1.0 } else { 1.0 };
    let (mut lowest, mut height, mut most) = (0.0_f64, 0.0, 0.0_f64);
    for step in &evidence.moves {
        height += step.rise_m * way;
        most = most.max(height - lowest);
        lowest = lowest.min(height);
    }
    most
}
