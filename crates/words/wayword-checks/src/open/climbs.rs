//! Checks stairs and storeys in an open world, by the floor heights along the path.

use super::phrase::motion_span;
use crate::{CheckSubject, floors, new_finding};
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, PathMotion, Verdict};
use wayword_language::{
    reading::{
        EventContent, TextReading,
        motion_words::{DESCRIBING, MOMENT},
    },
    text::TextToken,
};

/// A path that nowhere gains or loses this much goes up or down no step, metres.
const STEP_M: f64 = 0.1;
/// A path that goes this far the other way takes stairs there, metres.
const FLIGHT_M: f64 = 0.5;
/// Next to stairs the other way, a gain is no climb if it is less than this share of them, in a text with climbs both
/// ways.
const MIN_CLIMB_SHARE_BOTH_WAYS: f64 = 0.15;
/// The same share for a text with climbs in one direction only.
const MIN_CLIMB_SHARE_ONE_WAY: f64 = 0.45;

/// The mistakes in the climbs and storeys of a text.
pub(super) fn check_climbs(reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    let tokens = reading.tokens();
    let heights = PathHeights::from_subject(
        subject,
        if climbs_both_ways(reading) { MIN_CLIMB_SHARE_BOTH_WAYS } else { MIN_CLIMB_SHARE_ONE_WAY },
    );
    let mut found = Vec::new();
    for event in &reading.events {
        let wording = climb_wording(tokens, event.span);
        let (verdict, climb) = match event.what {
            EventContent::Climb(climb) => (heights.verdict_on_climb(climb), climb),
            EventContent::Steps(climb) => (heights.verdict_on_steps(climb), climb),
            EventContent::Storey(climb) => (heights.verdict_on_storey(climb), climb),
            _ => continue,
        };
        // "Once you are up the stairs": the path may be level, but not go down instead.
        let may_be = wording == ClimbWording::Moment && !heights.goes_other_way(climb);
        if wording == ClimbWording::Described || may_be {
            continue;
        }
        let way = if climb == ClimbDirection::Up { "up" } else { "down" };
        let reason = match verdict {
            Verdict::Pass => continue,
            Verdict::Fail => format!("the path nowhere goes {way}"),
            Verdict::Unverified => "the program cannot check whether the path goes up or down".to_owned(),
        };
        found.push(new_finding(CheckKind::Floors, verdict, reason, Some(motion_span(tokens, event.span, is_stairs))));
    }
    // People count storeys from the street or from the cellar, so a number alone contradicts no path.
    let numbers = floors::wrong_floors(reading, subject.evidence, subject.tag).map(|finding| CheckFinding {
        verdict: Verdict::Unverified,
        reason: "the program does not know from where the text counts storeys".into(),
        ..finding
    });
    found.extend(numbers);
    found
}

/// The wording of a climb.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ClimbWording {
    /// As a command.
    Command,
    /// As a moment, before which the path may end or after which it may begin: "once you are up the stairs", "begin to
    /// climb the stairs". Also without stairs, where "down" may be along a hallway: "walk all the way down".
    Moment,
    /// As a description of stairs, or of something that the walker no longer does: "the stairs going down", "stop
    /// before you go up".
    Described,
}

/// How a text words the climb at a byte range. The five words before the climb decide.
fn climb_wording(tokens: &[TextToken], span: [usize; 2]) -> ClimbWording {
    let at = tokens.partition_point(|token| token.span[0] < span[0]);
    let before = || tokens[..at].iter().rev().take_while(|token| token.is_word()).take(5);
    let has = |list: &[&str]| before().any(|token| list.contains(&token.word.as_str()));
    // "The descending staircase".
    let is_adjective = tokens.get(at).is_some_and(|token| token.word.ends_with("ing"))
        && before().next().is_some_and(|token| matches!(token.word.as_str(), "the" | "a"));
    match () {
        () if is_adjective || has(&["before"]) || (has(&DESCRIBING) && !has(&MOMENT)) => ClimbWording::Described,
        () if has(&MOMENT) || !names_stairs(tokens, at) => ClimbWording::Moment,
        () => ClimbWording::Command,
    }
}

/// Whether a text has a climb up and a climb down.
fn climbs_both_ways(reading: &TextReading) -> bool {
    let tells = |way: ClimbDirection| {
        reading.events.iter().any(|event| match event.what {
            EventContent::Climb(climb) | EventContent::Steps(climb) => climb == way,
            _ => false,
        })
    };
    tells(ClimbDirection::Up) && tells(ClimbDirection::Down)
}

fn is_stairs(word: &str) -> bool {
    word.ends_with("stairs") || word.starts_with("stair") || word.starts_with("step") || word.starts_with("flight")
}

/// Whether stairs or storeys are named near a climb: at most five tokens before its first token, or seven behind it.
fn names_stairs(tokens: &[TextToken], at: usize) -> bool {
    let near = tokens.iter().take(at + 8).skip(at.saturating_sub(5));
    let is_storey =
        |word: &str| matches!(word, "floor" | "floors" | "level" | "levels" | "storey" | "story" | "landing");
    let is_climb = |word: &str| ["climb", "ascend", "descend"].iter().any(|verb| word.starts_with(verb));
    near.map(|token| token.word.as_str()).any(|word| is_stairs(word) || is_storey(word) || is_climb(word))
}

/// How a path goes up and down.
struct PathHeights {
    /// Whether the motion along the path is known.
    is_known: bool,
    /// The height that it gains, metres: the most between any two of its frames.
    up_m: f64,
    /// The height that it loses, metres, measured in the same way.
    down_m: f64,
    /// Next to stairs the other way, a gain is no climb if it is less than this share of them.
    share: f64,
}

impl PathHeights {
    fn from_subject(subject: CheckSubject<'_>, share: f64) -> Self {
        let moves = &subject.evidence.moves;
        let eyes: Vec<f64> = moves.iter().map(|step| step.rise_m).collect();
        // A camera may be lower over a step than elsewhere over the floor, and be moved up and down on one floor.
        let floors_m = subject.reach.surroundings.map_or(&[][..], |around| around.floors_m());
        let floors: Vec<f64> = floors_m.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rises = if floors.len() == eyes.len() { floors } else { eyes };
        let most = |way: f64| most_gain_m(&rises, way);
        Self { is_known: subject.evidence.motion == PathMotion::Known, up_m: most(1.0), down_m: most(-1.0), share }
    }

    /// The height that the path makes in the direction of a climb, metres.
    fn gains_m(&self, climb: ClimbDirection) -> f64 {
        if climb == ClimbDirection::Down { self.down_m } else { self.up_m }
    }

    /// The height that the path makes against the direction of a climb, metres.
    fn loses_m(&self, climb: ClimbDirection) -> f64 {
        if climb == ClimbDirection::Down { self.up_m } else { self.down_m }
    }

    /// Whether the path takes stairs the other way, and next to none this way.
    fn goes_other_way(&self, climb: ClimbDirection) -> bool {
        let away_m = self.loses_m(climb);
        away_m >= FLIGHT_M && self.gains_m(climb) < self.share * away_m
    }

    fn verdict_on_climb(&self, climb: ClimbDirection) -> Verdict {
        match self.is_known {
            false => Verdict::Unverified,
            true if self.gains_m(climb) >= STEP_M && !self.goes_other_way(climb) => Verdict::Pass,
            true => Verdict::Fail,
        }
    }

    /// A few steps count however many stairs there are the other way.
    fn verdict_on_steps(&self, climb: ClimbDirection) -> Verdict {
        match self.is_known {
            false => Verdict::Unverified,
            true if self.gains_m(climb) >= STEP_M => Verdict::Pass,
            true => Verdict::Fail,
        }
    }

    /// "The bedroom upstairs" may lie on the storey on which the walker is already. It is wrong only if the path goes a
    /// storey the other way.
    fn verdict_on_storey(&self, climb: ClimbDirection) -> Verdict {
        match self.is_known {
            true if self.gains_m(climb) >= STEP_M => Verdict::Pass,
            true if self.loses_m(climb) >= STEP_M => Verdict::Fail,
            _ => Verdict::Unverified,
        }
    }
}

/// The most that these rises gain between any two points, metres. `way` is 1 for the way up and -1 for the way down.
fn most_gain_m(rises: &[f64], way: f64) -> f64 {
    let (mut lowest, mut height, mut most) = (0.0_f64, 0.0, 0.0_f64);
    for rise_m in rises {
        height += rise_m * way;
        most = most.max(height - lowest);
        lowest = lowest.min(height);
    }
    most
}
