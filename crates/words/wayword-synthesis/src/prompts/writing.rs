//! Computes the values that fill the writing prompt: frames, moves, references, constraints.

use super::{
    corrections::refusal_reasons,
    memory_lines::remembered_lines,
    move_words::{move_words, way_overview},
};
use crate::{walk::ObservedWalk, writer::WritingBrief};
use minijinja::{Value, context};
use rand::seq::index;
use wayword_core::{PathTarget, Side, seeded_rng};
use wayword_language::{lexicon::names_agree, text::word_count};

/// Most reference texts of a prompt. A style may have thousands, and more examples do not make a text more alike.
const MAX_SHOWN_REFERENCES: usize = 24;
/// Most landmarks that the prompt lists for a frame; further ones are left out.
const MAX_FRAME_LANDMARKS: usize = 8;

/// The variables of the template `write.j2`.
pub(super) fn writing_context(brief: &WritingBrief<'_>) -> Value {
    let walk = brief.walk;
    let frames: Vec<Value> = walk
        .observations
        .iter()
        .enumerate()
        .map(|(at, observation)| {
            let caption = observation.summary.trim_end_matches('.');
            context! { caption, landmarks => frame_landmarks(walk, at), move => walk.moves.get(at).map(move_words) }
        })
        .collect();
    let pictured: Vec<String> = brief.pictures.iter().map(|picture| format!("Frame {}", picture.frame)).collect();
    let complaints = brief.complaints.iter();
    let complaints: Vec<Value> = complaints
        .map(|complaint| context! { text => complaint.text, reasons => refusal_reasons(brief, complaint) })
        .collect();
    context! {
        frames,
        pictured,
        complaints,
        overview => way_overview(&walk.moves),
        remembered => remembered_lines(brief.memory),
        knows_motion => walk.path.motion.is_known(),
        references => shown_references(brief),
        target => walk.path.target.as_ref().filter(|_| ends_in_task(brief)).map(|target| target_line(walk, target)),
        constraints => style_constraints(brief),
        earlier => brief.earlier,
    }
}

/// The references that a prompt shows: all of them, or some that are drawn by the seed.
fn shown_references<'a>(brief: &WritingBrief<'a>) -> Vec<&'a str> {
    let all = &brief.style.references;
    let shown = all.len().min(MAX_SHOWN_REFERENCES);
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

/// The things of a frame that a text may name, each once, with its colour and side where they are known.
fn frame_landmarks(walk: &ObservedWalk, frame: usize) -> Vec<String> {
    let mut names: Vec<&str> = Vec::new();
    let mut landmarks = Vec::new();
    for seen in walk.seen_from(frame) {
        let name = seen.sighting.name.as_str();
        if landmarks.len() == MAX_FRAME_LANDMARKS || names.iter().any(|other| names_agree(other, name)) {
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
        landmarks.push(format!("{several}{colour}{name}{side}"));
    }
    landmarks
}

/// The target in words for the prompt, with a distinction where other objects of its name are in view.
fn target_line(walk: &ObservedWalk, target: &PathTarget) -> String {
    let told_by = target.told_by.first().map(|told_by| format!("it is {}", told_by.to_predicate()));
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
        sentences.push("The text is a navigation part, the word \"and\", and an activity part: a task on an object of the last frame.".to_owned());
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
