//! Reads the words around a target's name: ranks, sides, relations to other things, and its room.

use super::super::names::LexiconName;
use super::{
    clauses::ListenerText,
    target_description::{ArrivalSide, InRoom, LevelMention, RelationLandmark, TargetDescription, TargetRelation},
    vocabulary::{
        LOOK_WORDS, NUMBER_WORDS, NamesakeRank, ORDINAL_WORDS, RANK_WORDS, RELATION_PHRASES, ROOM_DETAIL_PHRASES,
        RelationKind,
    },
};
use wayword_language::lexicon::is_plural;

/// The name of the other thing begins at most this many words after a relation.
const MAX_GAP_WORDS: usize = 5;

impl ListenerText {
    /// Adds the ranks and looks in the words before the target's name, back to its article, at most six words.
    pub(super) fn read_before(&self, target: usize, [from, _]: [usize; 2], description: &mut TargetDescription) {
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
            // An ordinal that counts ("the second picture from the left") is a rank and no look.
            description.has_look |= LOOK_WORDS.contains(&word) && !self.is_ordinal_from(target, at);
            let rank = RANK_WORDS.iter().find(|(other, _)| *other == word).map(|(_, rank)| *rank);
            // "The far left picture" is the leftmost.
            let is_far_side = word == "far" && matches!(self.words[at + 1].as_str(), "left" | "right");
            description.ranks.extend(rank.filter(|_| !is_far_side));
            if let (Some(number), Some(from_left)) =
                (ORDINAL_WORDS.iter().position(|ordinal| *ordinal == word), self.counts_from(target))
            {
                description.ranks.push(if from_left {
                    NamesakeRank::FromLeft(number)
                } else {
                    NamesakeRank::FromRight(number)
                });
            }
        }
    }

    /// Whether a word is an ordinal that counts from a side: "the second picture from the left".
    pub(super) fn is_ordinal_from(&self, target: usize, at: usize) -> bool {
        ORDINAL_WORDS.contains(&self.words[at].as_str()) && self.counts_from(target).is_some()
    }

    /// "From the left" after a name: whether it counts from the left, or from the right.
    pub(super) fn counts_from(&self, target: usize) -> Option<bool> {
        let after = self.words.get(self.names[target].end..)?;
        let after: Vec<&str> = after.iter().take(4).map(String::as_str).collect();
        let side =
            after.windows(3).find(|run| run[0] == "from" && run[1] == "the" && matches!(run[2], "left" | "right"))?;
        Some(side[2] == "left")
    }

    /// Adds the sides, ranks and relations in the words after the target's name, up to the end of its clause.
    pub(super) fn read_after(&self, target: usize, [_, to]: [usize; 2], description: &mut TargetDescription) {
        let mut at = self.names[target].end;
        // After "in the kitchen", sides, ranks and relations belong to the room.
        let mut holder_is_room = false;
        while at < to {
            if let Some((length, side)) = self.side_at(at, to).filter(|_| !holder_is_room) {
                description.side = Some(side);
                at += length;
                continue;
            }
            let rank = self.rank_at(at, to).filter(|_| !holder_is_room);
            if let Some(rank) = rank {
                description.ranks.push(rank);
                at += 2;
                continue;
            }
            description.has_look |= !holder_is_room
                && at < self.names[target].end + 4
                && LOOK_WORDS.contains(&self.words[at].as_str())
                && !self.is_ordinal_from(target, at);
            let found = RELATION_PHRASES.iter().find(|(phrase, _)| self.has_phrase_at(phrase, at, to));
            let Some((phrase, how)) = found else {
                at += 1;
                continue;
            };
            let next = at + phrase.split(' ').count();
            let Some((landmarks, end)) = self.read_landmarks(next, to, *how) else {
                at = next;
                continue;
            };
            let in_room = matches!(how, RelationKind::On) && landmarks[0].is_room;
            if !holder_is_room && !in_room && !landmarks.is_empty() {
                description.relations.push(TargetRelation { how: *how, to: landmarks.clone() });
            }
            holder_is_room = holder_is_room || in_room;
            at = end;
        }
    }

    /// Whether a phrase is at a word, before the word `to`.
    pub(super) fn has_phrase_at(&self, phrase: &str, at: usize, to: usize) -> bool {
        let length = phrase.split(' ').count();
        at + length <= to && phrase.split(' ').eq(self.words[at..at + length].iter().map(String::as_str))
    }

    /// The side that words name ("on your left", "on the right side"), and how many words that takes.
    pub(super) fn side_at(&self, at: usize, to: usize) -> Option<(usize, ArrivalSide)> {
        let [first, second, side] =
            [0, 1, 2].map(|next| self.words.get(at + next).filter(|_| at + next < to).map_or("", String::as_str));
        let is_left = match side {
            "left" | "lefthand" => true,
            "right" | "righthand" => false,
            _ => return None,
        };
        let is_of = (3..6).any(|next| self.words.get(at + next).is_some_and(|word| word == "of") && next < 5);
        let is_side = matches!(first, "on" | "to" | "at") && matches!(second, "the" | "your") && !is_of;
        is_side.then_some((3, ArrivalSide { is_left, is_yours: second == "your" }))
    }

    /// The rank that words name: "closest to you", "in the middle".
    pub(super) fn rank_at(&self, at: usize, to: usize) -> Option<NamesakeRank> {
        let phrases = [
            ("closest to you", NamesakeRank::Nearest),
            ("nearest to you", NamesakeRank::Nearest),
            ("nearest you", NamesakeRank::Nearest),
            ("closest to me", NamesakeRank::Nearest),
            ("furthest from you", NamesakeRank::Farthest),
            ("farthest from you", NamesakeRank::Farthest),
            ("furthest away", NamesakeRank::Farthest),
            ("farthest away", NamesakeRank::Farthest),
            ("in the middle", NamesakeRank::Middle),
            ("in the center", NamesakeRank::Middle),
        ];
        let found = phrases.iter().find(|(phrase, _)| self.has_phrase_at(phrase, at, to))?;
        let is_of = self.words.get(at + 3).is_some_and(|word| word == "of" || word == "from");
        (!is_of).then_some(found.1)
    }

    /// The things that follow a relation, two for "between", and the index of the word after them.
    pub(super) fn read_landmarks(
        &self,
        from: usize,
        to: usize,
        how: RelationKind,
    ) -> Option<(Vec<RelationLandmark>, usize)> {
        let first =
            self.names.iter().position(|name| name.start >= from && name.start < (from + MAX_GAP_WORDS).min(to))?;
        let landmark =
            |name: &LexiconName| RelationLandmark { name: name.name.clone(), is_room: name.is_room && !name.is_thing };
        let name = &self.names[first];
        let mut landmarks = vec![landmark(name)];
        let mut end = name.end;
        if how == RelationKind::Between {
            let second = self.names.get(first + 1).filter(|next| next.start < (name.end + MAX_GAP_WORDS).min(to));
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

    /// The last room of a clause that is not just a landmark. In the target's own clause, it is the room of the target.
    pub(super) fn room_in(&self, [from, to]: [usize; 2], target: Option<usize>) -> Option<InRoom> {
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
            let is_landmark = ROOM_DETAIL_PHRASES
                .iter()
                .chain(&["closest to", "facing", "past", "through", "out of", "beyond", "after"])
                .any(|phrase| {
                    let run = format!(" {} ", before.join(" "));
                    run.contains(&format!(" {phrase} ")) && !(target.is_some() && before.iter().any(is_inside))
                });
            if after_target
                && (!is_landmark || found.is_none() && target.is_none())
                && (target.is_none() || before.iter().any(is_inside) || target.is_some_and(|target| target > at))
            {
                let mut room = InRoom { name: name.room_word(), ..InRoom::default() };
                self.read_room_details(at, to, target, &mut room);
                found = Some(room);
            }
        }
        found
    }

    /// Adds the things and the neighbouring rooms that describe a room ("the bathroom with two sinks").
    pub(super) fn read_room_details(&self, room: usize, to: usize, target: Option<usize>, described: &mut InRoom) {
        let mut end = self.names[room].end;
        for (at, name) in self.names.iter().enumerate().skip(room + 1) {
            let between = &self.words[end..name.start.max(end)];
            let run = format!(" {} ", between.join(" "));
            let is_introduced = ROOM_DETAIL_PHRASES.iter().any(|phrase| run.contains(&format!(" {phrase} ")));
            if name.end > to
                || Some(at) == target
                || between.len() > MAX_GAP_WORDS
                || !(is_introduced || run.contains(" and "))
            {
                break;
            }
            if name.is_fabric_part() {
                continue;
            }
            if name.is_room && !name.is_thing {
                described.beside.push(name.room_word());
            } else if name.is_thing {
                described.things.push(name.name.clone());
            }
            end = name.end;
        }
    }

    /// The level that the text ends on.
    pub(super) fn read_level(&self) -> Option<LevelMention> {
        let number = |word: &str| {
            let written = [&ORDINAL_WORDS, &NUMBER_WORDS]
                .into_iter()
                .find_map(|list| list.iter().position(|number| *number == word));
            let digits = word.trim_end_matches(char::is_alphabetic);
            written.map(|at| at as u32 + 1).or_else(|| digits.parse().ok())
        };
        let mut level = None;
        for at in 0..self.words.len() {
            let word =
                |step: isize| at.checked_add_signed(step).and_then(|at| self.words.get(at)).map_or("", String::as_str);
            level = match word(0) {
                "upstairs" => Some(LevelMention::Up),
                "downstairs" => Some(LevelMention::Down),
                "level" | "floor" | "story" | "storey" => match word(-1) {
                    "this" | "same" => Some(LevelMention::Same),
                    "top" | "upper" | "highest" => Some(LevelMention::Top),
                    "ground" => Some(LevelMention::Number(1)),
                    before => number(before)
                        .or_else(|| number(word(1)).filter(|_| word(0) == "level" || word(0) == "floor"))
                        .map(LevelMention::Number)
                        .or(level),
                },
                _ => level,
            };
        }
        level.filter(|level| !matches!(level, LevelMention::Number(0 | 10..)))
    }
}
