//! Asks the model that sees about the words of a text that the checks could not decide: whether a picture of the words' part of
//! the walk shows what they name, and which room the last picture shows.

use super::InstructionOrder;
use crate::{
    dialogue::{dialogue_room, dialogue_sightings, refuses_to_look},
    observe::ObservationRoles,
};
use wayword_checks::{UNDECIDED_AT_END, UNDECIDED_END_ROOM, UNDECIDED_PRESENCE, pass_finding};
use wayword_core::{
    AnswerForm, CheckFinding, CheckKind, DialogueExchange, Instruction, ModelError, Verdict, ViewQuestion,
    WitnessAnswer,
};
use wayword_language::lexicon::{find_thing, names_agree, room_name, same_room, to_singular, with_article};

/// Most questions about a text.
const MAX_QUESTIONS: usize = 2;

/// A question about a text.
struct TextQuestion {
    /// The number of the finding that it is about.
    finding: usize,
    /// The frame whose picture it is about.
    frame: usize,
    subject: QuestionedPlace,
    /// Whether a "no" makes the words wrong. A thing at the end may stand beside a walker whose picture looks ahead.
    no_counts: bool,
}

/// What a question is about.
enum QuestionedPlace {
    /// Whether the picture shows a thing.
    Thing(String),
    /// Which room the picture shows; the text says that it is this one.
    Room(String),
}

impl TextQuestion {
    fn words(&self) -> String {
        match &self.subject {
            QuestionedPlace::Thing(name) => format!("Is there {}?", with_article(name)),
            QuestionedPlace::Room(_) => "What room is this?".to_owned(),
        }
    }

    /// What an answer says of the place. Another room than that of the text proves nothing: one room has several names.
    fn read_answer(&self, exchange: &DialogueExchange, by: &str) -> Option<WitnessAnswer> {
        if refuses_to_look(&exchange.answer) {
            return None;
        }
        let told = std::slice::from_ref(exchange);
        match &self.subject {
            QuestionedPlace::Thing(name) => {
                let seen = dialogue_sightings(told, by);
                seen.into_iter().find(|sighting| names_agree(&sighting.name, name)).map(|sighting| sighting.witness)
            }
            QuestionedPlace::Room(name) => {
                dialogue_room(told).filter(|room| same_room(room, name)).map(|_| WitnessAnswer::Seen)
            }
        }
    }
}

/// Asks about places that are unverified. What the model sees passes; what it denies fails, and the text is written again.
///
/// # Errors
/// When the model fails.
pub(super) fn ask_about_text(
    instruction: &mut Instruction,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
) -> Result<(), ModelError> {
    let open = (0..instruction.findings.len()).filter_map(|finding| open_question(instruction, finding, order));
    let asked: Vec<TextQuestion> = open.take(MAX_QUESTIONS).collect();
    let questions: Vec<String> = asked.iter().map(TextQuestion::words).collect();
    let asks: Vec<ViewQuestion<'_>> = asked
        .iter()
        .zip(&questions)
        .map(|(asked, question)| ViewQuestion {
            view: &order.views[asked.frame],
            question,
            history: &[],
            answer: AnswerForm::Words,
        })
        .collect();
    if asks.is_empty() {
        return Ok(());
    }
    let answers = observers.answerer.answer_questions(&asks);
    for (asked, (question, answer)) in asked.iter().zip(questions.iter().zip(answers)) {
        let exchange = DialogueExchange::new(question, &answer?);
        match asked.read_answer(&exchange, observers.answerer.name()) {
            Some(WitnessAnswer::Seen) => instruction.findings[asked.finding] = pass_finding(CheckKind::Landmarks),
            Some(WitnessAnswer::Denied) if asked.no_counts => {
                let (QuestionedPlace::Thing(name) | QuestionedPlace::Room(name)) = &asked.subject;
                let reason = format!("the model that sees was asked, and Frame {} shows no {name}", asked.frame);
                let wrong = &mut instruction.findings[asked.finding];
                (wrong.verdict, wrong.reason) = (Verdict::Fail, reason);
            }
            Some(WitnessAnswer::Denied | WitnessAnswer::Unsure) | None => {}
        }
    }
    // "Landmarks: pass" stands only where nothing else is found there.
    let has_other =
        instruction.findings.iter().any(|it| it.check == CheckKind::Landmarks && it.verdict != Verdict::Pass);
    let mut passes = 0;
    instruction.findings.retain(|it| {
        let is_pass = it.check == CheckKind::Landmarks && it.verdict == Verdict::Pass;
        passes += usize::from(is_pass);
        !is_pass || (!has_other && passes == 1)
    });
    instruction.verdict = instruction.findings.iter().map(|finding| finding.verdict).max().unwrap_or(Verdict::Pass);
    Ok(())
}

/// The question about an unverified finding, if a picture may answer it. Of a thing it is about the frame where a witness was unsure of
/// it, the one nearest to the part of the text that names it, or else about the last frame of that part.
fn open_question(instruction: &Instruction, finding: usize, order: InstructionOrder<'_>) -> Option<TextQuestion> {
    let last = order.views.len().checked_sub(1)?;
    let CheckFinding { check, verdict, reason, span } = instruction.findings.get(finding)?;
    let is_open = (*check, *verdict) == (CheckKind::Landmarks, Verdict::Unverified);
    let [from, to] = span.filter(|_| is_open)?;
    let words = instruction.text.get(from..to)?.to_lowercase();
    let bare = ["the ", "a ", "an "].iter().find_map(|article| words.strip_prefix(article)).unwrap_or(&words);
    let name = to_singular(bare);
    let part = instruction.parts.iter().find(|part| part.span[0] <= from && from < part.span[1]);
    let told = part.map_or(last, |part| part.frames[1]).min(last);
    let is_room_alone = find_thing(&name).is_none() && room_name(bare).is_some();
    let room_at = match () {
        () if reason.starts_with(UNDECIDED_END_ROOM) => Some(last),
        () if reason.starts_with(UNDECIDED_PRESENCE) && is_room_alone => Some(told),
        () => None,
    };
    let has_picture = |frame: usize| order.views[frame].image.is_some();
    if let Some(frame) = room_at {
        let subject = QuestionedPlace::Room(bare.to_owned());
        return has_picture(frame).then_some(TextQuestion { finding, frame, subject, no_counts: false });
    }
    let no_counts = reason.starts_with(UNDECIDED_PRESENCE);
    let frame = match () {
        () if reason.ends_with(UNDECIDED_AT_END) => last,
        () if no_counts => {
            let unsure = order.evidence.frames_perhaps_with(&name).into_iter().filter(|frame| *frame <= last);
            unsure.min_by_key(|frame| frame.abs_diff(told)).unwrap_or(told)
        }
        () => return None,
    };
    let is_askable = find_thing(&name).is_some() && has_picture(frame);
    is_askable.then_some(TextQuestion { finding, frame, subject: QuestionedPlace::Thing(name), no_counts })
}
