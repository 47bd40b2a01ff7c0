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
    /// The side on which it is when the walker arrives.
    pub(super) side: Option<ArrivalSide>,
    /// The room of the object, with the things in it and the rooms next to it.
    pub(super) room: Option<InRoom>,
    /// The storey of the object.
    pub(super) level: Option<LevelMention>,
    /// Whether it has a word that labels cannot judge: a colour, a size, a material.
    pub(super) has_look: bool,
}

/// A side on which a thing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ArrivalSide {
    /// Whether it is the left side, and not the right.
    pub(super) is_left: bool,
    /// Whether it is the walker's own side ("on your left").
    pub(super) is_yours: bool,
}

/// A room, as a text describes it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct InRoom {
    /// Its kind; empty for "the room".
    pub(super) name: String,
    /// The names of things in it.
    pub(super) things: Vec<String>,
    /// The names of rooms next to it.
    pub(super) beside: Vec<String>,
}

/// The storey that a text names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LevelMention {
    /// A numbered storey, the lowest being 1.
    Number(u32),
    /// A storey above that of the start.
    Up,
    /// A storey below that of the start.
    Down,
    /// The storey of the start.
    Same,
    /// The highest storey of the building.
    Top,
}

/// How the object lies to another thing or room.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TargetRelation {
    pub(super) how: RelationKind,
    /// The other thing or room; two for "between".
    pub(super) to: Vec<RelationLandmark>,
}

/// The thing or room of a relation.
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
                .position(|name| name.is_thing && !name.is_fabric_part() && name.start >= *from && name.end <= *to)
        })
    };
    let last_move = moves.last().copied().into_iter().collect::<Vec<_>>();
    // The target is the first thing of the tasks, or else of the last move.
    let target = first_thing(&tasks).or_else(|| first_thing(&last_move))?;
    let target_clause = clauses.iter().copied().find(|[from, to]| (*from..*to).contains(&text.names[target].start))?;
    let mut description = TargetDescription {
        name: text.names[target].name.clone(),
        level: text.read_level(),
        ..TargetDescription::default()
    };
    text.read_before(target, target_clause, &mut description);
    text.read_after(target, target_clause, &mut description);
    let rooms_of = |clause: &[usize; 2]| text.room_in(*clause, (*clause == target_clause).then_some(target));
    let in_moves = moves.iter().filter(|clause| **clause != target_clause).filter_map(rooms_of).next_back();
    description.room = rooms_of(&target_clause).or(in_moves);
    Some(description)
}

#[cfg(test)]
mod tests;
