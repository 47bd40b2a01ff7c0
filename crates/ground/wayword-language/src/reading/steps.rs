//! Divides a text into the walker's steps. A step is a clause, or a part of one with at most one turn.

mod relation;

use super::{EventContent, StoreyMention, TextEvent, TextReading};
use crate::{lexicon::room_name, text::TextToken};
pub use relation::StepRelation;
use std::ops::Range;
use wayword_core::{ClimbDirection, Side};

crate::data::lists! {
    "languages/en/steps.txt";
    words: MARKING, CONDITIONS, SLIGHT, STRAIGHT, DOOR_WORDS, STAIR_WORDS, OUTDOORS, TOPS, BOTTOMS, LEAVING_WORDS, TURN_VERBS;
    phrases: KEEPING_ON;
}

/// One step of an instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct InstructionStep {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// Its turn; `Behind` for a turn around. Never `Ahead`.
    pub turn: Option<Side>,
    /// The byte range of the words of that turn.
    pub turn_span: Option<[usize; 2]>,
    /// Whether the text calls the turn slight.
    pub is_slight: bool,
    /// Its climb: a flight of stairs, or a few steps.
    pub climb: Option<ClimbDirection>,
    /// The storey that it mentions as a location: "the kitchen on level 2".
    pub floor: Option<StoreyMention>,
    /// Whether something lies up or down the stairs: "the bedroom upstairs".
    pub storey: Option<ClimbDirection>,
    /// Whether it is a command to stop or to wait.
    pub stops: bool,
    /// Whether it is a command to go straight on.
    pub is_straight: bool,
    /// Whether it only gives the time of something: "until you reach the sofa", "once you are out".
    pub is_condition: bool,
    /// Whether it speaks of the end of something: "at the end of the hallway".
    pub at_end: bool,
    /// Its relation to doors.
    pub door: StepDoor,
    /// Its relation to stairs.
    pub stairs: StepStairs,
    /// Whether it leads outside the house, and names no room there.
    pub is_outdoors: bool,
    /// A side on which the step locates a thing, and how the step relates to that thing: "the door on your left".
    pub side: Option<(StepRelation, Side)>,
    /// The landmarks and rooms that it names.
    pub places: Vec<StepMention>,
    /// Which words of the list [`MARKING`] it has, as indices into the list.
    pub marks: Vec<usize>,
}

/// A place that a step names.
#[derive(Debug, Clone, PartialEq)]
pub struct StepMention {
    /// Its event in the reading.
    pub event: usize,
    /// How the step relates to it.
    pub relation: StepRelation,
}

/// How a step relates to doors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StepDoor {
    /// It has no door.
    None,
    /// It leads from one room to another.
    Implied,
    /// It names a door.
    Named,
    /// It leads through a door that it names.
    Through,
}

/// How a step relates to stairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StepStairs {
    /// It has no stairs.
    None,
    /// It names them.
    Named,
    /// It names their upper end.
    Top,
    /// It names their lower end.
    Bottom,
}

/// The steps of a text that was read. Denied events are no part of them.
#[must_use]
pub fn read_steps(reading: &TextReading) -> Vec<InstructionStep> {
    let (tokens, denied) = (reading.tokens(), reading.denied_tokens());
    let first_token = |event: &TextEvent| tokens.partition_point(|token| token.span[0] < event.span[0]);
    let events: Vec<(usize, &TextEvent)> = reading.events.iter().map(|event| (first_token(event), event)).collect();
    let mut next_event = 0;
    let mut steps = Vec::new();
    for range in step_ranges(tokens, reading.token_clauses(), &events) {
        let from = next_event;
        next_event += events[from..].partition_point(|(at, _)| *at < range.end);
        steps.extend(StepBuilder { tokens, denied, range, first_event: from }.build_step(&events[from..next_event]));
    }
    steps
}

/// How far behind its verb the side of a turn may be, words.
const TURN_REACH_WORDS: usize = 5;

/// Cuts the tokens at clauses, before a condition, and before a second turn.
fn step_ranges(tokens: &[TextToken], clauses: &[usize], events: &[(usize, &TextEvent)]) -> Vec<Range<usize>> {
    let mut turns =
        events.iter().filter(|(_, event)| matches!(event.what, EventContent::Turn(_))).map(|(at, _)| *at).peekable();
    let mut cuts = vec![0];
    let (mut has_word, mut has_turn) = (false, false);
    let events_before = |at: usize| events.partition_point(|(event, _)| *event < at);
    for (at, token) in tokens.iter().enumerate() {
        let is_turn = std::iter::from_fn(|| turns.next_if(|turn| *turn <= at)).last() == Some(at);
        let new_clause = at > 0 && clauses[at] != clauses[at - 1];
        let is_condition = CONDITIONS.contains(&token.word.as_str());
        // "Walk down the hallway turn left": a turn without an "and".
        let begins_turn = TURN_VERBS.contains(&token.word.as_str())
            && clauses.get(at + 1).is_some_and(|clause| *clause == clauses[at])
            && events_before(*cuts.last().unwrap_or(&0)) < events_before(at)
            && events[events_before(at)..].first().is_some_and(|(turn, event)| {
                *turn <= at + TURN_REACH_WORDS
                    && clauses[*turn] == clauses[at]
                    && matches!(event.what, EventContent::Turn(_))
            });
        if new_clause || (has_word && is_condition) || (is_turn && has_turn) || (has_word && begins_turn) {
            cuts.push(at);
            (has_word, has_turn) = (false, false);
        }
        has_word |= token.is_word() && !matches!(token.word.as_str(), "and" | "then" | "or");
        has_turn |= is_turn;
    }
    cuts.push(tokens.len());
    cuts.windows(2).map(|pair| pair[0]..pair[1]).collect()
}

/// Puts one step together.
struct StepBuilder<'a> {
    tokens: &'a [TextToken],
    /// For each token, whether the text denies it.
    denied: &'a [bool],
    /// The tokens of the step.
    range: Range<usize>,
    /// The number of the first of its events.
    first_event: usize,
}

impl StepBuilder<'_> {
    /// The step; `None` where it has no words.
    fn build_step(&self, events: &[(usize, &TextEvent)]) -> Option<InstructionStep> {
        let first = self.range.clone().find(|at| self.tokens[*at].is_word())?;
        let last = self.range.clone().rev().find(|at| self.tokens[*at].is_word())?;
        let mut step = InstructionStep {
            span: [self.tokens[first].span[0], self.tokens[last].span[1]],
            turn: None,
            turn_span: None,
            is_slight: self.has_word(&SLIGHT) || self.continues_slight(first),
            climb: None,
            floor: None,
            storey: None,
            stops: false,
            is_straight: self.has_word(&STRAIGHT) || self.has_phrase(&KEEPING_ON),
            is_condition: CONDITIONS.contains(&self.tokens[first].word.as_str()),
            at_end: self.has_word(&["end"]),
            door: StepDoor::None,
            stairs: self.step_stairs(),
            is_outdoors: false,
            side: None,
            places: Vec::new(),
            marks: (0..MARKING.len()).filter(|mark| self.has_word(&MARKING[*mark..=*mark])).collect(),
        };
        let names_room = self.take_events(events, &mut step);
        step.is_outdoors = !names_room && self.has_word(&OUTDOORS);
        if step.door == StepDoor::None && self.has_word(&LEAVING_WORDS) {
            step.door = StepDoor::Implied;
        }
        if step.side.is_none() && step.turn.is_none() {
            step.side = self.named_side().map(|side| (StepRelation::Plain, side));
        }
        Some(step)
    }

    /// Puts the events into the step. Returns whether one of them names a room.
    fn take_events(&self, events: &[(usize, &TextEvent)], step: &mut InstructionStep) -> bool {
        // The place before, by its first word in the step, with its relation.
        let mut before = None;
        let mut names_room = false;
        for (number, (at, event)) in events.iter().enumerate().filter(|(_, (_, event))| !event.denied) {
            match &event.what {
                EventContent::Turn(side) => {
                    step.turn = step.turn.or(Some(*side));
                    step.turn_span = step.turn_span.or(Some(event.span));
                }
                EventContent::Climb(climb) | EventContent::Steps(climb) => step.climb = step.climb.or(Some(*climb)),
                EventContent::Floor(floor) if !floor.leaves && !floor.aside => step.floor = Some(*floor),
                EventContent::Storey(climb) => step.storey = Some(*climb),
                EventContent::Stop => step.stops = true,
                EventContent::Place(place) => {
                    let relation = StepRelation::from_place(place, &self.tokens[self.range.start..*at], before);
                    before = Some((*at - self.range.start, relation));
                    names_room |= place.is_room;
                    step.door = step.door.max(door_for(&place.name, relation));
                    if room_name(&place.name) == Some("stairs") {
                        step.stairs = step.stairs.max(StepStairs::Named);
                    }
                    if let (Some(side @ (Side::Left | Side::Right)), None) = (place.side, step.side) {
                        step.side = Some((relation, side));
                    }
                    let event = self.first_event + number;
                    step.places.push(StepMention { event, relation });
                }
                _ => {}
            }
        }
        names_room
    }

    /// Its tokens that are not denied.
    fn undenied_tokens(&self) -> impl Iterator<Item = usize> {
        self.range.clone().filter(|at| !self.denied[*at])
    }

    /// Whether the step has a word of a list.
    fn has_word(&self, list: &[&str]) -> bool {
        self.undenied_tokens().any(|at| list.contains(&self.tokens[at].word.as_str()))
    }

    /// Whether the step has no verb of its own behind a slight turn: "bear right at the sofa, left at the lamp".
    fn continues_slight(&self, first: usize) -> bool {
        let word = |at: usize| self.tokens[at].word.as_str();
        if !matches!(word(first), "left" | "right") {
            return false;
        }
        let before = (0..first).rev().find(|at| TURN_VERBS.contains(&word(*at)) || SLIGHT.contains(&word(*at)));
        before.is_some_and(|at| SLIGHT.contains(&word(at)) && !self.denied[at])
    }

    /// Whether the step has a phrase of a list.
    fn has_phrase(&self, list: &[Vec<&str>]) -> bool {
        let words = &self.tokens[self.range.clone()];
        let begins_at = |at: usize, phrase: &[&str]| {
            words[at..].iter().map(|token| token.word.as_str()).take(phrase.len()).eq(phrase.iter().copied())
        };
        let is_told = |at: usize| !self.denied[self.range.start + at];
        (0..words.len()).any(|at| is_told(at) && list.iter().any(|phrase| begins_at(at, phrase)))
    }

    /// How the step relates to stairs, by its words.
    fn step_stairs(&self) -> StepStairs {
        match self.has_word(&STAIR_WORDS) {
            false => StepStairs::None,
            true if self.has_word(&BOTTOMS) => StepStairs::Bottom,
            true if self.has_word(&TOPS) => StepStairs::Top,
            true => StepStairs::Named,
        }
    }

    /// A side that the step names in any way, but not the "right" of "right before".
    fn named_side(&self) -> Option<Side> {
        let words = &self.tokens[self.range.clone()];
        let right_before = |at: usize| words.get(at + 1).is_some_and(|next| matches!(&*next.word, "before" | "after"));
        self.undenied_tokens().find_map(|at| match self.tokens[at].word.as_str() {
            "left" => Some(Side::Left),
            "right" if !right_before(at - self.range.start) => Some(Side::Right),
            _ => None,
        })
    }
}

/// How a step that names this place relates to doors.
fn door_for(name: &str, relation: StepRelation) -> StepDoor {
    let is_door = name.split(' ').any(|word| DOOR_WORDS.contains(&word)) || name == "room";
    match relation {
        StepRelation::Through | StepRelation::OutOf | StepRelation::Into if is_door => StepDoor::Through,
        StepRelation::OutOf | StepRelation::Into => StepDoor::Implied,
        _ if is_door => StepDoor::Named,
        _ => StepDoor::None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::read_instruction;
    use std::collections::BTreeSet;

    fn told(text: &str) -> Vec<(String, InstructionStep)> {
        let reading = read_instruction(text, &BTreeSet::new());
        read_steps(&reading).into_iter().map(|step| (text[step.span[0]..step.span[1]].to_owned(), step)).collect()
    }

    #[test]
    fn a_step_has_at_most_one_turn() {
        let joined = told("Walk down the hallway turn left and stop.");
        assert_eq!(
            joined.iter().map(|(words, _)| &**words).collect::<Vec<_>>(),
            ["Walk down the hallway", "turn left", "and stop"]
        );
        let text = "Leave the attic and turn left. Take a right and a left, then walk on until you reach the globe.";
        let steps = told(text);
        let words: Vec<&str> = steps.iter().map(|(words, _)| words.as_str()).collect();
        assert_eq!(
            words,
            [
                "Leave the attic",
                "and turn left",
                "Take a right and a",
                "left",
                "then walk on",
                "until you reach the globe"
            ]
        );
        let turns: Vec<Option<Side>> = steps.iter().map(|(_, step)| step.turn).collect();
        assert_eq!(turns, [None, Some(Side::Left), Some(Side::Right), Some(Side::Left), None, None]);
        assert!(steps[5].1.is_condition && !steps[4].1.is_condition);
    }

    #[test]
    fn steps_have_doors_stairs_and_sides() {
        let step = |text: &str| told(text).remove(0).1;
        assert_eq!(step("Go through the door on your left.").door, StepDoor::Through);
        assert_eq!(step("Go through the door on your left.").side.map(|side| side.1), Some(Side::Left));
        assert_eq!(step("Leave the kitchen.").door, StepDoor::Implied);
        assert_eq!(step("Walk to the sofa.").door, StepDoor::None);
        assert_eq!(step("Wait at the bottom of the stairs.").stairs, StepStairs::Bottom);
        assert_eq!(step("Stop at the top of the staircase.").stairs, StepStairs::Top);
        assert!(step("Wait outside.").is_outdoors && step("Wait outside.").stops);
        assert_eq!(step("Stop right before the sofa.").side, None);
        assert_eq!(step("Go to the attic on level 3.").floor.and_then(|floor| floor.number), Some(3));
        assert_eq!(step("Go down from level 3.").floor, None);
        assert_eq!(step("Go to the bedroom upstairs.").storey, Some(ClimbDirection::Up));
        assert!(step("Keep on into the kitchen.").is_straight && step("Carry on past the sofa.").is_straight);
        let bends = read_steps(&read_instruction("Bear right at the sofa, left at the lamp.", &BTreeSet::new()));
        assert!(bends.iter().all(|step| step.turn.is_none() || step.is_slight), "{bends:?}");
        assert!(!step("Keep left at the sofa.").is_straight && !step("Do not keep on.").is_straight);
    }

    #[test]
    fn denied_words_are_no_part_of_a_step() {
        let step = |text: &str| told(text).remove(0).1;
        let denied = step("Do not turn left.");
        assert_eq!((denied.turn, denied.side), (None, None));
        assert_eq!(denied.marks, Vec::<usize>::new());
        assert!(step("Wait.").marks.len() == 1 && step("Do not wait.").marks.is_empty());
        assert_eq!(step("Never go down the stairs.").stairs, StepStairs::None);
        assert_eq!(step("Do not go straight on to the end of the stairs.").stairs, StepStairs::None);
        let denied = step("Don't go slightly forward to the end outside.");
        assert!(!(denied.is_straight || denied.is_slight || denied.at_end || denied.is_outdoors));
        assert_eq!(step("Do not leave the kitchen.").door, StepDoor::None);
        let both = step("Do not turn right but go down the stairs.");
        assert_eq!((both.turn, both.stairs, both.climb), (None, StepStairs::Named, Some(ClimbDirection::Down)));
    }
}
