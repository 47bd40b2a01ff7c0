//! A draft of a text: its clauses in words and the joints between them. Each phrase or joint can be replaced, for
//! example because it copies a reference.

use super::{
    Brief,
    dice::Dice,
    naming::{Names, Phrase},
    phrases::draw,
    route::Clause,
};
use crate::style::way::{Joint, is_until};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_language::text::capital;

pub(super) struct Draft<'a> {
    told: Vec<Clause>,
    phrases: Vec<Phrase>,
    joints: Vec<Joint>,
    /// How often each phrase was replaced.
    times: Vec<usize>,
    names: Names<'a>,
    /// Whether its last phrase is a task, which stays as it is.
    has_task: bool,
    full_stop: bool,
}

impl<'a> Draft<'a> {
    pub(super) fn of(told: Vec<Clause>, task: Option<&str>, full_stop: bool, brief: &'a Brief<'_>, dice: Dice) -> Self {
        let mut names = Names::of(&brief.profile.way, dice);
        let mut phrases: Vec<Phrase> = (0..told.len()).map(|at| names.phrase(&told, at, brief, dice)).collect();
        if let Some(task) = task {
            phrases.pop();
            phrases.push(Phrase { text: task.to_owned(), is_clause: true });
        }
        let joints = joints(&told, &phrases, brief, dice);
        let times = vec![0; told.len()];
        Self { told, phrases, joints, times, names, has_task: task.is_some(), full_stop }
    }

    /// The text, and where each of its phrases begins, in bytes.
    pub(super) fn text(&self) -> (String, Vec<usize>) {
        let (mut text, mut starts) = (String::new(), Vec::new());
        for (joint, phrase) in self.joints.iter().zip(&self.phrases) {
            starts.push(text.len());
            let words = match joint {
                Joint::Start => capital(&phrase.text),
                Joint::Stop => format!(". {}", capital(&phrase.text)),
                Joint::StopThen => format!(". Then {}", phrase.text),
                _ => format!("{}{}", joint.words(), phrase.text),
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
    pub(super) fn reword(&mut self, span: [usize; 2], starts: &[usize], brief: &Brief<'_>, dice: Dice) {
        let first = starts.iter().rposition(|start| *start <= span[0]).unwrap_or(0);
        let end = starts.iter().position(|start| *start >= span[1]).unwrap_or(starts.len()).max(first + 1);
        let drawn = |at: usize| self.told[at].drawn("reword", dice).random::<u32>();
        let Some(at) = (first..end).min_by_key(|at| (self.times[*at], drawn(*at))) else { return };
        self.times[at] += 1;
        let dice = dice.other(self.times[at]);
        let rng = &mut self.told[at].drawn("reword", dice);
        let is_task = self.has_task && at + 1 == self.phrases.len();
        if at > first && self.joints[at] != Joint::Run && (is_task || rng.random_bool(0.5)) {
            self.joints[at] = self.other_joint(at, brief, rng);
        } else if !is_task {
            let phrase = self.names.phrase(&self.told, at, brief, dice);
            self.joints[at] = match (is_until(&phrase.text), self.joints[at]) {
                (true, _) => Joint::Run,
                (false, Joint::Run) => Joint::And,
                (false, joint) => joint,
            };
            self.phrases[at] = phrase;
        }
    }

    /// Draws another joint; it begins a sentence if the old one did.
    fn other_joint(&self, at: usize, brief: &Brief<'_>, rng: &mut ChaCha8Rng) -> Joint {
        let old = self.joints[at];
        let fits = |joint: &Joint| {
            joint.begins_sentence() == old.begins_sentence() && (self.phrases[at].is_clause || *joint == Joint::Comma)
        };
        let shares = brief.profile.way.joints.iter().filter(|(joint, _)| fits(joint));
        let all: Vec<(f64, Joint)> = shares.map(|(joint, share)| (*share, *joint)).collect();
        draw(&all, rng).unwrap_or(old)
    }
}

/// Draws the joints between the phrases with the style's shares, and keeps to its number of sentences.
fn joints(told: &[Clause], phrases: &[Phrase], brief: &Brief<'_>, dice: Dice) -> Vec<Joint> {
    let constraints = &brief.style.constraints;
    let least = constraints.min_sentences.unwrap_or(1);
    let most = constraints.max_sentences.unwrap_or(usize::MAX).max(least);
    let way = &brief.profile.way;
    let mut joints: Vec<Joint> = vec![Joint::Start];
    for (at, phrase) in phrases.iter().enumerate().skip(1) {
        if is_until(&phrase.text) {
            joints.push(Joint::Run);
            continue;
        }
        let shares = match () {
            () if at + 1 == phrases.len() => &way.stop_joints,
            () if told[at - 1].kind.is_bare_turn() => &way.turn_joints,
            () => &way.joints,
        };
        let before = joints[at - 1];
        let weight = |joint: &Joint, share: f64| {
            let is_again = *joint == before && !joint.begins_sentence();
            let has_verb = phrase.is_clause || matches!(joint, Joint::Stop | Joint::Comma);
            if has_verb { share * if is_again { 0.3 } else { 1.0 } } else { 0.0 }
        };
        let all: Vec<(f64, Joint)> = shares.iter().map(|(joint, share)| (weight(joint, *share), *joint)).collect();
        joints.push(draw(&all, &mut told[at].drawn("joint", dice)).unwrap_or(Joint::Stop));
    }
    let begins = |joints: &[Joint]| joints.iter().filter(|joint| joint.begins_sentence()).count();
    while begins(&joints) < least {
        let may_stop = |at: &usize| !joints[*at].begins_sentence() && joints[*at] != Joint::Run;
        let within: Vec<usize> = (1..joints.len()).filter(may_stop).collect();
        if within.is_empty() {
            break;
        }
        let mut rng = dice.at("sentence", within.len());
        joints[within[rng.random_range(0..within.len())]] = Joint::Stop;
    }
    while begins(&joints) > most {
        let Some(at) = (1..joints.len()).find(|at| joints[*at].begins_sentence()) else { break };
        joints[at] = if phrases[at].is_clause { Joint::And } else { Joint::Comma };
    }
    joints
}
