//! Reads the description of the target out of a text, by a grammar that only the listener uses.

use super::{
    clauses::ListenerText,
    vocabulary::{NamesakeRank, RelationKind},
};
use std::collections::BTreeSet;

/// The description of the object of a text's task.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct TargetDescription {
    /// The object's name.
    pub(super) name: String,
    /// Its relations to other things, such as "next to the lamp".
    pub(super) relations: Vec<TargetRelation>,
    /// Its ranks among its namesakes, such as "the leftmost".
    pub(super) ranks: Vec<NamesakeRank>,
    /// The side on arrival. `is_yours` is the walker's own side ("on your left").
    pub(super) side: Option<ArrivalSide>,
    /// The room of the object, with the things in it and the rooms next to it.
    pub(super) room: Option<InRoom>,
    pub(super) level: Option<LevelMention>,
    /// Whether it has a word that labels cannot judge: a colour, a size, a material.
    pub(super) has_look: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ArrivalSide {
    pub(super) is_left: bool,
    pub(super) is_yours: bool,
}

#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct InRoom {
    /// Its kind; empty for "the room".
    pub(super) name: String,
    pub(super) things: Vec<String>,
    pub(super) beside: Vec<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LevelMention {
    Number(u32),
    Up,
    Down,
    Same,
    Top,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct TargetRelation {
    pub(super) how: RelationKind,
    /// The other thing or room; two for "between".
    pub(super) to: Vec<RelationLandmark>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct RelationLandmark {
    pub(super) name: String,
    pub(super) is_room: bool,
}

/// The description of the object of a text's task; `None` where the text names no thing. `known` has names of things in addition to those
/// of the lexicon.
pub(super) fn describe_target(text: &str, known: &BTreeSet<String>) -> Option<TargetDescription> {
    let text = ListenerText::from_text(text, known);
    let clauses = text.clause_ranges();
    let tasks: Vec<[usize; 2]> = clauses.iter().copied().filter(|clause| text.is_task(*clause)).collect();
    let moves: Vec<[usize; 2]> = clauses.iter().copied().filter(|clause| !text.is_task(*clause)).collect();
    let first_thing = |clauses: &[[usize; 2]]| {
        clauses.iter().find_map(|[from, to]| {
            text.names
                .iter()
                .position(|name| name.is_thing && !name.is_floor() && name.start >= *from && name.end <= *to)
        })
    };
    let last_move = moves.last().copied().into_iter().collect::<Vec<_>>();
    let target = first_thing(&tasks).or_else(|| first_thing(&last_move))?;
    let of_target = clauses.iter().copied().find(|[from, to]| (*from..*to).contains(&text.names[target].start))?;
    let mut said = TargetDescription {
        name: text.names[target].name.clone(),
        level: text.read_level(),
        ..TargetDescription::default()
    };
    text.read_before(target, of_target, &mut said);
    text.read_after(target, of_target, &mut said);
    let rooms_of = |clause: &[usize; 2]| text.room_in(*clause, (*clause == of_target).then_some(target));
    let in_moves = moves.iter().filter(|clause| **clause != of_target).filter_map(rooms_of).next_back();
    said.room = rooms_of(&of_target).or(in_moves);
    Some(said)
}

#[cfg(test)]
mod tests;
