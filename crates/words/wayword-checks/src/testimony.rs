//! Compares a text with other authors' texts about the same path, which serve as witnesses.

use crate::{TextFindings, evidence::Evidence, known_names};
use wayword_core::{CheckFinding, CheckKind, ClimbDirection, Side, Verdict};
use wayword_language::{
    lexicon::{names_agree, same_room},
    reading::{EventContent, PlaceMention, TextEvent, read_instruction},
    text::split_words,
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
        Self { events: read_instruction(text, &known_names(evidence)).into_claims().events, words: split_words(text) }
    }

    /// The sides of its turns, in their order.
    fn turn_events(&self) -> impl Iterator<Item = (&TextEvent, Side)> {
        self.events.iter().filter_map(|event| match event.what {
            EventContent::Turn(side) => Some((event, side)),
            _ => None,
        })
    }

    /// Whether it makes the same statement as an event of another text.
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
                let place = own.turn_events().position(|(other, _)| other.span == event.span);
                place.and_then(|place| self.turn_events().nth(place)).is_some_and(|(_, other)| other == *side)
            }
            _ => false,
        }
    }
}

fn names_same(event: &TextEvent, place: &PlaceMention) -> bool {
    let EventContent::Place(other) = &event.what else { return false };
    (place.is_thing && other.is_thing && names_agree(&place.name, &other.name))
        || (place.is_room && other.is_room && same_room(&place.name, &other.name))
}

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
