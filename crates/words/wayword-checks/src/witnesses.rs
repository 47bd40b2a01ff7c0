//! Compares a text with other authors' texts about the same path, which serve as witnesses.

use crate::{Checked, evidence::Evidence, names};
use wayword_core::{Check, Climb, Finding, Side, Verdict};
use wayword_language::{
    lexicon::{agree, same_room},
    reading::{Event, Place, What, read},
    text::words,
};

/// The statements of a text, as testimony for other texts about the same path.
#[derive(Debug, Clone)]
pub struct Testimony {
    events: Vec<Event>,
    /// The words, without case, marks and spaces.
    words: Vec<String>,
}

impl Testimony {
    /// Reads the statements of a text about a path.
    #[must_use]
    pub fn of(text: &str, evidence: &Evidence) -> Self {
        Self { events: read(text, &names(evidence)).claims().events, words: words(text) }
    }

    /// The sides of its turns, in their order.
    fn turns(&self) -> impl Iterator<Item = (&Event, Side)> {
        self.events.iter().filter_map(|event| match event.what {
            What::Turn(side) => Some((event, side)),
            _ => None,
        })
    }

    /// Whether it makes the same statement as an event of another text.
    fn confirms(&self, event: &Event, own: &Self) -> bool {
        match &event.what {
            What::Place(place) => self.events.iter().any(|other| names_same(other, place)),
            What::Climb(climb) | What::Steps(climb) | What::Storey(climb) => {
                self.events.iter().any(|other| climbs(other) == Some(*climb))
            }
            What::Floor(floor) => self.events.iter().any(|other| match other.what {
                What::Floor(other) => other.number == floor.number,
                _ => false,
            }),
            What::Turn(side) => {
                let place = own.turns().position(|(other, _)| other.span == event.span);
                place.and_then(|place| self.turns().nth(place)).is_some_and(|(_, other)| other == *side)
            }
            _ => false,
        }
    }
}

fn names_same(event: &Event, place: &Place) -> bool {
    let What::Place(other) = &event.what else { return false };
    (place.is_thing && other.is_thing && agree(&place.name, &other.name))
        || (place.is_room && other.is_room && same_room(&place.name, &other.name))
}

fn climbs(event: &Event) -> Option<Climb> {
    match event.what {
        What::Climb(climb) | What::Steps(climb) | What::Storey(climb) => Some(climb),
        _ => None,
    }
}

/// Lifts a failure to "unverified" where another author's text about the same path makes the same statement: a room,
/// an object, a climb, or a turn at the same place among the turns. A repetition within a text stays its own fault,
/// and a copy of the text, with other marks or spaces, is no witness.
pub fn lift(checked: &mut Checked, own: &Testimony, others: &[&Testimony]) {
    let others: Vec<&&Testimony> = others.iter().filter(|other| other.words != own.words).collect();
    for finding in &mut checked.findings {
        let is_lifted = finding.verdict == Verdict::Fail
            && about(finding, own).any(|event| others.iter().any(|other| other.confirms(event, own)));
        if is_lifted {
            finding.verdict = Verdict::Unverified;
            finding.reason.push_str("; another text about this path says the same");
        }
    }
}

/// The events that a finding is about.
fn about<'a>(finding: &'a Finding, own: &'a Testimony) -> impl Iterator<Item = &'a Event> {
    let is_meant = |event: &&Event| match event.what {
        What::Place(_) => finding.check == Check::Landmarks,
        What::Turn(_) => finding.check == Check::Turns,
        What::Climb(_) | What::Steps(_) | What::Storey(_) | What::Floor(_) => finding.check == Check::Floors,
        _ => false,
    };
    let span = finding.span.unwrap_or([0, 0]);
    let overlaps = move |event: &&Event| event.span[0] < span[1] && span[0] < event.span[1];
    own.events.iter().filter(is_meant).filter(overlaps)
}
