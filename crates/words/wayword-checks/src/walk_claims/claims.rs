//! Lists what each step of a text claims of its stretch of the walk.

use super::facts::WalkFacts;
use crate::memory::{RememberedThing, RoomStay};
use std::cmp::Ordering;
use wayword_core::{ClimbDirection, Side};
use wayword_language::reading::{
    EventContent, PlaceLink, PlaceMention, TextReading,
    steps::{InstructionStep, StepMention, StepRelation, StepStairs},
};

/// A claim of a step.
#[derive(Debug, Clone)]
pub(super) struct StepClaim<'a> {
    /// Its byte range in the text.
    pub(super) span: [usize; 2],
    /// Its event in the reading, where it is one.
    pub(super) event: Option<usize>,
    pub(super) what: ClaimedFact<'a>,
    /// The things of the walk that its first and its second place may mean.
    pub(super) things: [Vec<&'a RememberedThing>; 2],
    /// The stays in rooms that its first place may mean.
    pub(super) stays: Vec<&'a RoomStay>,
    /// The turn that the step makes before it comes to the place: "turn left into the office".
    pub(super) turn_before: Option<Side>,
}

impl<'a> StepClaim<'a> {
    fn new(facts: &WalkFacts<'a>, span: [usize; 2], event: Option<usize>, what: ClaimedFact<'a>) -> Self {
        let (first, second) = match what {
            ClaimedFact::Place { place, .. } | ClaimedFact::EndOf(place) => (Some(place), None),
            ClaimedFact::Between([one, other]) | ClaimedFact::Beside([one, other]) => (Some(one), Some(other)),
            ClaimedFact::Turn { .. }
            | ClaimedFact::Climb(_)
            | ClaimedFact::StairEnd { .. }
            | ClaimedFact::Length { .. } => (None, None),
        };
        let things = [first, second].map(|place| place.map(|place| facts.things_meant(place)).unwrap_or_default());
        let room = first.filter(|place| place.is_room);
        let stays = room.map(|place| facts.stays_in(&place.name)).unwrap_or_default();
        Self { span, event, what, things, stays, turn_before: None }
    }
}

/// What a claim says.
#[derive(Debug, Clone, Copy)]
pub(super) enum ClaimedFact<'a> {
    /// The walk turns to a side, or around (`Behind`).
    Turn { side: Side, size: TurnSize },
    /// The walk goes up or down.
    Climb(ClimbDirection),
    /// A place lies at the stretch in this way.
    Place { place: &'a PlaceMention, role: PlaceRole },
    /// The stretch ends between two places.
    Between([&'a PlaceMention; 2]),
    /// A place lies beside another one.
    Beside([&'a PlaceMention; 2]),
    /// The upper or the lower end of stairs is on the stretch.
    StairEnd { is_top: bool },
    /// The stretch ends where a room ends.
    EndOf(&'a PlaceMention),
    /// The stretch is so long, metres.
    Length { low_m: f64, high_m: f64 },
}

impl ClaimedFact<'_> {
    /// Whether it is about the walker's motion alone, which the poses decide.
    pub(super) fn is_motion(&self) -> bool {
        matches!(self, Self::Turn { .. } | Self::Climb(_) | Self::StairEnd { .. } | Self::Length { .. })
    }
}

/// How wide a text says that a turn is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TurnSize {
    /// "Turn slightly left".
    Slight,
    /// "Turn left".
    Plain,
    /// "Turn hard left".
    Sharp,
}

/// How a place lies at a stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlaceRole {
    /// The stretch passes it.
    Passed,
    /// The turn of the stretch comes when it has been passed.
    TurnedPast,
    /// The stretch leads to it, or only towards it.
    Approached { is_reached: bool },
    /// The stretch ends at it.
    Reached,
    /// The walk ends at it.
    Stopped,
    /// The turn of the stretch is at it.
    TurnedAt,
    /// The stretch leads into it.
    Entered,
    /// The stretch leads out of it.
    Left,
    /// The stretch leads through it.
    Through,
    /// The stretch runs along it.
    Along,
    /// The stretch, or the walk's end where the step stops, lies in it.
    Within { at_stop: bool },
    /// The stretch comes near it.
    Near,
    /// It is in sight.
    InSight,
}

/// The words for a way to a place, of which "to" alone says that the way ends there.
const WAY_WORDS: [&str; 5] = ["to", "toward", "towards", "approach", "for"];

/// The words for a turn that is wider than most.
const SHARP_WORDS: [&str; 3] = ["hard", "sharp", "sharply"];

/// Whether each step stops. "Stop when you reach the sofa": the condition of a stop is about the stop.
pub(super) fn effective_stops(steps: &[InstructionStep]) -> Vec<bool> {
    let mut stops = false;
    let stops_there = |step: &InstructionStep| {
        stops = step.stops || (stops && step.is_condition);
        stops
    };
    steps.iter().map(stops_there).collect()
}

/// The claims of each step, in the order of the steps; `stops` are their [`effective_stops`].
pub(super) fn claims_by_step<'a>(
    facts: &WalkFacts<'a>,
    reading: &'a TextReading,
    (steps, stops): (&[InstructionStep], &[bool]),
    object: Option<usize>,
) -> Vec<Vec<StepClaim<'a>>> {
    let lists = ClaimLister { facts, reading, object };
    steps.iter().zip(stops).map(|(step, stops)| lists.list_claims(step, *stops)).collect()
}

struct ClaimLister<'f, 'a> {
    facts: &'f WalkFacts<'a>,
    reading: &'a TextReading,
    /// The event of the object of a task.
    object: Option<usize>,
}

impl<'a> ClaimLister<'_, 'a> {
    fn list_claims(&self, step: &InstructionStep, stops: bool) -> Vec<StepClaim<'a>> {
        let mut claims = Vec::new();
        if let Some(side) = step.turn {
            let span = step.turn_span.unwrap_or(step.span);
            let event = self.event_at(span);
            claims.push(StepClaim::new(
                self.facts,
                span,
                event,
                ClaimedFact::Turn { side, size: self.turn_size(step) },
            ));
        }
        if let Some(climb) = step.climb {
            let is_climb = |what: &EventContent| matches!(what, EventContent::Climb(_) | EventContent::Steps(_));
            let event = self.events_within(step.span).find(|at| is_climb(&self.reading.events[*at].what));
            let span = event.map_or(step.span, |at| self.reading.events[at].span);
            claims.push(StepClaim::new(self.facts, span, event, ClaimedFact::Climb(climb)));
        }
        if let StepStairs::Top | StepStairs::Bottom = step.stairs {
            let what = ClaimedFact::StairEnd { is_top: step.stairs == StepStairs::Top };
            claims.push(StepClaim::new(self.facts, step.span, None, what));
        }
        let mut before: Option<&StepMention> = None;
        for mention in &step.places {
            // Another check judges the object of a task; what follows it tells which one is meant.
            match self.object.map(|object| mention.event.cmp(&object)) {
                None | Some(Ordering::Less) => claims.extend(self.place_claim(step, stops, mention, before)),
                Some(Ordering::Equal) => {}
                Some(Ordering::Greater) => claims.extend(self.object_claim(mention, before)),
            }
            before = Some(mention);
        }
        claims.extend(self.between_claim(step));
        claims.extend(self.end_claim(step));
        claims.extend(self.length_claims(step));
        claims
    }

    fn place(&self, mention: &StepMention) -> Option<&'a PlaceMention> {
        match &self.reading.events.get(mention.event)?.what {
            EventContent::Place(place) => Some(place),
            _ => None,
        }
    }

    /// The events whose words lie within a range of the text.
    fn events_within(&self, [from, to]: [usize; 2]) -> impl Iterator<Item = usize> {
        let events = self.reading.events.iter().enumerate();
        events.filter(move |(_, event)| event.span[0] >= from && event.span[1] <= to).map(|(at, _)| at)
    }

    fn event_at(&self, span: [usize; 2]) -> Option<usize> {
        self.reading.events.iter().position(|event| event.span == span)
    }

    /// The claim about one place. `before` is the place before it in the step.
    fn place_claim(
        &self,
        step: &InstructionStep,
        stops: bool,
        mention: &StepMention,
        before: Option<&StepMention>,
    ) -> Option<StepClaim<'a>> {
        let place = self.place(mention)?;
        let locates = matches!(place.link, PlaceLink::Within | PlaceLink::Beside);
        let span = self.reading.events[mention.event].span;
        let turn_before = step.turn.filter(|_| step.turn_span.is_some_and(|turn| turn[1] <= span[0]));
        let claim =
            |what| Some(StepClaim { turn_before, ..StepClaim::new(self.facts, span, Some(mention.event), what) });
        let is_room = |place: &&PlaceMention| place.is_room && !place.is_thing;
        let other = before.filter(|_| locates).and_then(|before| self.place(before));
        // "Wait in the hallway near the lamp": the lamp does not tell which hallway.
        if let Some(other) = other.filter(|other| !is_room(other) || is_room(&place)) {
            return match (mention.relation, is_room(&place)) {
                (StepRelation::Between, _) => None,
                (_, true) if is_room(&other) => None,
                // "The sink in the kitchen", "stop at the sofa in the living room".
                (StepRelation::In | StepRelation::At, true) => {
                    claim(ClaimedFact::Place { place, role: PlaceRole::Within { at_stop: stops } })
                }
                // "The door next to the dining room": one need not be in it.
                (_, true) => None,
                (StepRelation::With | StepRelation::Of, _) => {
                    claim(ClaimedFact::Place { place, role: PlaceRole::InSight })
                }
                _ => claim(ClaimedFact::Beside([other, place])),
            };
        }
        // "From the bedroom, bear left": it is left in the next step.
        if mention.relation == StepRelation::OutOf && place.is_room && self.begins_with_from(step) {
            return claim(ClaimedFact::Place { place, role: PlaceRole::Within { at_stop: false } });
        }
        let is_towards = self.is_towards(step, mention);
        let role = place_role((step, stops), mention.relation, place, is_towards)?;
        claim(ClaimedFact::Place { place, role })
    }

    fn begins_with_from(&self, step: &InstructionStep) -> bool {
        let first = self.reading.tokens().iter().find(|token| token.span[0] >= step.span[0]);
        first.is_some_and(|token| token.word == "from")
    }

    /// How wide a step says that its turn is.
    fn turn_size(&self, step: &InstructionStep) -> TurnSize {
        // "Turn hard right", "take a sharp left".
        let [from, to] = step.turn_span.unwrap_or(step.span);
        let before = self.reading.tokens().iter().filter(|token| token.span[1] <= to);
        let mut near = before
            .rev()
            .take_while(|token| token.span[0] >= from)
            .chain(self.reading.tokens().iter().rev().find(|token| token.span[1] <= from));
        let is_sharp = near.any(|token| SHARP_WORDS.contains(&token.word.as_str()));
        match (step.is_slight, is_sharp) {
            (true, _) => TurnSize::Slight,
            (false, true) => TurnSize::Sharp,
            (false, false) => TurnSize::Plain,
        }
    }

    /// Whether the last word about the way before a place is "towards".
    fn is_towards(&self, step: &InstructionStep, mention: &StepMention) -> bool {
        let until = self.reading.events[mention.event].span[0];
        let words =
            self.reading.tokens().iter().filter(|token| step.span[0] <= token.span[0] && token.span[1] <= until);
        let mut ways = words.filter(|token| WAY_WORDS.contains(&token.word.as_str()));
        ways.next_back().is_some_and(|token| token.word != "to")
    }

    /// The claim about the neighbour of a task's object: "the wardrobe next to the clock".
    fn object_claim(&self, mention: &StepMention, before: Option<&StepMention>) -> Option<StepClaim<'a>> {
        let object = before.filter(|before| Some(before.event) == self.object).and_then(|before| self.place(before))?;
        let place = self.place(mention)?;
        let is_beside = matches!(mention.relation, StepRelation::Near | StepRelation::Before | StepRelation::At);
        let is_thing = |place: &PlaceMention| place.is_thing && !place.is_room;
        if !is_beside || !is_thing(place) || !is_thing(object) {
            return None;
        }
        let span = self.reading.events[mention.event].span;
        Some(StepClaim::new(self.facts, span, Some(mention.event), ClaimedFact::Beside([object, place])))
    }

    /// The claim of the walker to be between two places. In "the kettle between the stove and the sink" it is the kettle.
    fn between_claim(&self, step: &InstructionStep) -> Option<StepClaim<'a>> {
        let is_between =
            |pair: &&[StepMention]| pair.first().is_some_and(|first| first.relation == StepRelation::Between);
        let [first, second] = step.places.windows(2).find(is_between)? else { return None };
        let is_told = self.object.is_none_or(|object| first.event < object);
        let pair = [self.place(first).filter(|_| is_told)?, self.place(second)?];
        let span = self.reading.events[first.event].span;
        Some(StepClaim::new(self.facts, span, None, ClaimedFact::Between(pair)))
    }

    /// The claim to go to the end of a room: "to the end of the hallway".
    fn end_claim(&self, step: &InstructionStep) -> Option<StepClaim<'a>> {
        let is_end = |mention: &&StepMention| step.at_end && mention.relation == StepRelation::At;
        let mention = step.places.iter().find(is_end)?;
        let place = self.place(mention).filter(|place| place.is_room && !place.is_thing)?;
        let span = self.reading.events[mention.event].span;
        Some(StepClaim::new(self.facts, span, None, ClaimedFact::EndOf(place)))
    }

    fn length_claims(&self, step: &InstructionStep) -> Vec<StepClaim<'a>> {
        let length = |at: usize| {
            let event = &self.reading.events[at];
            let EventContent::Distance { metres_low, metres_high } = event.what else { return None };
            let what = ClaimedFact::Length { low_m: metres_low, high_m: metres_high };
            Some(StepClaim::new(self.facts, event.span, None, what))
        };
        self.events_within(step.span).filter_map(length).collect()
    }
}

/// How a place lies at the stretch of a step; `None` where the step says nothing that can be checked.
fn place_role(
    (step, stops): (&InstructionStep, bool),
    relation: StepRelation,
    place: &PlaceMention,
    is_towards: bool,
) -> Option<PlaceRole> {
    Some(match relation {
        StepRelation::Past if step.turn.is_some() => PlaceRole::TurnedPast,
        StepRelation::Past => PlaceRole::Passed,
        // "Wait inside the closet."
        StepRelation::Into if stops && place.is_room => PlaceRole::Within { at_stop: true },
        StepRelation::Into => PlaceRole::Entered,
        StepRelation::OutOf => PlaceRole::Left,
        StepRelation::Through => PlaceRole::Through,
        StepRelation::Along => PlaceRole::Along,
        StepRelation::In => PlaceRole::Within { at_stop: stops },
        StepRelation::With => PlaceRole::InSight,
        StepRelation::Between | StepRelation::Of => return None,
        StepRelation::To if stops => PlaceRole::Stopped,
        StepRelation::To if step.is_condition => PlaceRole::Reached,
        StepRelation::To => PlaceRole::Approached { is_reached: !place.is_room && !is_towards },
        StepRelation::Plain | StepRelation::At | StepRelation::Near | StepRelation::Before => {
            match (stops, step.turn.is_some() || place.tells_turn) {
                // "Stop in front of the dining room."
                (true, _) if place.is_room && !place.is_thing => PlaceRole::Near,
                (true, _) => PlaceRole::Stopped,
                (false, true) => PlaceRole::TurnedAt,
                (false, false) => PlaceRole::Near,
            }
        }
    })
}
