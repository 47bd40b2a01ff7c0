//! Renders the pages from templates. No value that a template receives reveals the condition of a text or the goal of a path.

use super::{forms::FormFields, ways::ways_from_place};
use crate::{
    store::{
        AnswerProgress, ArrivalOutcome, MAX_MOVES_PER_WALK, MAX_OWN_TEXT_CHARS, ParticipantStage, ParticipationOutcome,
        StoredSlot, StudyTransaction,
    },
    study::{
        EndQuestionKind, PageTexts, ParticipantStatus, Study, StudyError, StudyRoute, StudyScene, StudyTask, StudyText,
        fill_placeholders,
    },
    token::hash_parts,
    wording::{FOLLOW_STATEMENTS, RATE_QUESTIONS, RatingScale},
};
use minijinja::{Environment, Error, Value, context, value::Kwargs};
use wayword_core::{DoubtGrade, Heading, ViewpointId, doubt::split_at_doubts, hex_text};

/// The templates by their names. They are part of the program.
const TEMPLATES: [(&str, &str); 15] = [
    ("base.html", include_str!("pages/base.html")),
    ("parts.html", include_str!("pages/parts.html")),
    ("consent.html", include_str!("pages/consent.html")),
    ("understood.html", include_str!("pages/understood.html")),
    ("watch.html", include_str!("pages/watch.html")),
    ("rate.html", include_str!("pages/rate.html")),
    ("pair.html", include_str!("pages/pair.html")),
    ("follow.html", include_str!("pages/follow.html")),
    ("follow_after.html", include_str!("pages/follow_after.html")),
    ("practice_result.html", include_str!("pages/practice_result.html")),
    ("attention.html", include_str!("pages/attention.html")),
    ("end.html", include_str!("pages/end.html")),
    ("done.html", include_str!("pages/done.html")),
    ("message.html", include_str!("pages/message.html")),
    ("withdraw.html", include_str!("pages/withdraw.html")),
];

/// The templates of all pages.
pub(super) struct PageTemplates {
    templates: Environment<'static>,
}

/// The name of a template with the values to fill in.
#[derive(Debug)]
pub(super) struct StudyPage {
    name: &'static str,
    values: Value,
}

/// Values that all pages of a participant have.
#[derive(Debug, Clone, Default)]
pub(super) struct PageContext {
    /// A public mark of the person, see [`person_mark`].
    pub(super) who: Option<String>,
    /// The key of a message about a missing or wrong field, in the section `error` of the texts.
    pub(super) error: Option<&'static str>,
    /// The fields as they were filled in, if one of them was missing or wrong.
    pub(super) given: Option<FormFields>,
}

/// A public mark of a person for the pages. It is the same in each session, so an answer that was kept in the browser can still be
/// sent after the participant has come in again.
pub(super) fn person_mark(name: &str) -> String {
    hex_text(&hash_parts(&["mark", name])[..8])
}

/// A short hash of the consent text. A changed text has another version.
pub(super) fn consent_version(study: &Study) -> String {
    hex_text(&hash_parts(&study.consent_words())[..6])
}

impl PageTemplates {
    /// Reads the templates, with the words that all pages share.
    ///
    /// # Errors
    /// When one is not well-formed, which a test rules out.
    pub(super) fn new(texts: &PageTexts, is_preview: bool) -> Result<Self, StudyError> {
        let mut templates = Environment::new();
        templates.add_global("t", Value::from_serialize(texts.sections()));
        templates.add_global("language", texts.language.as_str());
        templates.add_global("direction", texts.direction());
        templates.add_global("is_preview", is_preview);
        templates.add_filter("fill", fill_text);
        for (name, source) in TEMPLATES {
            templates.add_template(name, source).map_err(|error| template_error(&error))?;
        }
        Ok(Self { templates })
    }

    /// The HTML of a page.
    ///
    /// # Errors
    /// When a value is missing, which tests rule out.
    pub(super) fn render_html(&self, page: &StudyPage) -> Result<String, StudyError> {
        let template =
            self.templates.get_template(&format!("{}.html", page.name)).map_err(|error| template_error(&error))?;
        template.render(&page.values).map_err(|error| template_error(&error))
    }
}

fn template_error(error: &minijinja::Error) -> StudyError {
    StudyError::refused_request(
        format!("a page cannot be made: {error:#}"),
        "this is a fault of the program; please report it",
    )
}

impl StudyPage {
    /// A page with the template `name`. `page_values` are for this page alone; those that all pages have are added.
    fn new(
        study: &Study,
        name: &'static str,
        page_context: &PageContext,
        can_withdraw: bool,
        page_values: Value,
    ) -> Self {
        let settings = &study.settings;
        let shared = context! {
            page => name,
            study => context! {
                title => settings.title, contact => settings.contact, retention => settings.retention, minutes => settings.minutes,
            },
            who => page_context.who,
            error => page_context.error.map(|key| study.texts.text("error", key)),
            given => page_context.given,
            // Instructions are in English unless study.toml names another language, whatever the language of the pages.
            text_lang => match settings.text_language.as_str() {
                "" => (study.texts.language != "en").then_some("en"),
                tag => Some(tag),
            },
            can_withdraw,
        };
        Self { name, values: context! { ..page_values, ..shared } }
    }

    /// The page on which people consent.
    pub(super) fn consent_page(study: &Study, page_context: &PageContext) -> Self {
        let own = context! {
            paragraphs => study.settings.about, agreement => study.settings.agreement, version => consent_version(study),
            ethics => study.settings.ethics, links => study.settings.links,
            recorded => study.texts.recorded_words(study.plan.mode),
        };
        Self::new(study, "consent", page_context, false, own)
    }

    /// A page with a message of the texts, by its name, as `missing`.
    pub(super) fn named_message(study: &Study, name: &str, retry: bool) -> Self {
        let text = |part: &str| study.texts.text("message", &format!("{name}_{part}")).to_owned();
        Self::message_page(study, &text("title"), &text("text"), retry)
    }

    /// A page with a message only.
    pub(super) fn message_page(study: &Study, heading: &str, text: &str, retry: bool) -> Self {
        Self::new(study, "message", &PageContext::default(), false, context! { heading, text, retry })
    }

    /// The page that asks a participant who wants to stop what shall happen to the answers.
    pub(super) fn withdraw_page(study: &Study, page_context: &PageContext) -> Self {
        Self::new(study, "withdraw", page_context, false, Value::UNDEFINED)
    }

    /// The last page for visitors who did not consent, and for participants after their answers were deleted.
    pub(super) fn gone_page(study: &Study, has_consented: bool) -> Self {
        let outcome = if has_consented { "withdrawn" } else { "no_consent" };
        let code = if has_consented { "" } else { study.settings.codes.no_consent.as_str() };
        Self::end_page(study, &PageContext::default(), outcome, code, 0, false)
    }

    /// The last page. `code` is for the recruiter, and `kept` is whether the answers are kept.
    fn end_page(
        study: &Study,
        page_context: &PageContext,
        outcome: &str,
        code: &str,
        answers: u32,
        kept: bool,
    ) -> Self {
        let code = Some(code).filter(|code| !code.is_empty());
        let url = Some(&study.settings.codes.return_url).filter(|url| !url.is_empty());
        let encoded =
            |code| percent_encoding::utf8_percent_encode(code, percent_encoding::NON_ALPHANUMERIC).to_string();
        let return_url = code.zip(url).map(|(code, url)| url.replace("{code}", &encoded(code)));
        Self::new(
            study,
            "done",
            page_context,
            page_context.who.is_some(),
            context! { outcome, code, return_url, answers, kept },
        )
    }

    /// The last page for a participation that has ended.
    fn outcome_page(study: &Study, page_context: &PageContext, outcome: ParticipationOutcome) -> Self {
        let codes = &study.settings.codes;
        let (name, code) = match outcome.status {
            ParticipantStatus::ScreenedOut => ("screened_out", &codes.screened_out),
            ParticipantStatus::AttentionFailed => ("attention_failed", &codes.attention_failed),
            ParticipantStatus::Withdrawn => {
                return Self::end_page(study, page_context, "withdrawn", "", outcome.answers, true);
            }
            ParticipantStatus::Started | ParticipantStatus::Complete => ("done", &codes.done),
        };
        Self::end_page(study, page_context, name, code, outcome.answers, true)
    }

    /// The page for the stage that a participant has reached.
    pub(super) fn page_for_stage(
        transaction: &StudyTransaction<'_>,
        person: i64,
        page_context: &PageContext,
    ) -> Result<Self, StudyError> {
        let study = transaction.study();
        let stage = transaction.current_stage(person)?;
        let progress = transaction.answer_progress(person)?;
        let stage_page = |name, values| Self::new(study, name, page_context, true, values);
        Ok(match stage {
            ParticipantStage::Over(outcome) => Self::outcome_page(study, page_context, outcome),
            ParticipantStage::Understood { attempt } => stage_page(
                "understood",
                context! {
                    try => attempt, wrong => attempt > 0, intro => task_steps(study),
                    questions => study.settings.questions.iter()
                        .map(|question| context! { text => question.text, answers => question.answers }).collect::<Vec<_>>(),
                },
            ),
            ParticipantStage::Attention { number, level } => {
                let levels = study.texts.agreement_levels();
                let asked = levels[usize::from(level.clamp(1, 5)) - 1].clone();
                let text = fill_placeholders(study.texts.text("attention", "text"), [("level", asked)]);
                stage_page("attention", context! { number, text, levels, ..progress_context(progress) })
            }
            ParticipantStage::End => stage_page("end", end_context(study)),
            ParticipantStage::Item(held) => match Self::page_for_item(transaction, &held, page_context, progress) {
                Some(page) => page,
                None => Self::named_message(study, "item", false),
            },
        })
    }

    /// The page of an item; `None` if the study lacks the item, its route or its scene.
    fn page_for_item(
        transaction: &StudyTransaction<'_>,
        held: &StoredSlot,
        page_context: &PageContext,
        progress: AnswerProgress,
    ) -> Option<Self> {
        let study = transaction.study();
        let (item, route, scene) = transaction.slot_contents(held)?;
        let film = || {
            let alt: Vec<&str> = route.film.iter().map(|picture| study.texts.film_description(&picture.alt)).collect();
            context! { frames => alt.len(), alt }
        };
        let text = item.texts.first().map(|first| &first.text);
        let (name, own) = match study.plan.mode {
            StudyTask::Rate if study.settings.write_first && held.own_text.is_none() => {
                ("watch", context! { film => film(), examples => study.settings.examples, most => MAX_OWN_TEXT_CHARS })
            }
            StudyTask::Rate => (
                "rate",
                context! {
                    film => film(), examples => study.settings.examples, own_text => held.own_text, text,
                    questions => scale_contexts(&study.texts, &RATE_QUESTIONS),
                },
            ),
            StudyTask::Pair => {
                let other = item.texts.get(1).map(|second| &second.text);
                let (a, b) = if held.is_turned { (other, text) } else { (text, other) };
                ("pair", context! { film => film(), a, b })
            }
            StudyTask::Follow if held.stopped_ms.is_some() => {
                let result = if held.is_practice { practice_result(held, route, scene?) } else { Value::UNDEFINED };
                let statements = scale_contexts(&study.texts, &FOLLOW_STATEMENTS);
                ("follow_after", context! { text, statements, ..result })
            }
            StudyTask::Follow => {
                let marked_text = item.texts.first()?;
                let walker = walker_context(held, route, scene?, &study.texts)?;
                ("follow", context! { ..marked_runs(marked_text, &study.texts), ..walker })
            }
        };
        let own = context! { slot => held.slot, is_practice => held.is_practice, ..own };
        let shown = if held.is_practice {
            own
        } else {
            context! { ..own, ..progress_context(progress) }
        };
        Some(Self::new(study, name, page_context, true, shown))
    }
}

/// The filter `fill` of the templates: fills in the placeholders of a text, as `t.consent.minutes|fill(minutes=20)`.
#[allow(clippy::needless_pass_by_value, reason = "a filter takes its keyword arguments by value")]
fn fill_text(text: &str, values: Kwargs) -> Result<String, Error> {
    let names: Vec<String> = values.args().map(str::to_owned).collect();
    let value = |name: &String| Ok((name.clone(), values.get::<Value>(name)?.to_string()));
    let values: Vec<(String, String)> = names.iter().map(value).collect::<Result<_, Error>>()?;
    Ok(fill_placeholders(text, values.iter().map(|(name, value)| (name.as_str(), value.clone()))))
}

/// Questions with the words of their levels, in the language of the pages.
fn scale_contexts(texts: &PageTexts, scales: &[RatingScale]) -> Vec<Value> {
    let scale = |scale| {
        let (text, levels) = texts.scale_words(scale);
        context! { text, levels }
    };
    scales.iter().map(scale).collect()
}

/// The questions at the end.
fn end_context(study: &Study) -> Value {
    let question = |question: &crate::study::EndQuestion| {
        let kind = match question.kind {
            EndQuestionKind::Text => "text",
            EndQuestionKind::Choice => "choice",
            EndQuestionKind::Scale => "scale",
        };
        let numbers: Vec<String> = (1..=question.answers.len()).map(|number| number.to_string()).collect();
        context! {
            field => format!("end_{}", question.name), text => question.text, kind, numbers, answers => question.answers,
            optional => question.optional, most => question.text_limit(),
        }
    };
    context! { questions => study.settings.end.iter().map(question).collect::<Vec<_>>() }
}

/// Splits a text into runs of words. A marked run has its number, grade and alternatives.
fn marked_runs(study_text: &StudyText, texts: &PageTexts) -> Value {
    let mut number = 0;
    let runs = split_at_doubts(&study_text.text, &study_text.marks, |mark| mark.span).into_iter();
    let run = |(words, mark): (&str, Option<&crate::study::TextMark>)| {
        number += usize::from(mark.is_some());
        let mark = mark.map(|mark| {
            let says = match mark.grade {
                DoubtGrade::Likely => texts.text("walk", "mark_likely"),
                DoubtGrade::Uncertain => texts.text("walk", "mark_uncertain"),
            };
            context! { number, grade => mark.grade.name(), says, alternatives => mark.alternatives }
        });
        context! { words, mark }
    };
    let runs: Vec<Value> = runs.map(run).collect();
    context! { runs, marks => number }
}

/// Under so many metres from the end a walk has arrived, as in the results.
const ARRIVED_M: f64 = 3.0;

/// The values for the result of a walk: how far its end is from the end of the route.
fn practice_result(held: &StoredSlot, route: &StudyRoute, scene: &StudyScene) -> Value {
    let here = held.moves.last().or(route.viewpoints.first());
    let way = here
        .zip(route.viewpoints.last())
        .and_then(|(here, goal)| scene.to_graph().ok()?.shortest_path(here, goal).ok().flatten());
    let off_m = way.map(|way| way.length_m);
    let arrived = off_m.is_some_and(|off_m| off_m < ARRIVED_M);
    // Rounded away from the border, so that the number does not contradict the word.
    let round = |off_m: f64| if arrived { off_m.floor() } else { off_m.ceil() } as u32;
    context! { arrived, arrived_m => ARRIVED_M as u32, off_m => off_m.map(round) }
}

/// The values for a walker's page: the place, the viewing direction and the ways on.
fn walker_context(held: &StoredSlot, route: &StudyRoute, scene: &StudyScene, texts: &PageTexts) -> Option<Value> {
    let (here, facing) = walker_place(held, route, scene)?;
    let place = scene.places.get(here)?;
    let seq = held.moves.len();
    Some(context! {
        seq,
        panorama => format!("/look/{}/{seq}.jpg", held.slot),
        facing_deg => (facing.deg() * 10.0).round() / 10.0,
        ways => if seq < MAX_MOVES_PER_WALK { ways_from_place(scene, place, facing, texts) } else { Vec::new() },
        moves_left => MAX_MOVES_PER_WALK - seq.min(MAX_MOVES_PER_WALK),
    })
}

/// The viewpoint of the walker and the direction of the last step; at the start, the start heading of the path.
fn walker_place<'a>(
    held: &'a StoredSlot,
    route: &'a StudyRoute,
    scene: &StudyScene,
) -> Option<(&'a ViewpointId, Heading)> {
    let start = route.viewpoints.first()?;
    let Some(here) = held.moves.last() else { return Some((start, route.start_heading)) };
    let before = held.moves.len().checked_sub(2).and_then(|at| held.moves.get(at)).unwrap_or(start);
    let (from, to) = (scene.places.get(before)?, scene.places.get(here)?);
    Some((here, Heading::towards(from.eye_position(), to.eye_position()).unwrap_or(route.start_heading)))
}

/// How many items are answered, and whether the page offers a break: halfway, if there are at least 4 items.
fn progress_context(progress: AnswerProgress) -> Value {
    let is_half = progress.expected >= 4 && progress.answered == progress.expected / 2;
    context! { where => context! { done => progress.answered, of => progress.expected }, break_offered => is_half }
}

/// The steps of the task, for the page before the first item.
fn task_steps(study: &Study) -> Vec<&str> {
    let steps: &[&str] = match study.plan.mode {
        StudyTask::Follow if study.plan.conditions.iter().any(|condition| condition.shows_doubts) => {
            &["follow_read", "follow_marks", "follow_look", "follow_stop", "follow_say", "practice"]
        }
        StudyTask::Follow => &["follow_read", "follow_look", "follow_stop", "follow_say", "practice"],
        StudyTask::Rate if study.settings.write_first => &["watch", "write", "read_after_writing", "practice"],
        StudyTask::Rate => &["watch", "rate_read", "rate_answer", "practice"],
        StudyTask::Pair => &["watch", "pair_read", "pair_say", "practice"],
    };
    steps.iter().map(|key| study.texts.text("task", key)).collect()
}

/// The message page for an arrival that may not take part.
pub(super) fn refusal_page(study: &Study, outcome: &ArrivalOutcome) -> StudyPage {
    let (name, retry) = match outcome {
        ArrivalOutcome::Twice => ("twice", false),
        ArrivalOutcome::Gone => ("gone", false),
        ArrivalOutcome::Full => ("places", true),
        ArrivalOutcome::Closed => ("closed", false),
        ArrivalOutcome::Unknown | ArrivalOutcome::New | ArrivalOutcome::Back(_) => ("link", false),
    };
    StudyPage::named_message(study, name, retry)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_templates_are_well_formed() {
        PageTemplates::new(&PageTexts::default(), false).unwrap();
    }
}
