//! Computes the values that fill the writing prompt: frames, moves, references, constraints.

use super::{corrections::reasons, remembered::remembered};
use crate::{walk::Walk, writer::Brief};
use minijinja::{Value, context};
use rand::seq::index;
use wayword_core::{Climb, Move, Side, Target, Turn, rng};
use wayword_language::{lexicon::agree, text::word_count};

/// Most reference texts of a prompt. A style may have thousands, and more examples do not make a text more alike.
const MOST_REFERENCES: usize = 24;
/// Most landmarks of a frame.
const MOST_LANDMARKS: usize = 8;
/// Most steps of the overview; a longer way has no overview.
const MOST_STEPS: usize = 40;

pub(super) fn context(brief: &Brief<'_>) -> Value {
    let walk = brief.walk;
    let frames: Vec<Value> = walk
        .observations
        .iter()
        .enumerate()
        .map(|(at, observation)| {
            let caption = observation.summary.trim_end_matches('.');
            context! { caption, landmarks => landmarks(walk, at), move => walk.moves.get(at).map(motion) }
        })
        .collect();
    let pictured: Vec<String> = brief.pictures.iter().map(|picture| format!("Frame {}", picture.frame)).collect();
    let complaints = brief.complaints.iter();
    let complaints: Vec<Value> =
        complaints.map(|complaint| context! { text => complaint.text, reasons => reasons(brief, complaint) }).collect();
    context! {
        frames,
        pictured,
        complaints,
        overview => overview(&walk.moves),
        remembered => remembered(brief.memory),
        knows_motion => walk.path.motion.is_known(),
        references => references(brief),
        target => walk.path.target.as_ref().filter(|_| ends_in_task(brief)).map(|target| told_target(walk, target)),
        constraints => constraints(brief),
        earlier => brief.earlier,
    }
}

/// The references that a prompt shows: all of them, or some that are drawn by the seed.
fn references<'a>(brief: &Brief<'a>) -> Vec<&'a str> {
    let all = &brief.style.references;
    let shown = all.len().min(MOST_REFERENCES);
    let mut chosen = match shown == all.len() {
        true => (0..shown).collect(),
        false => {
            index::sample(&mut rng(brief.seed, &["shown references", &brief.style.name]), all.len(), shown).into_vec()
        }
    };
    chosen.sort_unstable();
    chosen.into_iter().filter_map(|at| all.get(at)).map(String::as_str).collect()
}

/// Whether the style's texts end in a task: by its rule, or because most of its references do. In other styles a target
/// is an object like any other.
fn ends_in_task(brief: &Brief<'_>) -> bool {
    brief.style.constraints.ends_in_task || brief.profile.tasks >= 0.5
}

/// The things of a frame that a text may name, each once, with its colour and side where they are known.
fn landmarks(walk: &Walk, frame: usize) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut told = Vec::new();
    for seen in walk.seen(frame) {
        let name = seen.sighting.name.as_str();
        if told.len() == MOST_LANDMARKS || names.iter().any(|other| agree(other, name)) {
            continue;
        }
        names.push(name);
        let colour = seen.sighting.colour.as_ref().filter(|colour| !name.contains(colour.as_str()));
        let colour = colour.map_or(String::new(), |colour| format!("{colour} "));
        let several = if seen.sighting.several { "several " } else { "" };
        let side = match seen.side {
            Some(Side::Left) => " (left)",
            Some(Side::Right) => " (right)",
            Some(Side::Behind) => " (behind)",
            Some(Side::Ahead) | None => "",
        };
        told.push(format!("{several}{colour}{name}{side}"));
    }
    told
}

/// The name of a frame in reasons and in the overview.
pub(super) fn frame_of_move(at: usize) -> String {
    format!("Frame {at}")
}

/// The words for a turn of the walk.
pub(super) fn way(turn: Turn) -> &'static str {
    match turn {
        Turn::Straight => "goes straight on",
        Turn::SlightLeft => "turns slightly left",
        Turn::SlightRight => "turns slightly right",
        Turn::Left => "turns left",
        Turn::Right => "turns right",
        Turn::Around => "turns around",
    }
}

/// A move in words, with its numbers.
fn motion(step: &Move) -> String {
    let deg = step.turn_rad.to_degrees().abs().round();
    let turn = match step.turn() {
        Turn::Straight => "straight on".to_owned(),
        turn => format!("{} ({deg} degrees)", way(turn)),
    };
    format!("{turn}, {:.1} metres{}", step.distance_m, climb(step.climb(), step.rise_m))
}

fn climb(climb: Climb, rise_m: f64) -> String {
    match climb {
        Climb::Level => String::new(),
        Climb::Up => format!(", up {rise_m:.1} metres of stairs"),
        Climb::Down => format!(", down {:.1} metres of stairs", -rise_m),
    }
}

/// The way in short: a move that goes straight on is joined to the one before.
fn overview(moves: &[Move]) -> Vec<String> {
    let mut steps: Vec<(usize, usize, Turn, Climb, f64)> = Vec::new();
    for (at, step) in moves.iter().enumerate() {
        match steps.last_mut() {
            Some((_, to, _, climb, length_m)) if step.turn() == Turn::Straight && *climb == step.climb() => {
                (*to, *length_m) = (at + 1, *length_m + step.distance_m);
            }
            _ => steps.push((at, at + 1, step.turn(), step.climb(), step.distance_m)),
        }
    }
    if steps.len() > MOST_STEPS || steps.len() < 2 {
        return Vec::new();
    }
    let told = steps.into_iter().map(|(from, to, turn, climb, length_m)| {
        let turn = if turn == Turn::Straight { String::new() } else { format!("{}, then ", way(turn)) };
        let stairs = match climb {
            Climb::Level => "",
            Climb::Up => " up the stairs",
            Climb::Down => " down the stairs",
        };
        format!("At {} the walk {turn}goes {length_m:.0} metres{stairs}, to {}", frame_of_move(from), frame_of_move(to))
    });
    told.collect()
}

fn told_target(walk: &Walk, target: &Target) -> String {
    let told_by = target.told_by.first().map(|told_by| format!("it is {}", told_by.predicate()));
    match told_by.filter(|_| target.has_namesake) {
        Some(told_by) => format!("{} (others like it are visible; {told_by})", target.name),
        None if !walk.describes_target() => {
            format!("{} (no description mentions it: name it by this word, and say nothing else of it)", target.name)
        }
        None => target.name.clone(),
    }
}

/// The style's rules in words. The sentence on fine-grained texts and the shape of coarse ones follow the paper (arXiv
/// 2403.11487).
fn constraints(brief: &Brief<'_>) -> Vec<String> {
    let (rules, mut told) = (&brief.style.constraints, Vec::new());
    if brief.profile.tells_turns() {
        told.push("Reaching the goal counts: not every frame has to be used.".to_owned());
    }
    if let Some(least) = rules.min_sentences {
        told.push(format!("Write {least} sentences or more."));
    }
    match rules.max_sentences {
        Some(1) => told.push("Write a single sentence.".to_owned()),
        Some(most) => told.push(format!("Write at most {most} sentences.")),
        None => {}
    }
    match rules.fewer_words_than {
        Some(limit) => told.push(format!("Use fewer than {limit} words.")),
        None => told.extend(usual_length(brief)),
    }
    if rules.ends_in_task {
        told.push("The text is a navigation part, the word \"and\", and an activity part: a task on an object of the last frame.".to_owned());
    }
    told
}

/// How long the style's texts are, without the shortest and the longest tenth.
fn usual_length(brief: &Brief<'_>) -> Option<String> {
    let words = &brief.profile.words;
    let (short, long) = (words.get(words.len() / 10)?, words.get(words.len() * 9 / 10)?);
    (word_count(brief.style.references.first()?) > 0)
        .then(|| format!("The reference texts have {short} to {long} words; write about as many as this way needs."))
}
