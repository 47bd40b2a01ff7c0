//! Puts the clauses of a way into words: draws a shape for each, and one name for each room and thing of the text.

use super::{
    Brief,
    dice::Dice,
    phrases::{draw, fill, stay_phrase},
    route::{Clause, Role, side_word, stands_still, suits},
};
use crate::style::way::{Kind, Way, is_until};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use wayword_core::Motion;
use wayword_language::lexicon::{counted, plural, room_name, thing};

/// A clause in words.
pub(super) struct Phrase {
    pub(super) text: String,
    /// Whether it begins with a verb, so that it can follow "and".
    pub(super) is_clause: bool,
}

/// Share of things that get a colour although they do not need one.
const COLOURED: f64 = 0.25;

/// Whether a shape with "exit" or "out" fits a clause: it names the room that it leaves, or its door leads out of the
/// first room and not into the last.
fn goes_out(clause: &Clause, brief: &Brief<'_>) -> bool {
    let openings = &brief.memory.openings;
    let is_first = openings.len() > 1 && openings[0].before == clause.at;
    clause.from.is_some() || is_first || !matches!(clause.kind, Kind::ThroughDoor | Kind::DoorOnSide | Kind::ToDoor)
}

/// Distance into a room up to which the walker is "just inside", metres.
const STEP_M: f64 = 2.5;

/// Length of the way in the room of a frame up to it, metres.
fn walked_in_m(at: usize, brief: &Brief<'_>) -> f64 {
    let before = brief.memory.stay(at).map_or(0, |stay| stay.entered.saturating_sub(1));
    brief.walk.walked_m(before, at)
}

/// The demands of a clause's context on its shape.
#[derive(Clone, Copy)]
struct Needs {
    motion: Motion,
    /// Whether it has to name its room.
    names_room: bool,
    /// Whether it leaves the room of the start, or names the room that it leaves.
    leaves: bool,
    /// Whether the walker is at most a step behind the door of its room.
    is_near_door: bool,
    /// Whether it may limit the clause before it ("until you reach ...").
    may_run: bool,
}

/// The names that a text gives to rooms and things: one for each.
pub(super) struct Names<'a> {
    way: &'a Way,
    chosen: BTreeMap<String, String>,
    dice: Dice,
}

impl<'a> Names<'a> {
    pub(super) fn of(way: &'a Way, dice: Dice) -> Self {
        Self { way, chosen: BTreeMap::new(), dice }
    }

    /// One of the clauses of a text in words.
    pub(super) fn phrase(&mut self, told: &[Clause], at: usize, brief: &Brief<'_>, dice: Dice) -> Phrase {
        let clause = &told[at];
        let rng = &mut clause.drawn("words", dice);
        if clause.kind == Kind::Straight && stands_still(brief.walk) {
            return Phrase { text: stay_phrase(None, rng), is_clause: true };
        }
        let motion = brief.walk.path.motion;
        let before = at.checked_sub(1).map(|before| told[before].kind).filter(|_| !clause.follows_offer);
        // A thing may limit a plain "go straight", so that the text stays complete without the thing.
        let follows = match clause.thing {
            Some(_) => before == Some(Kind::Straight),
            None => before.is_some_and(Kind::goes_on),
        };
        let needs = Needs {
            motion,
            names_room: has_to_name(told, at, brief),
            is_near_door: clause.kind != Kind::StopIn || walked_in_m(clause.at, brief) <= STEP_M,
            leaves: goes_out(clause, brief),
            may_run: follows,
        };
        let shape = self.shape(clause, needs, rng);
        let side = clause.side.map_or("", side_word);
        let thing = clause.thing.as_ref().map(|thing| {
            let name = self.thing(&thing.name);
            let says_colour = thing.needs_colour || rng.random_bool(COLOURED);
            let colour = thing.colour.as_ref().filter(|_| says_colour);
            let name = colour.map_or(name.clone(), |colour| format!("{colour} {name}"));
            let name = match thing.alike {
                // "The two gold lamps".
                2 if rng.random_bool(0.3) => counted(2, &name),
                2.. if rng.random_bool(0.6) => plural(&name),
                _ => name,
            };
            thing.with.as_ref().map_or(name.clone(), |other| format!("{name} and {other}"))
        });
        let mut room = |room: Option<&String>| room.map(|room| self.room(room)).unwrap_or_default();
        let (room, from) = (room(clause.room.as_ref()), room(clause.from.as_ref()));
        let gaps = [
            ("{s}", side),
            ("{p}", side),
            ("{l}", thing.as_deref().unwrap_or_default()),
            ("{r}", room.as_str()),
            ("{a}", from.as_str()),
        ];
        let is_clause = !["in", "at", "with"].contains(&shape.split(' ').next().unwrap_or_default());
        Phrase { text: fill(&shape, &gaps), is_clause }
    }

    /// A shape of the clause's kind, by its share.
    fn shape(&self, clause: &Clause, needs: Needs, rng: &mut ChaCha8Rng) -> String {
        let own = Way::built_in().shapes.get(&clause.kind);
        let shapes = self.way.shapes.get(&clause.kind).or(own);
        let ahead = clause.thing.as_ref().is_none_or(|thing| thing.in_front);
        let usual = clause.room.as_deref().and_then(room_name);
        let is_open_air = matches!(usual, Some("porch" | "balcony" | "outdoor area"));
        // A hallway is not called "the room", and a porch has no walls to leave it by.
        let has_walls = !is_open_air && !matches!(usual, Some("hallway" | "entryway"));
        let is_room = |shape: &str| {
            let names_none = shape.split(' ').any(|word| word == "room");
            (clause.room.is_some() || !shape.contains("{r}")) && ((has_walls && !needs.names_room) || !names_none)
        };
        let fits = |shape: &&String| {
            suits(shape, needs.motion)
                && (ahead || !shape.contains("front"))
                && is_room(shape)
                && (is_open_air || !shape.contains("onto the {r}") && !shape.contains("out into the {r}"))
                && (needs.is_near_door
                    || !["just inside", "once you", "doorway"].iter().any(|near| shape.contains(near)))
                && (needs.leaves || !["exit", "leave", "out "].iter().any(|out| shape.contains(out)))
                && (needs.may_run || !is_until(shape))
        };
        let all: Vec<(f64, &String)> = shapes
            .into_iter()
            .flatten()
            .filter(|(shape, _)| fits(shape))
            .map(|(shape, count)| (*count, shape))
            .collect();
        draw(&all, rng).cloned().unwrap_or_else(|| plain(clause.kind).to_owned())
    }

    fn room(&mut self, room: &str) -> String {
        self.name(room, room_name(room).and_then(|usual| self.way.rooms.get(usual)))
    }

    /// A label that is more precise than the usual name ("round table") often stays as it is.
    fn thing(&mut self, name: &str) -> String {
        let names = thing(name).and_then(|thing| self.way.things.get(thing.name));
        let says_more = names.is_some_and(|names| !names.contains_key(name));
        let names = names.filter(|_| !says_more || self.dice.by(&["usual name", name]).random_bool(0.4));
        self.name(name, names)
    }

    fn name(&mut self, name: &str, names: Option<&BTreeMap<String, f64>>) -> String {
        if let Some(chosen) = self.chosen.get(name) {
            return chosen.clone();
        }
        let all: Vec<(f64, &String)> = names.into_iter().flatten().map(|(name, count)| (*count, name)).collect();
        let drawn = draw(&all, &mut self.dice.by(&["name", name]));
        let chosen = drawn.cloned().unwrap_or_else(|| name.to_owned());
        self.chosen.insert(name.to_owned(), chosen.clone());
        chosen
    }
}

/// Whether a clause has to name its room, because "the room" would be unclear: it is the room of the end, a later
/// clause mentions it, or no earlier clause named it.
fn has_to_name(told: &[Clause], at: usize, brief: &Brief<'_>) -> bool {
    let Some(room) = &told[at].room else { return false };
    let speaks_of_it = |clause: &Clause| clause.room.as_ref() == Some(room) || clause.from.as_ref() == Some(room);
    let (before, after) = (told[..at].iter().any(speaks_of_it), told[at + 1..].iter().any(speaks_of_it));
    match told[at].kind {
        Kind::Leave | Kind::LeaveByDoor => at > 0 && !before,
        Kind::StopIn => !before,
        // The thing in the room identifies it.
        Kind::EnterWith => after,
        _ => after || brief.memory.room(brief.memory.frames().saturating_sub(1)) == Some(room),
    }
}

/// The words of a kind where no shape fits.
fn plain(kind: Kind) -> &'static str {
    match kind {
        Kind::Straight => "keep going",
        Kind::StopAt => "stop by the {l}",
        Kind::Pass | Kind::PassOnSide | Kind::To => "go past the {l}",
        Kind::StopIn => "stop there",
        _ => "keep on",
    }
}

/// Estimates the number of words of clauses from the mean length of their shapes.
pub(super) struct Lengths<'a> {
    way: &'a Way,
    known: BTreeMap<Kind, f64>,
}

/// Mean number of words that join a clause to the one before.
const JOINT_WORDS: f64 = 0.6;
/// Expected words for a second thing, which half of the places with that option have, and words for a side.
const PAIR_WORDS: f64 = 1.0;
const SIDE_WORDS: f64 = 2.0;
/// The assumed share of places for things that get one. It is fixed, so that the plan does not depend on the things
/// that are seen.
const WITH_A_THING: f64 = 0.6;

impl<'a> Lengths<'a> {
    pub(super) fn of(way: &'a Way) -> Self {
        Self { way, known: BTreeMap::new() }
    }

    /// Number of words of a plan if this share of its places for things gets one.
    fn sum(&mut self, plan: &[Clause], with_a_thing: f64) -> f64 {
        let all = plan.iter().map(|clause| {
            let (with, without) = self.with_and_without(clause);
            without + with_a_thing * (with - without)
        });
        all.sum::<f64>() - JOINT_WORDS
    }

    /// How many words a plan is expected to have.
    pub(super) fn expected(&mut self, plan: &[Clause]) -> f64 {
        self.sum(plan, WITH_A_THING)
    }

    /// Number of words of a plan if every place gets a thing.
    pub(super) fn most(&mut self, plan: &[Clause]) -> f64 {
        self.sum(plan, 1.0)
    }

    /// The words of a clause with its thing and without it.
    fn with_and_without(&mut self, clause: &Clause) -> (f64, f64) {
        let own = self.words(clause.kind) + JOINT_WORDS;
        let Some(offer) = &clause.offer else { return (own, own) };
        let with = match offer.role {
            Role::Turn => self.words(Kind::TurnAt) + JOINT_WORDS,
            Role::PassEnter => self.words(Kind::PassEnter) + JOINT_WORDS,
            Role::EnterWith => self.words(Kind::EnterWith) + JOINT_WORDS,
            Role::Stop(kind) => self.words(kind) + JOINT_WORDS,
            Role::Onward => own + if offer.tells_side { SIDE_WORDS } else { 0.0 },
        };
        let without = if clause.is_offer() { 0.0 } else { own };
        (with + if offer.pair { PAIR_WORDS } else { 0.0 }, without)
    }

    fn words(&mut self, kind: Kind) -> f64 {
        *self.known.entry(kind).or_insert_with(|| {
            let shapes = self.way.shapes.get(&kind).or(Way::built_in().shapes.get(&kind));
            let (mut words, mut texts) = (0.0, 0.0);
            for (shape, count) in shapes.into_iter().flatten() {
                words += count * shape.split(' ').count() as f64;
                texts += count;
            }
            if texts > 0.0 { words / texts } else { 3.0 }
        })
    }
}
