//! A text that names the place at the end, and what to do there.
//!
//! Several drafts are drawn with the shares of the style's wording. The one is chosen that identifies the object,
//! copies no reference, and comes nearest to a length drawn from the references.

mod room;

use super::{
    Brief, WriteError,
    dice::Dice,
    landmarks::Landmarks,
    object::Said,
    phrases::{self, drawn, fill, pick, the, unbent},
    route::{last_climb, stands_still, usable_room},
    task,
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use room::Goal;
use wayword_checks::Matter;
use wayword_core::Climb;
use wayword_language::text::{capital, word_count};

/// Number of drafts for each plan, and most plans.
const DRAFTS: usize = 30;
const PLANS: usize = 4;
/// Cost of a fault of a draft, in words of length difference.
const NEVER: f64 = 1000.0;
const RATHER_NOT: f64 = 100.0;

/// A text that names the place at the end, and what to do there.
pub(super) fn the_place(brief: &Brief<'_>, dice: Dice) -> Result<String, WriteError> {
    let rng = &mut dice.by(&["place"]);
    let walk = brief.walk;
    let last = walk.path.frames.len() - 1;
    // A target is meant for a task, so the text has one if the style has any.
    let asks = brief.style.constraints.ends_in_task
        || brief.profile.tasks >= 0.5 && walk.path.target.is_some()
        || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0));
    let Some(room) = walk.room(last).filter(|_| asks && !stands_still(walk)) else {
        return bare(brief, asks, dice);
    };
    let rooms = [room.to_owned()];
    let object = Said::of(brief, rng)?;
    let goal = Goal::new(brief, room);
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let words = brief.shorter_length().min(limit.saturating_sub(1));
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    let matter = Matter { target: Some(&object.name), rooms: &rooms };
    let copies = &brief.profile.copies;
    let mut best: Option<(f64, String)> = None;
    // If every draft shares a run of words with a reference, a new plan is drawn.
    for _ in 0..PLANS {
        let plan = Plan::draw(brief, &goal, words, rng);
        for _ in 0..DRAFTS {
            let text = draft(brief, &goal, &object, plan, rng);
            let count = word_count(&text);
            let is_copied = if copies.copied(&text, matter).is_some() { NEVER } else { 0.0 };
            let is_shared = if copies.much(&text).is_some() { RATHER_NOT } else { 0.0 };
            let too_long = if count < limit { 0.0 } else { NEVER };
            let fault = count.abs_diff(words) as f64 + is_copied + is_shared + too_long;
            if best.as_ref().is_none_or(|(least, _)| fault < *least) {
                best = Some((fault, text));
            }
        }
        if best.as_ref().is_some_and(|(fault, _)| *fault < RATHER_NOT) {
            break;
        }
    }
    let text = best.map(|(_, text)| text).unwrap_or_default();
    Ok(format!("{}{}", capital(&text), if full_stop { "." } else { "" }))
}

/// Decisions that are drawn before the drafts, so that the choice among drafts does not change the style's shares.
#[derive(Clone, Copy)]
struct Plan<'a> {
    order: &'a str,
    opener: &'a str,
    names_level: bool,
    is_sure: bool,
    /// Number of properties beyond the necessary ones, for a longer text.
    more: usize,
    please: bool,
}

/// A text with fewer words than this need not single its target out.
const SHORT: usize = 8;
/// Lengths, words, from which on a text has one, two or three properties more than necessary.
const LONG: [usize; 3] = [16, 20, 25];

impl<'a> Plan<'a> {
    fn draw(brief: &'a Brief<'_>, goal: &Goal<'a>, words: usize, rng: &mut ChaCha8Rng) -> Self {
        let wording = &brief.profile.wording;
        Self {
            order: wording.draw_sharply("order", rng, |_| true).unwrap_or("move"),
            opener: goal.opener(rng),
            names_level: goal.names_level(rng) || words >= LONG[2] && goal.is_one_of_several(),
            is_sure: words >= SHORT && rng.random_bool(wording.sure()),
            more: LONG.iter().filter(|long| words >= **long).count(),
            please: rng.random_bool(wording.share("please")),
        }
    }
}

/// A draft of the text, in lower case and without a full stop.
fn draft(brief: &Brief<'_>, goal: &Goal<'_>, object: &Said<'_>, plan: Plan<'_>, rng: &mut ChaCha8Rng) -> String {
    let wording = &brief.profile.wording;
    let by = object.description(wording, plan.is_sure, plan.more, rng);
    let place = goal.phrase(&by, plan.names_level, rng);
    let verb = wording.verb(&object.name, wording.sharp(), rng);
    let task = task::done(verb, &object.phrase(&by, wording, rng));
    let text = match plan.order {
        "task" => format!("{task} {} {place}", goal.preposition(verb, rng)),
        "in" => format!("{} {place} {task}", goal.preposition("", rng)),
        _ => format!("{} {place} and {task}", plan.opener),
    };
    if plan.please { format!("please {text}") } else { text }
}

/// A text without a task, or for an end without a known room.
fn bare(brief: &Brief<'_>, asks: bool, dice: Dice) -> Result<String, WriteError> {
    let rng = &mut dice.by(&["place"]);
    let mut landmarks = Landmarks::new(brief, dice);
    let task = if asks { Some(task::task(brief, rng)?) } else { None };
    if let Some((_, name)) = &task {
        landmarks.reserve(name);
    }
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    let walk = brief.walk;
    let room = walk.room(walk.path.frames.len() - 1).and_then(usable_room);
    let goal = match &room {
        _ if stands_still(walk) => phrases::stay_phrase(room.as_deref(), rng),
        Some(room) => {
            let goal = Goal::new(brief, room);
            let names_level = goal.names_level(rng);
            format!("{} {}", goal.opener(rng), goal.phrase(&[], names_level, rng))
        }
        None => without_room(brief, &landmarks, rng),
    };
    let phrases: Vec<String> = [goal].into_iter().chain(task.map(|(task, _)| task)).collect();
    let count = sentence_target(brief, rng);
    if count > 1 {
        return Ok(sentences(&phrases, count, full_stop, rng));
    }
    let text = if phrases.len() > 1 { phrases.join(" and ") } else { join(&phrases, rng) };
    Ok(format!("{}{}", capital(&text), if full_stop { "." } else { "" }))
}

/// The words for the way to an end without a known room.
fn without_room(brief: &Brief<'_>, landmarks: &Landmarks<'_>, rng: &mut ChaCha8Rng) -> String {
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
    let by = (0..=last).rev().find_map(|frame| landmarks.choose(frame, 2));
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

fn sentence_target(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> usize {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    drawn(&brief.profile.sentences, rng).clamp(least, constraints.max_sentences.unwrap_or(usize::MAX).max(least))
}

/// Distributes phrases evenly over sentences, in their order.
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

/// Joins phrases into one sentence without its full stop. If a phrase contains "and", they are joined by "then".
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
