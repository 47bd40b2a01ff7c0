//! What a text says of its target: by a grammar of its own.

use super::super::names::{Named, named_with, words};
use std::collections::BTreeSet;
use wayword_language::lexicon::is_plural;

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

/// Phrases of relations, the longest first.
const RELATIONS: &[(&str, How)] = &[
    ("on the left side of", How::LeftOf),
    ("on the right side of", How::RightOf),
    ("to the left side of", How::LeftOf),
    ("to the right side of", How::RightOf),
    ("to the left of", How::LeftOf),
    ("to the right of", How::RightOf),
    ("on the left of", How::LeftOf),
    ("on the right of", How::RightOf),
    ("furthest away from", How::Farthest),
    ("farthest away from", How::Farthest),
    ("furthest from", How::Farthest),
    ("farthest from", How::Farthest),
    ("left of", How::LeftOf),
    ("right of", How::RightOf),
    ("in front of", How::Unknown),
    ("across from", How::Unknown),
    ("opposite to", How::Unknown),
    ("closest to", How::Closest),
    ("nearest to", How::Closest),
    ("closest", How::Closest),
    ("nearest", How::Closest),
    ("adjacent to", How::Near),
    ("attached to", How::On),
    ("on top of", How::On),
    ("close to", How::Near),
    ("next to", How::Near),
    ("alongside", How::Near),
    ("opposite", How::Unknown),
    ("underneath", How::Under),
    ("beneath", How::Under),
    ("between", How::Between),
    ("against", How::Unknown),
    ("around", How::Near),
    ("beside", How::Near),
    ("behind", How::Unknown),
    ("inside", How::On),
    ("above", How::Above),
    ("below", How::Under),
    ("under", How::Under),
    ("facing", How::Unknown),
    ("outside", How::Unknown),
    ("near", How::Near),
    ("over", How::Above),
    ("from", How::On),
    ("with", How::Near),
    ("by", How::Near),
    ("on", How::On),
    ("in", How::On),
    ("at", How::Near),
    ("of", How::On),
    ("off", How::On),
];
/// After a room: what the room has, or what it is beside.
const OF_ROOMS: &[&str] = &[
    "with",
    "has",
    "having",
    "containing",
    "contains",
    "next to",
    "beside",
    "by",
    "near",
    "across from",
    "attached to",
    "connected to",
    "adjacent to",
    "off",
    "off of",
    "outside",
    "outside of",
    "in",
    "inside",
    "of",
    "from",
    "closest to",
    "nearest",
    "nearest to",
    "between",
];
/// Words between a relation and the name of the other thing.
const GAP: usize = 5;

/// Verbs of moves.
const MOVES: &[&str] = &[
    "go", "walk", "head", "proceed", "move", "enter", "travel", "continue", "exit", "leave", "climb", "make", "come",
    "visit", "step", "pass", "turn", "return", "navigate", "run", "take", "find", "get", "follow", "reach", "locate",
];
/// What a clause that is no task may begin with instead.
const OPENERS: &[&str] =
    &["in", "at", "on", "inside", "into", "to", "from", "up", "down", "upstairs", "downstairs", "through"];
/// Words before the verb of a clause.
const FILLERS: &[&str] =
    &["please", "then", "and", "now", "next", "there", "you", "can", "could", "will", "kindly", "once"];
/// Words that no clause begins with after "and".
const NO_VERBS: &[&str] = &[
    "the", "a", "an", "two", "three", "one", "other", "some", "its", "your", "is", "has", "with", "white", "black",
    "right", "left", "which", "that", "on", "in", "of", "next", "above", "below", "under", "by", "wood", "wooden",
];
const RANKS: &[(&str, Rank)] = &[
    ("leftmost", Rank::Leftmost),
    ("left", Rank::Leftmost),
    ("rightmost", Rank::Rightmost),
    ("right", Rank::Rightmost),
    ("nearest", Rank::Nearest),
    ("closest", Rank::Nearest),
    ("furthest", Rank::Farthest),
    ("farthest", Rank::Farthest),
    ("far", Rank::Farthest),
    ("top", Rank::Highest),
    ("topmost", Rank::Highest),
    ("upper", Rank::Highest),
    ("highest", Rank::Highest),
    ("bottom", Rank::Lowest),
    ("lower", Rank::Lowest),
    ("lowest", Rank::Lowest),
    ("middle", Rank::Middle),
    ("center", Rank::Middle),
    ("centre", Rank::Middle),
];
const ORDINALS: [&str; 5] = ["first", "second", "third", "fourth", "fifth"];
const NUMBERS: [&str; 5] = ["one", "two", "three", "four", "five"];
/// Words for how something looks.
const LOOKS: &[&str] = &[
    "white",
    "black",
    "red",
    "blue",
    "green",
    "brown",
    "grey",
    "gray",
    "yellow",
    "orange",
    "pink",
    "purple",
    "beige",
    "tan",
    "gold",
    "golden",
    "silver",
    "cream",
    "dark",
    "light",
    "colored",
    "coloured",
    "wooden",
    "wood",
    "glass",
    "metal",
    "leather",
    "marble",
    "stone",
    "brick",
    "wicker",
    "big",
    "large",
    "small",
    "little",
    "tall",
    "short",
    "long",
    "wide",
    "huge",
    "tiny",
    "round",
    "square",
    "rectangular",
    "oval",
    "circular",
    "larger",
    "smaller",
    "largest",
    "biggest",
    "smallest",
    "open",
    "closed",
    "double",
    "single",
    "striped",
    "floral",
    "patterned",
    "framed",
    "fancy",
    "old",
    "teal",
    "turquoise",
    "maroon",
    "burgundy",
    "plaid",
    "shiny",
    "bright",
    "clear",
    "stainless",
    "steel",
    "first",
    "second",
    "third",
    "fourth",
    "last",
    "other",
];

/// A text as words, with where clauses begin, and its names.
struct Text {
    words: Vec<String>,
    /// For each word, whether a mark stands before it.
    after_mark: Vec<bool>,
    names: Vec<Named>,
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

impl Text {
    fn of(text: &str, known: &BTreeSet<String>) -> Self {
        let (mut all, mut after_mark) = (Vec::new(), Vec::new());
        for part in text.split(['.', ',', ';', ':', '!', '?']) {
            let part = words(part);
            after_mark.extend((0..part.len()).map(|at| at == 0));
            all.extend(part);
        }
        let names = named_with(&all, known);
        Self { words: all, after_mark, names }
    }

    /// From where to where each clause goes.
    fn clauses(&self) -> Vec<[usize; 2]> {
        let begins = |at: &usize| {
            let before = at.checked_sub(1).map(|at| self.words[at].as_str());
            *at == 0
                || self.after_mark[*at]
                || (matches!(before, Some("and" | "then" | "to")) && self.is_verb(*at, before))
        };
        let starts: Vec<usize> = (0..self.words.len()).filter(begins).collect();
        let ends = starts.iter().skip(1).copied().chain([self.words.len()]);
        starts.iter().copied().zip(ends).map(|(from, to)| [from, to]).collect()
    }

    /// Whether a clause may begin with a word after "and", "then" or "to".
    fn is_verb(&self, at: usize, before: Option<&str>) -> bool {
        let word = self.words[at].as_str();
        let in_name = self.names.iter().any(|name| (name.start..name.end).contains(&at));
        let is_free = !NO_VERBS.contains(&word) && !in_name && !LOOKS.contains(&word) && word != "then";
        let is_known = is_free || self.has_object(at);
        // "Go to the kitchen to clean the sink" begins a task; "go to the kitchen" does not.
        let has_object = || self.words.get(at + 1).is_some_and(|next| next == "the" || next == "me");
        let follows_move = || self.words[..at - 1].last().is_some_and(|word| MOVES.contains(&word.as_str()));
        is_known && (before != Some("to") || (has_object() && !MOVES.contains(&word) && !follows_move()))
    }

    /// Whether a word is a verb by the word after it: "switch on", "water the".
    fn has_object(&self, at: usize) -> bool {
        let next = self.words.get(at + 1).map_or("", String::as_str);
        let is_small = NO_VERBS.contains(&self.words[at].as_str());
        !is_small && matches!(next, "the" | "a" | "an" | "on" | "off" | "me" | "up" | "down" | "out")
    }

    fn is_task(&self, [from, to]: [usize; 2]) -> bool {
        let Some(at) = (from..to).find(|at| !FILLERS.contains(&self.words[*at].as_str())) else { return false };
        let next = self.words.get(at + 1).filter(|_| at + 1 < to).map_or("", String::as_str);
        let has_thing =
            self.names.iter().any(|name| name.is_thing && !name.is_room && name.start > at && name.end <= to);
        let is_way = |words: &[&str]| words.contains(&next);
        match self.words[at].as_str() {
            "turn" => has_thing && !is_way(&["left", "right", "around", "back", "to"]),
            "take" | "make" => has_thing && !is_way(&["left", "right", "your"]) && !self.names_stairs(at, to),
            "get" => next != "to" && has_thing,
            "the" | "a" | "an" | "it" | "that" | "which" | "is" | "where" => false,
            "there" => false,
            word => {
                !MOVES.contains(&word) && !OPENERS.contains(&word) && !self.names.iter().any(|name| name.start == at)
            }
        }
    }

    fn names_stairs(&self, from: usize, to: usize) -> bool {
        self.words[from..to]
            .iter()
            .any(|word| matches!(word.as_str(), "stairs" | "staircase" | "steps" | "left" | "right"))
    }

    /// What the words before a name say.
    fn before(&self, target: usize, [from, _]: [usize; 2], said: &mut Said) {
        let name = &self.names[target];
        let first = name.start.saturating_sub(6).max(from);
        let mut at = name.start;
        while at > first
            && !matches!(self.words[at - 1].as_str(), "the" | "a" | "an" | "me" | "your" | "that" | "off" | "up")
        {
            at -= 1;
        }
        for at in at..name.start {
            let word = self.words[at].as_str();
            // "Turn on the lights", "the light brown table": a name's own words are no look.
            said.has_look |= LOOKS.contains(&word) && !self.is_ordinal_from(target, at);
            let rank = RANKS.iter().find(|(other, _)| *other == word).map(|(_, rank)| *rank);
            // "The far left picture" is the leftmost.
            let is_far_side = word == "far" && matches!(self.words[at + 1].as_str(), "left" | "right");
            said.ranks.extend(rank.filter(|_| !is_far_side));
            if let (Some(number), Some(from_left)) =
                (ORDINALS.iter().position(|one| *one == word), self.counts_from(target))
            {
                said.ranks.push(if from_left { Rank::FromLeft(number) } else { Rank::FromRight(number) });
            }
        }
    }

    fn is_ordinal_from(&self, target: usize, at: usize) -> bool {
        ORDINALS.contains(&self.words[at].as_str()) && self.counts_from(target).is_some()
    }

    /// "From the left" after a name: whether it counts from the left, or from the right.
    fn counts_from(&self, target: usize) -> Option<bool> {
        let after = self.words.get(self.names[target].end..)?;
        let after: Vec<&str> = after.iter().take(4).map(String::as_str).collect();
        let side =
            after.windows(3).find(|run| run[0] == "from" && run[1] == "the" && matches!(run[2], "left" | "right"))?;
        Some(side[2] == "left")
    }

    /// What the words after a name say, to the end of its clause.
    fn after(&self, target: usize, [_, to]: [usize; 2], said: &mut Said) {
        let mut at = self.names[target].end;
        let mut holder_is_room = false;
        while at < to {
            if let Some((length, side)) = self.side_at(at, to).filter(|_| !holder_is_room) {
                said.side = Some(side);
                at += length;
                continue;
            }
            let rank = self.rank_at(at, to).filter(|_| !holder_is_room);
            if let Some(rank) = rank {
                said.ranks.push(rank);
                at += 2;
                continue;
            }
            said.has_look |= !holder_is_room
                && at < self.names[target].end + 4
                && LOOKS.contains(&self.words[at].as_str())
                && !self.is_ordinal_from(target, at);
            let found = RELATIONS.iter().find(|(phrase, _)| self.stands_at(phrase, at, to));
            let Some((phrase, how)) = found else {
                at += 1;
                continue;
            };
            let next = at + phrase.split(' ').count();
            let Some((landmarks, end)) = self.landmarks(next, to, *how) else {
                at = next;
                continue;
            };
            let in_room = matches!(how, How::On) && landmarks[0].is_room;
            if !holder_is_room && !in_room && !landmarks.is_empty() {
                said.relations.push(Relation { how: *how, to: landmarks.clone() });
            }
            holder_is_room = holder_is_room || in_room;
            at = end;
        }
    }

    fn stands_at(&self, phrase: &str, at: usize, to: usize) -> bool {
        let length = phrase.split(' ').count();
        at + length <= to && phrase.split(' ').eq(self.words[at..at + length].iter().map(String::as_str))
    }

    /// "On your left", "on the right side".
    fn side_at(&self, at: usize, to: usize) -> Option<(usize, Side)> {
        let [first, second, side] =
            [0, 1, 2].map(|next| self.words.get(at + next).filter(|_| at + next < to).map_or("", String::as_str));
        let is_left = match side {
            "left" | "lefthand" => true,
            "right" | "righthand" => false,
            _ => return None,
        };
        let is_of = (3..6).any(|next| self.words.get(at + next).is_some_and(|word| word == "of") && next < 5);
        let is_side = matches!(first, "on" | "to" | "at") && matches!(second, "the" | "your") && !is_of;
        is_side.then_some((3, Side { is_left, is_yours: second == "your" }))
    }

    /// "Closest to you", "in the middle", "on top".
    fn rank_at(&self, at: usize, to: usize) -> Option<Rank> {
        let phrases = [
            ("closest to you", Rank::Nearest),
            ("nearest to you", Rank::Nearest),
            ("nearest you", Rank::Nearest),
            ("closest to me", Rank::Nearest),
            ("furthest from you", Rank::Farthest),
            ("farthest from you", Rank::Farthest),
            ("furthest away", Rank::Farthest),
            ("farthest away", Rank::Farthest),
            ("in the middle", Rank::Middle),
            ("in the center", Rank::Middle),
        ];
        let found = phrases.iter().find(|(phrase, _)| self.stands_at(phrase, at, to))?;
        let is_of = self.words.get(at + 3).is_some_and(|word| word == "of" || word == "from");
        (!is_of).then_some(found.1)
    }

    /// The things that follow a relation.
    fn landmarks(&self, from: usize, to: usize, how: How) -> Option<(Vec<Landmark>, usize)> {
        let first = self.names.iter().position(|name| name.start >= from && name.start < (from + GAP).min(to))?;
        let landmark = |name: &Named| Landmark { name: name.name.clone(), is_room: name.is_room && !name.is_thing };
        let name = &self.names[first];
        let mut landmarks = vec![landmark(name)];
        let mut end = name.end;
        if how == How::Between {
            let second = self.names.get(first + 1).filter(|next| next.start < (name.end + GAP).min(to));
            let joined = second.filter(|next| self.words[name.end..next.start].iter().any(|word| word == "and"));
            let several = is_plural(&self.words[name.end - 1]);
            match joined {
                Some(next) => {
                    landmarks.push(landmark(next));
                    end = next.end;
                }
                None if several => landmarks.push(landmark(name)),
                None => return None,
            }
        }
        Some((landmarks, end))
    }

    /// The room of a clause that is no mere landmark; in the target's own clause, the room that it lies in.
    fn room_in(&self, [from, to]: [usize; 2], target: Option<usize>) -> Option<InRoom> {
        let mut found: Option<InRoom> = None;
        for (at, name) in self.names.iter().enumerate() {
            let is_room = name.is_room && Some(at) != target && name.start >= from && name.end <= to;
            if !is_room {
                continue;
            }
            let before: Vec<&str> =
                self.words[from.max(name.start.saturating_sub(4))..name.start].iter().map(String::as_str).collect();
            let after_target = target.is_none_or(|target| name.start > self.names[target].end || target > at);
            let is_inside = |word: &&str| matches!(*word, "in" | "of" | "inside" | "from" | "on" | "at");
            let is_landmark = OF_ROOMS
                .iter()
                .chain(&["closest to", "facing", "past", "through", "out of", "beyond", "after"])
                .any(|phrase| {
                    let run = format!(" {} ", before.join(" "));
                    run.contains(&format!(" {phrase} "))
                        && !(target.is_some() && before.iter().any(|word| is_inside(&word)))
                });
            if after_target
                && (!is_landmark || found.is_none() && target.is_none())
                && (target.is_none()
                    || before.iter().any(|word| is_inside(&word))
                    || target.is_some_and(|target| target > at))
            {
                let mut room = InRoom { name: name.room_word(), ..InRoom::default() };
                self.of_room(at, to, target, &mut room);
                found = Some(room);
            }
        }
        found
    }

    /// What follows a room: things in it, rooms beside it.
    fn of_room(&self, room: usize, to: usize, target: Option<usize>, said: &mut InRoom) {
        let mut end = self.names[room].end;
        for (at, name) in self.names.iter().enumerate().skip(room + 1) {
            let between = &self.words[end..name.start.max(end)];
            let run = format!(" {} ", between.join(" "));
            let is_told = OF_ROOMS.iter().any(|phrase| run.contains(&format!(" {phrase} ")));
            if name.end > to || Some(at) == target || between.len() > GAP || !(is_told || run.contains(" and ")) {
                break;
            }
            if name.is_floor() {
                continue;
            }
            if name.is_room && !name.is_thing {
                said.beside.push(name.room_word());
            } else if name.is_thing {
                said.things.push(name.name.clone());
            }
            end = name.end;
        }
    }

    /// The level that the text ends on.
    fn level(&self) -> Option<Level> {
        let number = |word: &str| {
            let written = [&ORDINALS, &NUMBERS].into_iter().find_map(|list| list.iter().position(|one| *one == word));
            let digits = word.trim_end_matches(char::is_alphabetic);
            written.map(|at| at as u32 + 1).or_else(|| digits.parse().ok())
        };
        let mut level = None;
        for at in 0..self.words.len() {
            let word =
                |step: isize| at.checked_add_signed(step).and_then(|at| self.words.get(at)).map_or("", String::as_str);
            level = match word(0) {
                "upstairs" => Some(Level::Up),
                "downstairs" => Some(Level::Down),
                "level" | "floor" | "story" | "storey" => match word(-1) {
                    "this" | "same" => Some(Level::Same),
                    "top" | "upper" | "highest" => Some(Level::Top),
                    "ground" => Some(Level::Number(1)),
                    before => number(before)
                        .or_else(|| number(word(1)).filter(|_| word(0) == "level" || word(0) == "floor"))
                        .map(Level::Number)
                        .or(level),
                },
                _ => level,
            };
        }
        level.filter(|level| !matches!(level, Level::Number(0 | 10..)))
    }
}

#[cfg(test)]
mod tests;
