//! What the writing prompt is filled with.

use crate::writer::{Brief, Complaint};
use minijinja::{Value, context};
use wayword_core::{Climb, Constraints, Distinction, Move, Side, Target, Turn, Verdict};

pub(super) fn context(brief: &Brief<'_>) -> Value {
    let walk = brief.walk;
    let frames: Vec<Value> = walk
        .observations
        .iter()
        .enumerate()
        .map(|(at, observation)| context! { caption => observation.summary.trim_end_matches('.'), move => walk.moves.get(at).map(motion) })
        .collect();
    context! {
        frames,
        knows_motion => walk.path.motion.is_known(),
        references => brief.style.references,
        target => walk.path.target.as_ref().filter(|_| ends_in_task(brief)).map(target),
        constraints => constraints(&brief.style.constraints, brief.profile.tells_turns()),
        complaints => brief.complaints.iter().map(complaint).collect::<Vec<_>>(),
    }
}

/// Whether the style's texts end in a task: by its rule, or because most of its references do. In other styles a target
/// is an object like any other.
fn ends_in_task(brief: &Brief<'_>) -> bool {
    brief.style.constraints.ends_in_task || brief.profile.tasks >= 0.5
}

/// A move in words, with its numbers.
fn motion(step: &Move) -> String {
    let deg = step.turn_rad.to_degrees().abs().round();
    let turn = match step.turn() {
        Turn::Straight => "straight on".to_owned(),
        Turn::SlightLeft => format!("turns slightly left ({deg} degrees)"),
        Turn::SlightRight => format!("turns slightly right ({deg} degrees)"),
        Turn::Left => format!("turns left ({deg} degrees)"),
        Turn::Right => format!("turns right ({deg} degrees)"),
        Turn::Around => format!("turns around ({deg} degrees)"),
    };
    let climb = match step.climb() {
        Climb::Level => String::new(),
        Climb::Up => format!(", up {:.1} metres of stairs", step.rise_m),
        Climb::Down => format!(", down {:.1} metres of stairs", -step.rise_m),
    };
    format!("{turn}, {:.1} metres{climb}", step.distance_m)
}

fn target(target: &Target) -> String {
    let told_by = target.told_by.first().map(|told_by| match told_by {
        Distinction::Colour { colour } => format!("it is {colour}"),
        Distinction::OnSide { side } => {
            let side = match side {
                Side::Ahead => "ahead",
                Side::Right => "on the right",
                Side::Behind => "behind",
                Side::Left => "on the left",
            };
            format!("it is {side} of somebody who arrives")
        }
        Distinction::NextTo { neighbour } => format!("it is next to the {neighbour}"),
        Distinction::Range { nearest: true } => "it is the nearest one".to_owned(),
        Distinction::Range { nearest: false } => "it is the farthest one".to_owned(),
    });
    match told_by.filter(|_| target.has_namesake) {
        Some(told_by) => format!("{} (others like it are visible; {told_by})", target.name),
        None => target.name.clone(),
    }
}

/// The style's rules in words. The sentence on fine-grained texts and the shape of coarse ones follow the paper (arXiv
/// 2403.11487).
fn constraints(rules: &Constraints, tells_turns: bool) -> Vec<String> {
    let mut told = Vec::new();
    if tells_turns {
        told.push("Give directions for a smart robot that starts at the same place. Reaching the goal counts: not every frame has to be used.".to_owned());
    }
    if let Some(least) = rules.min_sentences {
        told.push(format!("Write {least} sentences or more."));
    }
    match rules.max_sentences {
        Some(1) => told.push("Write a single sentence.".to_owned()),
        Some(most) => told.push(format!("Write at most {most} sentences.")),
        None => {}
    }
    if let Some(limit) = rules.fewer_words_than {
        told.push(format!("Use fewer than {limit} words."));
    }
    if rules.ends_in_task {
        told.push("The text is a navigation part, the word \"and\", and an activity part: a task on an object of the last frame.".to_owned());
    }
    told
}

fn complaint(complaint: &Complaint) -> Value {
    let failed = complaint.findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    let reasons: Vec<&str> = failed.map(|finding| finding.reason.as_str()).collect();
    context! { text => complaint.text, reasons }
}
