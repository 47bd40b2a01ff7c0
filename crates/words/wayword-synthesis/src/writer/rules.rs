//! The writer that works by rules, which follow what a style's references are like.

use super::{
    Brief, WriteError, Writer,
    landmarks::Landmarks,
    phrases::{self, pick},
    place::the_place,
    route::{Step, Weighed, steps},
    task,
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Motion, rng};
use wayword_language::text::{capital, word_count};

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
pub(super) fn ends_in_task(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> bool {
    brief.style.constraints.ends_in_task || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0))
}

pub(super) fn drawn(values: &[usize], rng: &mut ChaCha8Rng) -> usize {
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

pub(super) fn sentence_target(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> usize {
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

/// Phrases as sentences, shared out evenly, in their order.
pub(super) fn sentences(phrases: &[String], count: usize, full_stop: bool, rng: &mut ChaCha8Rng) -> String {
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
pub(super) fn join(phrases: &[String], rng: &mut ChaCha8Rng) -> String {
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
