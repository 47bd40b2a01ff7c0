//! A draft of a text: its clauses in words and the joints between them. Each phrase or joint can be replaced, for
//! example because it copies a reference.

use super::{
    WritingBrief,
    dice::TextDice,
    naming::{ChosenNames, ClausePhrase, PhraseContent},
    phrases::draw_option,
    route::WayClause,
    task::TaskPhrase,
};
use crate::style::way::{ClauseJoint, ClauseKind, WayWording};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_language::text::capitalise_first;

/// A text in the making. Clauses, phrases and joints belong together one by one; a joint comes before its phrase.
#[derive(Clone)]
pub(super) struct TextDraft<'a> {
    /// The clauses of the plan, with their things.
    clauses: Vec<WayClause>,
    phrases: Vec<ClausePhrase>,
    joints: Vec<ClauseJoint>,
    /// How often each phrase was replaced.
    reword_counts: Vec<usize>,
    names: ChosenNames<'a>,
    /// Whether its last phrase is a task, which stays as it is.
    has_task: bool,
    /// Whether a text of one sentence ends in a full stop; longer ones always do.
    full_stop: bool,
}

impl<'a> TextDraft<'a> {
    /// Puts the clauses into words and draws the joints. A task replaces the words of the last clause.
    pub(super) fn from_clauses(
        mut told: Vec<WayClause>,
        task: Option<&TaskPhrase>,
        full_stop: bool,
        brief: &'a WritingBrief<'_>,
        dice: TextDice,
    ) -> Self {
        // "Walk straight. Go forward": once is enough.
        told.dedup_by(|next, before| next.kind == ClauseKind::Straight && before.kind == ClauseKind::Straight);
        if begins_behind_untold_turn(&told, brief) {
            told.remove(0);
        }
        if task.is_none() && leaves_out_stop(&told, brief, dice) {
            told.pop();
        }
        let mut names = ChosenNames::for_way(brief, dice);
        let mut phrases: Vec<ClausePhrase> =
            (0..told.len()).map(|at| names.clause_phrase(&told, at, brief, dice)).collect();
        if let Some(task) = task {
            phrases.pop();
            let (text, content) = (task.text.clone(), PhraseContent::Task(task.content.clone()));
            phrases.push(ClausePhrase { text, is_clause: true, runs_on: false, content });
        }
        let joints = choose_joints(&told, &phrases, &brief.profile.way, brief, dice);
        let times = vec![0; told.len()];
        Self { clauses: told, phrases, joints, reword_counts: times, names, has_task: task.is_some(), full_stop }
    }

    /// The clauses of the plan, one for each phrase.
    pub(super) fn clauses(&self) -> &[WayClause] {
        &self.clauses
    }

    /// The phrases of the text.
    pub(super) fn phrases(&self) -> &[ClausePhrase] {
        &self.phrases
    }

    /// Whether a text of one sentence ends in a full stop.
    pub(super) fn ends_in_full_stop(&self) -> bool {
        self.full_stop
    }

    /// The text, and where each of its phrases begins, in bytes.
    pub(super) fn text_and_starts(&self) -> (String, Vec<usize>) {
        let (mut text, mut starts) = (String::new(), Vec::new());
        for (joint, phrase) in self.joints.iter().zip(&self.phrases) {
            starts.push(text.len());
            let words = match joint {
                ClauseJoint::Start => capitalise_first(&phrase.text),
                ClauseJoint::Stop => format!(". {}", capitalise_first(&phrase.text)),
                ClauseJoint::StopThen => format!(". Then {}", phrase.text),
                _ => format!("{}{}", joint.joining_words(), phrase.text),
            };
            text.push_str(&words);
        }
        let sentences = self.joints.iter().filter(|joint| joint.begins_sentence()).count();
        if self.full_stop || sentences > 1 {
            text.push('.');
        }
        (text, starts)
    }

    /// Replaces the words or the joint of one phrase within a span of the text: the phrase that was replaced least
    /// often.
    pub(super) fn reword_span(&mut self, span: [usize; 2], starts: &[usize], brief: &WritingBrief<'_>, dice: TextDice) {
        let first = starts.iter().rposition(|start| *start <= span[0]).unwrap_or(0);
        let end = starts.iter().position(|start| *start >= span[1]).unwrap_or(starts.len()).max(first + 1);
        let drawn = |at: usize| self.clauses[at].clause_rng("reword", dice).random::<u32>();
        let Some(at) = (first..end).min_by_key(|at| (self.reword_counts[*at], drawn(*at))) else { return };
        self.reword_counts[at] += 1;
        let dice = dice.other_draws(self.reword_counts[at]);
        let rng = &mut self.clauses[at].clause_rng("reword", dice);
        let is_task = self.has_task && at + 1 == self.phrases.len();
        if at > first && self.joints[at] != ClauseJoint::Run && (is_task || rng.random_bool(0.5)) {
            self.joints[at] = self.other_joint(at, brief, rng);
        } else if !is_task {
            let phrase = self.names.clause_phrase(&self.clauses, at, brief, dice);
            self.joints[at] = match (phrase.runs_on, self.joints[at]) {
                (true, _) => ClauseJoint::Run,
                (false, ClauseJoint::Run) => ClauseJoint::And,
                (false, joint) => joint,
            };
            self.phrases[at] = phrase;
        }
    }

    /// Draws another joint; it begins a sentence if the old one did.
    fn other_joint(&self, at: usize, brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> ClauseJoint {
        let old = self.joints[at];
        let fits = |joint: &ClauseJoint| {
            joint.begins_sentence() == old.begins_sentence()
                && (self.phrases[at].is_clause || *joint == ClauseJoint::Comma)
        };
        let shares = brief.profile.way.joints.iter().filter(|(joint, _)| fits(joint));
        let all: Vec<(f64, ClauseJoint)> = shares.map(|(joint, share)| (*share, *joint)).collect();
        draw_option(&all, rng).unwrap_or(old)
    }
}

/// Whether a text goes straight on first although it leaves out the turn at the start, as texts of some languages do.
fn begins_behind_untold_turn(told: &[WayClause], brief: &WritingBrief<'_>) -> bool {
    let [first, _, ..] = told else { return false };
    let turns = brief.memory.bends.first().is_some_and(|bend| bend.first == 0 && !bend.is_slight());
    brief.profile.way.untold_first_turns > 0.0 && first.kind == ClauseKind::Straight && turns
}

/// Whether a text ends without "and stop": the clause before it tells where the way ends.
fn leaves_out_stop(told: &[WayClause], brief: &WritingBrief<'_>, dice: TextDice) -> bool {
    let [.., before, stop] = told else { return false };
    if !brief.memory.is_on_graph() {
        return false;
    }
    let arrives = matches!(
        before.kind,
        ClauseKind::Enter
            | ClauseKind::EnterOnSide
            | ClauseKind::EnterThroughDoor
            | ClauseKind::EnterWith
            | ClauseKind::LeaveEnter
            | ClauseKind::PassEnter
            | ClauseKind::TurnInto
            | ClauseKind::To
            | ClauseKind::Up
            | ClauseKind::Down
    );
    let share = brief.profile.way.silent_stop_share();
    stop.kind == ClauseKind::Stop
        && told.len() > 2
        && arrives
        && stop.clause_rng("silent stop", dice).random_bool(share)
}

/// Draws the joints between the phrases with the style's shares, and keeps to its number of sentences.
pub(super) fn choose_joints(
    clauses: &[WayClause],
    phrases: &[ClausePhrase],
    way: &WayWording,
    brief: &WritingBrief<'_>,
    dice: TextDice,
) -> Vec<ClauseJoint> {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    let most = constraints.max_sentences.unwrap_or(usize::MAX).max(least);
    let mut joints: Vec<ClauseJoint> = vec![ClauseJoint::Start];
    for (at, phrase) in phrases.iter().enumerate().skip(1) {
        if phrase.runs_on {
            joints.push(ClauseJoint::Run);
            continue;
        }
        let shares = match () {
            () if at + 1 == phrases.len() => &way.stop_joints,
            () if clauses[at - 1].kind.is_bare_turn() => &way.turn_joints,
            () => &way.joints,
        };
        let before = joints[at - 1];
        // The same joint twice in a row within a sentence is rarer, and only a clause with a verb can follow "and".
        let weight = |joint: &ClauseJoint, share: f64| {
            let is_again = *joint == before && !joint.begins_sentence();
            let has_verb = phrase.is_clause || matches!(joint, ClauseJoint::Stop | ClauseJoint::Comma);
            if has_verb { share * if is_again { 0.3 } else { 1.0 } } else { 0.0 }
        };
        let all: Vec<(f64, ClauseJoint)> =
            shares.iter().map(|(joint, share)| (weight(joint, *share), *joint)).collect();
        joints.push(draw_option(&all, &mut clauses[at].clause_rng("joint", dice)).unwrap_or(ClauseJoint::Stop));
    }
    let count_sentences = |joints: &[ClauseJoint]| joints.iter().filter(|joint| joint.begins_sentence()).count();
    while count_sentences(&joints) < least {
        let may_stop = |at: &usize| !joints[*at].begins_sentence() && joints[*at] != ClauseJoint::Run;
        let within: Vec<usize> = (1..joints.len()).filter(may_stop).collect();
        if within.is_empty() {
            break;
        }
        let mut rng = dice.rng_at_frame("sentence", within.len());
        joints[within[rng.random_range(0..within.len())]] = ClauseJoint::Stop;
    }
    while count_sentences(&joints) > most {
        let Some(at) = (1..joints.len()).find(|at| joints[*at].begins_sentence()) else { break };
        joints[at] = if phrases[at].is_clause { ClauseJoint::And } else { ClauseJoint::Comma };
    }
    joints
}
