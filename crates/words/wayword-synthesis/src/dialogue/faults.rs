//! Checks a caption against the sightings of its dialogue, to keep hallucinated objects out.

use super::answers::{AnswerMention, denial_covers, find_mentions};
use std::{collections::BTreeSet, fmt};
use wayword_core::{ObjectSighting, WitnessAnswer};
use wayword_language::{
    lexicon::{ThingClass, find_thing, names_agree, normalise_name},
    text::split_words,
};

/// A statement of a caption that its dialogue does not support. Its text is a reason that a model understands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CaptionFault {
    /// The caption names an object that an answer denied, or denies one itself: a caption should only list objects
    /// that are there.
    Denied {
        /// As the caption names it.
        name: String,
    },
    /// The caption names an object that every answer left unsure.
    Unsure {
        /// As the caption names it.
        name: String,
    },
    /// The caption names an object that no answer named.
    Invented {
        /// As the caption names it.
        name: String,
    },
}

impl fmt::Display for CaptionFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Denied { name } => write!(f, "it names \"{name}\", and an answer says that it is not there"),
            Self::Unsure { name } => write!(f, "it names \"{name}\", and no answer was sure of it"),
            Self::Invented { name } => write!(f, "it names \"{name}\", and no answer named it"),
        }
    }
}

/// The objects of a text that the sightings of its dialogue do not support, each name once.
///
/// Objects are words that the lexicon or a sighting names. Walls, floors, ceilings and rooms are not checked. A name
/// that can also mean a room counts as one if the text begins with it ("A staircase with a window").
#[must_use]
pub fn caption_faults(text: &str, sightings: &[ObjectSighting]) -> Vec<CaptionFault> {
    let known: BTreeSet<String> = sightings.iter().map(|sighting| normalise_name(&sighting.name)).collect();
    let mentions = find_mentions(text, &known);
    let mut faults: Vec<CaptionFault> = Vec::new();
    for (at, mention) in mentions.iter().enumerate().filter(|(_, mention)| mention.is_thing) {
        let is_the_room = at == 0 && mention.is_room && begins_with_room(text, &mention.name);
        let fault = mention_fault(mention, sightings).filter(|fault| !is_the_room && !faults.contains(fault));
        faults.extend(fault);
    }
    faults
}

/// Whether a text consists of just a name, or begins with the name and "with".
fn begins_with_room(text: &str, name: &str) -> bool {
    let text = split_words(text);
    let name = split_words(name);
    let after_article = text.iter().position(|word| !matches!(word.as_str(), "a" | "an" | "the" | "some")).unwrap_or(0);
    let rest = &text[after_article..];
    rest.starts_with(&name) && rest.get(name.len()).is_none_or(|next| next == "with")
}

/// The fault of one mention; `None` if the sightings support it, or if it is not checked.
fn mention_fault(mention: &AnswerMention, sightings: &[ObjectSighting]) -> Option<CaptionFault> {
    let name = mention.name.clone();
    let is_known = sightings.iter().any(|sighting| contains_name(&sighting.name, &name));
    let class = find_thing(&name).map(|thing| thing.class);
    if class == Some(ThingClass::Fabric) || (class.is_none() && !is_known) {
        return None;
    }
    let denied = sightings.iter().any(|sighting| denial_covers(sighting, &name, mention.colour.as_deref()));
    let is_witnessed =
        |witness| sightings.iter().any(|sighting| sighting.witness == witness && sighting_names(sighting, &name));
    if mention.witness == WitnessAnswer::Denied || (denied && !seen_by_name(sightings, &name)) {
        Some(CaptionFault::Denied { name })
    } else if is_witnessed(WitnessAnswer::Seen) {
        None
    } else if is_witnessed(WitnessAnswer::Unsure) {
        Some(CaptionFault::Unsure { name })
    } else {
        Some(CaptionFault::Invented { name })
    }
}

/// Whether a thing of exactly this name was seen: a lamp may be denied on the left and seen on the right.
fn seen_by_name(sightings: &[ObjectSighting], name: &str) -> bool {
    sightings.iter().any(|sighting| {
        sighting.witness == WitnessAnswer::Seen && normalise_name(&sighting.name) == normalise_name(name)
    })
}

/// Whether a sighting is of a thing with this name, or of several things of which it is one.
fn sighting_names(sighting: &ObjectSighting, name: &str) -> bool {
    names_agree(&sighting.name, name) || contains_name(&sighting.name, name)
}

/// Whether a name contains another as whole words: "cup and plate" contains "cup".
fn contains_name(name: &str, part: &str) -> bool {
    format!(" {} ", normalise_name(name)).contains(&format!(" {} ", normalise_name(part)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogue::{OPENING_REQUEST, dialogue_sightings};
    use wayword_core::DialogueExchange;

    fn faults(text: &str) -> Vec<String> {
        let transcript = [
            DialogueExchange::new(
                OPENING_REQUEST,
                "The picture shows a bedroom with a bed, a couch, a red chair and a mirror. There might be a piano.",
            ),
            DialogueExchange::new("Is there really a mirror?", "No, there is no mirror."),
            DialogueExchange::new("Is there a lamp?", "No."),
            DialogueExchange::new("Is there a dining chair?", "No."),
        ];
        let told = dialogue_sightings(&transcript, "test");
        let short = |fault: CaptionFault| match fault {
            CaptionFault::Denied { name } => format!("denied {name}"),
            CaptionFault::Unsure { name } => format!("unsure {name}"),
            CaptionFault::Invented { name } => format!("invented {name}"),
        };
        caption_faults(text, &told).into_iter().map(short).collect()
    }

    #[test]
    fn caption_faults_accepts_a_faithful_summary() {
        for text in [
            "A bedroom with a bed, a sofa and a red chair.",
            "The picture shows a bedroom. The bed stands against a white wall on a wooden floor.",
            "A cosy bedroom with a double bed and an armchair.",
            "",
        ] {
            assert_eq!(faults(text), Vec::<String>::new(), "{text}");
        }
    }

    #[test]
    fn caption_faults_reports_denied_unsure_and_invented_things() {
        assert_eq!(faults("A bedroom with a bed and a mirror."), ["denied mirror"]);
        assert_eq!(faults("A bedroom with no lamp."), ["denied lamp"]);
        assert_eq!(faults("A bedroom with a bed and a floor lamp."), ["denied floor lamp"]);
        assert_eq!(faults("A bedroom with dining chairs."), ["denied dining chair"]);
        assert_eq!(faults("A bedroom with a piano."), ["unsure piano"]);
        assert_eq!(faults("A bedroom with a treadmill and a treadmill."), ["invented treadmill"]);
        assert_eq!(faults("A bedroom without stairs."), ["denied stairs"]);
        assert_eq!(faults("A bedroom with stairs."), ["invented stairs"]);
        assert_eq!(faults("There are stairs."), ["invented stairs"]);
        assert_eq!(faults("A staircase with a bed."), Vec::<String>::new());
    }

    #[test]
    fn a_fault_is_a_reason_in_words() {
        let fault = CaptionFault::Denied { name: "mirror".into() };
        assert_eq!(fault.to_string(), "it names \"mirror\", and an answer says that it is not there");
    }
}
