//! An instruction in the form that a follower uses: its steps with the places that they name, and their location in a
//! building.

use crate::building::KnownBuilding;
use crate::nearness::{PlaceNearness, PlaceQuery};
use std::{collections::BTreeSet, sync::Arc};
use wayword_core::Side;
use wayword_language::{
    languages::ReadableText,
    lexicon::same_room,
    reading::{
        EventContent, TextReading, read_instruction,
        steps::{InstructionStep, StepRelation, read_steps},
    },
};

/// An instruction, step by step, independent of a building.
#[derive(Debug, Clone)]
pub struct Guide {
    pub(crate) steps: Vec<GuideStep>,
    /// The rooms that it names.
    rooms: Vec<String>,
    /// Whether it describes no way, but only a place to go to: "Go to the attic and dust the globe".
    pub(crate) is_goal: bool,
}

/// A step with the places that it names.
#[derive(Debug, Clone)]
pub(crate) struct GuideStep {
    /// The step as it was read from the text.
    pub(crate) step: InstructionStep,
    pub(crate) kind: GuideStepKind,
    pub(crate) mentions: Vec<GuideMention>,
}

/// A room or an object that a step names.
#[derive(Debug, Clone)]
pub(crate) struct GuideMention {
    /// The byte range of its name in the text; `None` if the step only implies that it leads outdoors.
    pub(crate) span: Option<[usize; 2]>,
    /// How the step relates to the place: to it, past it, out of it.
    pub(crate) relation: StepRelation,
    /// The side of the walker on which the text locates the place.
    pub(crate) side: Option<Side>,
    /// Whether a turn happens at it.
    pub(crate) tells_turn: bool,
    /// Its possible meanings, the likeliest first.
    pub(crate) meanings: Vec<PlaceQuery>,
}

/// The kinds of steps, by their most important content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GuideStepKind {
    /// A turn to the left or to the right.
    Turn,
    SlightTurn,
    TurnAround,
    /// Up or down stairs.
    Climb,
    /// A command to stop or to wait.
    Stop,
    /// Only the time of something: "until you reach the sofa".
    Condition,
    /// A command to go straight on.
    Straight,
    /// Into, out of or through something.
    Cross,
    /// To, past or along something.
    Go,
    /// None of these, and without a place.
    Other,
    /// The first step of a text that describes no way, but only a place to go to.
    Goal,
    /// A later step of such a text.
    Task,
}

impl GuideStepKind {
    /// Number of kinds.
    pub(crate) const COUNT: usize = 12;

    /// The kind of a step of a text that describes the way.
    fn for_step(step: &InstructionStep) -> Self {
        let crosses = |relation| matches!(relation, StepRelation::OutOf | StepRelation::Into | StepRelation::Through);
        match step.turn {
            Some(Side::Left | Side::Right) if step.is_slight => Self::SlightTurn,
            Some(Side::Left | Side::Right) => Self::Turn,
            Some(_) => Self::TurnAround,
            None if step.climb.is_some() => Self::Climb,
            None if step.stops => Self::Stop,
            None if step.is_condition => Self::Condition,
            None if step.is_straight => Self::Straight,
            None if step.places.iter().any(|place| crosses(place.relation)) => Self::Cross,
            None if step.places.is_empty() => Self::Other,
            None => Self::Go,
        }
    }
}

impl GuideStep {
    /// Whether it describes a part of the way: a turn, stairs, where to stop, a thing to pass.
    fn describes_way(&self) -> bool {
        let is_way = |mention: &GuideMention| {
            matches!(
                mention.relation,
                StepRelation::OutOf | StepRelation::Through | StepRelation::Past | StepRelation::Along
            )
        };
        let InstructionStep { turn, climb, stops, is_straight, is_condition, .. } = &self.step;
        turn.is_some() || climb.is_some() || *stops || *is_straight || *is_condition || self.mentions.iter().any(is_way)
    }

    /// Removes its turn.
    pub(crate) fn leave_out_turn(&mut self) {
        self.step.turn = None;
        self.kind = GuideStepKind::for_step(&self.step);
    }

    /// Changes its relation to one of its places.
    pub(crate) fn change_relation(&mut self, place: usize, relation: StepRelation) {
        if let Some(mention) = self.mentions.get_mut(place) {
            mention.relation = relation;
        }
        if let Some(mention) = self.step.places.get_mut(place) {
            mention.relation = relation;
        }
        self.kind = GuideStepKind::for_step(&self.step);
    }

    /// Changes the sides on which its places are.
    pub(crate) fn change_sides(&mut self, change: impl Fn(Side) -> Side) {
        self.step.side = self.step.side.map(|(relation, side)| (relation, change(side)));
        for mention in &mut self.mentions {
            mention.side = mention.side.map(&change);
        }
    }
}

impl Guide {
    /// Reads an instruction; one in another language through English words.
    #[must_use]
    pub fn read_text(text: &str) -> Self {
        Self::from_reading(&read_instruction(ReadableText::new(text, None).english(), &BTreeSet::new()))
    }

    /// The names of the places at which the text ends: those of its last step that stops, or else of its last step.
    #[must_use]
    pub fn end_names(&self) -> Vec<&str> {
        let end = self.steps.iter().rev().find(|step| step.step.stops).or(self.steps.last());
        let mentions = end.into_iter().flat_map(|step| &step.mentions);
        mentions.flat_map(|mention| &mention.meanings).map(|meaning| meaning.name.as_str()).collect()
    }

    /// The guide of an instruction that was read before.
    #[must_use]
    pub fn from_reading(reading: &TextReading) -> Self {
        let mut rooms = Vec::new();
        let to_guide_step = |step: InstructionStep| {
            let mut mentions: Vec<GuideMention> = Vec::new();
            for place in &step.places {
                let EventContent::Place(named) = &reading.events[place.event].what else { continue };
                if named.is_room {
                    rooms.push(named.name.clone());
                }
                mentions.push(GuideMention {
                    span: Some(reading.events[place.event].span),
                    relation: place.relation,
                    side: named.side,
                    tells_turn: named.tells_turn,
                    meanings: name_meanings(&named.name, named.is_room, named.is_thing),
                });
            }
            if step.is_outdoors {
                rooms.push("outdoor area".to_owned());
                let meanings = name_meanings("outdoor area", true, false);
                let relation = StepRelation::Into;
                mentions.push(GuideMention { span: None, relation, side: None, tells_turn: false, meanings });
            }
            GuideStep { kind: GuideStepKind::for_step(&step), step, mentions }
        };
        let mut steps: Vec<GuideStep> = read_steps(reading).into_iter().map(to_guide_step).collect();
        let is_goal = !steps.is_empty() && !steps.iter().any(|step| step.describes_way());
        if is_goal {
            steps.iter_mut().for_each(|step| step.kind = GuideStepKind::Task);
            steps[0].kind = GuideStepKind::Goal;
        }
        Self { steps, rooms, is_goal }
    }

    /// Appends the steps of a piece of the text that begins at a byte of it.
    pub(crate) fn append_steps(&mut self, piece: Self, from: usize) {
        let shifted = |span: [usize; 2]| span.map(|at| at + from);
        self.rooms.extend(piece.rooms);
        self.steps.extend(piece.steps.into_iter().map(|mut step| {
            step.step.span = shifted(step.step.span);
            step.step.turn_span = step.step.turn_span.map(shifted);
            step.mentions.iter_mut().for_each(|mention| mention.span = mention.span.map(shifted));
            step
        }));
    }

    /// The same guide, read as a piece of a way even if the piece names only a place to go to.
    pub(crate) fn into_way(mut self) -> Self {
        self.is_goal = false;
        self.steps.iter_mut().for_each(|step| step.kind = GuideStepKind::for_step(&step.step));
        self
    }

    /// Number of steps.
    #[must_use]
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether it has no step.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Whether it names a room.
    pub(crate) fn names_room(&self, room: &str) -> bool {
        self.rooms.iter().any(|named| same_room(room, named))
    }

    /// The places that it names, each as the number of the step and the position in the step's list.
    pub(crate) fn named_places(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let step_places =
            |(step, content): (usize, &GuideStep)| (0..content.mentions.len()).map(move |place| (step, place));
        self.steps.iter().enumerate().flat_map(step_places)
    }

    /// Whether the guide has a turn or a place within a byte range of its text, and still has a step without the words there.
    pub(crate) fn has_step_without(&self, [from, to]: [usize; 2]) -> bool {
        let is_within = |span: [usize; 2]| from <= span[0] && span[1] <= to;
        let loses_turn = |step: &GuideStep| step.step.turn_span.is_some_and(is_within);
        let loses = |mention: &GuideMention| mention.span.is_some_and(is_within);
        let is_changed = self.steps.iter().any(|step| loses_turn(step) || step.mentions.iter().any(loses));
        let overlaps = |step: &GuideStep| step.step.span[0] < to && from < step.step.span[1];
        let is_emptied =
            |step: &GuideStep| step.mentions.iter().all(loses) && (step.step.turn.is_none() || loses_turn(step));
        let is_gone =
            |step: &&GuideStep| is_within(step.step.span) || (is_changed && overlaps(step) && is_emptied(step));
        let gone = self.steps.iter().filter(is_gone).count();
        (is_changed || gone > 0) && gone < self.len()
    }

    /// Number of its turns.
    pub(crate) fn count_turns(&self) -> usize {
        self.steps.iter().filter(|step| step.step.turn.is_some()).count()
    }
}

/// The possible meanings of a name, the likeliest first. If a building lacks the full name ("coffee table"), it may have the last
/// word ("table").
fn name_meanings(name: &str, is_room: bool, is_thing: bool) -> Vec<PlaceQuery> {
    let meaning = |is_room: bool, name: &str| PlaceQuery { is_room, name: name.to_owned() };
    let last = name.rsplit_once(' ').map(|(_, last)| last);
    let mut meanings = Vec::new();
    meanings.extend(is_room.then(|| meaning(true, name)));
    meanings.extend(is_thing.then(|| meaning(false, name)));
    meanings.extend(last.filter(|_| is_thing).map(|last| meaning(false, last)));
    meanings
}

/// An instruction in a building, with its places located there.
#[derive(Debug)]
pub struct GuideTrial<'a> {
    pub(crate) guide: &'a Guide,
    pub(crate) building: &'a KnownBuilding,
    /// For each step, those of its mentions that the building has.
    pub(crate) located: Vec<Vec<LocatedMention<'a>>>,
    /// For each viewpoint, whether the text names its room; `None` where the room has no name.
    pub(crate) is_room_named: Vec<Option<bool>>,
}

/// A mention, and the distance of each viewpoint from it.
#[derive(Debug)]
pub(crate) struct LocatedMention<'a> {
    pub(crate) mention: &'a GuideMention,
    /// Whether the meaning that the building has is a room, and not a thing.
    pub(crate) is_room: bool,
    pub(crate) near: Arc<PlaceNearness>,
}

impl<'a> GuideTrial<'a> {
    /// Locates the places of an instruction in a building. A place that the building lacks has no influence on the
    /// scores.
    #[must_use]
    pub fn new(guide: &'a Guide, building: &'a KnownBuilding) -> Self {
        Self::find_mentions(guide, building, false)
    }

    /// Locates the places of an instruction in the visited part of a building. A place that is not in it may be anywhere else.
    #[must_use]
    pub(crate) fn new_partial(guide: &'a Guide, building: &'a KnownBuilding) -> Self {
        Self::find_mentions(guide, building, true)
    }

    /// Locates the mentions of each step, by the first of their meanings that the building has. If the building is known in part
    /// only, a mention without such a meaning is kept with its first meaning.
    fn find_mentions(guide: &'a Guide, building: &'a KnownBuilding, is_partial: bool) -> Self {
        let find = |mention: &'a GuideMention| {
            let mut meanings = mention.meanings.iter().map(|what| (what.is_room, building.find_nearness(what)));
            let first = meanings.next()?;
            let exists = |(_, near): &(bool, Arc<PlaceNearness>)| near.exists;
            let found = if exists(&first) { Some(first.clone()) } else { meanings.find(exists) };
            let (is_room, near) = found.or(is_partial.then_some(first))?;
            Some(LocatedMention { mention, is_room, near })
        };
        let found = guide.steps.iter().map(|step| step.mentions.iter().filter_map(find).collect()).collect();
        let room = |at: usize| building.viewpoints[at].room.as_deref();
        let tells_room = (0..building.len()).map(|at| Some(guide.names_room(room(at)?))).collect();
        Self { guide, building, located: found, is_room_named: tells_room }
    }
}

#[cfg(test)]
mod tests;
