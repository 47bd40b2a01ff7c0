//! The words of another language for a text that describes a way.

use super::{LanguageWriter, clauses::SaidClause};
use crate::{
    style::way::{ClauseJoint, ClauseKind},
    writer::{
        WritingBrief,
        draft::{TextDraft, choose_joints},
        naming::{ClausePhrase, PhraseContent},
        phrases::draw_option,
        route::WayClause,
    },
};
use rand::Rng;
use wayword_language::lexicon::room_name;

/// A clause of at most so many characters may come before another one without a mark.
const MAX_UNPARTED_CHARACTERS: usize = 4;
/// A clause of at most so many characters may come behind any other without a mark.
const MAX_TINY_CHARACTERS: usize = 2;
/// Least number of clauses from one "then" to the next.
const MIN_CLAUSES_BETWEEN_THEN: usize = 4;

impl LanguageWriter<'_> {
    /// A text about a way. Its joints are those of the language.
    pub(super) fn way_text(&mut self, draft: &TextDraft<'_>, brief: &WritingBrief<'_>) -> Option<String> {
        let (mut clauses, mut phrases): (Vec<WayClause>, Vec<ClausePhrase>) = (Vec::new(), Vec::new());
        for said in self.clauses_to_say(draft) {
            let text = match said.content {
                PhraseContent::Stay => self.phrase("stay")?.to_owned(),
                PhraseContent::Task(task) => self.task(task)?,
                PhraseContent::Clause(content) => {
                    let before = phrases.last().map_or("", |phrase: &ClausePhrase| phrase.text.as_str());
                    let text = self.clause(&said, content, before)?;
                    self.doorway_of_room(&said.clause, &text, brief).unwrap_or(text)
                }
            };
            let runs_on = self.language.traits_of(&text).is_until;
            phrases.push(ClausePhrase { text, is_clause: true, runs_on, content: said.content.clone() });
            clauses.push(said.clause);
        }
        let mut joints = choose_joints(&clauses, &phrases, self.language.way(), brief, self.dice);
        self.smooth_joints(&mut joints, &clauses, &phrases);
        let mut text = String::new();
        for (at, (joint, phrase)) in joints.iter().zip(&phrases).enumerate() {
            let is_last = at + 1 == phrases.len();
            let words = self.language.joining_words(*joint, is_last).iter().map(|(words, share)| (*share, words));
            let rng = &mut self.dice.named_rng(&["joint", &at.to_string()]);
            text += &draw_option(&words.collect::<Vec<_>>(), rng).cloned().unwrap_or_default();
            text += &phrase.text;
            // "First leave the room, after that turn left" joins once too often.
            let next = at > 0 && joints.get(at + 1).is_some_and(|next| *next == ClauseJoint::And);
            if let Some(after) = self.language.words_after(&phrase.text).filter(|_| next) {
                let after: Vec<(f64, &String)> = after.iter().map(|(words, share)| (*share, words)).collect();
                text += &draw_option(&after, rng).cloned().unwrap_or_default();
            }
        }
        let sentences = joints.iter().filter(|joint| joint.begins_sentence()).count();
        if draft.ends_in_full_stop() || sentences > 1 {
            text += self.language.full_stop();
        }
        Some(text)
    }

    /// The clauses of a text in the other language, in their order.
    fn clauses_to_say<'d>(&self, draft: &'d TextDraft<'_>) -> Vec<SaidClause<'d>> {
        let mut said: Vec<SaidClause<'d>> = Vec::new();
        let last = draft.phrases().len().saturating_sub(1);
        for (at, (clause, phrase)) in draft.clauses().iter().zip(draft.phrases()).enumerate() {
            let before = said.last().map(|said| said.clause.kind);
            let kinds = match &phrase.content {
                PhraseContent::Clause(content) => self.kinds_to_say(clause, content, before, at == last),
                PhraseContent::Stay | PhraseContent::Task(_) => vec![clause.kind],
            };
            // Along a hallway one goes straight on.
            let is_said = before.is_some_and(|before| matches!(before, ClauseKind::Along | ClauseKind::Straight));
            if is_said && clause.kind == ClauseKind::Straight && at != last {
                continue;
            }
            let takes_straight = said.last().is_some_and(SaidClause::is_straight_on)
                && kinds.first().is_some_and(|kind| may_go_straight(*kind));
            if takes_straight {
                said.pop();
            }
            for (number, kind) in kinds.into_iter().enumerate() {
                let goes_straight = takes_straight && number == 0;
                said.push(SaidClause { clause: clause.of_kind(kind), content: &phrase.content, goes_straight });
            }
        }
        said
    }

    /// The words of a clause to a doorway with the name of its room, where texts of the style name it: the one that the walker is in at the start, or else the one behind it.
    fn doorway_of_room(&mut self, clause: &WayClause, text: &str, brief: &WritingBrief<'_>) -> Option<String> {
        let openings = &brief.memory.openings;
        let at = openings.iter().position(|opening| match clause.kind {
            ClauseKind::ToDoor => opening.before == clause.at,
            ClauseKind::StopInDoorway => opening.behind == clause.at,
            _ => false,
        })?;
        let is_named = clause.clause_rng("doorway", self.dice).random_bool(brief.profile.way.named_doorways);
        let room = if at == 0 && clause.kind == ClauseKind::ToDoor { &openings[at].from } else { &openings[at].to };
        let has_walls = !matches!(room_name(room), None | Some("hallway" | "stairs" | "entryway" | "outdoor area"));
        if !is_named || !has_walls {
            return None;
        }
        let room = self.room_name(room)?;
        self.language.name_doorway(text, &room)
    }

    /// Puts a comma where two clauses would run together that always have a mark between them, and where "then" would come soon after "then".
    fn smooth_joints(&self, joints: &mut [ClauseJoint], clauses: &[WayClause], phrases: &[ClausePhrase]) {
        let is_short = |phrase: &ClausePhrase| phrase.text.chars().count() <= MAX_UNPARTED_CHARACTERS;
        let is_tiny = |phrase: &ClausePhrase| phrase.text.chars().count() <= MAX_TINY_CHARACTERS;
        let (mut is_unparted, mut last_then) = (false, None);
        for at in 1..joints.len() {
            let runs_together = match clauses[at].kind {
                // "Walk to the sofa and stop", "turn left and walk to the sofa".
                ClauseKind::Stop => false,
                _ if clauses[at - 1].kind.is_bare_turn() || is_tiny(&phrases[at]) => is_unparted,
                _ => is_unparted || !is_short(&phrases[at - 1]) || self.language.is_parted(&phrases[at].text),
            };
            if joints[at] == ClauseJoint::And && runs_together {
                joints[at] = ClauseJoint::Comma;
            }
            is_unparted = joints[at] == ClauseJoint::And;
            if says_then(joints[at]) && last_then.is_some_and(|then| at < then + MIN_CLAUSES_BETWEEN_THEN) {
                joints[at] = if joints[at].begins_sentence() { ClauseJoint::Stop } else { ClauseJoint::Comma };
            }
            last_then = if says_then(joints[at]) { Some(at) } else { last_then };
        }
    }
}

/// Whether a clause of a kind can say that the walker goes straight on ("go straight to the sofa").
fn may_go_straight(kind: ClauseKind) -> bool {
    matches!(
        kind,
        ClauseKind::To
            | ClauseKind::ToDoor
            | ClauseKind::Pass
            | ClauseKind::PassOnSide
            | ClauseKind::Enter
            | ClauseKind::Leave
            | ClauseKind::Through
            | ClauseKind::AlongToEnd
    )
}

/// Whether a joint has the word "then".
fn says_then(joint: ClauseJoint) -> bool {
    matches!(joint, ClauseJoint::StopThen | ClauseJoint::AndThen | ClauseJoint::CommaThen | ClauseJoint::Then)
}
