//! Looks around along a path and has each view talked about.

use crate::{
    dialogue::{Asker, Condensed, Dialogue, Mode, Need, RulesSummariser, Summariser},
    walk::FrameSelection,
};
use wayword_core::{
    Answerer, Ask, Caption, Exchange, Frame, Gaze, Look, ModelError, Observation, Path, Platform, PlatformError, Side,
    View, Witness,
};

/// Who asks, sees and sums up, and how.
#[derive(Clone, Copy)]
pub struct Minds<'a> {
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
    /// The world did not give a view.
    #[error(transparent)]
    Platform(#[from] PlatformError),
    /// A mind did not answer.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// A panorama's description has fewer words than this (arXiv 2403.11487).
const CONDENSED_WORDS: usize = 20;

/// Captions of a path: one observation per frame.
///
/// From the last frame of a central run, if nothing is seen ahead, the walker looks all around: a robot that has arrived
/// would, and the task has to be about something that can be seen from there.
///
/// # Errors
/// When a view cannot be had or a question is not answered.
pub fn observe(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    minds: Minds<'_>,
) -> Result<Vec<Observation>, ObserveError> {
    let last = path.frames.len().saturating_sub(1);
    let frames = path.frames.iter().enumerate();
    frames
        .map(|(at, frame)| {
            let looks = look_at(platform, path, frame, &gazes(frame, selection), minds)?;
            let empty = !looks
                .iter()
                .flat_map(|look| &look.caption.sightings)
                .any(|sighting| sighting.witness == Witness::Seen);
            // Without poses there is no around: the picture is all that there is.
            let may_look = path.motion.is_known() && selection == FrameSelection::Central;
            let looks = if at == last && empty && may_look {
                look_at(platform, path, frame, &Gaze::around(frame.pose.heading), minds)?
            } else {
                looks
            };
            let Condensed { text, by } = summary(frame, &looks, minds)?;
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
    minds: Minds<'_>,
) -> Result<Vec<Look>, ObserveError> {
    let views = gazes.iter().map(|gaze| Ok((gaze, platform.look(&path.scene, frame, *gaze)?)));
    let views: Vec<(&Gaze, View)> = views.collect::<Result<_, PlatformError>>()?;
    // A camera shows one direction of a place; the others are left out, unless there is nothing else to fail on.
    let all_blank = views.iter().all(|(_, view)| view.is_blank());
    let looks = views.into_iter().filter(|(_, view)| all_blank || !view.is_blank()).map(|(gaze, view)| {
        // A camera's picture shows what the camera looked at, which need not be quite what was asked for.
        let shown = Gaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
        let gaze = if view.image.is_some() { shown } else { *gaze };
        Ok(Look { gaze, caption: talk_about(&view, minds)? })
    });
    looks.collect()
}

/// Runs one dialogue about a view to its end.
///
/// # Errors
/// When a mind does not answer.
pub fn talk_about(view: &View, minds: Minds<'_>) -> Result<Caption, ModelError> {
    let mut dialogue = Dialogue::new(minds.mode);
    loop {
        match dialogue.need() {
            Need::Question => dialogue.ask(minds.asker.next_question(dialogue.transcript())?),
            Need::Answer(question) => {
                let history: Vec<Exchange> = dialogue.transcript().to_vec();
                let ask = Ask { view, question: &question, history: &history };
                let answer = minds.answerer.answer(&[ask]).pop().unwrap_or_else(|| Err(unanswered(minds.answerer)));
                dialogue.answer(&answer?);
            }
            Need::Summary => return caption(dialogue.transcript(), minds),
        }
    }
}

/// An answerer that leaves a question out would otherwise be asked it for ever.
fn unanswered(answerer: &dyn Answerer) -> ModelError {
    ModelError::Failed { model: answerer.name().to_owned(), reason: "it left a question out".to_owned() }
}

/// What a dialogue comes to. Without a dialogue no language model takes part: the only answer is the caption, or rules join
/// the answers to the fixed queries.
fn caption(transcript: &[Exchange], minds: Minds<'_>) -> Result<Caption, ModelError> {
    let answerer = minds.answerer.name();
    let rules = || RulesSummariser.sum_up(transcript, answerer);
    match (minds.mode, transcript) {
        (Mode::Dialogue { .. }, _) => minds.summariser.sum_up(transcript, answerer),
        (Mode::Single, [only]) => Ok(Caption { text: only.answer.clone(), by: Some(answerer.to_owned()), ..rules()? }),
        (Mode::Fixed | Mode::Single, _) => rules(),
    }
}

fn summary(frame: &Frame, looks: &[Look], minds: Minds<'_>) -> Result<Condensed, ModelError> {
    if let [only] = looks {
        return Ok(Condensed { text: only.caption.text.clone(), by: None });
    }
    let directed = |look| (direction(frame, look), &look.caption);
    minds.summariser.condense(&looks.iter().map(directed).collect::<Vec<_>>(), CONDENSED_WORDS)
}

/// The direction of a look in words, for somebody who walks.
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

    /// An answerer that breaks its word: no answer for a question.
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
        let minds = Minds {
            asker: &asker,
            answerer: &Mute,
            summariser: &RulesSummariser,
            mode: Mode::Dialogue { questions: 9 },
            prompts_hash: None,
        };
        assert!(matches!(talk_about(&view, minds), Err(ModelError::Failed { model, .. }) if model == "test/mute"));
    }
}
