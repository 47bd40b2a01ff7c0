//! A language model that summarises dialogues. Its captions are checked against the sightings of the dialogue.

use super::{
    PERCEPTION_SEED,
    chatter::refuses,
    clean::{plain, whole_sentences},
    say,
};
use crate::{
    dialogue::{Condensed, RulesSummariser, Summariser, caption_faults},
    prompts::Prompts,
};
use std::sync::Arc;
use wayword_core::{
    Caption, Exchange, Finish, LONGEST_TEXT_BYTES, LanguageModel, Message, ModelError, Sampling, Sighting, Witness,
};
use wayword_language::{lexicon::agree, text::word_count};

/// Lets a language model summarise. If a caption names a denied object or one that no answer named, or if it is a
/// refusal or cut off, the model is asked once more, with the reason. If it fails again, rules summarise, and the
/// caption records that.
#[derive(Clone)]
pub struct ModelSummariser {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// As in ChatCaptioner, with room for two or three whole sentences.
const SAMPLING: Sampling = Sampling { temperature: 0.0, max_tokens: 160, seed: PERCEPTION_SEED };
/// How often a caption is asked for.
const ATTEMPTS: usize = 2;

impl ModelSummariser {
    /// A summariser behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }

    /// Asks until `faults` finds none. `Err(reasons)` where every attempt had some.
    fn attempt(
        &self,
        prompt: impl Fn(&[String]) -> Result<String, ModelError>,
        faults: impl Fn(&str) -> Vec<String>,
    ) -> Result<Result<String, Vec<String>>, ModelError> {
        let mut complaints = Vec::new();
        for attempt in 1..=ATTEMPTS {
            let reply = say(self.model.as_ref(), Message::user(prompt(&complaints)?), SAMPLING)?;
            let text = plain(whole_sentences(&reply), &["caption", "summary"]);
            let found = match text.len() {
                0 => vec!["it was empty".to_owned()],
                bytes if bytes > LONGEST_TEXT_BYTES => {
                    vec![format!("it has {bytes} bytes, more than {LONGEST_TEXT_BYTES}")]
                }
                _ if refuses(&text) => vec!["it refused to describe the picture".to_owned()],
                // The whole sentences of the last attempt are better than a summary by rules.
                _ if reply.finish == Finish::Length && attempt < ATTEMPTS => {
                    vec!["it was cut off: write a shorter one".to_owned()]
                }
                _ => faults(&text),
            };
            if found.is_empty() {
                return Ok(Ok(text));
            }
            complaints = found;
        }
        Ok(Err(complaints))
    }
}

impl Summariser for ModelSummariser {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn sum_up(&self, transcript: &[Exchange], answerer: &str) -> Result<Caption, ModelError> {
        let by_rules = RulesSummariser.sum_up(transcript, answerer)?;
        let prompt = |complaints: &[String]| Ok(self.prompts.summary(transcript, &by_rules.sightings, complaints)?);
        let faults = |text: &str| faults(text, &by_rules.sightings);
        Ok(match self.attempt(prompt, faults)? {
            Ok(text) => Caption { text, ..by_rules },
            Err(reasons) => Caption { by: Some(instead(&reasons)), ..by_rules },
        })
    }

    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<Condensed, ModelError> {
        let texts: Vec<(&str, &str)> =
            captions.iter().map(|(direction, caption)| (*direction, caption.text.as_str())).collect();
        let prompt = |complaints: &[String]| Ok(self.prompts.condense(&texts, fewer_words_than, complaints)?);
        let told = together(captions);
        let faults = |text: &str| {
            let mut faults = faults(text, &told);
            let words = word_count(text);
            if words >= fewer_words_than {
                faults.push(format!("it has {words} words where fewer than {fewer_words_than} were asked for"));
            }
            faults
        };
        match self.attempt(prompt, faults)? {
            Ok(text) => Ok(Condensed { text, by: None }),
            Err(reasons) => {
                let by_rules = RulesSummariser.condense(captions, fewer_words_than)?;
                Ok(Condensed { by: Some(instead(&reasons)), ..by_rules })
            }
        }
    }
}

/// The note that rules summarised instead of a model, with the reasons.
fn instead(reasons: &[String]) -> String {
    format!("rules, because {}", reasons.join("; "))
}

fn faults(text: &str, told: &[Sighting]) -> Vec<String> {
    caption_faults(text, told).iter().map(ToString::to_string).collect()
}

/// The sightings of all directions. A thing that one view lacks may be in the next, so a denial counts only if no view
/// shows the thing.
fn together(captions: &[(&str, &Caption)]) -> Vec<Sighting> {
    let all: Vec<&Sighting> = captions.iter().flat_map(|(_, caption)| &caption.sightings).collect();
    let seen = |name: &str| all.iter().any(|other| other.witness == Witness::Seen && agree(&other.name, name));
    all.iter()
        .filter(|sighting| sighting.witness == Witness::Seen || !seen(&sighting.name))
        .map(|sighting| (*sighting).clone())
        .collect()
}
