//! The settings of a study in `study.toml`, which the researcher may edit: wording, limits, questions and recruiter.

use super::{ConsentLink, EndQuestion, ExclusionRules, PageTexts, StudyTask, consent_page::check_consent_page};
use serde::{Deserialize, Serialize};

/// The contents of `study.toml`. A change takes effect at the next start of the site.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudySettings {
    /// The title of the study on its pages.
    pub title: String,
    /// Whom participants can ask: name, institution, address. Without it, the site can be reached from this machine only.
    pub contact: String,
    /// Until when the answers are kept, in words that participants read.
    pub retention: String,
    /// How long one participant needs, minutes.
    pub minutes: u32,
    /// What participants read before they consent, one paragraph each.
    pub about: Vec<String>,
    /// The statement to which participants agree.
    pub agreement: String,
    /// Example texts of the style, for those who rate.
    #[serde(default)]
    pub examples: Vec<String>,
    /// Whether those who rate write an instruction of their own before they see the one they rate.
    #[serde(default)]
    pub write_first: bool,
    /// How many attention checks a participant gets, 0 to 4.
    pub attention_checks: u32,
    /// The fewest items that must be left to admit a new participant. Near the end of a study, fewer may be left than
    /// `per_participant`.
    #[serde(default)]
    pub least_items: u32,
    /// The language of the texts, as `en` or `hi-IN`; empty if they are in English, the language of the pages.
    #[serde(default)]
    pub text_language: String,
    /// The lease of an item: after so many seconds without a sign of life it may go to another participant.
    pub lease_s: u64,
    /// The approval of an ethics committee, as participants read it: committee, number, date.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub ethics: String,
    /// Links on the consent page.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<ConsentLink>,
    /// Questions that test whether a participant has understood the task.
    #[serde(default)]
    pub questions: Vec<ComprehensionQuestion>,
    /// Questions that participants answer after their last item.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub end: Vec<EndQuestion>,
    /// Rules by which the results leave out single answers.
    #[serde(default, skip_serializing_if = "ExclusionRules::is_empty")]
    pub exclusions: ExclusionRules,
    /// Where participants come from.
    pub recruiter: RecruiterSettings,
    /// Codes that participants take back to the recruiter.
    #[serde(default)]
    pub codes: CompletionCodes,
}

/// A question with one right answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ComprehensionQuestion {
    /// The question.
    pub text: String,
    /// The answers to choose from.
    pub answers: Vec<String>,
    /// Index of the right answer.
    pub right: usize,
}

/// How participants come to the site.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", tag = "kind")]
pub enum RecruiterSettings {
    /// Each has a personal link.
    Links,
    /// The recruiter adds parameters to one link: Prolific, MTurk and their like.
    Parameters {
        /// The parameter with the participant's id, as `PROLIFIC_PID` or `workerId`.
        person: String,
        /// The parameter with the session's id, as `SESSION_ID` or `assignmentId`.
        session: String,
        /// The parameter with the study's id, as `STUDY_ID` or `hitId`; empty where there is none.
        #[serde(default)]
        study: String,
        /// The id of a study at the recruiter: only its links are let in. Empty lets in those of any study.
        #[serde(default)]
        only_study: String,
    },
}

/// Codes that inform the recruiter about the outcome, and the address to which they are sent.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct CompletionCodes {
    /// The address to which participants return, with `{code}` in the place of the code; empty shows only the code.
    pub return_url: String,
    /// All items were answered.
    pub done: String,
    /// The task was not understood.
    pub screened_out: String,
    /// All items were answered, and more attention checks failed than Prolific tolerates.
    pub attention_failed: String,
    /// No consent was given.
    pub no_consent: String,
}

/// Prolific's rule, minutes: in a study of this length or longer, a participant may fail one attention check; in a shorter one, none.
const LONG_STUDY_MINUTES: u32 = 5;
/// How long a participant needs for everything besides the items, minutes.
const BASE_MINUTES: u32 = 4;
/// Most answers that a comprehension question may offer. [`StudySettings::check`] refuses more.
const MAX_ANSWERS_PER_QUESTION: usize = 10;

impl StudySettings {
    /// How many failed attention checks are tolerated by Prolific's rule.
    pub(crate) fn tolerated_failed_checks(&self) -> usize {
        usize::from(self.minutes >= LONG_STUDY_MINUTES)
    }

    /// All texts that participants read before they consent.
    pub(crate) fn consent_words(&self) -> Vec<&str> {
        let mut words: Vec<&str> = self.about.iter().map(String::as_str).collect();
        words.extend([self.agreement.as_str(), &self.title, &self.contact, &self.retention]);
        // Left out where they are empty, so that the hash of an older study stays the same.
        words.extend(Some(self.ethics.as_str()).filter(|ethics| !ethics.is_empty()));
        words.extend(self.links.iter().flat_map(|link| [link.text.as_str(), &link.url]));
        words
    }

    /// The settings that a new study begins with, in English.
    #[must_use]
    pub fn for_mode(mode: StudyTask, per_participant: u32) -> Self {
        Self::in_language(mode, per_participant, &PageTexts::default())
    }

    /// The settings that a new study begins with, in the language of its pages.
    #[must_use]
    pub fn in_language(mode: StudyTask, per_participant: u32, texts: &PageTexts) -> Self {
        let minutes_each = match mode {
            StudyTask::Follow | StudyTask::Rate => 2,
            StudyTask::Pair => 1,
        };
        let word = |key: &str| texts.text("new_study", key).to_owned();
        Self {
            title: word("title"),
            contact: String::new(),
            retention: word("retention"),
            minutes: BASE_MINUTES + minutes_each * per_participant,
            about: ["about", mode.name(), "privacy"].map(word).to_vec(),
            agreement: word("agreement"),
            examples: Vec::new(),
            write_first: mode == StudyTask::Rate,
            attention_checks: if per_participant > 2 { 2 } else { 0 },
            least_items: 1,
            text_language: String::new(),
            lease_s: 20 * 60,
            ethics: String::new(),
            links: Vec::new(),
            end: Vec::new(),
            exclusions: ExclusionRules::default(),
            questions: ComprehensionQuestion::for_mode(mode, texts),
            recruiter: RecruiterSettings::Links,
            codes: CompletionCodes::default(),
        }
    }

    /// Checks the settings.
    ///
    /// # Errors
    /// The first problem, as a sentence about a field.
    pub fn check(&self) -> Result<(), String> {
        for question in &self.questions {
            if question.right >= question.answers.len() || question.answers.len() > MAX_ANSWERS_PER_QUESTION {
                return Err(format!(
                    "questions: the right answer of {:?} is not among its answers (they count from 0), or there are more than {MAX_ANSWERS_PER_QUESTION}",
                    question.text
                ));
            }
        }
        if self.attention_checks > 4 {
            return Err("attention_checks: at most 4".to_owned());
        }
        if self.attention_checks == 1 && self.minutes >= LONG_STUDY_MINUTES {
            let rule = "in a study of 5 minutes or more one failed check says nothing (Prolific's rule)";
            return Err(format!("attention_checks: {rule}; give 2 or more, or 0"));
        }
        let is_tag = |letter: char| letter.is_ascii_alphanumeric() || letter == '-';
        if !self.text_language.chars().all(is_tag) {
            return Err("text_language: give a tag like en or hi-IN".to_owned());
        }
        if self.lease_s == 0 || self.lease_s > 7 * 24 * 3600 {
            return Err("lease_s: give 1 to 604800 seconds".to_owned());
        }
        if self.about.is_empty() || self.agreement.is_empty() {
            return Err("about and agreement: participants must read what they consent to".to_owned());
        }
        let others = [
            ("agreement", self.agreement.as_str()),
            ("title", &self.title),
            ("contact", &self.contact),
            ("retention", &self.retention),
            ("ethics", &self.ethics),
        ];
        check_consent_page(&self.about, &others, &self.links)?;
        EndQuestion::check_all(&self.end)?;
        self.exclusions.check()?;
        let url = &self.codes.return_url;
        let is_usable = url.starts_with("https://") && url.contains("{code}");
        if !url.is_empty() && !is_usable {
            return Err("codes.return_url: begin it with https:// and put {code} where the code goes".to_owned());
        }
        if let RecruiterSettings::Parameters { person, session, .. } = &self.recruiter
            && (person.is_empty() || session.is_empty())
        {
            return Err("recruiter: name the parameters `person` and `session`".to_owned());
        }
        Ok(())
    }
}

impl ComprehensionQuestion {
    /// The questions with which a new study of this task begins.
    fn for_mode(mode: StudyTask, texts: &PageTexts) -> Vec<Self> {
        let question = |name: &str, answers: [&str; 3]| {
            let word = |key: &str| texts.text("new_questions", &format!("{name}{key}")).to_owned();
            let right = answers.iter().position(|answer| *answer == "_right").unwrap_or_default();
            Self { text: word(""), answers: answers.map(word).to_vec(), right }
        };
        let right_last = ["_wrong_1", "_wrong_2", "_right"];
        let right_first = ["_right", "_wrong_1", "_wrong_2"];
        let right_between = ["_wrong_1", "_right", "_wrong_2"];
        match mode {
            StudyTask::Follow => vec![question("follow_way", right_between), question("follow_stop", right_first)],
            StudyTask::Rate => vec![question("rate_first", right_last), question("rate_about", right_first)],
            StudyTask::Pair => vec![question("pair_what", right_between), question("pair_equal", right_first)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn check_accepts_the_settings_of_a_new_study() {
        for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
            for items in [1, 2, 3, 10] {
                StudySettings::for_mode(mode, items).check().unwrap();
            }
        }
    }

    #[test]
    fn what_docs_say_of_study_toml_is_read_and_written_back() {
        let added = r#"
            ethics = "Board 7"
            [[links]]
            text = "More"
            url = "mailto:a@example.org"
            [[end]]
            name = "experience"
            text = "How often?"
            kind = "scale"
            answers = ["never", "often"]
            [[end]]
            name = "remarks"
            text = "What else?"
            kind = "text"
            optional = true
            max_chars = 500
            [exclusions]
            min_seconds_per_item = 3
            min_share_of_film = 0.8
            min_moves_per_walk = 1
        "#;
        let plain = StudySettings::for_mode(StudyTask::Pair, 3);
        let written = toml::to_string_pretty(&plain).unwrap();
        assert!(
            ["end", "links", "exclusions", "ethics"].iter().all(|key| !written.contains(&format!("{key}]"))),
            "{written}"
        );
        let (keys, tables) = written.split_at(written.find("[[questions]]").unwrap());
        let read: StudySettings = toml::from_str(&format!("{keys}{added}{tables}")).unwrap();
        read.check().unwrap();
        assert_eq!((read.end.len(), read.exclusions.min_share_of_film, read.links.len()), (2, 0.8, 1));
        let again: StudySettings = toml::from_str(&toml::to_string_pretty(&read).unwrap()).unwrap();
        assert_eq!(again, read);
        assert_ne!(read.consent_words(), plain.consent_words(), "consent is to the links and the approval too");
    }

    #[test]
    fn the_recruiters_address_is_https() {
        let with = |url: &str| {
            let codes = CompletionCodes { return_url: url.to_owned(), ..CompletionCodes::default() };
            StudySettings { codes, ..StudySettings::for_mode(StudyTask::Pair, 3) }.check()
        };
        with("https://app.prolific.com/submissions/complete?cc={code}").unwrap();
        for wrong in ["http://a.example/{code}", "javascript:alert('{code}')", "https://a.example/"] {
            assert!(with(wrong).unwrap_err().contains("return_url"), "{wrong}");
        }
    }

    #[test]
    fn check_refuses_a_single_attention_check_that_could_never_count() {
        let settings = StudySettings { attention_checks: 1, minutes: 5, ..StudySettings::for_mode(StudyTask::Pair, 3) };
        assert!(settings.check().unwrap_err().contains("attention_checks"));
    }
}
