//! A language model that summarises dialogues. Its captions are checked against the sightings of the dialogue.

use super::{PERCEPTION_SEED, send_message};
use crate::{
    dialogue::{CaptionSummariser, CondensedCaption, RulesSummariser, caption_faults},
    prompts::Prompts,
};
use std::sync::Arc;
use wayword_core::{
    Caption, ChatMessage, DialogueExchange, FinishReason, LanguageModel, MAX_TEXT_BYTES, ModelError, ObjectSighting,
    SamplingOptions, WitnessAnswer,
};
use wayword_language::{lexicon::names_agree, text::word_count};
use wayword_replies::{is_refusal, read_sentences, read_text};

/// Lets a language model summarise. If a caption names a denied object or one that no answer named, or if it is a
/// refusal or cut off, the model is asked once more, with the reason. If it fails again, rules summarise, and the
/// caption records that.
#[derive(Clone)]
pub struct ModelSummariser {
    model: Arc<dyn LanguageModel>,
    prompts: Arc<Prompts>,
}

/// As in ChatCaptioner, with room for two or three whole sentences.
const SUMMARY_SAMPLING: SamplingOptions = SamplingOptions { temperature: 0.0, max_tokens: 160, seed: PERCEPTION_SEED };
/// How often a caption is asked for before rules write it.
const MAX_CAPTION_ATTEMPTS: usize = 2;

impl ModelSummariser {
    /// A summariser behind a model.
    #[must_use]
    pub fn new(model: Arc<dyn LanguageModel>, prompts: Arc<Prompts>) -> Self {
        Self { model, prompts }
    }

    /// Asks until `faults` finds none. `Err(reasons)` where every attempt had some.
    fn ask_until_faultless(
        &self,
        prompt: impl Fn(&[String]) -> Result<String, ModelError>,
        faults: impl Fn(&str) -> Vec<String>,
    ) -> Result<Result<String, Vec<String>>, ModelError> {
        let mut complaints = Vec::new();
        for attempt in 1..=MAX_CAPTION_ATTEMPTS {
            let reply =
                send_message(self.model.as_ref(), ChatMessage::from_user(prompt(&complaints)?), SUMMARY_SAMPLING)?;
            let (text, fault) = match read_text(&read_sentences(&reply), &["caption", "summary"]) {
                Ok(text) => (text, None),
                Err(fault) => (reply.text.clone(), Some(fault)),
            };
            let new_complaints = match text.len() {
                0 => vec!["it was empty".to_owned()],
                bytes if bytes > MAX_TEXT_BYTES => {
                    vec![format!("it has {bytes} bytes, more than {MAX_TEXT_BYTES}")]
                }
                _ if fault.is_some() => fault.into_iter().collect(),
                _ if is_refusal(&text) => vec!["it refused to describe the picture".to_owned()],
                // The whole sentences of the last attempt are better than a summary by rules.
                _ if reply.finish == FinishReason::Length && attempt < MAX_CAPTION_ATTEMPTS => {
                    vec!["it was cut off: write a shorter one".to_owned()]
                }
                _ => faults(&text),
            };
            if new_complaints.is_empty() {
                return Ok(Ok(text));
            }
            complaints = new_complaints;
        }
        Ok(Err(complaints))
    }
}

impl CaptionSummariser for ModelSummariser {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn sum_up(&self, transcript: &[DialogueExchange], answerer: &str) -> Result<Caption, ModelError> {
        let by_rules = RulesSummariser.sum_up(transcript, answerer)?;
        let prompt =
            |complaints: &[String]| Ok(self.prompts.summary_prompt(transcript, &by_rules.sightings, complaints)?);
        let faults = |text: &str| fault_reasons(text, &by_rules.sightings);
        Ok(match self.ask_until_faultless(prompt, faults)? {
            Ok(text) => Caption { text, ..by_rules },
            Err(reasons) => Caption { by: Some(rules_instead(&reasons)), ..by_rules },
        })
    }

    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<CondensedCaption, ModelError> {
        let texts: Vec<(&str, &str)> =
            captions.iter().map(|(direction, caption)| (*direction, caption.text.as_str())).collect();
        let prompt = |complaints: &[String]| Ok(self.prompts.condense_prompt(&texts, fewer_words_than, complaints)?);
        let sightings = joint_sightings(captions);
        let faults = |text: &str| {
            let mut faults = fault_reasons(text, &sightings);
            let words = word_count(text);
            if words >= fewer_words_than {
                faults.push(format!("it has {words} words where fewer than {fewer_words_than} were asked for"));
            }
            faults
        };
        match self.ask_until_faultless(prompt, faults)? {
            Ok(text) => Ok(CondensedCaption { text, by: None }),
            Err(reasons) => {
                let by_rules = RulesSummariser.condense(captions, fewer_words_than)?;
                Ok(CondensedCaption { by: Some(rules_instead(&reasons)), ..by_rules })
            }
        }
    }
}

/// The note that rules summarised instead of a model, with the reasons.
fn rules_instead(reasons: &[String]) -> String {
    format!("rules, because {}", reasons.join("; "))
}

/// The faults of a caption in words for the model.
fn fault_reasons(text: &str, sightings: &[ObjectSighting]) -> Vec<String> {
    caption_faults(text, sightings).iter().map(ToString::to_string).collect()
}

/// The sightings of all directions. A thing that one view lacks may be in the next, so a denial counts only if no view
/// shows the thing.
fn joint_sightings(captions: &[(&str, &Caption)]) -> Vec<ObjectSighting> {
    let all: Vec<&ObjectSighting> = captions.iter().flat_map(|(_, caption)| &caption.sightings).collect();
    let seen =
        |name: &str| all.iter().any(|other| other.witness == WitnessAnswer::Seen && names_agree(&other.name, name));
    all.iter()
        .filter(|sighting| sighting.witness == WitnessAnswer::Seen || !seen(&sighting.name))
        .map(|sighting| (*sighting).clone())
        .collect()
}
