//! Computes the values that fill the writing prompt: the parts of the walk, the target, references, constraints.

use super::{corrections::refusal_reasons, detail::PromptDetail, walk_parts::walk_parts};
use crate::writer::WritingBrief;
use minijinja::{Value, context};
use rand::seq::index;
use std::collections::BTreeSet;
use wayword_core::{ObjectDistinction, PathTarget, Side, seeded_rng};
use wayword_language::{Language, languages::NameSense, lexicon::names_agree, text::word_count};

/// The variables of the template `write.j2`.
pub(super) fn writing_context(brief: &WritingBrief<'_>, detail: PromptDetail) -> Value {
    let walk = brief.walk;
    let pictured: Vec<String> = brief.pictures.iter().map(|picture| format!("Frame {}", picture.frame)).collect();
    let complaints = brief.complaints.iter();
    let complaints: Vec<Value> = complaints
        .map(|complaint| context! { text => complaint.text, reasons => refusal_reasons(brief, complaint) })
        .collect();
    context! {
        last_frame => walk.path.frames.len().saturating_sub(1),
        parts => walk_parts(brief, detail),
        pictured,
        complaints,
        knows_motion => walk.path.motion.is_known(),
        references => shown_references(brief, detail),
        target => walk.path.target.as_ref().filter(|_| ends_in_task(brief)).map(|target| target_line(brief, target)),
        constraints => style_constraints(brief),
        earlier => brief.earlier,
        language => language_words(brief),
        own_names => own_names(brief),
    }
}

/// The language to write in, as a model knows it; nothing for English.
fn language_words(brief: &WritingBrief<'_>) -> Option<&'static str> {
    let tag = brief.profile.language.as_ref()?.tag();
    Some(if tag == "zh" { "Simplified Chinese" } else { Language::from_tag(tag).foreign_name()? })
}

/// Most names that a prompt gives in the language to write in.
const MAX_OWN_NAMES: usize = 60;

/// The rooms and things of the walk in the language to write in, as "sofa 沙发".
fn own_names(brief: &WritingBrief<'_>) -> Vec<String> {
    let Some(language) = &brief.profile.language else { return Vec::new() };
    let memory = brief.memory;
    let rooms = memory.stays.iter().map(|stay| (stay.room.as_str(), NameSense::Room));
    let things = memory.things.iter().map(|thing| thing.name.as_str());
    let target = brief.walk.path.target.iter().map(|target| target.name.as_str());
    let things = things.chain(target).map(|thing| (thing, NameSense::Thing));
    let own = |(name, sense): (&str, NameSense)| Some(format!("{name} {}", language.usual_name(name, sense)?));
    let names: BTreeSet<String> = rooms.chain(things).filter_map(own).collect();
    names.into_iter().take(MAX_OWN_NAMES).collect()
}

/// The references that a prompt shows: all of them, or some that are drawn by the seed.
fn shown_references<'a>(brief: &WritingBrief<'a>, detail: PromptDetail) -> Vec<&'a str> {
    let all = &brief.style.references;
    let shown = all.len().min(detail.max_references());
    let mut chosen = match shown == all.len() {
        true => (0..shown).collect(),
        false => index::sample(&mut seeded_rng(brief.seed, &["shown references", &brief.style.name]), all.len(), shown)
            .into_vec(),
    };
    chosen.sort_unstable();
    chosen.into_iter().filter_map(|at| all.get(at)).map(String::as_str).collect()
}

/// Whether the style's texts end in a task: by its rule, or because most of its references do. In other styles a target
/// is an object like any other.
fn ends_in_task(brief: &WritingBrief<'_>) -> bool {
    brief.style.constraints.ends_in_task || brief.profile.tasks >= 0.5
}

/// The target in words: a description that fits no other object, and where it is at the end.
fn target_line(brief: &WritingBrief<'_>, target: &PathTarget) -> String {
    let by =
        |facts: &[ObjectDistinction]| facts.iter().map(ObjectDistinction::to_predicate).collect::<Vec<_>>().join(", ");
    let mut line = target.name.clone();
    match target.descriptions.first() {
        Some(description) if description.leaves == 1 && description.by.is_empty() => {}
        Some(description) if description.leaves == 1 => {
            line += &format!(", to be told from others: {}", by(&description.by));
        }
        Some(description) if description.by.is_empty() => {
            line += " (others in the building are called so too, so lead the reader to its place)";
        }
        Some(description) => {
            line += &format!(
                ", {} (others in the building fit this too, so lead the reader to its place)",
                by(&description.by)
            );
        }
        None if target.has_namesake && !target.told_by.is_empty() => {
            line += &format!(" (others like it are visible; it is {})", by(&target.told_by));
        }
        None => {}
    }
    line += &target_spot(brief, target);
    if !brief.memory.things.iter().any(|thing| names_agree(&thing.name, &target.name)) {
        line += " (nobody described it: name it by this word, and say nothing else of its looks)";
    }
    line
}

/// Where the target is for somebody who arrives at the last frame, where that is known.
fn target_spot(brief: &WritingBrief<'_>, target: &PathTarget) -> String {
    let (memory, last) = (brief.known, brief.known.frame_count().saturating_sub(1));
    let thing = memory.things.iter().find(|thing| thing.object.as_ref() == Some(&target.object));
    let far_m = thing.and_then(|thing| memory.distance_m(thing, last));
    let side = thing.and_then(|thing| memory.side_at(thing, last)).filter(|_| brief.walk.path.motion.is_known());
    let side = side.map(|side| match side {
        Side::Ahead => "ahead",
        Side::Left => "on the left",
        Side::Right => "on the right",
        Side::Behind => "behind",
    });
    match (side, far_m) {
        (Some(side), Some(far_m)) => format!("; on arrival {side}, {far_m:.1} metres away"),
        _ => String::new(),
    }
}

/// The style's rules in words. The sentence on fine-grained texts and the shape of coarse ones follow the paper (arXiv
/// 2403.11487).
fn style_constraints(brief: &WritingBrief<'_>) -> Vec<String> {
    let (rules, mut sentences) = (&brief.style.constraints, Vec::new());
    if brief.profile.tells_turns() {
        sentences.push("Reaching the goal counts: not every frame has to be used.".to_owned());
    }
    if let Some(least) = rules.min_sentences {
        sentences.push(format!("Write {least} sentences or more."));
    }
    match rules.max_sentences {
        Some(1) => sentences.push("Write a single sentence.".to_owned()),
        Some(most) => sentences.push(format!("Write at most {most} sentences.")),
        None => {}
    }
    match rules.fewer_words_than {
        Some(limit) => sentences.push(format!("Use fewer than {limit} words.")),
        None => sentences.extend(usual_length(brief)),
    }
    if rules.ends_in_task {
        let object =
            if brief.walk.path.target.is_some() { "that object" } else { "a thing that is seen from the last frame" };
        sentences.push(format!(
            "The text is a navigation part, the word \"and\", and an activity part: a task on {object}."
        ));
    }
    sentences
}

/// How long the style's texts are, without the shortest and the longest tenth.
fn usual_length(brief: &WritingBrief<'_>) -> Option<String> {
    let words = &brief.profile.words;
    let (short, long) = (words.get(words.len() / 10)?, words.get(words.len() * 9 / 10)?);
    (word_count(brief.style.references.first()?) > 0)
        .then(|| format!("The reference texts have {short} to {long} words; write about as many as this way needs."))
}
