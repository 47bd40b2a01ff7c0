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

impl LanguageWriter<'_> {
    /// A text about a way. Its joints are those of the language.
    pub(super) fn way_text(&mut self, draft: &TextDraft<'_>, brief: &WritingBrief<'_>) -> Option<String> {
        let mut phrases: Vec<ClausePhrase> = Vec::new();
        for (clause, phrase) in draft.clauses().iter().zip(draft.phrases()) {
            let text = match &phrase.content {
                PhraseContent::Stay => self.phrase("stay")?.to_owned(),
                PhraseContent::Task(task) => self.task(task)?,
                PhraseContent::Clause(content) => {
                    let before = phrases.last().map_or("", |phrase| phrase.text.as_str());
                    self.clause(clause, content, before)?
                }
            };
            let runs_on = self.language.traits_of(&text).is_until;
            phrases.push(ClausePhrase { text, is_clause: true, runs_on, content: phrase.content.clone() });
        }
        let mut joints = choose_joints(draft.clauses(), &phrases, self.language.way(), brief, self.dice);
        self.smooth_joints(&mut joints, &phrases);
        let mut text = String::new();
        for (joint, phrase) in joints.iter().zip(&phrases) {
            text += self.language.joining_words(*joint);
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

    /// A clause behind the words `before`. A thing for which the language has no name is left out.
    fn clause(&mut self, clause: &WayClause, content: &ClauseContent, before: &str) -> Option<String> {
        let named = content.thing.as_ref().map(|thing| self.thing(thing));
        let (kind, thing) = match named {
            Some(None) => (without_thing(content.kind), String::new()),
            Some(Some(name)) => (content.kind, name),
            None => (content.kind, String::new()),
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
        let names_room = |shape: &str| shape.contains("{r}") == !content.room.is_empty();
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
