//! The words of another language for a text that describes a way.

use super::LanguageWriter;
use crate::{
    style::way::{ClauseJoint, ClauseKind},
    writer::{
        WritingBrief,
        draft::{TextDraft, choose_joints},
        naming::{ClauseContent, ClausePhrase, PhraseContent},
        phrases::draw_option,
        route::WayClause,
    },
};
use wayword_core::Side;

/// A clause of at most so many characters may follow another one, or come before it, without a mark.
const MAX_UNPARTED_CHARACTERS: usize = 4;

/// Share of the clauses that go to a thing which mean one that is passed.
const PASSED_SHARE: f64 = 0.3;
/// Share of them behind which a turn follows.
const TURN_SHARE: f64 = 0.2;
/// Share of the clauses that go to a door which a clause through it follows.
const DOOR_SHARE: f64 = 0.3;

impl LanguageWriter<'_> {
    /// A text about a way. Its joints are those of the language.
    pub(super) fn way_text(&mut self, draft: &TextDraft<'_>, brief: &WritingBrief<'_>) -> Option<String> {
        let (mut clauses, mut phrases): (Vec<WayClause>, Vec<ClausePhrase>) = (Vec::new(), Vec::new());
        let last = draft.phrases().len().saturating_sub(1);
        for (at, (clause, phrase)) in draft.clauses().iter().zip(draft.phrases()).enumerate() {
            let said: Vec<(ClauseKind, String)> = match &phrase.content {
                PhraseContent::Stay => vec![(clause.kind, self.phrase("stay")?.to_owned())],
                PhraseContent::Task(task) => vec![(clause.kind, self.task(task)?)],
                PhraseContent::Clause(content) => {
                    let before = clauses.last().map(|before: &WayClause| before.kind);
                    let kinds = self.kinds_to_say(clause, content, before.filter(|_| at == last));
                    let mut said: Vec<(ClauseKind, String)> = Vec::new();
                    for kind in kinds {
                        let earlier = said.last().map(|(_, text)| text).or(phrases.last().map(|phrase| &phrase.text));
                        let text = self.clause(&clause.of_kind(kind), content, earlier.map_or("", String::as_str))?;
                        said.push((kind, text));
                    }
                    said
                }
            };
            for (kind, text) in said {
                let runs_on = self.language.traits_of(&text).is_until;
                clauses.push(clause.of_kind(kind));
                phrases.push(ClausePhrase { text, is_clause: true, runs_on, content: phrase.content.clone() });
            }
        }
        let mut joints = choose_joints(&clauses, &phrases, self.language.way(), brief, self.dice);
        self.smooth_joints(&mut joints, &phrases);
        let mut text = String::new();
        for (at, (joint, phrase)) in joints.iter().zip(&phrases).enumerate() {
            let words = self.language.joining_words(*joint).iter().map(|(words, share)| (*share, words));
            let rng = &mut self.dice.named_rng(&["joint", &at.to_string()]);
            text += &draw_option(&words.collect::<Vec<_>>(), rng).cloned().unwrap_or_default();
            text += &phrase.text;
        }
        let sentences = joints.iter().filter(|joint| joint.begins_sentence()).count();
        if draft.ends_in_full_stop() || sentences > 1 {
            text += self.language.full_stop();
        }
        Some(text)
    }

    /// Puts a comma where two long clauses would follow each other without any word or mark between them, and where "then" would follow
    /// "then".
    fn smooth_joints(&self, joints: &mut [ClauseJoint], phrases: &[ClausePhrase]) {
        let is_short = |phrase: &ClausePhrase| phrase.text.chars().count() <= MAX_UNPARTED_CHARACTERS;
        let mut is_unparted = false;
        for at in 1..joints.len() {
            let has_no_mark = joints[at] == ClauseJoint::And && self.language.joining_words(joints[at]).is_empty();
            if has_no_mark && (is_unparted || !is_short(&phrases[at - 1]) && !is_short(&phrases[at])) {
                joints[at] = ClauseJoint::Comma;
            }
            is_unparted = joints[at] == ClauseJoint::And;
            if says_then(joints[at]) && says_then(joints[at - 1]) {
                joints[at] = if joints[at].begins_sentence() { ClauseJoint::Stop } else { ClauseJoint::Comma };
            }
        }
    }

    /// The kinds of the clauses that say what a clause says, by how often texts of the language have them. What is named, and in which order,
    /// is the same in all. `before_end` is the kind of the clause before, if this is the last one.
    fn kinds_to_say(
        &self,
        clause: &WayClause,
        content: &ClauseContent,
        before_end: Option<ClauseKind>,
    ) -> Vec<ClauseKind> {
        let way = self.language.way();
        let count = |kind| way.kind_count(kind);
        let unsaid = if before_end.is_some() { (1.0 - way.stop_share) / way.stop_share.max(f64::EPSILON) } else { 0.0 };
        let arrives = before_end.is_some_and(|before| !before.is_bare_turn() && before != ClauseKind::Straight);
        let own = vec![content.kind];
        // Where frames lie close together, a clause for each step says where the walker is.
        if !content.needs.is_on_graph {
            return own;
        }
        let options: Vec<(f64, Vec<ClauseKind>)> = match content.kind {
            ClauseKind::Pass => {
                vec![(count(ClauseKind::Pass), own), (count(ClauseKind::To) * PASSED_SHARE, vec![ClauseKind::To])]
            }
            ClauseKind::TurnAt => {
                let apart = vec![ClauseKind::To, ClauseKind::Turn];
                vec![(count(ClauseKind::TurnAt), own), (count(ClauseKind::To) * TURN_SHARE, apart)]
            }
            ClauseKind::Enter | ClauseKind::Leave | ClauseKind::ThroughDoor if content.needs.has_door => {
                let by_door = vec![ClauseKind::ToDoor, content.kind];
                vec![(count(content.kind), own), (count(ClauseKind::ToDoor) * DOOR_SHARE, by_door)]
            }
            ClauseKind::StopAt => vec![(1.0, own), (unsaid, vec![ClauseKind::To])],
            ClauseKind::StopInDoorway => vec![(1.0, own), (unsaid, vec![ClauseKind::ToDoor])],
            ClauseKind::Stop if arrives => vec![(1.0, own), (unsaid, Vec::new())],
            _ => vec![(1.0, own)],
        };
        draw_option(&options, &mut clause.clause_rng("kinds", self.dice)).unwrap_or_default()
    }

    /// A clause, behind the words `before`. A thing for which the language has no name is left out.
    fn clause(&mut self, clause: &WayClause, content: &ClauseContent, before: &str) -> Option<String> {
        let named = content.thing.as_ref().map(|thing| self.thing(thing));
        let (kind, thing) = match named {
            Some(None) => (without_thing(clause.kind), String::new()),
            Some(Some(name)) => (clause.kind, name),
            None => (clause.kind, String::new()),
        };
        let room = if content.room.is_empty() { String::new() } else { self.name(&content.room)? };
        let from = if content.from.is_empty() { String::new() } else { self.name(&content.from)? };
        let shape = self.draw_shape(clause, content, kind, before)?;
        let side =
            content.side.map_or("", |side| self.language.side(if side == Side::Left { side } else { Side::Right }));
        let shape = content.door_number.and_then(|number| self.language.number_door(&shape, number)).unwrap_or(shape);
        let gaps = [("{s}", side), ("{p}", side), ("{l}", &thing), ("{r}", &room), ("{a}", &from)];
        Some(gaps.iter().fold(shape, |text, (slot, word)| text.replace(slot, word)))
    }

    /// A shape of a kind, by its share. It names the room where the English words do.
    fn draw_shape(
        &self,
        clause: &WayClause,
        content: &ClauseContent,
        kind: ClauseKind,
        before: &str,
    ) -> Option<String> {
        let says_room =
            !content.room.is_empty() && !matches!(kind, ClauseKind::ToDoor | ClauseKind::To | ClauseKind::Turn);
        let names_room = |shape: &str| shape.contains("{r}") == says_room;
        // "Go straight, go straight to the sofa" says it once too often.
        let is_straight = self.language.traits_of(before).goes_straight && kind != ClauseKind::Straight;
        let admitted = |shape: &str| {
            let traits = self.language.traits_of(shape);
            content.needs.admit(&traits) && !(is_straight && traits.goes_straight)
        };
        let numbered =
            |shape: &str| content.door_number.is_none_or(|number| self.language.number_door(shape, number).is_some());
        let rng = &mut clause.clause_rng("language words", self.dice);
        let mut draw = |fits: &dyn Fn(&str) -> bool| {
            let shapes = self.language.shapes(kind).into_iter().flatten().filter(|(shape, _)| fits(shape));
            let all: Vec<(f64, &String)> = shapes.map(|(shape, count)| (*count, shape)).collect();
            draw_option(&all, rng).cloned()
        };
        draw(&|shape| names_room(shape) && admitted(shape) && numbered(shape))
            .or_else(|| draw(&|shape| names_room(shape) && numbered(shape)))
            .or_else(|| draw(&names_room))
    }
}

/// Whether a joint has the word "then".
fn says_then(joint: ClauseJoint) -> bool {
    matches!(joint, ClauseJoint::StopThen | ClauseJoint::AndThen | ClauseJoint::CommaThen | ClauseJoint::Then)
}

/// The kind of a clause that says the same without its thing.
fn without_thing(kind: ClauseKind) -> ClauseKind {
    match kind {
        ClauseKind::TurnAt => ClauseKind::Turn,
        ClauseKind::PassEnter | ClauseKind::EnterWith => ClauseKind::Enter,
        ClauseKind::StopAt => ClauseKind::Stop,
        ClauseKind::StopAtIn => ClauseKind::StopIn,
        _ => ClauseKind::Straight,
    }
}
