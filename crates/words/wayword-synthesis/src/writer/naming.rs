//! Puts the clauses of a way into words: draws a shape for each, and one name for each room and thing of the text.

use super::{
    WritingBrief,
    dice::TextDice,
    landmarks::lies_on_floor,
    phrases::{draw_option, fill_gaps, ordinal_of, stay_phrase},
    route::{OfferRole, WayClause, side_word, stands_still, told_until},
    shape_needs::ShapeNeeds,
    task::TaskContent,
};
use crate::style::way::{ClauseKind, ShapeTraits, WayWording, is_door_word, is_until};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::Side;
use wayword_language::lexicon::{ThingClass, counted_name, find_thing, room_name, to_plural};

/// A clause in words.
#[derive(Clone)]
pub(super) struct ClausePhrase {
    pub(super) text: String,
    /// Whether it begins with a verb, so that it can follow "and".
    pub(super) is_clause: bool,
    /// Whether it limits the clause before it, as in "until you reach the sofa".
    pub(super) runs_on: bool,
    /// What it tells.
    pub(super) content: PhraseContent,
}

/// What a phrase tells, apart from its words.
#[derive(Clone)]
pub(super) enum PhraseContent {
    /// To stay, on a path that goes nowhere.
    Stay,
    /// A clause of a way.
    Clause(ClauseContent),
    /// A task.
    Task(TaskContent),
}

/// What a clause of a way names, in English. What its words leave out is `None`.
#[derive(Clone)]
pub(super) struct ClauseContent {
    pub(super) kind: ClauseKind,
    pub(super) side: Option<Side>,
    pub(super) thing: Option<NamedThing>,
    /// The name of its room; empty where the words have "the room" or none.
    pub(super) room: String,
    /// The name of the room that it leaves.
    pub(super) from: String,
    /// Which of the doors on its side it means, where that is not the first.
    pub(super) door_number: Option<usize>,
    /// Whether its words name the thing before the room.
    pub(super) thing_first: bool,
    pub(super) needs: ShapeNeeds,
}

/// A thing as a text names it, in English.
#[derive(Clone)]
pub(super) struct NamedThing {
    pub(super) name: String,
    pub(super) colour: Option<String>,
    /// How many it speaks of: one, two, or several without a number.
    pub(super) count: ThingCount,
    /// Another thing that is named with it.
    pub(super) with: Option<String>,
}

/// How many things a name is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ThingCount {
    One,
    Two,
    Several,
}

impl NamedThing {
    /// Its words: "the two gold lamps and table", without the article.
    fn english(&self) -> String {
        let name = self.colour.as_ref().map_or(self.name.clone(), |colour| format!("{colour} {}", self.name));
        let name = match self.count {
            ThingCount::One => name,
            ThingCount::Two => counted_name(2, &name),
            ThingCount::Several => to_plural(&name),
        };
        self.with.as_ref().map_or(name.clone(), |other| format!("{name} and {other}"))
    }
}

/// Share of things that get a colour although they do not need one.
const COLOUR_SHARE: f64 = 0.25;

/// Whether people see a thing in the one colour that its material has: a picture has a subject and a frame, and a mirror shows the room.
fn shows_one_colour(name: &str) -> bool {
    !find_thing(name).is_some_and(|thing| matches!(thing.class, ThingClass::WallArt | ThingClass::Glass))
}

/// The names that a text gives to rooms and things: one for each.
#[derive(Clone)]
pub(super) struct ChosenNames<'a> {
    way: &'a WayWording,
    /// The chosen name of each room and thing, by the name in the evidence.
    chosen: BTreeMap<String, String>,
    /// The usual names of the rooms of the walk.
    walk_rooms: BTreeSet<&'static str>,
    /// Whether the walk leads over the graph of a scan. Labels of scans say how a room was built, and people say how it looks; generated and
    /// drawn rooms are what they are called.
    is_scan: bool,
    dice: TextDice,
}

impl<'a> ChosenNames<'a> {
    pub(super) fn for_way(brief: &'a WritingBrief<'_>, dice: TextDice) -> Self {
        let walk_rooms = brief.memory.stays.iter().filter_map(|stay| room_name(&stay.room)).collect();
        let is_scan = brief.memory.is_on_graph();
        Self { way: &brief.profile.way, chosen: BTreeMap::new(), walk_rooms, is_scan, dice }
    }

    /// Clause number `at` of a text in words. The clauses around it decide what its words may leave out.
    pub(super) fn clause_phrase(
        &mut self,
        clauses: &[WayClause],
        at: usize,
        brief: &WritingBrief<'_>,
        dice: TextDice,
    ) -> ClausePhrase {
        let clause = &clauses[at];
        let rng = &mut clause.clause_rng("words", dice);
        if clause.kind == ClauseKind::Straight && stands_still(brief.walk) {
            let text = stay_phrase(None, rng);
            return ClausePhrase { text, is_clause: true, runs_on: false, content: PhraseContent::Stay };
        }
        let door_number = door_number(clauses, at, brief);
        let needs = ShapeNeeds::of_clause(clauses, at, door_number, brief);
        let shape = self.draw_shape(clause, &needs, rng);
        let thing = clause.thing.as_ref().map(|thing| {
            let name = self.name_thing(&thing.name);
            let says_colour = thing.needs_colour || rng.random_bool(COLOUR_SHARE);
            let colour = thing.colour.clone().filter(|_| says_colour && shows_one_colour(&thing.name));
            // Several alike are mostly, but not always, named in the plural.
            let count = match thing.alike {
                2 if rng.random_bool(0.3) => ThingCount::Two,
                2.. if rng.random_bool(0.6) => ThingCount::Several,
                _ => ThingCount::One,
            };
            NamedThing { name, colour, count, with: thing.with.clone() }
        });
        let mut room = |room: Option<&String>| room.map(|room| self.name_room(room)).unwrap_or_default();
        let (room, from) = (room(clause.room.as_ref()), room(clause.from.as_ref()));
        let side = clause.side.map_or("", side_word);
        let phrase = thing.as_ref().map(NamedThing::english).unwrap_or_default();
        let gaps =
            [("{s}", side), ("{p}", side), ("{l}", phrase.as_str()), ("{r}", room.as_str()), ("{a}", from.as_str())];
        let is_clause = !["in", "at", "with"].contains(&shape.split(' ').next().unwrap_or_default());
        let numbered = door_number.and_then(|number| number_door(&shape, number)).unwrap_or(shape);
        let text = fill_gaps(&numbered, &gaps);
        let thing_first = ShapeTraits::names_thing_first(&numbered);
        let room = if numbered.contains("{r}") { room } else { String::new() };
        let content =
            ClauseContent { kind: clause.kind, side: clause.side, thing, room, from, door_number, thing_first, needs };
        ClausePhrase { runs_on: is_until(&text), text, is_clause, content: PhraseContent::Clause(content) }
    }

    /// A shape of the clause's kind, by its share.
    fn draw_shape(&self, clause: &WayClause, needs: &ShapeNeeds, rng: &mut ChaCha8Rng) -> String {
        let own = WayWording::built_in().shapes.get(&clause.kind);
        let shapes = self.way.shapes.get(&clause.kind).or(own);
        let fits = |shape: &&String| {
            needs.admit(&ShapeTraits::of_english(shape))
                && needs.door_number.is_none_or(|number| number_door(shape, number).is_some())
        };
        let all: Vec<(f64, &String)> = shapes
            .into_iter()
            .flatten()
            .filter(|(shape, _)| fits(shape))
            .map(|(shape, count)| (*count, shape))
            .collect();
        draw_option(&all, rng).cloned().unwrap_or_else(|| plain_words(clause.kind).to_owned())
    }

    fn name_room(&mut self, room: &str) -> String {
        let usual = room_name(room);
        let by_label = usual.and_then(|usual| self.way.rooms_by_label.get(usual)).filter(|_| self.is_scan);
        match by_label {
            Some(names) => self.chosen_name(room, Some(&self.free_names(room, usual, names))),
            None => self.chosen_name(room, usual.and_then(|usual| self.way.rooms.get(usual))),
        }
    }

    /// The names that a room of a scan may get. No two rooms of a text get one name, and none gets that of another room of the walk: a
    /// family room is not called "living room" on the way to the living room.
    fn free_names(&self, room: &str, usual: Option<&str>, names: &BTreeMap<String, f64>) -> BTreeMap<String, f64> {
        let is_free = |name: &String| {
            let is_taken = self.chosen.iter().any(|(other, chosen)| other != room && chosen == name);
            let other = room_name(name).filter(|other| Some(*other) != usual);
            !is_taken && !other.is_some_and(|other| self.walk_rooms.contains(other))
        };
        names.iter().filter(|(name, _)| is_free(name)).map(|(name, texts)| (name.clone(), *texts)).collect()
    }

    /// A label that is more precise than the usual name ("round table") often stays as it is.
    fn name_thing(&mut self, name: &str) -> String {
        let names = find_thing(name).and_then(|thing| self.way.things.get(thing.name));
        let says_more = names.is_some_and(|names| !names.contains_key(name));
        let names = names.filter(|_| !says_more || self.dice.named_rng(&["usual name", name]).random_bool(0.4));
        self.chosen_name(name, names)
    }

    /// The name that was chosen for a room or thing before, or else one that is drawn from `names` by its count.
    fn chosen_name(&mut self, name: &str, names: Option<&BTreeMap<String, f64>>) -> String {
        if let Some(chosen) = self.chosen.get(name) {
            return chosen.clone();
        }
        let all: Vec<(f64, &String)> = names.into_iter().flatten().map(|(name, count)| (*count, name)).collect();
        let drawn = draw_option(&all, &mut self.dice.named_rng(&["name", name]));
        let chosen = drawn.cloned().unwrap_or_else(|| name.to_owned());
        self.chosen.insert(name.to_owned(), chosen.clone());
        chosen
    }
}

/// Which of the doors on its side a clause means, counted from the last place that the text names before; `None` for the first, and
/// where doors are not known.
fn door_number(clauses: &[WayClause], at: usize, brief: &WritingBrief<'_>) -> Option<usize> {
    let (clause, memory) = (&clauses[at], brief.memory);
    let side = clause.side.filter(|_| clause.kind == ClauseKind::DoorOnSide)?;
    let before = &clauses[..at];
    let things = before.iter().filter_map(|before| before.thing.as_ref()).filter(|thing| !lies_on_floor(&thing.name));
    let thing = things.filter_map(|thing| thing.passed).map(|(frame, _)| frame).max();
    let from = told_until(before, memory).max(thing.unwrap_or(0)).min(clause.at);
    memory.door_number(side, from, clause.at).filter(|number| *number > 1)
}

/// A shape whose door gets a number: "the second door on the {p}".
fn number_door(shape: &str, number: usize) -> Option<String> {
    let number = ordinal_of(u32::try_from(number).ok()?)?;
    let mut words: Vec<&str> = shape.split(' ').collect();
    let at = (1..words.len()).find(|at| is_door_word(words[*at]) && words[at - 1] == "the")?;
    words.insert(at, number);
    Some(words.join(" "))
}

/// The words of a kind where no shape fits.
fn plain_words(kind: ClauseKind) -> &'static str {
    match kind {
        ClauseKind::Straight => "keep going",
        ClauseKind::StopAt => "stop by the {l}",
        ClauseKind::Pass | ClauseKind::PassOnSide | ClauseKind::To => "go past the {l}",
        ClauseKind::StopIn => "stop there",
        _ => "keep on",
    }
}

/// Estimates the number of words of clauses from the mean length of their shapes.
pub(super) struct ClauseLengths<'a> {
    way: &'a WayWording,
    /// The mean length of each kind that was asked for, words.
    known: BTreeMap<ClauseKind, f64>,
}

/// Mean number of words that join a clause to the one before.
const JOINT_WORDS: f64 = 0.6;
/// Expected words for a second thing, which half of the places with that option have.
const PAIR_WORDS: f64 = 1.0;
/// Words for the side of a thing.
const SIDE_WORDS: f64 = 2.0;
/// The assumed share of places for things that get one. It is fixed, so that the plan does not depend on the things
/// that are seen.
const FILLED_OFFER_SHARE: f64 = 0.6;

impl<'a> ClauseLengths<'a> {
    pub(super) fn for_way(way: &'a WayWording) -> Self {
        Self { way, known: BTreeMap::new() }
    }

    /// Number of words of a plan if this share of its places for things gets one.
    fn sum_words(&mut self, plan: &[WayClause], with_a_thing: f64) -> f64 {
        let all = plan.iter().map(|clause| {
            let (with, without) = self.with_and_without(clause);
            without + with_a_thing * (with - without)
        });
        all.sum::<f64>() - JOINT_WORDS
    }

    /// How many words a plan is expected to have.
    pub(super) fn expected_words(&mut self, plan: &[WayClause]) -> f64 {
        self.sum_words(plan, FILLED_OFFER_SHARE)
    }

    /// Number of words of a plan if every place gets a thing.
    pub(super) fn most_words(&mut self, plan: &[WayClause]) -> f64 {
        self.sum_words(plan, 1.0)
    }

    /// The words of a clause with its thing and without it.
    fn with_and_without(&mut self, clause: &WayClause) -> (f64, f64) {
        let own = self.kind_words(clause.kind) + JOINT_WORDS;
        let Some(offer) = &clause.offer else { return (own, own) };
        let with = match offer.role {
            OfferRole::Turn => self.kind_words(ClauseKind::TurnAt) + JOINT_WORDS,
            OfferRole::PassEnter => self.kind_words(ClauseKind::PassEnter) + JOINT_WORDS,
            OfferRole::EnterWith => self.kind_words(ClauseKind::EnterWith) + JOINT_WORDS,
            OfferRole::Stop(kind) => self.kind_words(kind) + JOINT_WORDS,
            OfferRole::Onward => own + if offer.tells_side { SIDE_WORDS } else { 0.0 },
        };
        let without = if clause.is_offer() { 0.0 } else { own };
        (with + if offer.pair { PAIR_WORDS } else { 0.0 }, without)
    }

    /// The mean number of words of the shapes of a kind.
    fn kind_words(&mut self, kind: ClauseKind) -> f64 {
        *self.known.entry(kind).or_insert_with(|| {
            let shapes = self.way.shapes.get(&kind).or(WayWording::built_in().shapes.get(&kind));
            let (mut words, mut texts) = (0.0, 0.0);
            for (shape, count) in shapes.into_iter().flatten() {
                words += count * shape.split(' ').count() as f64;
                texts += count;
            }
            if texts > 0.0 { words / texts } else { 3.0 }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{style::built_in, walk::ObservedWalk};
    use wayword_checks::{Evidence, WalkMemory};
    use wayword_core::{Path, PathMotion, SceneId};

    /// The names that texts with these draws give to two rooms of a walk.
    fn names_of(rooms: [&'static str; 2], draws: usize) -> BTreeSet<[String; 2]> {
        let path = Path {
            id: "p".into(),
            scene: SceneId::new("s").unwrap(),
            frames: Vec::new(),
            motion: PathMotion::Known,
            target: None,
        };
        let memory = WalkMemory::from_path(&Evidence::for_path_alone(&path), &path);
        let (walk, style) = (ObservedWalk::new(path, Vec::new()), built_in("r2r").unwrap());
        let profile = crate::style::StyleProfile::for_style(&style);
        let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
        let dice = TextDice::for_brief(&brief);
        let named = |number| {
            let mut names = ChosenNames::for_way(&brief, dice.other_draws(number));
            names.walk_rooms = rooms.into_iter().filter_map(room_name).collect();
            names.is_scan = true;
            rooms.map(|room| names.name_room(room))
        };
        (0..draws).map(named).collect()
    }

    #[test]
    fn a_room_is_called_as_people_call_it_and_like_no_other_room_of_the_walk() {
        let alone: BTreeSet<String> =
            names_of(["family room", "kitchen"], 60).into_iter().map(|[name, _]| name).collect();
        assert!(alone.contains("living room"), "{alone:?}");
        for [family, living] in names_of(["family room", "living room"], 60) {
            assert!(family != living && family != "living room", "{family}, {living}");
        }
    }
}
