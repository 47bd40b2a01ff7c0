//! Compares a text with other authors' texts about the same path, which serve as witnesses.

use crate::{TextFindings, evidence::Evidence, known_names};
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, Side, Verdict};
use wayword_language::{
    lexicon::{names_agree, same_room},
    reading::{EventContent, PlaceMention, TextEvent, read_instruction},
};

/// The statements of a text, as testimony for other texts about the same path.
#[derive(Debug, Clone)]
pub struct Testimony {
    events: Vec<TextEvent>,
    /// The words, without case, marks and spaces.
    words: Vec<String>,
}

impl Testimony {
    /// Reads the statements of a text about a path.
    #[must_use]
    pub fn from_text(text: &str, evidence: &Evidence) -> Self {
        let reading = read_instruction(text, &known_names(evidence)).into_claims();
        Self { words: reading.to_plain_words(), events: reading.events }
    }

    /// Its turns, each with its side, in their order.
    fn turn_events(&self) -> impl Iterator<Item = (&TextEvent, Side)> {
        self.events.iter().filter_map(|event| match event.what {
            EventContent::Turn(side) => Some((event, side)),
            _ => None,
        })
    }

    /// Whether this testimony makes the same statement as `event`, an event of the text `own`. Turns are compared by
    /// their number: the second turn with the second turn.
    fn confirms_event(&self, event: &TextEvent, own: &Self) -> bool {
        match &event.what {
            EventContent::Place(place) => self.events.iter().any(|other| names_same(other, place)),
            EventContent::Climb(climb) | EventContent::Steps(climb) | EventContent::Storey(climb) => {
                self.events.iter().any(|other| climb_in(other) == Some(*climb))
            }
            EventContent::Floor(floor) => self.events.iter().any(|other| match other.what {
                EventContent::Floor(other) => other.number == floor.number,
                _ => false,
            }),
            EventContent::Turn(side) => {
                let number = own.turn_events().position(|(other, _)| other.span == event.span);
                number.and_then(|number| self.turn_events().nth(number)).is_some_and(|(_, other)| other == *side)
            }
            _ => false,
        }
    }
}

/// Whether an event names a place as another text does.
fn names_same(event: &TextEvent, place: &PlaceMention) -> bool {
    let EventContent::Place(other) = &event.what else { return false };
    (place.is_thing && other.is_thing && names_agree(&place.name, &other.name))
        || (place.is_room && other.is_room && same_room(&place.name, &other.name))
}

/// The direction of a climb, if the event is one.
fn climb_in(event: &TextEvent) -> Option<ClimbDirection> {
    match event.what {
        EventContent::Climb(climb) | EventContent::Steps(climb) | EventContent::Storey(climb) => Some(climb),
        _ => None,
    }
}

/// Lifts a failure to "unverified" where another author's text about the same path makes the same statement: a room,
/// an object, a climb, or a turn at the same place among the turns. A repetition within a text stays its own fault,
/// and a copy of the text, with other marks or spaces, is no witness.
pub fn lift_confirmed(checked: &mut TextFindings, own: &Testimony, others: &[&Testimony]) {
    let others: Vec<&&Testimony> = others.iter().filter(|other| other.words != own.words).collect();
    for finding in &mut checked.findings {
        let is_lifted = finding.verdict == Verdict::Fail
            && events_about(finding, own).any(|event| others.iter().any(|other| other.confirms_event(event, own)));
        if is_lifted {
            finding.verdict = Verdict::Unverified;
            finding.reason.push_str("; another text about this path says the same");
        }
    }
}

/// The events that a finding is about.
fn events_about<'a>(finding: &'a CheckFinding, own: &'a Testimony) -> impl Iterator<Item = &'a TextEvent> {
    let is_meant = |event: &&TextEvent| match event.what {
        EventContent::Place(_) => finding.check == CheckKind::Landmarks,
        EventContent::Turn(_) => finding.check == CheckKind::Turns,
        EventContent::Climb(_) | EventContent::Steps(_) | EventContent::Storey(_) | EventContent::Floor(_) => {
            finding.check == CheckKind::Floors
        }
        _ => false,
    };
    let span = finding.span.unwrap_or([0, 0]);
    let overlaps = move |event: &&TextEvent| event.span[0] < span[1] && span[0] < event.span[1];
    own.events.iter().filter(is_meant).filter(overlaps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CheckWorld, tests::to_the_bedroom};

    /// The verdict on a failed statement of a text after the other texts were heard.
    fn verdict_after(check: CheckKind, text: &str, words: &str, others: &[&str]) -> Verdict {
        let evidence = to_the_bedroom();
        let from = text.find(words).unwrap();
        let span = Some([from, from + words.len()]);
        let failed = CheckFinding { check, verdict: Verdict::Fail, reason: "wrong".into(), span };
        let passed = CheckFinding { verdict: Verdict::Pass, ..failed.clone() };
        let mut checked = TextFindings {
            findings: vec![failed, passed],
            mentions: Vec::new(),
            parts: Vec::new(),
            world: CheckWorld::Open,
        };
        let witnesses: Vec<Testimony> = others.iter().map(|text| Testimony::from_text(text, &evidence)).collect();
        lift_confirmed(&mut checked, &Testimony::from_text(text, &evidence), &witnesses.iter().collect::<Vec<_>>());
        assert_eq!(checked.findings[1].verdict, Verdict::Pass);
        let is_lifted = checked.findings[0].verdict == Verdict::Unverified;
        let wanted = if is_lifted { "wrong; another text about this path says the same" } else { "wrong" };
        assert_eq!(checked.findings[0].reason, wanted);
        checked.findings[0].verdict
    }

    #[test]
    fn a_place_is_confirmed_by_a_place_of_its_name() {
        let place = |other: &str| verdict_after(CheckKind::Landmarks, "Walk past the couch.", "couch", &[other]);
        assert_eq!(place("Stop at the sofa."), Verdict::Unverified);
        assert_eq!(place("Stop at the lamp."), Verdict::Fail);
        assert_eq!(place("Do not stop at the sofa."), Verdict::Fail, "it is denied there");
        let room = |other: &str| verdict_after(CheckKind::Landmarks, "Walk into the den.", "den", &[other]);
        assert_eq!(
            (room("Stop in the family room."), room("Stop in the kitchen.")),
            (Verdict::Unverified, Verdict::Fail)
        );
        let text = "Walk past the couch. Walk past the lamp.";
        assert_eq!(verdict_after(CheckKind::Landmarks, text, "lamp", &["Stop at the sofa."]), Verdict::Fail);
        assert_eq!(
            verdict_after(CheckKind::Landmarks, text, "lamp", &["Turn left.", "Stop at the lamp."]),
            Verdict::Unverified
        );
        // A finding of another check is not about the place.
        assert_eq!(
            verdict_after(CheckKind::Order, "Walk past the couch.", "couch", &["Stop at the sofa."]),
            Verdict::Fail
        );
    }

    #[test]
    fn a_climb_is_confirmed_by_any_climb_in_its_direction() {
        for text in ["Go up the stairs.", "Go upstairs.", "Walk up two steps.", "Stop at the lamp upstairs."] {
            let word = ["upstairs", "up"].into_iter().find(|word| text.contains(word)).unwrap();
            let climb = |other: &str| verdict_after(CheckKind::Floors, text, word, &[other]);
            for other in ["Climb the stairs now.", "Now walk up a few steps.", "The bedroom upstairs is yours."] {
                assert_eq!(climb(other), Verdict::Unverified, "{text} {other}");
            }
            assert_eq!((climb("Go down the stairs."), climb("Turn left.")), (Verdict::Fail, Verdict::Fail), "{text}");
        }
    }

    #[test]
    fn a_storey_is_confirmed_by_its_number() {
        let text = "Go to the bedroom on the second floor.";
        let storey = |other: &str| verdict_after(CheckKind::Floors, text, "second floor", &[other]);
        assert_eq!(storey("Stop on the second floor."), Verdict::Unverified);
        assert_eq!((storey("Stop on the third floor."), storey("Turn left.")), (Verdict::Fail, Verdict::Fail));
    }

    #[test]
    fn a_turn_is_confirmed_at_the_same_place_among_the_turns() {
        let text = "Turn left. Turn right.";
        let second = |other: &str| verdict_after(CheckKind::Turns, text, "right", &[other]);
        assert_eq!(second("Turn left, then turn right and stop."), Verdict::Unverified);
        assert_eq!(second("Turn right, then turn left and stop."), Verdict::Fail);
        assert_eq!(second("Now turn right."), Verdict::Fail, "it is the first turn there");
        assert_eq!(verdict_after(CheckKind::Turns, text, "left", &["Now turn left."]), Verdict::Unverified);
    }

    #[test]
    fn a_copy_is_no_witness_and_a_finding_without_words_is_not_lifted() {
        let text = "Walk past the couch.";
        assert_eq!(verdict_after(CheckKind::Landmarks, text, "couch", &["walk past  the COUCH!"]), Verdict::Fail);
        assert_eq!(verdict_after(CheckKind::Landmarks, text, "Walk past", &["Stop at the sofa."]), Verdict::Fail);
        let evidence = to_the_bedroom();
        let own = Testimony::from_text(text, &evidence);
        let finding =
            CheckFinding { check: CheckKind::Landmarks, verdict: Verdict::Fail, reason: String::new(), span: None };
        assert_eq!(events_about(&finding, &own).count(), 0);
    }
}
