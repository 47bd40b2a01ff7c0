//! Words for the room at the end: its name, its storey, and properties that distinguish it from other rooms.

use crate::{
    style::PlaceWording,
    writer::{WritingBrief, phrases::ordinal_of, route::last_climb},
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use wayword_core::{ClimbDirection, ObjectDescription, ObjectDistinction};
use wayword_language::lexicon::{room_name, with_article};

/// What a text tells of the room where a path ends, in English names.
#[derive(Clone)]
pub(in crate::writer) struct RoomContent {
    pub(in crate::writer) name: String,
    /// The number of its storey, from 1, where the text names it.
    pub(in crate::writer) level: Option<u32>,
    /// The properties of the room that the text names.
    pub(in crate::writer) by: Vec<ObjectDistinction>,
}

/// The room where a path ends.
pub(super) struct GoalRoom<'a> {
    wording: &'a PlaceWording,
    room: &'a str,
    /// The number of its storey, from 1.
    level: Option<u32>,
    /// Which way the last stairs of the path go.
    climb: Option<ClimbDirection>,
    /// Probability that the storey is named although it is not needed.
    level_probability: f64,
    /// How many storeys the building has; 0 where that is not known.
    storeys: usize,
    /// Whether the storey tells the room from others of its kind.
    level_decides: bool,
}

/// How often a text names the storey, relative to the style's average: where the storey changes along the path, where
/// the building has several storeys, and where it has one.
const STOREY_SHARE_FACTORS: [f64; 3] = [1.5, 0.75, 0.2];
/// The greatest probability that the storey is named although it is not needed.
const MAX_LEVEL_PROBABILITY: f64 = 0.97;
/// How often the storey comes behind the other properties of the room, where it can.
const LEVEL_LAST_SHARE: f64 = 0.35;

impl<'a> GoalRoom<'a> {
    pub(super) fn new(brief: &WritingBrief<'a>, room: &'a str) -> Self {
        let path = &brief.walk.path;
        let levels: BTreeSet<u32> = path.frames.iter().filter_map(|frame| frame.level).collect();
        let storeys = path.target.as_ref().map_or(0, |target| target.storeys);
        let need = match storeys {
            _ if levels.len() > 1 => STOREY_SHARE_FACTORS[0],
            0 => 1.0,
            1 => STOREY_SHARE_FACTORS[2],
            _ => STOREY_SHARE_FACTORS[1],
        };
        let wording = &brief.profile.wording;
        let level_probability = (wording.share_of_texts("level") * need).clamp(0.0, MAX_LEVEL_PROBABILITY);
        let level = path.frames.last().and_then(|frame| frame.level);
        let descriptions = path.target.as_ref().map_or(&[][..], |target| &target.descriptions);
        let level_decides = !descriptions.is_empty() && descriptions.iter().all(ObjectDescription::tells_level);
        Self { wording, room, level, climb: last_climb(brief.walk), level_probability, storeys, level_decides }
    }

    /// Whether the storey is named: where it tells the room from others, and else as often as people name it.
    pub(super) fn names_level(&self, rng: &mut ChaCha8Rng) -> bool {
        let names_it = rng.random_bool(self.level_probability);
        names_it || self.level_decides
    }

    /// Whether the building is known to have another storey.
    pub(super) fn is_one_of_several(&self) -> bool {
        self.storeys > 1
    }

    /// "Go to", "proceed to": up or down only where the path goes there.
    pub(super) fn draw_opener(&self, rng: &mut ChaCha8Rng) -> &'a str {
        let fits = |opener: &str| {
            let holds = |word: &str| opener.split(' ').any(|part| part == word);
            match self.climb {
                // "Into the stairs" is no English.
                _ if holds("into") || holds("enter") => room_name(self.room) != Some("stairs"),
                Some(ClimbDirection::Up) => !holds("down") && !holds("downstairs"),
                Some(ClimbDirection::Down) => !holds("up") && !holds("upstairs"),
                _ => !["up", "down", "upstairs", "downstairs"].iter().any(|word| holds(word)),
            }
        };
        // A sharp draw prefers frequent openers even more than people do.
        self.wording.draw_sharply("opener", rng, fits).unwrap_or("go to")
    }

    /// "In", "from", "on": before the room, behind a task.
    pub(super) fn draw_preposition(&self, verb: &str, rng: &mut ChaCha8Rng) -> &'static str {
        let takes = ["bring", "grab", "fetch", "take", "get", "remove"].iter().any(|take| verb.starts_with(take));
        match room_name(self.room) {
            _ if takes && rng.random_bool(0.5) => "from",
            Some("porch" | "balcony" | "stairs") => "on",
            _ => "in",
        }
    }

    /// The room with its article and the `distinctions` that are about rooms.
    pub(super) fn room_phrase(
        &self,
        distinctions: &[&ObjectDistinction],
        names_level: bool,
        rng: &mut ChaCha8Rng,
    ) -> (String, RoomContent) {
        let must = distinctions.iter().any(|by| matches!(by, ObjectDistinction::Level { .. }));
        let level = self.level.filter(|_| must || names_level);
        let room = self.wording.draw_name(self.room, rng);
        // "The kitchen by the corridor with the stove" reads as if the corridor had it.
        let has_with = |by: &ObjectDistinction| matches!(by, ObjectDistinction::RoomWith { .. });
        let (with, beside): (Vec<&ObjectDistinction>, Vec<&ObjectDistinction>) =
            distinctions.iter().partition(|by| has_with(by));
        let qualifiers: Vec<String> =
            with.into_iter().chain(beside).filter_map(|by| self.room_qualifier(by, rng)).collect();
        let by = distinctions.iter().filter(|by| by.is_about_room()).map(|by| (*by).clone()).collect();
        let content = RoomContent { name: room.to_owned(), level, by };
        let Some(level) = level else { return (join_words(&[format!("the {room}")], &qualifiers), content) };
        let has_ordinal = |way: &str| ordinal_of(level).is_some() || !way.contains("{th}");
        let way = self.wording.draw("level", rng, has_ordinal).unwrap_or("the {r} on level {n}");
        let filled = way.replace("{n}", &level.to_string()).replace("{th}", ordinal_of(level).unwrap_or_default());
        // "The bathroom next to the hall on level 2": the storey may also come last.
        let is_last = filled.starts_with("the {r} ") && rng.random_bool(LEVEL_LAST_SHARE);
        if is_last && !qualifiers.is_empty() {
            let level = filled.trim_start_matches("the {r} ").to_owned();
            return (join_words(&[format!("the {room}")], &[qualifiers, vec![level]].concat()), content);
        }
        (join_words(&[filled.replace("{r}", room)], &qualifiers), content)
    }

    /// "Next to the hallway", "with the stove"; `None` for a property that is not about rooms.
    fn room_qualifier(&self, by: &ObjectDistinction, rng: &mut ChaCha8Rng) -> Option<String> {
        let (table, name) = match by {
            ObjectDistinction::RoomBy { room } => ("room by", self.wording.draw_name(room, rng).to_owned()),
            ObjectDistinction::RoomWith { thing } => ("room with", self.wording.draw_name(thing, rng).to_owned()),
            _ => return None,
        };
        let way = self.wording.draw(table, rng, |_| true)?;
        Some(way.replace("a {x}", &with_article(&name)).replace("{x}", &name))
    }
}

fn join_words(first: &[String], others: &[String]) -> String {
    [first, others].concat().join(" ")
}
