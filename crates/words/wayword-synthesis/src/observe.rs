//! Looks at the views along a path and runs a dialogue about each.

use crate::{
    dialogue::{Asker, Condensed, Dialogue, Mode, Need, RulesSummariser, Summariser},
    walk::FrameSelection,
};
use wayword_core::{
    Answerer, Ask, Caption, Exchange, Frame, Gaze, Look, ModelError, Observation, Path, Platform, PlatformError, Side,
    View, Witness,
};

/// Who asks, sees and summarises, and how.
#[derive(Clone, Copy)]
pub struct Observers<'a> {
    /// Chooses the questions.
    pub asker: &'a dyn Asker,
    /// Answers them.
    pub answerer: &'a dyn Answerer,
    /// Sums the answers up.
    pub summariser: &'a dyn Summariser,
    /// Dialogue, or fixed queries.
    pub mode: Mode,
    /// Hash of the prompts, where a language model takes part.
    pub prompts_hash: Option<&'a str>,
}

/// A path could not be observed.
#[derive(Debug, thiserror::Error)]
pub enum ObserveError {
    /// The platform did not give a view.
    #[error(transparent)]
    Platform(#[from] PlatformError),
    /// A role did not answer.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A panorama's description has fewer words than this (arXiv 2403.11487).
const CONDENSED_WORDS: usize = 20;

/// Captions of a path: one observation per frame.
///
/// At the last frame of a central run, if nothing is seen ahead, the walker looks all around. A robot that has arrived
/// would do so, and the task has to be about something that can be seen from there.
///
/// # Errors
/// When the platform gives no view, or a question is not answered.
pub fn observe(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    observers: Observers<'_>,
) -> Result<Vec<Observation>, ObserveError> {
    let last = path.frames.len().saturating_sub(1);
    let frames = path.frames.iter().enumerate();
    frames
        .map(|(at, frame)| {
            let looks = look_at(platform, path, frame, &gazes(frame, selection), observers)?;
            let empty = !looks
                .iter()
                .flat_map(|look| &look.caption.sightings)
                .any(|sighting| sighting.witness == Witness::Seen);
            // Without poses one cannot look around: the frame has one picture.
            let may_look = path.motion.is_known() && selection == FrameSelection::Central;
            let looks = if at == last && empty && may_look {
                look_at(platform, path, frame, &Gaze::around(frame.pose.heading), observers)?
            } else {
                looks
            };
            let Condensed { text, by } = summary(frame, &looks, observers)?;
            Ok(Observation { summary: text, by, looks })
        })
        .collect()
}

/// Where to look from a frame.
#[must_use]
pub fn gazes(frame: &Frame, selection: FrameSelection) -> Vec<Gaze> {
    match selection {
        FrameSelection::Central => vec![Gaze::quarter(frame.pose.heading)],
        FrameSelection::Panoramic => Gaze::compass().to_vec(),
    }
}

fn look_at(
    platform: &dyn Platform,
    path: &Path,
    frame: &Frame,
    gazes: &[Gaze],
    observers: Observers<'_>,
) -> Result<Vec<Look>, ObserveError> {
    let views = gazes.iter().map(|gaze| Ok((gaze, platform.look(&path.scene, frame, *gaze)?)));
    let views: Vec<(&Gaze, View)> = views.collect::<Result<_, PlatformError>>()?;
    // A camera shows one direction of a place, so blank views are left out. If all are blank they stay, because the
    // error then says what is missing.
    let all_blank = views.iter().all(|(_, view)| view.is_blank());
    let looks = views.into_iter().filter(|(_, view)| all_blank || !view.is_blank()).map(|(gaze, view)| {
        // A camera's picture may show a slightly different direction than the one asked for.
        let shown = Gaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
        let gaze = if view.image.is_some() { shown } else { *gaze };
        Ok(Look { gaze, caption: talk_about(&view, observers)? })
    });
    looks.collect()
}

/// Runs one dialogue about a view to its end.
///
/// # Errors
/// When a role does not answer.
pub fn talk_about(view: &View, observers: Observers<'_>) -> Result<Caption, ModelError> {
    let mut dialogue = Dialogue::new(observers.mode);
    loop {
        match dialogue.need() {
            Need::Question => dialogue.ask(observers.asker.next_question(dialogue.transcript())?),
            Need::Answer(question) => {
                let history: Vec<Exchange> = dialogue.transcript().to_vec();
                let ask = Ask { view, question: &question, history: &history };
                let answer =
                    observers.answerer.answer(&[ask]).pop().unwrap_or_else(|| Err(unanswered(observers.answerer)));
                dialogue.answer(&answer?);
            }
            Need::Summary => return caption(dialogue.transcript(), observers),
        }
    }
}

/// The error for an answerer that leaves a question out. Without it the dialogue would ask the same question for ever.
fn unanswered(answerer: &dyn Answerer) -> ModelError {
    ModelError::Failed { model: answerer.name().to_owned(), reason: "it gave no answer".to_owned() }
}

/// The caption of a dialogue. In the modes without a dialogue no language model summarises: the only answer is the
/// caption, or rules join the answers to the fixed queries.
fn caption(transcript: &[Exchange], observers: Observers<'_>) -> Result<Caption, ModelError> {
    let answerer = observers.answerer.name();
    let rules = || RulesSummariser.sum_up(transcript, answerer);
    match (observers.mode, transcript) {
        (Mode::Dialogue { .. }, _) => observers.summariser.sum_up(transcript, answerer),
        (Mode::Single, [only]) => Ok(Caption { text: only.answer.clone(), by: Some(answerer.to_owned()), ..rules()? }),
        (Mode::Fixed | Mode::Single, _) => rules(),
    }
}

fn summary(frame: &Frame, looks: &[Look], observers: Observers<'_>) -> Result<Condensed, ModelError> {
    if let [only] = looks {
        return Ok(Condensed { text: only.caption.text.clone(), by: None });
    }
    let directed = |look| (direction(frame, look), &look.caption);
    observers.summariser.condense(&looks.iter().map(directed).collect::<Vec<_>>(), CONDENSED_WORDS)
}

/// The direction of a look in words, as seen by the walker.
fn direction(frame: &Frame, look: &Look) -> &'static str {
    match frame.pose.heading.side_of(look.gaze.heading) {
        Side::Ahead => "ahead",
        Side::Right => "on the right",
        Side::Behind => "behind",
        Side::Left => "on the left",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialogue::RulesAsker;
    use wayword_core::{Answer, DVec3, Heading, Pose};

    /// An answerer that gives no answer to a question.
    struct Mute;

    impl Answerer for Mute {
        fn name(&self) -> &str {
            "test/mute"
        }

        fn answer(&self, _: &[Ask<'_>]) -> Vec<Result<Answer, ModelError>> {
            Vec::new()
        }
    }

    #[test]
    fn an_answerer_that_leaves_a_question_out_is_not_asked_for_ever() {
        let view = View::new(Pose::level(DVec3::ZERO, Heading::NORTH), 1.0, None, None);
        let asker = RulesAsker::default();
        let observers = Observers {
            asker: &asker,
            answerer: &Mute,
            summariser: &RulesSummariser,
            mode: Mode::Dialogue { questions: 9 },
            prompts_hash: None,
        };
        assert!(matches!(talk_about(&view, observers), Err(ModelError::Failed { model, .. }) if model == "test/mute"));
    }
}
