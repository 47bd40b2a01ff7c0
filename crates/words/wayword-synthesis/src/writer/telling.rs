//! The clauses of a way in the words of its style.

use super::{
    Brief,
    landmarks::Landmarks,
    phrases::{draw, fill, stay_phrase},
    route::{self, Clause, KEPT, side_word, stands_still, suits, usable_room},
    task,
};
use crate::style::way::{Joint, Kind, Way};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::Motion;
use wayword_language::{
    lexicon::{counted, plural, room_name, thing},
    text::{capital, word_count},
};

/// No text is cut shorter than this, words.
const LEAST_WORDS: usize = 8;
/// Clauses of less weight than this are left out of a text that is longer than its style's.
const OPTIONAL: u8 = 3;

/// A text that describes the way step by step. `task` is what to do at the end, in words, with the name of its object.
pub(super) fn the_way(brief: &Brief<'_>, task: Option<&(String, String)>, rng: &mut ChaCha8Rng) -> String {
    let mut landmarks = Landmarks::new(brief);
    if let Some((_, name)) = task {
        landmarks.reserve(name);
    }
    let mut clauses = route::clauses(brief, &mut landmarks, rng);
    let words = brief.length().max(LEAST_WORDS);
    while clauses.iter().map(|clause| length(clause.kind)).sum::<usize>() > words && drop_least(&mut clauses, OPTIONAL)
    {
    }
    let limit = brief.style.constraints.fewer_words_than.unwrap_or(usize::MAX);
    let full_stop = rng.random_bool(brief.profile.full_stops.clamp(0.0, 1.0));
    let mut names = Names { way: &brief.profile.way, chosen: BTreeMap::new() };
    loop {
        let mut told = clauses.clone();
        mend(&mut told, brief);
        let mut phrases: Vec<Phrase> = told.iter().map(|clause| names.phrase(clause, brief, rng)).collect();
        if let Some((task, _)) = task {
            phrases.pop();
            phrases.push(Phrase { text: task.clone(), is_clause: true });
        }
        let text = joined(&phrases, brief, full_stop, rng);
        if word_count(&text) < limit || !drop_least(&mut clauses, KEPT) {
            return text;
        }
    }
}

/// About how many words a clause has.
fn length(kind: Kind) -> usize {
    match kind {
        Kind::Stop => 1,
        Kind::Turn | Kind::TurnAround | Kind::Straight => 2,
        Kind::TurnSlightly | Kind::Leave | Kind::Enter => 3,
        Kind::PassEnter | Kind::StopAtIn => 9,
        Kind::TurnAt | Kind::StopAtTop | Kind::StopAtBottom | Kind::PassOnSide | Kind::LeaveEnter => 7,
        _ => 5,
    }
}

/// Leaves out the clause that matters least, if one matters less than `below`.
fn drop_least(clauses: &mut Vec<Clause>, below: u8) -> bool {
    let candidates = clauses.iter().enumerate().filter(|(_, clause)| clause.weight < below);
    let Some((at, _)) = candidates.min_by_key(|(at, clause)| (clause.weight, *at)) else { return false };
    clauses.remove(at);
    true
}

/// Puts right what leaving out clauses may have broken: a room that is left was entered, and of two turns in a row the
/// second has a place.
fn mend(clauses: &mut Vec<Clause>, brief: &Brief<'_>) {
    let start = brief.memory.room(0).and_then(usable_room);
    let mut known: BTreeSet<String> = start.into_iter().collect();
    clauses.retain(|clause| {
        let leaves = matches!(clause.kind, Kind::Leave | Kind::TurnOut);
        let is_known = !leaves || clause.from.as_ref().is_none_or(|from| known.contains(from));
        if !matches!(clause.kind, Kind::Leave | Kind::TurnOut) {
            known.extend(clause.room.clone());
        }
        is_known || clause.kind == Kind::TurnOut
    });
    for at in 0..clauses.len() {
        if let Kind::LeaveEnter | Kind::TurnOut = clauses[at].kind {
            let from = clauses[at].from.clone();
            let entered = clauses[..at].iter().any(|clause| clause.kind != Kind::Leave && clause.room == from);
            if !entered && from != brief.memory.room(0).map(str::to_owned) {
                let is_turn = clauses[at].kind == Kind::TurnOut;
                clauses[at].kind = if is_turn { Kind::Turn } else { Kind::Enter };
            }
        }
    }
    for at in 1..clauses.len() {
        if clauses[at].is_bare() && clauses[at - 1].is_bare() {
            give_place(&mut clauses[at], brief);
        }
    }
    while let Some(at) = (1..clauses.len()).find(|at| clauses[*at].is_bare() && clauses[*at - 1].is_bare()) {
        let mut onward = clauses[at].clone();
        onward.kind = Kind::Straight;
        clauses.insert(at, onward);
    }
}

/// A turn in the room in which it happens.
fn give_place(clause: &mut Clause, brief: &Brief<'_>) {
    let room = brief.memory.room(clause.at).and_then(usable_room);
    if clause.kind == Kind::Turn && room.is_some() {
        (clause.kind, clause.room) = (Kind::TurnIn, room);
    }
}

/// A clause in words.
struct Phrase {
    text: String,
    /// Whether it begins with its verb, so that "and" begins a clause before it.
    is_clause: bool,
}

/// The names that a text gives to rooms and things: one for each.
struct Names<'a> {
    way: &'a Way,
    chosen: BTreeMap<String, String>,
}

impl Names<'_> {
    fn phrase(&mut self, clause: &Clause, brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Phrase {
        if clause.kind == Kind::Straight && stands_still(brief.walk) {
            return Phrase { text: stay_phrase(None, rng), is_clause: true };
        }
        let motion = brief.walk.path.motion;
        let shape = self.shape(clause, motion, rng);
        let side = clause.side.map_or("", side_word);
        let thing = clause.thing.as_ref().map(|thing| {
            let name = self.thing(&thing.name, rng);
            let name = thing.colour.as_ref().map_or(name.clone(), |colour| format!("{colour} {name}"));
            match thing.alike {
                // "The two gold lamps".
                2 if rng.random_bool(0.3) => counted(2, &name),
                2.. if rng.random_bool(0.6) => plural(&name),
                _ => name,
            }
        });
        let mut room = |room: Option<&String>| room.map(|room| self.room(room, rng)).unwrap_or_default();
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
    fn shape(&self, clause: &Clause, motion: Motion, rng: &mut ChaCha8Rng) -> String {
        let own = Way::built_in().shapes.get(&clause.kind);
        let shapes = self.way.shapes.get(&clause.kind).or(own);
        let ahead = clause.thing.as_ref().is_none_or(|thing| thing.side == Some(wayword_core::Side::Ahead));
        // "The room" is no hallway, and nobody leaves a porch by it.
        let has_walls = clause
            .room
            .as_deref()
            .and_then(room_name)
            .is_none_or(|room| !matches!(room, "hallway" | "entryway" | "porch" | "balcony" | "outdoor area"));
        let is_room = |shape: &str| {
            let names_none = shape.split(' ').any(|word| word == "room");
            (clause.room.is_some() || !shape.contains("{r}")) && (has_walls || !names_none)
        };
        let fits = |shape: &&String| suits(shape, motion) && (ahead || !shape.contains("front")) && is_room(shape);
        let all: Vec<(f64, &String)> = shapes
            .into_iter()
            .flatten()
            .filter(|(shape, _)| fits(shape))
            .map(|(shape, count)| (*count, shape))
            .collect();
        draw(&all, rng).cloned().unwrap_or_else(|| plain(clause.kind).to_owned())
    }

    fn room(&mut self, room: &str, rng: &mut ChaCha8Rng) -> String {
        self.name(room, room_name(room).and_then(|usual| self.way.rooms.get(usual)), rng)
    }

    fn thing(&mut self, name: &str, rng: &mut ChaCha8Rng) -> String {
        self.name(name, thing(name).and_then(|thing| self.way.things.get(thing.name)), rng)
    }

    fn name(&mut self, name: &str, names: Option<&BTreeMap<String, f64>>, rng: &mut ChaCha8Rng) -> String {
        if let Some(chosen) = self.chosen.get(name) {
            return chosen.clone();
        }
        let all: Vec<(f64, &String)> = names.into_iter().flatten().map(|(name, count)| (*count, name)).collect();
        let chosen = draw(&all, rng).cloned().unwrap_or_else(|| name.to_owned());
        self.chosen.insert(name.to_owned(), chosen.clone());
        chosen
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

/// The clauses joined into sentences, as the style joins them.
fn joined(phrases: &[Phrase], brief: &Brief<'_>, full_stop: bool, rng: &mut ChaCha8Rng) -> String {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    let most = constraints.max_sentences.unwrap_or(usize::MAX).max(least);
    let way = &brief.profile.way;
    let mut joints: Vec<Joint> = vec![Joint::Start];
    for (at, phrase) in phrases.iter().enumerate().skip(1) {
        let shares = if at + 1 == phrases.len() { &way.stop_joints } else { &way.joints };
        let before = joints[at - 1];
        let weight = |joint: &Joint, share: f64| {
            let is_again = *joint == before && !joint.begins_sentence();
            let has_verb = phrase.is_clause || matches!(joint, Joint::Stop | Joint::Comma);
            if has_verb { share * if is_again { 0.3 } else { 1.0 } } else { 0.0 }
        };
        let all: Vec<(f64, Joint)> = shares.iter().map(|(joint, share)| (weight(joint, *share), *joint)).collect();
        joints.push(draw(&all, rng).unwrap_or(Joint::Stop));
    }
    let begins = |joints: &[Joint]| joints.iter().filter(|joint| joint.begins_sentence()).count();
    while begins(&joints) < least {
        let within: Vec<usize> = (1..joints.len()).filter(|at| !joints[*at].begins_sentence()).collect();
        if within.is_empty() {
            break;
        }
        joints[within[rng.random_range(0..within.len())]] = Joint::Stop;
    }
    while begins(&joints) > most {
        let Some(at) = (1..joints.len()).find(|at| joints[*at].begins_sentence()) else { break };
        joints[at] = if phrases[at].is_clause { Joint::And } else { Joint::Comma };
    }
    let mut text = String::new();
    for (joint, phrase) in joints.iter().zip(phrases) {
        let words = match joint {
            Joint::Start => capital(&phrase.text),
            Joint::Stop => format!(". {}", capital(&phrase.text)),
            Joint::StopThen => format!(". Then {}", phrase.text),
            _ => format!("{}{}", joint.words(), phrase.text),
        };
        text.push_str(&words);
    }
    if full_stop || begins(&joints) > 1 {
        text.push('.');
    }
    text
}

/// The task of a text that ends in one.
pub(super) fn ending(brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Result<Option<(String, String)>, super::WriteError> {
    let ends = brief.style.constraints.ends_in_task || rng.random_bool(brief.profile.tasks.clamp(0.0, 1.0));
    if ends { task::task(brief, rng).map(Some) } else { Ok(None) }
}
