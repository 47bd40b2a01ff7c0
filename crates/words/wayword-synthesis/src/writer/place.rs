//! A text that names the place at the end, and what to do there.
//!
//! Several drafts are drawn with the shares of the style's wording. The one is chosen that identifies the object,
//! copies no reference, and comes nearest to a length drawn from the references.

mod room;

pub(super) use room::RoomContent;

use super::{
    WriteError, WritingBrief,
    dice::TextDice,
    landmarks::LandmarkChooser,
    object::TaskObject,
    phrases::{self, draw_measure, fill_gaps, phrases_for_motion, pick_any, with_the},
    route::{last_climb, stands_still, usable_room},
    task::{TaskContent, draw_task, task_words},
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use room::GoalRoom;
use wayword_checks::TextTopic;
use wayword_core::ClimbDirection;
use wayword_language::text::{capitalise_first, split_tokens, word_count};

/// Number of drafts for each plan.
const DRAFTS_PER_PLAN: usize = 30;
/// Most plans that are drawn; of all their drafts the best is taken, even if it has a fault.
const MAX_PLANS: usize = 4;
/// Cost of a fault that no text should have (a copied phrase, too many words), in words of length difference.
const NEVER_FAULT_WORDS: f64 = 1000.0;
/// Cost of a run of words that a draft shares with a reference, in words of length difference.
const AVOIDED_FAULT_WORDS: f64 = 100.0;

/// What a text tells that names the place at the end.
#[derive(Clone)]
pub(super) struct PlaceContent {
    pub(super) goal: GoalContent,
    /// What to do there.
    pub(super) task: Option<TaskContent>,
    /// Whether it begins with "please".
    pub(super) please: bool,
}

/// Where a text sends the walker, in English names.
#[derive(Clone)]
pub(super) enum GoalContent {
    Room(RoomContent),
    /// It has to stay, in this room where it is known.
    Stay(Option<String>),
    Climb(ClimbDirection),
    Thing(String),
    /// Through a room, without a goal.
    Through(String),
    Onward,
}

/// A text that names the place at the end, and what to do there; in words, and what they say.
pub(super) fn write_place_text(brief: &WritingBrief<'_>, dice: TextDice) -> Result<(String, PlaceContent), WriteError> {
    let rng = &mut dice.named_rng(&["place"]);
    let walk = brief.walk;
    let last = walk.path.frames.len() - 1;
    // A target is meant for a task, so the text has one if the style has any.
    let asks = brief.style.constraints.ends_in_task
        || brief.profile.tasks >= 0.5 && walk.path.target.is_some()
        || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0));
    let Some(room) = walk.room_at(last).filter(|_| asks && !stands_still(walk)) else {
        return bare_text(brief, asks, dice);
    };
    let rooms = [room.to_owned()];
    let object = TaskObject::for_brief(brief, rng)?;
    let goal = GoalRoom::new(brief, room);
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let words = brief.shorter_length().min(limit.saturating_sub(1));
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    let topic = TextTopic { target: Some(&object.name), rooms: &rooms };
    let copies = &brief.profile.copies;
    let mut best: Option<(f64, (String, PlaceContent))> = None;
    // If every draft shares a run of words with a reference, a new plan is drawn.
    for _ in 0..MAX_PLANS {
        let plan = PlaceTextPlan::draw_plan(brief, &goal, words, rng);
        for _ in 0..DRAFTS_PER_PLAN {
            let (text, content) = draft_text(brief, &goal, &object, plan, rng);
            let (count, tokens) = (word_count(&text), split_tokens(&text));
            let copied_cost = if copies.find_copy(&tokens, topic).is_some() { NEVER_FAULT_WORDS } else { 0.0 };
            let shared_cost = if copies.find_avoidable_copy(&tokens).is_some() { AVOIDED_FAULT_WORDS } else { 0.0 };
            let over_limit_cost = if count < limit { 0.0 } else { NEVER_FAULT_WORDS };
            let fault = count.abs_diff(words) as f64 + copied_cost + shared_cost + over_limit_cost;
            if best.as_ref().is_none_or(|(least, _)| fault < *least) {
                best = Some((fault, (text, content)));
            }
        }
        if best.as_ref().is_some_and(|(fault, _)| *fault < AVOIDED_FAULT_WORDS) {
            break;
        }
    }
    let Some((_, (text, content))) = best else { return bare_text(brief, asks, dice) };
    Ok((format!("{}{}", capitalise_first(&text), if full_stop { "." } else { "" }), content))
}

/// Decisions that are drawn before the drafts, so that the choice among drafts does not change the style's shares.
#[derive(Clone, Copy)]
struct PlaceTextPlan<'a> {
    /// "move" (go to the room and do the task), "task" (do the task in the room) or "in" (in the room, do the task).
    order: &'a str,
    /// The words before the room: "go to".
    opener: &'a str,
    /// Whether the storey of the room is named.
    names_level: bool,
    /// Whether the description has to fit no other object.
    is_sure: bool,
    /// Number of properties beyond the necessary ones, for a longer text.
    more: usize,
    /// Whether the text begins with "please".
    please: bool,
}

/// A text with fewer words than this need not single its target out.
const SHORT_TEXT_WORDS: usize = 8;
/// Lengths, words, from which on a text has one, two or three properties more than necessary.
const LONG_TEXT_WORDS: [usize; 3] = [16, 20, 25];

impl<'a> PlaceTextPlan<'a> {
    /// Draws the plan of a text of so many words.
    fn draw_plan(brief: &'a WritingBrief<'_>, goal: &GoalRoom<'a>, words: usize, rng: &mut ChaCha8Rng) -> Self {
        let wording = &brief.profile.wording;
        Self {
            order: wording.draw_sharply("order", rng, |_| true).unwrap_or("move"),
            opener: goal.draw_opener(rng),
            names_level: goal.names_level(rng) || words >= LONG_TEXT_WORDS[2] && goal.is_one_of_several(),
            is_sure: words >= SHORT_TEXT_WORDS && rng.random_bool(wording.sure_share()),
            more: LONG_TEXT_WORDS.iter().filter(|long| words >= **long).count(),
            please: rng.random_bool(wording.share_of_texts("please")),
        }
    }
}

/// A draft of the text, in lower case and without a full stop.
fn draft_text(
    brief: &WritingBrief<'_>,
    goal: &GoalRoom<'_>,
    object: &TaskObject<'_>,
    plan: PlaceTextPlan<'_>,
    rng: &mut ChaCha8Rng,
) -> (String, PlaceContent) {
    let wording = &brief.profile.wording;
    let by = object.draw_description(wording, plan.is_sure, plan.more, rng);
    let (place, room) = goal.room_phrase(&by, plan.names_level, rng);
    let verb = wording.draw_verb(&object.name, wording.sharp_power(), rng);
    let (phrase, object) = object.object_phrase(&by, wording, rng);
    let task = task_words(verb, &phrase);
    let text = match plan.order {
        "task" => format!("{task} {} {place}", goal.draw_preposition(verb, rng)),
        "in" => format!("{} {place} {task}", goal.draw_preposition("", rng)),
        _ => format!("{} {place} and {task}", plan.opener),
    };
    let task = TaskContent { verb: verb.to_owned(), object };
    let content = PlaceContent { goal: GoalContent::Room(room), task: Some(task), please: plan.please };
    (if plan.please { format!("please {text}") } else { text }, content)
}

/// A text without a task, or for an end without a known room.
fn bare_text(brief: &WritingBrief<'_>, asks: bool, dice: TextDice) -> Result<(String, PlaceContent), WriteError> {
    let rng = &mut dice.named_rng(&["place"]);
    let mut landmarks = LandmarkChooser::new(brief, dice);
    let task = if asks { Some(draw_task(brief, rng)?) } else { None };
    if let Some(task) = &task {
        landmarks.reserve_name(&task.name);
    }
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    let walk = brief.walk;
    let room = walk.room_at(walk.path.frames.len() - 1).and_then(usable_room);
    let (words, goal) = match &room {
        _ if stands_still(walk) => (phrases::stay_phrase(room.as_deref(), rng), GoalContent::Stay(room)),
        Some(room) => {
            let goal = GoalRoom::new(brief, room);
            let names_level = goal.names_level(rng);
            let opener = goal.draw_opener(rng);
            let (place, content) = goal.room_phrase(&[], names_level, rng);
            (format!("{opener} {place}"), GoalContent::Room(content))
        }
        None => without_room(brief, &landmarks, rng),
    };
    let (task, task_content) = task.map(|task| (task.text, task.content)).unzip();
    let content = PlaceContent { goal, task: task_content, please: false };
    let phrases: Vec<String> = [words].into_iter().chain(task).collect();
    let count = sentence_target(brief, rng);
    if count > 1 {
        return Ok((join_sentences(&phrases, count, full_stop, rng), content));
    }
    let text = if phrases.len() > 1 { phrases.join(" and ") } else { join_phrases(&phrases, rng) };
    Ok((format!("{}{}", capitalise_first(&text), if full_stop { "." } else { "" }), content))
}

/// The way to an end without a known room; in words, and what they say.
fn without_room(
    brief: &WritingBrief<'_>,
    landmarks: &LandmarkChooser<'_>,
    rng: &mut ChaCha8Rng,
) -> (String, GoalContent) {
    let walk = brief.walk;
    let last = walk.path.frames.len() - 1;
    if let Some(climb @ (ClimbDirection::Up | ClimbDirection::Down)) = last_climb(walk) {
        let ways: &[&str] = match climb {
            ClimbDirection::Up => &["go upstairs", "head up the stairs", "walk up the stairs", "climb the stairs"],
            _ => &["go downstairs", "head down the stairs", "walk down the stairs"],
        };
        return (pick_any(rng, ways).to_owned(), GoalContent::Climb(climb));
    }
    let by = (0..=last).rev().find_map(|frame| landmarks.choose_for_frame(frame, 2));
    let through = (0..last).rev().find_map(|at| walk.room_at(at).and_then(usable_room));
    match (by, through) {
        (Some(landmark), _) => {
            let way = pick_any(rng, &["go to {l}", "walk up to {l}", "head over to {l}", "go past {l}"]);
            (fill_gaps(way, &[("{l}", &landmark.phrase)]), GoalContent::Thing(landmark.name))
        }
        (None, Some(room)) => {
            let way = pick_any(rng, &["go through {r}", "walk through {r}", "leave {r}"]);
            (fill_gaps(way, &[("{r}", &with_the(&room))]), GoalContent::Through(room))
        }
        (None, None) => {
            let ways = phrases_for_motion(&["go straight ahead", "walk on to the end", "keep going"], walk.path.motion);
            (pick_any(rng, &ways).to_owned(), GoalContent::Onward)
        }
    }
}

/// How many sentences the text should have: drawn from the references, within the rules of the style.
fn sentence_target(brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> usize {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    draw_measure(&brief.profile.sentences, rng).clamp(least, constraints.max_sentences.unwrap_or(usize::MAX).max(least))
}

/// Distributes phrases evenly over sentences, in their order.
fn join_sentences(phrases: &[String], count: usize, full_stop: bool, rng: &mut ChaCha8Rng) -> String {
    let count = count.clamp(1, phrases.len().max(1));
    let bounds: Vec<usize> = (0..=count).map(|at| at * phrases.len() / count).collect();
    let parts: Vec<String> =
        bounds.windows(2).map(|pair| capitalise_first(&join_phrases(&phrases[pair[0]..pair[1]], rng))).collect();
    let mut text = parts.join(". ");
    if full_stop || count > 1 {
        text.push('.');
    }
    text
}

/// Joins phrases into one sentence without its full stop. If a phrase contains "and", they are joined by "then".
fn join_phrases(phrases: &[String], rng: &mut ChaCha8Rng) -> String {
    let Some((last, before)) = phrases.split_last() else { return String::new() };
    if before.is_empty() {
        return last.clone();
    }
    let has_and = phrases.iter().any(|phrase| phrase.contains(" and "));
    let link = if has_and {
        pick_any(rng, &[", then ", ", and then "])
    } else {
        pick_any(rng, &[" and ", ", then ", " and then ", " and "])
    };
    format!("{}{link}{last}", before.join(", "))
}
