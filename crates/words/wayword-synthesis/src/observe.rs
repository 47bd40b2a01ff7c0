//! Looks at the views along a path and runs a dialogue about each, so that every frame gets a caption.

use crate::{
    dialogue::{Asker, Condensed, Dialogue, Mode, Need, RulesSummariser, Summariser},
    seeing::see,
    walk::FrameSelection,
};
use wayword_core::{
    AnswerForm, Answerer, Ask, Caption, Exchange, Frame, Gaze, Look, ModelError, Motion, Observation, Path, Platform,
    PlatformError, Side, View, Witness,
};

/// The roles that make captions of views: asker, answerer and summariser, and the mode in which they work.
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
    /// Hash of the prompts, where a language model plays a role.
    pub prompts_hash: Option<&'a str>,
    /// The name of the detector that corrected the captions, with its score threshold, if there is one.
    pub detector: Option<&'a str>,
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
pub(crate) const CONDENSED_WORDS: usize = 20;

/// A view that still needs its caption.
#[derive(Debug, Clone)]
pub struct Planned {
    /// Number of its frame on the path.
    pub frame: usize,
    /// The direction and width that the view shows.
    pub gaze: Gaze,
    /// The view itself.
    pub view: View,
}

/// Makes captions for views that do not depend on each other: one caption each, in their order.
pub type Talk<'a> = dyn Fn(&[Planned]) -> Result<Vec<Caption>, ModelError> + 'a;

/// Captions of a path: one observation per frame.
///
/// At the last frame of a central run, if the view ahead shows no object, the walker looks all around. A robot that has
/// arrived would do so, and the task has to be about something that can be seen from there.
///
/// # Errors
/// When the platform gives no view, or a question is not answered.
pub fn observe(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    observers: Observers<'_>,
) -> Result<Vec<Observation>, ObserveError> {
    observe_with(platform, path, selection, observers, &|views| {
        views.iter().map(|planned| talk_about(&planned.view, observers)).collect()
    })
}

/// Like [`observe`], with a function that makes the captions of several views at once, for example in parallel.
///
/// # Errors
/// When the platform gives no view, or a question is not answered.
pub fn observe_with(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    observers: Observers<'_>,
    talk: &Talk<'_>,
) -> Result<Vec<Observation>, ObserveError> {
    let mut looks: Vec<Vec<Look>> = vec![Vec::new(); path.frames.len()];
    let planned = plan(platform, path, selection)?;
    assign(talk(&planned)?, planned, &mut looks);
    if let Some(planned) = plan_at_end(platform, path, selection, &looks)? {
        looks.last_mut().into_iter().for_each(Vec::clear);
        assign(talk(&planned)?, planned, &mut looks);
    }
    let frames = path.frames.iter().zip(looks);
    Ok(frames.map(|(frame, looks)| observation(frame, looks, observers)).collect::<Result<_, _>>()?)
}

/// The views of a path that need a caption, frame by frame.
///
/// # Errors
/// When the platform gives no view.
pub fn plan(platform: &dyn Platform, path: &Path, selection: FrameSelection) -> Result<Vec<Planned>, PlatformError> {
    let mut planned = Vec::new();
    for (at, frame) in path.frames.iter().enumerate() {
        planned.extend(views(platform, path, at, &gazes(frame, selection))?);
    }
    Ok(planned)
}

/// The views all around the end of a central path, where the view ahead shows no object.
fn plan_at_end(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    looks: &[Vec<Look>],
) -> Result<Option<Vec<Planned>>, PlatformError> {
    let (Some(frame), Some(at_end)) = (path.frames.last(), looks.last()) else { return Ok(None) };
    let mut sightings = at_end.iter().flat_map(|look| &look.caption.sightings);
    let is_empty = !sightings.any(|sighting| sighting.witness == Witness::Seen);
    // Without poses the walker cannot look around: the frame has one picture.
    if !is_empty || !path.motion.is_known() || selection != FrameSelection::Central {
        return Ok(None);
    }
    views(platform, path, looks.len() - 1, &Gaze::around(frame.pose.heading)).map(Some)
}

/// Makes the observation of a frame from its looks, with a summary of their captions.
///
/// # Errors
/// When the summariser fails.
pub fn observation(frame: &Frame, looks: Vec<Look>, observers: Observers<'_>) -> Result<Observation, ModelError> {
    let Condensed { text, by } = summary(frame, &looks, observers)?;
    Ok(Observation { summary: text, by, looks })
}

fn assign(captions: Vec<Caption>, planned: Vec<Planned>, looks: &mut [Vec<Look>]) {
    for (Planned { frame, gaze, .. }, caption) in planned.into_iter().zip(captions) {
        looks[frame].push(Look { gaze, caption });
    }
}

/// The directions in which a frame is looked at.
#[must_use]
pub fn gazes(frame: &Frame, selection: FrameSelection) -> Vec<Gaze> {
    match selection {
        FrameSelection::Central => vec![Gaze::quarter(frame.pose.heading)],
        FrameSelection::Panoramic => Gaze::compass().to_vec(),
    }
}

/// The directions all around a frame: ahead, right, behind, left. Only ahead if the motion is unknown, because the
/// other directions are then unknown too.
#[must_use]
pub fn gazes_around(path: &Path, frame: &Frame) -> Vec<Gaze> {
    match path.motion {
        Motion::Known => Gaze::around(frame.pose.heading).to_vec(),
        Motion::Unknown => vec![Gaze::quarter(frame.pose.heading)],
    }
}

fn views(platform: &dyn Platform, path: &Path, at: usize, gazes: &[Gaze]) -> Result<Vec<Planned>, PlatformError> {
    let views = gazes.iter().map(|gaze| Ok((gaze, platform.look(&path.scene, &path.frames[at], *gaze)?)));
    let views: Vec<(&Gaze, View)> = views.collect::<Result<_, PlatformError>>()?;
    // A camera shows only one direction, so blank views are left out. If all views are blank they stay: the error then
    // explains what the platform lacks.
    let all_blank = views.iter().all(|(_, view)| view.is_blank());
    let planned = views.into_iter().filter(|(_, view)| all_blank || !view.is_blank()).map(|(gaze, view)| {
        // A camera's picture may show a slightly different direction than the one asked for.
        let shown = Gaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
        let gaze = if view.image.is_some() { shown } else { *gaze };
        Planned { frame: at, gaze, view }
    });
    Ok(planned.collect())
}

/// Runs the dialogue about one view to its end and returns the caption.
///
/// # Errors
/// When a role does not answer.
pub fn talk_about(view: &View, observers: Observers<'_>) -> Result<Caption, ModelError> {
    if let Mode::Structured { questions } = observers.mode {
        return see(view, observers, questions);
    }
    let mut dialogue = Dialogue::new(observers.mode);
    loop {
        match dialogue.need() {
            Need::Question => dialogue.ask(observers.asker.next_question(dialogue.transcript())?),
            Need::Answer(question) => {
                let history: Vec<Exchange> = dialogue.transcript().to_vec();
                let ask = Ask { view, question: &question, history: &history, answer: AnswerForm::Words };
                let answer =
                    observers.answerer.answer(&[ask]).pop().unwrap_or_else(|| Err(unanswered(observers.answerer)));
                dialogue.answer(&answer?);
            }
            Need::Summary => return caption(dialogue.transcript(), observers),
        }
    }
}

/// The error for an answerer that returns no answer to a question. Without it the dialogue would repeat the question
/// forever.
pub(crate) fn unanswered(answerer: &dyn Answerer) -> ModelError {
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
        (Mode::Fixed | Mode::Single | Mode::Structured { .. }, _) => rules(),
    }
}

fn summary(frame: &Frame, looks: &[Look], observers: Observers<'_>) -> Result<Condensed, ModelError> {
    if let [only] = looks {
        return Ok(Condensed { text: only.caption.text.clone(), by: None });
    }
    let directed = |look| (direction(frame, look), &look.caption);
    // A structured answer costs one call, and its caption none.
    let rules = matches!(observers.mode, Mode::Structured { .. });
    let summariser: &dyn Summariser = if rules { &RulesSummariser } else { observers.summariser };
    summariser.condense(&looks.iter().map(directed).collect::<Vec<_>>(), CONDENSED_WORDS)
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
            detector: None,
        };
        assert!(matches!(talk_about(&view, observers), Err(ModelError::Failed { model, .. }) if model == "test/mute"));
    }
}
