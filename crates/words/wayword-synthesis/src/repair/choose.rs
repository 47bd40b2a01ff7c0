//! Chooses among several candidate texts of one walk the one by which a follower finds the way most surely.

use super::{InstructionOrder, WritingOutcome, attempts::new_draft, refine::write_candidate};
use crate::{
    observe::ObservationRoles,
    writer::{InstructionWriter, RulesWriter},
};
use wayword_core::{ChosenBy, Instruction, ModelError, TextSelection, Verdict, WrittenDraft};
use wayword_language::{languages::ReadableText, text::word_count};

/// The cost of a word in natural logs of the probability to arrive: of two texts that lead there equally surely the
/// shorter is chosen, and ten more words have to raise the probability by a twentieth.
const WORD_COST_LN: f64 = 0.005;

/// Writes all candidates, each with its repairs, and returns the best.
pub(super) fn write_best(
    writer: &dyn InstructionWriter,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
) -> Result<WritingOutcome, ModelError> {
    let mut accepted: Vec<TextCandidate> = Vec::new();
    let mut rejected: Option<(Option<Instruction>, String)> = None;
    let mut passed = 0;
    let mut drafts: Vec<WrittenDraft> = Vec::new();
    let all = 0..order.candidates.max(1);
    let numbers: Vec<u32> = order.only.map_or(all, |only| only..only + 1).collect();
    let write = |number: u32| write_candidate(writer, observers, order, number);
    for (number, outcome) in numbers.iter().copied().zip(order.together.write_each(&numbers, &write)) {
        match outcome? {
            WritingOutcome::Accepted(mut instruction) => {
                passed += 1;
                drafts.append(&mut instruction.provenance.drafts);
                if accepted.iter().all(|other| other.instruction.text != instruction.text) {
                    accepted.push(TextCandidate { number, instruction });
                } else if writer.name() != RulesWriter.name() {
                    let reasons = vec!["another candidate has the same words".to_owned()];
                    drafts.push(new_draft(&instruction.text, number, reasons, &[]));
                }
            }
            WritingOutcome::Rejected { last, reason, drafts: mut earlier } => {
                drafts.append(&mut earlier);
                rejected = rejected.or(Some((last, reason)));
            }
        }
    }
    let texts: Vec<(u32, String)> =
        accepted.iter().map(|candidate| (candidate.number, candidate.instruction.text.clone())).collect();
    let (best, by) = best_candidate(accepted, order);
    Ok(match (best, rejected) {
        (Some(TextCandidate { number, mut instruction }), _) => {
            if writer.name() != RulesWriter.name() {
                let others = texts.into_iter().filter(|(other, _)| *other != number);
                let reasons = vec!["another candidate was chosen".to_owned()];
                drafts.extend(others.map(|(candidate, text)| new_draft(&text, candidate, reasons.clone(), &[])));
            }
            instruction.provenance.drafts = drafts;
            let chosen = TextSelection { among: order.candidates, passed, number, by };
            instruction.provenance.chosen = (order.candidates > 1).then_some(chosen);
            WritingOutcome::Accepted(instruction)
        }
        (None, Some((last, reason))) => WritingOutcome::Rejected { last, reason, drafts },
        (None, None) => WritingOutcome::Rejected { last: None, reason: "no text was written".to_owned(), drafts },
    })
}

/// One of several texts for a walk.
struct TextCandidate {
    /// Its number, from 0. Rejected candidates have numbers too.
    number: u32,
    instruction: Instruction,
}

/// The best candidate, and how it was chosen. A text that passes all checks is preferred to one with something
/// unverified.
fn best_candidate(accepted: Vec<TextCandidate>, order: InstructionOrder<'_>) -> (Option<TextCandidate>, ChosenBy) {
    let verdict = accepted.iter().map(|candidate| candidate.instruction.verdict).min().unwrap_or(Verdict::Pass);
    let mut alike = accepted.into_iter().filter(|candidate| candidate.instruction.verdict == verdict);
    let Some(follower) = order.follower.filter(|_| order.candidates > 1) else {
        return (alike.next(), ChosenBy::Checks);
    };
    let score = |TextCandidate { instruction, .. }: &TextCandidate| {
        follower.leads_there(&instruction.text).map(|share| text_worth(share, instruction))
    };
    let scored: Vec<(Option<f64>, TextCandidate)> = alike.map(|candidate| (score(&candidate), candidate)).collect();
    let by = if scored.iter().any(|(score, _)| score.is_some()) { ChosenBy::Follower } else { ChosenBy::Checks };
    let mut best: Option<(Option<f64>, TextCandidate)> = None;
    for (score, candidate) in scored {
        // Of candidates with equal scores the first is chosen.
        if best.as_ref().is_none_or(|(before, _)| score > *before) {
            best = Some((score, candidate));
        }
    }
    (best.map(|(_, candidate)| candidate), by)
}

/// The value of a text that leads to the end with probability `share`, natural logs: this probability times the chance
/// to take the right object there, less the cost of its words.
fn text_worth(share: f64, instruction: &Instruction) -> f64 {
    let readable = ReadableText::new(&instruction.text, None);
    let objects = instruction.ambiguity.as_ref().map_or(1, |ambiguity| ambiguity.objects.max(1));
    share.max(f64::MIN_POSITIVE).ln() - (objects as f64).ln() - WORD_COST_LN * word_count(readable.english()) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        dialogue::RulesAsker,
        offline::LabelAnswerer,
        repair::{
            TextFollower,
            tests::{GOOD, Scripted, observers, order, walk},
        },
        style::{StyleProfile, built_in},
    };
    use wayword_checks::TextFindings;
    use wayword_core::TextAmbiguity;

    /// A follower that finds the end the more surely the more often a text contains "lamp", and cannot follow one that
    /// names the sofa.
    struct LampFinder;

    impl TextFollower for LampFinder {
        fn follow(&self, _: &str, _: &mut TextFindings) -> TextAmbiguity {
            TextAmbiguity { objects: 1, ..TextAmbiguity::default() }
        }

        fn leads_there(&self, text: &str) -> Option<f64> {
            (!text.contains("sofa")).then(|| 0.2 + 0.3 * text.matches("lamp").count() as f64)
        }

        fn advice(&self, _: &Instruction) -> Vec<String> {
            Vec::new()
        }
    }

    const TO_THE_LAMP: &str = "Walk to the lamp and turn right. Stop at the sink.";
    const ON: &str = "Walk straight ahead and turn right. Stop at the sink.";
    const TO_A_PIANO: &str = "Walk to the piano and turn right. Stop at the sink.";

    fn kept(texts: &[&str], follower: Option<&dyn TextFollower>) -> Instruction {
        let walk = walk();
        let evidence = walk.evidence().unwrap();
        let style = built_in("r2r").unwrap();
        let profile = StyleProfile::for_style(&style);
        let memory = walk.memory();
        let candidates = u32::try_from(texts.len()).unwrap();
        let order =
            InstructionOrder { repairs: 0, candidates, follower, ..order(&walk, &memory, &evidence, &style, &profile) };
        let asker = RulesAsker::default();
        let labels = LabelAnswerer::default();
        let observers = observers(&asker, &labels);
        let writer = Scripted::new(texts.iter().map(|text| Ok((*text).to_owned())).collect());
        match write_best(&writer, observers, order).unwrap() {
            WritingOutcome::Accepted(instruction) => instruction,
            WritingOutcome::Rejected { reason, .. } => panic!("{reason}"),
        }
    }

    #[test]
    fn write_best_chooses_the_text_that_leads_there_most_surely() {
        let kept = kept(&[ON, TO_A_PIANO, TO_THE_LAMP, GOOD], Some(&LampFinder));
        assert_eq!(kept.text, TO_THE_LAMP);
        assert_eq!(
            kept.provenance.chosen,
            Some(TextSelection { among: 4, passed: 3, number: 2, by: ChosenBy::Follower })
        );
    }

    #[test]
    fn write_best_chooses_by_checks_without_a_usable_follower() {
        let follower: &dyn TextFollower = &LampFinder;
        for follower in [None, Some(follower)] {
            let kept = kept(&[TO_A_PIANO, GOOD], follower);
            assert_eq!(kept.text, GOOD);
            assert_eq!(
                kept.provenance.chosen,
                Some(TextSelection { among: 2, passed: 1, number: 1, by: ChosenBy::Checks })
            );
        }
    }

    #[test]
    fn write_best_prefers_the_shorter_of_equally_sure_texts() {
        let longer = "Walk straight ahead and carry on and turn right. Stop at the sink.";
        assert_eq!(kept(&[longer, ON], Some(&LampFinder)).text, ON);
    }

    #[test]
    fn a_single_text_records_no_choice() {
        assert_eq!(kept(&[GOOD], Some(&LampFinder)).provenance.chosen, None);
    }
}
