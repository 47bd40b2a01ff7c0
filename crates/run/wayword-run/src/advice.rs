//! What a text lacks for a walker to arrive by it, in sentences for its writer.

use crate::follow::{FollowedPath, read_followable};
use wayword_checks::{
    CoveredDecision, DecisionTold, Evidence, WalkDecision, WalkMemory, cover_walk,
    memory::{RememberedThing, WalkBend},
};
use wayword_core::{ClimbDirection, Instruction, Side};
use wayword_follower::{
    FeatureWeights,
    doubt::{DoubtBounds, find_doubts},
};
use wayword_language::{lexicon::names_agree, rewording::TokenisedText};

/// Most sentences of each kind.
const MAX_SENTENCES: usize = 3;

/// The decisions of the walk that no words tell, the words that would fit the walk better, and how many other ends the text may mean. Things
/// are named only where the writer knows of them.
pub(crate) fn writing_advice(
    followed: &FollowedPath<'_>,
    instruction: &Instruction,
    (evidence, memory): (&Evidence, &WalkMemory),
    writers_memory: &WalkMemory,
) -> Vec<String> {
    let text = instruction.text.as_str();
    let Ok((guide, reading)) = read_followable(text, None) else { return Vec::new() };
    let parts = match instruction.parts.is_empty() {
        true => followed.align_reading(text, &reading, (evidence, memory)),
        false => instruction.parts.clone(),
    };
    let is_open = |bend: &WalkBend| (bend.first..=bend.last).any(|frame| followed.has_other_way(frame));
    let covered = cover_walk(&reading, &parts, memory, is_open);
    let mut advice: Vec<String> = covered.iter().filter_map(untold_sentence).take(MAX_SENTENCES).collect();
    let spelt = TokenisedText::from_reading(text, &reading);
    let doubts = find_doubts(
        &spelt,
        &guide,
        followed.known_path(),
        FeatureWeights::fitted(),
        (&DoubtBounds::default(), &instruction.findings),
    );
    for doubt in doubts.iter().take(MAX_SENTENCES) {
        let words = text.get(doubt.span[0]..doubt.span[1]).unwrap_or_default();
        let better: Vec<String> = doubt
            .alternatives
            .iter()
            .take(2)
            .filter_map(|other| Some(format!("{:?}", other.words.as_ref()?)))
            .collect();
        let better = if better.is_empty() {
            String::new()
        } else {
            format!(" ({} would fit the way better)", better.join(" or "))
        };
        advice.push(format!("a reader of {words:?} may leave the way: {}{better}", doubt.reason));
    }
    let ambiguity = instruction.ambiguity.as_ref();
    if let Some(ends) = ambiguity.and_then(|ambiguity| ambiguity.ends).filter(|ends| *ends > 1) {
        // A thing that the writer knows nothing of would be made up.
        let is_known = |name: &&str| writers_memory.things.iter().any(|thing| names_agree(&thing.name, name));
        let apart = ambiguity.and_then(|ambiguity| ambiguity.told_apart_by.as_deref()).filter(is_known);
        let apart = apart.map_or(String::new(), |apart| format!(": name {apart:?}, which only the right end has"));
        advice.push(format!("the words may end at {ends} places{apart}"));
    }
    if advice.is_empty() {
        let last = memory.frame_count().saturating_sub(1);
        let is_near =
            |thing: &&RememberedThing| writers_memory.distance_m(thing, last).is_some_and(|far_m| far_m <= 2.0);
        let near = writers_memory.things.iter().filter(is_near);
        let names: Vec<&str> = near.map(|thing| thing.name.as_str()).take(MAX_SENTENCES).collect();
        if !names.is_empty() {
            advice
                .push(format!("a reader may stop too early or too late: say where it ends, by {}", names.join(" or ")));
        }
    }
    advice
}

/// A decision of the walk that no words tell.
fn untold_sentence(covered: &CoveredDecision) -> Option<String> {
    if covered.told != DecisionTold::LeftOut {
        return None;
    }
    let what = match &covered.decision {
        WalkDecision::Turn { side: Side::Left } => "turns left".to_owned(),
        WalkDecision::Turn { side: Side::Right } => "turns right".to_owned(),
        WalkDecision::Turn { .. } => "turns around".to_owned(),
        WalkDecision::Climb { direction: ClimbDirection::Down } => "goes down stairs".to_owned(),
        WalkDecision::Climb { .. } => "goes up stairs".to_owned(),
        WalkDecision::Room { name } => format!("enters the {name}"),
    };
    Some(format!("no words tell that the way {what} at Frame {}", covered.frames[0]))
}
