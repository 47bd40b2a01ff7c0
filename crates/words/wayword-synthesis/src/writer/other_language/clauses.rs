//! The words of another language for one clause of a way.

use super::LanguageWriter;
use crate::{
    style::way::{ClauseKind, ShapeTraits},
    writer::{
        naming::{ClauseContent, PhraseContent},
        phrases::draw_option,
        route::WayClause,
        shape_needs::is_long,
    },
};
use wayword_core::Side;

/// A clause to put into words.
pub(super) struct SaidClause<'d> {
    pub(super) clause: WayClause,
    /// What it tells.
    pub(super) content: &'d PhraseContent,
    /// Whether it also tells that the walker goes straight on.
    pub(super) goes_straight: bool,
}

impl SaidClause<'_> {
    /// Whether it tells no more than to go straight on.
    pub(super) fn is_straight_on(&self) -> bool {
        self.clause.kind == ClauseKind::Straight && matches!(self.content, PhraseContent::Clause(_))
    }
}

/// Share of the clauses that go to a thing which mean one that is passed.
const PASSED_SHARE: f64 = 0.3;
/// Share of them behind which a turn follows.
const TURN_SHARE: f64 = 0.2;
/// Share of the clauses that go to a door which a clause through it follows.
const DOOR_SHARE: f64 = 0.3;
/// How much more a bare "stop" weighs behind a clause that goes to the place than its count, against "stop at the sofa".
const APART_FACTOR: f64 = 1.5;

impl LanguageWriter<'_> {
    /// The kinds of the clauses for the content of a clause, by how often texts of the language have them. What is named, and in which order,
    /// is the same in all. `before` is the kind of the clause before.
    pub(super) fn kinds_to_say(
        &self,
        clause: &WayClause,
        content: &ClauseContent,
        before: Option<ClauseKind>,
        is_last: bool,
    ) -> Vec<ClauseKind> {
        let way = self.language.way();
        let count = |kind| way.kind_count(kind);
        let own = vec![content.kind];
        // Where frames lie close together, a clause for each step tells where the walker is.
        if !content.needs.is_on_graph {
            return own;
        }
        let is_said = before.is_some() && is_last;
        let unsaid = if is_said { 1.0 - way.stop_share } else { 0.0 };
        // "Walk to the sofa and stop" is more usual than "stop at the sofa".
        let apart = |own| {
            let (own, apart) = (count(own), count(ClauseKind::Stop) * APART_FACTOR);
            let said = (1.0 - unsaid) / (own + apart).max(f64::EPSILON);
            (said * own, said * apart)
        };
        let arrives = before.is_some_and(|before| !before.is_bare_turn() && before != ClauseKind::Straight);
        let options: Vec<(f64, Vec<ClauseKind>)> = match content.kind {
            ClauseKind::Pass => {
                vec![(count(ClauseKind::Pass), own), (count(ClauseKind::To) * PASSED_SHARE, vec![ClauseKind::To])]
            }
            ClauseKind::TurnAt => {
                let apart = vec![ClauseKind::To, ClauseKind::Turn];
                vec![(count(ClauseKind::TurnAt), own), (count(ClauseKind::To) * TURN_SHARE, apart)]
            }
            ClauseKind::Enter | ClauseKind::Leave | ClauseKind::ThroughDoor
                if content.needs.has_door && before != Some(ClauseKind::ToDoor) =>
            {
                let by_door = vec![ClauseKind::ToDoor, content.kind];
                vec![(count(content.kind), own), (count(ClauseKind::ToDoor) * DOOR_SHARE, by_door)]
            }
            ClauseKind::StopAt | ClauseKind::StopInDoorway | ClauseKind::StopIn if is_last => {
                let Some(to) = arriving_kind(content.kind, before) else { return own };
                let (together, apart) = apart(content.kind);
                // "Go straight to the sofa and stop" rather than "go straight, stop at the sofa".
                let together = if before == Some(ClauseKind::Straight) { 0.0 } else { together };
                vec![(together, own), (apart, vec![to, ClauseKind::Stop]), (unsaid, vec![to])]
            }
            // "Go up the stairs, at the top of the stairs turn left" names the stairs twice.
            ClauseKind::TurnAtTop | ClauseKind::TurnAtBottom
                if matches!(before, Some(ClauseKind::Up | ClauseKind::Down)) =>
            {
                vec![(1.0, vec![ClauseKind::Turn])]
            }
            ClauseKind::Stop if arrives => vec![(1.0 - unsaid, own), (unsaid, Vec::new())],
            _ => return own,
        };
        let is_known = options.iter().any(|(weight, _)| *weight > 0.0);
        let drawn = draw_option(&options, &mut clause.clause_rng("kinds", self.dice));
        drawn.filter(|_| is_known).unwrap_or_else(|| vec![content.kind])
    }

    /// A clause, behind the words `before`. A thing for which the language has no name is left out.
    pub(super) fn clause(&mut self, said: &SaidClause<'_>, content: &ClauseContent, before: &str) -> Option<String> {
        let named = content.thing.as_ref().map(|thing| self.thing(thing));
        let (kind, thing) = match named {
            Some(None) => (without_thing(said.clause.kind), String::new()),
            Some(Some(name)) => (said.clause.kind, name),
            None => (said.clause.kind, String::new()),
        };
        let room = if content.room.is_empty() { String::new() } else { self.room_name(&content.room)? };
        let from = if content.from.is_empty() { String::new() } else { self.room_name(&content.from)? };
        let shape = self.draw_shape(said, content, kind, before)?;
        let side = content
            .side
            .map_or("", |side| self.language.side(if side == Side::Left { Side::Left } else { Side::Right }));
        let shape = content.door_number.and_then(|number| self.language.number_door(&shape, number)).unwrap_or(shape);
        let gaps = [("{s}", side), ("{p}", side), ("{l}", &thing), ("{r}", &room), ("{a}", &from)];
        Some(gaps.iter().fold(shape, |text, (slot, word)| text.replace(slot, word)))
    }

    /// A shape of a kind, by its share. It names the room where the English words do.
    fn draw_shape(
        &self,
        said: &SaidClause<'_>,
        content: &ClauseContent,
        kind: ClauseKind,
        before: &str,
    ) -> Option<String> {
        let says_room =
            !content.room.is_empty() && !matches!(kind, ClauseKind::ToDoor | ClauseKind::To | ClauseKind::Turn);
        // "Go straight, go straight to the sofa" repeats itself.
        let may_go_straight = kind == ClauseKind::Straight || !self.language.traits_of(before).goes_straight;
        let is_long = content.thing.as_ref().is_some_and(|thing| is_long(&thing.name));
        let fits = |shape: &str| {
            let is_numbered =
                content.door_number.is_none_or(|number| self.language.number_door(shape, number).is_some());
            let is_ordered = !(shape.contains("{l}") && shape.contains("{r}"))
                || ShapeTraits::names_thing_first(shape) == content.thing_first;
            shape.contains("{r}") == says_room
                && is_numbered
                && is_ordered
                && (is_long || !self.language.goes_along_thing(shape))
        };
        let is_first = before.is_empty();
        let admitted = |shape: &str| {
            let traits = self.language.traits_of(shape);
            fits(shape) && content.needs.admit(&traits) && (may_go_straight || !traits.goes_straight)
        };
        let begins_well = |shape: &str| admitted(shape) && !(is_first && self.language.begins_no_text(shape));
        let rng = &mut said.clause.clause_rng("language words", self.dice);
        let mut draw = |fits: &dyn Fn(&str) -> bool| {
            let shapes = self.language.shapes(kind, is_first).into_iter().flatten().filter(|(shape, _)| fits(shape));
            let all: Vec<(f64, &String)> = shapes.map(|(shape, count)| (*count, shape)).collect();
            draw_option(&all, rng).cloned()
        };
        let straight = if said.goes_straight {
            draw(&|shape| admitted(shape) && self.language.traits_of(shape).goes_straight)
        } else {
            None
        };
        // Where none fits the walk, one without a door still may.
        let says_no_door = |shape: &str| fits(shape) && self.language.traits_of(shape).doors.is_empty();
        straight.or_else(|| draw(&begins_well)).or_else(|| draw(&admitted)).or_else(|| draw(&says_no_door))
    }
}

/// The kind of a clause that arrives where one of a kind stops; `None` where the walker may have been there for some time.
fn arriving_kind(stops: ClauseKind, before: Option<ClauseKind>) -> Option<ClauseKind> {
    match stops {
        ClauseKind::StopAt => Some(ClauseKind::To),
        ClauseKind::StopInDoorway => (before != Some(ClauseKind::ToDoor)).then_some(ClauseKind::ToDoor),
        _ if before.is_some_and(|before| before.is_bare_turn() || before.goes_on() || before == ClauseKind::ToDoor) => {
            Some(ClauseKind::Enter)
        }
        _ => None,
    }
}

/// The kind of the same clause without its thing.
fn without_thing(kind: ClauseKind) -> ClauseKind {
    match kind {
        ClauseKind::TurnAt => ClauseKind::Turn,
        ClauseKind::PassEnter | ClauseKind::EnterWith => ClauseKind::Enter,
        ClauseKind::StopAt => ClauseKind::Stop,
        ClauseKind::StopAtIn => ClauseKind::StopIn,
        _ => ClauseKind::Straight,
    }
}
