//! The writer that works by rules, which follow what a style's references are like.

use super::{
    Brief, WriteError, Writer,
    landmarks::Landmarks,
    phrases::{self, fill, level_phrase, ordinal, pick, the, unbent},
    route::{Step, Weighed, last_climb, stands_still, steps, usable_room},
    task,
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Climb, Motion, rng};
use wayword_language::{
    lexicon::room_name,
    text::{capital, word_count},
};

/// Writes from captions and moves. Where the references name turns, it describes the way step by step; where they
/// don't, it names the place at the end. Length, sentences, storeys, task and full stop are drawn from the references
/// too.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesWriter;

impl Writer for RulesWriter {
    fn name(&self) -> &str {
        "rules"
    }

    fn write(&self, brief: &Brief<'_>) -> Result<String, WriteError> {
        let (attempt, candidate) = (brief.complaints.len().to_string(), brief.candidate.to_string());
        let mut rng = rng(brief.seed, &["rules", &brief.style.name, &brief.walk.path.id, &attempt, &candidate]);
        if brief.profile.tells_turns() { the_way(brief, &mut rng) } else { the_place(brief, &mut rng) }
    }
}

/// Whether this text ends in a task.
fn ends_in_task(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> bool {
    brief.style.constraints.ends_in_task || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0))
}

fn drawn(values: &[usize], rng: &mut ChaCha8Rng) -> usize {
    if values.is_empty() { 1 } else { values[rng.random_range(0..values.len())] }
}

/// A text that describes the way step by step.
fn the_way(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<String, WriteError> {
    let mut landmarks = Landmarks::new(brief);
    let task = if ends_in_task(brief, rng) { Some(task::task(brief, rng)?) } else { None };
    if let Some((_, name)) = &task {
        landmarks.reserve(name);
    }
    let steps = steps(brief.walk, &mut landmarks, rng);
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let mut phrases = in_words(&steps, brief.walk.path.motion, rng);
    if let Some((task, _)) = task {
        phrases.pop();
        phrases.push(Phrase { text: task, weight: KEPT });
    }
    keep_within(&mut phrases, drawn(&brief.profile.words, rng).max(LEAST_WORDS));
    let count = sentence_target(brief, rng);
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    loop {
        let texts: Vec<String> = phrases.iter().map(|phrase| phrase.text.clone()).collect();
        let text = sentences(&texts, count, full_stop, &mut rng.clone());
        if word_count(&text) < limit || !drop_least(&mut phrases, KEPT) {
            return Ok(text);
        }
    }
}

fn sentence_target(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> usize {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    drawn(&brief.profile.sentences, rng).clamp(least, constraints.max_sentences.unwrap_or(usize::MAX).max(least))
}

/// A step in words, with how much it matters.
struct Phrase {
    text: String,
    weight: u8,
}

/// Weight of what is never left out: the end.
const KEPT: u8 = 4;
/// Steps of less weight than this are left out of a text that is longer than its style's.
const OPTIONAL: u8 = 3;
/// No text is cut shorter than this, words.
const LEAST_WORDS: usize = 8;

/// Leaves out the steps that matter least until the rest has about that many words. Turns are kept.
fn keep_within(phrases: &mut Vec<Phrase>, words: usize) {
    while phrases.iter().map(|phrase| word_count(&phrase.text) + 1).sum::<usize>() > words + 1
        && drop_least(phrases, OPTIONAL)
    {}
}

/// Leaves out the step that matters least, if one matters less than `below`.
fn drop_least(phrases: &mut Vec<Phrase>, below: u8) -> bool {
    let candidates = phrases.iter().enumerate().filter(|(_, phrase)| phrase.weight < below);
    let Some((at, _)) = candidates.min_by_key(|(at, phrase)| (phrase.weight, *at)) else { return false };
    phrases.remove(at);
    true
}

fn in_words(steps: &[Weighed], motion: Motion, rng: &mut ChaCha8Rng) -> Vec<Phrase> {
    let mut told_room: Option<String> = None;
    let mut last_turn = None;
    let phrase = |Weighed { step, weight }: &Weighed| {
        let bare_side = match step {
            Step::Turn { turn, at: None, into: None, within: None } => turn.side(),
            _ => None,
        };
        let text = match bare_side.filter(|side| last_turn == Some(*side)) {
            Some(side) => phrases::turn_again(side, rng),
            None => phrases::phrase(step, told_room.as_deref(), motion, rng),
        };
        last_turn = match step {
            Step::Turn { turn, .. } => turn.side(),
            Step::On => last_turn,
            _ => None,
        };
        match step {
            Step::Room { to: room, .. } | Step::Along { room } | Step::Turn { into: Some(room), .. } => {
                told_room = Some(room.clone());
            }
            _ => {}
        }
        Phrase { text, weight: if matches!(step, Step::Stop { .. }) { KEPT } else { *weight } }
    };
    steps.iter().map(phrase).collect()
}

const GO: &[&str] = &[
    "go to {r}",
    "head to {r}",
    "walk to {r}",
    "enter {r}",
    "make your way to {r}",
    "go into {r}",
    "proceed to {r}",
    "head over to {r}",
    "go over to {r}",
    "walk into {r}",
    "head into {r}",
    "move to {r}",
    "come to {r}",
    "walk over to {r}",
    "step into {r}",
    "go on to {r}",
];
const GO_BY: &[&str] = &[
    "go past {l} to {r}",
    "walk past {l} into {r}",
    "head past {l} to {r}",
    "pass {l} to enter {r}",
    "go by {l} into {r}",
];

/// A text that names the place at the end, and what to do there.
fn the_place(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<String, WriteError> {
    let mut landmarks = Landmarks::new(brief);
    let task = if ends_in_task(brief, rng) { Some(task::task(brief, rng)?) } else { None };
    if let Some((_, name)) = &task {
        landmarks.reserve(name);
    }
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let words = drawn(&brief.profile.words, rng).min(limit.saturating_sub(1));
    let task_words = task.as_ref().map_or(0, |(task, _)| word_count(task) + 1);
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    let fits = |text: &str| word_count(text) + task_words <= words.max(task_words + 5).min(limit.saturating_sub(1));
    let options = goals(brief, &mut landmarks, rng);
    // The richest description that fits. The first is the barest, and is used where none fits.
    let goal = options.iter().rev().find(|text| fits(text)).or(options.first()).cloned().unwrap_or_default();
    let count = sentence_target(brief, rng);
    let phrases: Vec<String> = match task {
        Some((task, _)) => vec![goal, task],
        None => vec![goal],
    };
    Ok(if count > 1 {
        sentences(&phrases, count, full_stop, rng)
    } else {
        let text = if phrases.len() > 1 && rng.random_bool(0.8) { phrases.join(" and ") } else { join(&phrases, rng) };
        format!("{}{}", capital(&text), if full_stop { "." } else { "" })
    })
}

/// Ways to name the end of the walk, from the barest to the richest.
fn goals(brief: &Brief<'_>, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> Vec<String> {
    let walk = brief.walk;
    let last = walk.path.frames.len() - 1;
    let room = walk.room(last).and_then(usable_room);
    if stands_still(walk) {
        return vec![phrases::stay_phrase(room.as_deref(), rng)];
    }
    let Some(room) = room else { return vec![without_room(brief, landmarks, rng)] };
    let go = pick(rng, GO);
    let mut options = vec![fill(go, &[("{r}", &the(&room))])];
    let level = walk.path.frames[last].level.filter(|_| rng.random_bool(brief.profile.floors.clamp(0.0, 1.0)));
    let placed = level.map_or_else(|| the(&room), |level| on_level(&room, level, rng));
    options.push(fill(go, &[("{r}", &placed)]));
    let before = (0..last).rev().filter_map(|at| walk.room(at)).find(|other| room_name(other) != room_name(&room));
    let detail = match rng.random_range(0..10) {
        0..=2 => landmarks
            .choose(last, 2, rng)
            .map(|landmark| fill(go, &[("{r}", &format!("{placed} with {}", landmark.phrase))])),
        3..=4 => before.map(|other| {
            fill(
                go,
                &[(
                    "{r}",
                    &format!("{placed} {} {}", pick(rng, &["next to", "by", "off", "near", "beyond"]), the(other)),
                )],
            )
        }),
        5..=6 => {
            let frame = rng.random_range(0..last.max(1));
            landmarks
                .choose(frame, 2, rng)
                .map(|landmark| fill(pick(rng, GO_BY), &[("{l}", &landmark.phrase), ("{r}", &placed)]))
        }
        _ => None,
    };
    options.extend(detail);
    options
}

fn on_level(room: &str, level: u32, rng: &mut ChaCha8Rng) -> String {
    match (rng.random_range(0..4), ordinal(level)) {
        (0, Some(ordinal)) => format!("the {ordinal} floor {room}"),
        (1, _) => format!("the level {level} {room}"),
        _ => format!("the {room} on {}", level_phrase(level, rng)),
    }
}

/// The way to an end whose room has no name.
fn without_room(brief: &Brief<'_>, landmarks: &mut Landmarks<'_>, rng: &mut ChaCha8Rng) -> String {
    let walk = brief.walk;
    let last = walk.path.frames.len() - 1;
    match last_climb(walk) {
        Some(Climb::Up) => {
            return pick(rng, &["go upstairs", "head up the stairs", "walk up the stairs", "climb the stairs"])
                .to_owned();
        }
        Some(Climb::Down) => {
            return pick(rng, &["go downstairs", "head down the stairs", "walk down the stairs"]).to_owned();
        }
        Some(Climb::Level) | None => {}
    }
    let by = (0..=last).rev().find_map(|frame| landmarks.choose(frame, 2, rng));
    let through = (0..last).rev().find_map(|at| walk.room(at).and_then(usable_room));
    match (by, through) {
        (Some(landmark), _) => fill(
            pick(rng, &["go to {l}", "walk up to {l}", "head over to {l}", "go past {l}"]),
            &[("{l}", &landmark.phrase)],
        ),
        (None, Some(room)) => {
            fill(pick(rng, &["go through {r}", "walk through {r}", "leave {r}"]), &[("{r}", &the(&room))])
        }
        (None, None) => {
            pick(rng, &unbent(&["go straight ahead", "walk on to the end", "keep going"], walk.path.motion)).to_owned()
        }
    }
}

/// Phrases as sentences, shared out evenly, in their order.
fn sentences(phrases: &[String], count: usize, full_stop: bool, rng: &mut ChaCha8Rng) -> String {
    let count = count.clamp(1, phrases.len().max(1));
    let bounds: Vec<usize> = (0..=count).map(|at| at * phrases.len() / count).collect();
    let parts: Vec<String> = bounds.windows(2).map(|pair| capital(&join(&phrases[pair[0]..pair[1]], rng))).collect();
    let mut text = parts.join(". ");
    if full_stop || count > 1 {
        text.push('.');
    }
    text
}

/// Phrases as one sentence without its full stop. Where a phrase has an "and" of its own, "then" joins them.
fn join(phrases: &[String], rng: &mut ChaCha8Rng) -> String {
    let Some((last, before)) = phrases.split_last() else { return String::new() };
    if before.is_empty() {
        return last.clone();
    }
    let has_and = phrases.iter().any(|phrase| phrase.contains(" and "));
    let link = if has_and {
        pick(rng, &[", then ", ", and then "])
    } else {
        pick(rng, &[" and ", ", then ", " and then ", " and "])
    };
    format!("{}{link}{last}", before.join(", "))
}
