//! A text that names the place at the end, and what to do there.

use super::{
    Brief, WriteError,
    landmarks::Landmarks,
    phrases::{self, drawn, fill, level_phrase, ordinal, pick, the, unbent},
    route::{last_climb, stands_still, usable_room},
    rules::{join, sentence_target, sentences},
    telling::ending,
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::Climb;
use wayword_language::{
    lexicon::room_name,
    text::{capital, word_count},
};

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
pub(super) fn the_place(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<String, WriteError> {
    let mut landmarks = Landmarks::new(brief);
    let task = ending(brief, rng)?;
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
