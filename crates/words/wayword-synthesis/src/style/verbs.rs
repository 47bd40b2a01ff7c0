//! Collects the verbs that reference texts use for tasks on things ("turn on {o}"), by kind of thing.

use super::wording::{VERB_TABLE_PREFIX, WordingCounts, verbs_of_class, verbs_of_kind};
use std::collections::BTreeSet;
use wayword_language::{
    lexicon::{find_thing, kinds_of},
    reading::{
        EventContent, TextReading, read_instruction,
        vocabulary::{DETERMINERS, WALKING},
    },
};

/// A verb is used if the references have it at least this often for one kind of thing.
const MIN_VERB_USES: f64 = 3.0;
/// Words that may stand between a verb and its object.
const TASK_PARTICLES: [&str; 14] =
    ["me", "on", "off", "up", "down", "out", "in", "away", "over", "at", "into", "inside", "under", "back"];
/// A verb for a whole class of things also needs this share of the tasks on the class.
const MIN_CLASS_SHARE: f64 = 0.01;

/// Counts the verb of a text's task, with `{o}` in place of the object.
pub(super) fn count_verb(words: &[String], reading: &TextReading, counts: &mut WordingCounts) {
    let Some(task) = &reading.task else { return };
    let Some(EventContent::Place(place)) = task.object.map(|at| &reading.events[at].what) else { return };
    let Some(kind) = find_thing(&place.name) else { return };
    let Some(at) = words.iter().rposition(|word| *word == task.verb) else { return };
    let Some(end) =
        (at + 1..words.len().min(at + 5)).find(|at| DETERMINERS.contains(&words[*at].as_str()) && words[*at] != "that")
    else {
        return;
    };
    let verb_words = &words[at..end];
    let is_plain = verb_words.len() <= 3
        && verb_words[0].len() > 1
        && verb_words[0].chars().all(char::is_alphabetic)
        && verb_words[1..].iter().all(|word| TASK_PARTICLES.contains(&word.as_str()));
    if !is_plain
        || WALKING.contains(&task.verb.as_str())
            && !matches!(
                task.verb.as_str(),
                "get" | "bring" | "pick" | "take" | "turn" | "pull" | "move" | "make" | "sit" | "push"
            )
    {
        return;
    }
    // "Turn the light on": the particle comes after the object.
    let noun = place.name.rsplit(' ').next().unwrap_or_default();
    let behind = words[end..].iter().position(|word| word == noun).map(|noun| end + noun + 1);
    let particle = behind.and_then(|at| Some((words.get(at)?, words.get(at + 1))));
    let mut key = format!("{} {{o}}", verb_words.join(" "));
    if let Some((particle @ ("on" | "off" | "out" | "up" | "down"), next)) =
        particle.map(|(word, next)| (word.as_str(), next))
    {
        let is_last = next.is_none_or(|next| matches!(next.as_str(), "in" | "and" | "from"));
        if is_last && verb_words.len() == 1 {
            key = format!("{key} {particle}");
        }
    }
    kinds_of(kind.name).iter().for_each(|kind| counts.add(&verbs_of_kind(kind), &key));
    counts.add(&verbs_of_class(kind.class), &key);
}

/// Keeps the verbs that several references use and that our own reader recognises as a task.
pub(super) fn retain_common_verbs(counts: &mut WordingCounts) {
    for (table, verbs) in &mut counts.0 {
        let Some(owner) = table.strip_prefix(VERB_TABLE_PREFIX) else { continue };
        let all: f64 = verbs.values().sum();
        let least =
            if owner.starts_with("class ") { (all * MIN_CLASS_SHARE).max(MIN_VERB_USES) } else { MIN_VERB_USES };
        let object = if owner.starts_with("class ") { "lamp" } else { owner };
        verbs.retain(|verb, count| *count >= least && is_read(verb, object));
    }
}

/// Whether our reader recognises a verb as a task and understands all of the sentence.
fn is_read(verb: &str, object: &str) -> bool {
    let text = format!("Go to the kitchen and {}", verb.replace("{o}", &format!("the {object}")));
    let reading = read_instruction(&text, &BTreeSet::new());
    let has_object = reading.task.as_ref().is_some_and(|task| task.object.is_some());
    has_object && reading.clauses.iter().all(|clause| clause.understood || clause.span[0] == clause.span[1])
}
