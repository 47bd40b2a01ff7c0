//! What a text says of its target: by a grammar of its own.

use super::clauses::Text;
use std::collections::BTreeSet;

/// What a text says of the object of its task.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Said {
    /// Its name.
    pub(super) name: String,
    /// Where it lies against other things.
    pub(super) relations: Vec<Relation>,
    /// Which of its namesakes it is.
    pub(super) ranks: Vec<Rank>,
    /// The side on arrival: left where true. `yours`: the walker's own side is meant.
    pub(super) side: Option<Side>,
    /// Rooms, each with what it has and what is beside it: the object lies in the last one.
    pub(super) room: Option<InRoom>,
    pub(super) level: Option<Level>,
    /// Whether a word describes it that labels cannot judge: a colour, a size, a material.
    pub(super) has_look: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Side {
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
pub(super) enum Level {
    Number(u32),
    Up,
    Down,
    Same,
    Top,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rank {
    Leftmost,
    Rightmost,
    Nearest,
    Farthest,
    Highest,
    Lowest,
    Middle,
    FromLeft(usize),
    FromRight(usize),
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relation {
    pub(super) how: How,
    /// The name of the other thing or room; two for "between".
    pub(super) to: Vec<Landmark>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Landmark {
    pub(super) name: String,
    pub(super) is_room: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum How {
    Closest,
    Farthest,
    Near,
    Above,
    Under,
    On,
    LeftOf,
    RightOf,
    Between,
    /// "In front of", "behind": labels do not tell.
    Unknown,
}

/// What a text says of the object of its task; `None` where it names no thing. `known`: names of things beside the lexicon's.
pub(super) fn said(text: &str, known: &BTreeSet<String>) -> Option<Said> {
    let text = Text::of(text, known);
    let clauses = text.clauses();
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
    let mut said = Said { name: text.names[target].name.clone(), level: text.level(), ..Said::default() };
    text.before(target, of_target, &mut said);
    text.after(target, of_target, &mut said);
    let rooms_of = |clause: &[usize; 2]| text.room_in(*clause, (*clause == of_target).then_some(target));
    let in_moves = moves.iter().filter(|clause| **clause != of_target).filter_map(rooms_of).next_back();
    said.room = rooms_of(&of_target).or(in_moves);
    Some(said)
}

#[cfg(test)]
mod tests;
