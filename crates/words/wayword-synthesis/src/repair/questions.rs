//! Asks the model that sees about the words of a text that the checks could not decide: whether a picture of the words' part of
//! the walk shows what they name.

use super::InstructionOrder;
use crate::{
    dialogue::{dialogue_sightings, refuses_to_look},
    observe::ObservationRoles,
};
use wayword_checks::{UNDECIDED_PRESENCE, pass_finding};
use wayword_core::{
    AnswerForm, CheckFinding, CheckKind, DialogueExchange, Instruction, ModelError, Verdict, ViewQuestion,
    WitnessAnswer,
};
use wayword_language::lexicon::{find_thing, names_agree, to_singular, with_article};

/// Most questions about a text.
const MAX_QUESTIONS: usize = 2;

/// Asks about landmarks that are unverified. What the model sees passes; what it denies fails, and the text is written again.
///
/// # Errors
/// When the model fails.
pub(super) fn ask_about_text(
    instruction: &mut Instruction,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
) -> Result<(), ModelError> {
    let asked: Vec<(usize, String, usize)> = instruction
        .findings
        .iter()
        .enumerate()
        .filter_map(|(at, finding)| {
            let (name, frame) = askable_words(instruction, finding, order)?;
            Some((at, name, frame))
        })
        .take(MAX_QUESTIONS)
        .collect();
    let questions: Vec<String> = asked.iter().map(|(_, name, _)| format!("Is there {}?", with_article(name))).collect();
    let asks: Vec<ViewQuestion<'_>> = asked
        .iter()
        .zip(&questions)
        .map(|((_, _, frame), question)| ViewQuestion {
            view: &order.views[*frame],
            question,
            history: &[],
            answer: AnswerForm::Words,
        })
        .collect();
    if asks.is_empty() {
        return Ok(());
    }
    let answers = observers.answerer.answer_questions(&asks);
    for ((finding, name, frame), (question, answer)) in asked.iter().zip(questions.iter().zip(answers)) {
        let exchange = DialogueExchange::new(question, &answer?);
        match witness_of(&exchange, name, observers.answerer.name()) {
            Some(WitnessAnswer::Seen) => instruction.findings[*finding] = pass_finding(CheckKind::Landmarks),
            Some(WitnessAnswer::Denied) => {
                let reason = format!("the model that sees was asked, and Frame {frame} shows no {name}");
                let wrong = &mut instruction.findings[*finding];
                (wrong.verdict, wrong.reason) = (Verdict::Fail, reason);
            }
            Some(WitnessAnswer::Unsure) | None => {}
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

/// The thing of an unverified finding whose presence the checks could not decide, and the frame whose picture should show it: of those
/// where a witness was unsure of it, the one nearest to the part of the text that names it, or else the last frame of that part.
fn askable_words(
    instruction: &Instruction,
    finding: &CheckFinding,
    order: InstructionOrder<'_>,
) -> Option<(String, usize)> {
    let last = order.views.len().checked_sub(1)?;
    let is_open = finding.check == CheckKind::Landmarks && finding.verdict == Verdict::Unverified;
    let [from, to] = finding.span.filter(|_| is_open && finding.reason.starts_with(UNDECIDED_PRESENCE))?;
    let words = instruction.text.get(from..to)?.to_lowercase();
    let bare = ["the ", "a ", "an "].iter().find_map(|article| words.strip_prefix(article)).unwrap_or(&words);
    let name = to_singular(bare);
    let part = instruction.parts.iter().find(|part| part.span[0] <= from && from < part.span[1]);
    let told = part.map_or(last, |part| part.frames[1]).min(last);
    let unsure = order.evidence.frames_perhaps_with(&name);
    let frame =
        unsure.into_iter().filter(|frame| *frame <= last).min_by_key(|frame| frame.abs_diff(told)).unwrap_or(told);
    (find_thing(&name).is_some() && order.views[frame].image.is_some()).then_some((name, frame))
}

/// What an answer says of a thing.
fn witness_of(exchange: &DialogueExchange, name: &str, by: &str) -> Option<WitnessAnswer> {
    if refuses_to_look(&exchange.answer) {
        return None;
    }
    let told = dialogue_sightings(std::slice::from_ref(exchange), by);
    told.into_iter().find(|sighting| names_agree(&sighting.name, name)).map(|sighting| sighting.witness)
}
