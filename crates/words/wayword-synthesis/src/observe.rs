//! Looks at the views along a path and runs a dialogue about each, so that every frame gets a caption.

use crate::{
    dialogue::{CaptionSummariser, CondensedCaption, Dialogue, DialogueMode, DialogueNeed, RulesSummariser},
    seeing::see_view,
    walk::FrameSelection,
};
use wayword_core::{
    AnswerForm, Caption, CaptionedView, DialogueExchange, Frame, FrameObservation, ModelError, Path, PathMotion,
    Platform, PlatformError, Side, View, ViewGaze, ViewQuestion, WitnessAnswer,
};

pub use crate::dialogue::ObservationRoles;

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

/// Limit for the description of a panorama, words: it has fewer than this (arXiv 2403.11487).
pub(crate) const CONDENSED_WORD_LIMIT: usize = 20;

/// A view that still needs its caption.
#[derive(Debug, Clone)]
pub struct PlannedView {
    /// Number of its frame on the path.
    pub frame: usize,
    /// The direction and width that the view shows.
    pub gaze: ViewGaze,
    /// The view itself.
    pub view: View,
}

/// Makes captions for views that do not depend on each other: one caption each, in their order.
pub type ViewCaptioner<'a> = dyn Fn(&[PlannedView]) -> Result<Vec<Caption>, ModelError> + 'a;

/// Captions of a path: one observation per frame.
///
/// At the last frame of a central run, if the view ahead shows no object, the walker looks all around. A robot that has
/// arrived would do so, and the task has to be about something that can be seen from there.
///
/// # Errors
/// When the platform gives no view, or a question is not answered.
pub fn observe_path(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    observers: ObservationRoles<'_>,
) -> Result<Vec<FrameObservation>, ObserveError> {
    observe_path_with(platform, path, selection, observers, &|views| {
        views.iter().map(|planned| caption_view(&planned.view, observers)).collect()
    })
}

/// Like [`observe_path`], with a function that makes the captions of several views at once, for example in parallel.
///
/// # Errors
/// When the platform gives no view, or a question is not answered.
pub fn observe_path_with(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    observers: ObservationRoles<'_>,
    captioner: &ViewCaptioner<'_>,
) -> Result<Vec<FrameObservation>, ObserveError> {
    let mut looks: Vec<Vec<CaptionedView>> = vec![Vec::new(); path.frames.len()];
    let planned = plan_views(platform, path, selection)?;
    assign_captions(captioner(&planned)?, planned, &mut looks);
    if let Some(planned) = plan_at_end(platform, path, selection, &looks)? {
        looks.last_mut().into_iter().for_each(Vec::clear);
        assign_captions(captioner(&planned)?, planned, &mut looks);
    }
    let frames = path.frames.iter().zip(looks);
    Ok(frames.map(|(frame, looks)| join_looks(frame, looks, observers)).collect::<Result<_, _>>()?)
}

/// The views of a path that need a caption, frame by frame.
///
/// # Errors
/// When the platform gives no view.
pub fn plan_views(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
) -> Result<Vec<PlannedView>, PlatformError> {
    let mut planned = Vec::new();
    for (at, frame) in path.frames.iter().enumerate() {
        planned.extend(views_for_gazes(platform, path, at, &frame_gazes(frame, selection))?);
    }
    Ok(planned)
}

/// The views all around the last frame of a central run. `None` where the view ahead shows an object, or where the
/// walker cannot look around.
fn plan_at_end(
    platform: &dyn Platform,
    path: &Path,
    selection: FrameSelection,
    looks: &[Vec<CaptionedView>],
) -> Result<Option<Vec<PlannedView>>, PlatformError> {
    let (Some(frame), Some(at_end)) = (path.frames.last(), looks.last()) else { return Ok(None) };
    let mut sightings = at_end.iter().flat_map(|look| &look.caption.sightings);
    let is_empty = !sightings.any(|sighting| sighting.witness == WitnessAnswer::Seen);
    // Without poses the walker cannot look around: the frame has one picture.
    if !is_empty || !path.motion.is_known() || selection != FrameSelection::Central {
        return Ok(None);
    }
    views_for_gazes(platform, path, looks.len() - 1, &ViewGaze::around_heading(frame.pose.heading)).map(Some)
}

/// Makes the observation of a frame from its looks, with a summary of their captions.
///
/// # Errors
/// When the summariser fails.
pub fn join_looks(
    frame: &Frame,
    looks: Vec<CaptionedView>,
    observers: ObservationRoles<'_>,
) -> Result<FrameObservation, ModelError> {
    let CondensedCaption { text, by } = summarise_looks(frame, &looks, observers)?;
    Ok(FrameObservation { summary: text, by, looks })
}

/// Adds each caption to the looks of its frame. `captions` and `planned` belong together one by one.
fn assign_captions(captions: Vec<Caption>, planned: Vec<PlannedView>, looks: &mut [Vec<CaptionedView>]) {
    for (PlannedView { frame, gaze, .. }, caption) in planned.into_iter().zip(captions) {
        looks[frame].push(CaptionedView { gaze, caption });
    }
}

/// The directions in which a frame is looked at.
#[must_use]
pub fn frame_gazes(frame: &Frame, selection: FrameSelection) -> Vec<ViewGaze> {
    match selection {
        FrameSelection::Central => vec![ViewGaze::quarter_view(frame.pose.heading)],
        FrameSelection::Panoramic => ViewGaze::compass_views().to_vec(),
    }
}

/// The directions all around a frame: ahead, right, behind, left. Only ahead if the motion is unknown, because the
/// other directions are then unknown too.
#[must_use]
pub fn gazes_around(path: &Path, frame: &Frame) -> Vec<ViewGaze> {
    match path.motion {
        PathMotion::Known => ViewGaze::around_heading(frame.pose.heading).to_vec(),
        PathMotion::Unknown => vec![ViewGaze::quarter_view(frame.pose.heading)],
    }
}

/// The views from frame number `at` of a path in the given directions. Blank views are left out, unless all are blank.
fn views_for_gazes(
    platform: &dyn Platform,
    path: &Path,
    at: usize,
    gazes: &[ViewGaze],
) -> Result<Vec<PlannedView>, PlatformError> {
    let views = gazes.iter().map(|gaze| Ok((gaze, platform.look_from(&path.scene, &path.frames[at], *gaze)?)));
    let views: Vec<(&ViewGaze, View)> = views.collect::<Result<_, PlatformError>>()?;
    // A camera shows only one direction, so blank views are left out. If all views are blank they stay: the error then
    // explains what the platform lacks.
    let all_blank = views.iter().all(|(_, view)| view.is_blank());
    let planned = views.into_iter().filter(|(_, view)| all_blank || !view.is_blank()).map(|(gaze, view)| {
        // A camera's picture may show a slightly different direction than the one asked for.
        let shown = ViewGaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
        let gaze = if view.image.is_some() { shown } else { *gaze };
        PlannedView { frame: at, gaze, view }
    });
    Ok(planned.collect())
}

/// Runs the dialogue about one view to its end and returns the caption.
///
/// # Errors
/// When a role does not answer.
pub fn caption_view(view: &View, observers: ObservationRoles<'_>) -> Result<Caption, ModelError> {
    if let DialogueMode::Structured { questions } = observers.mode {
        return see_view(view, observers, questions);
    }
    let mut dialogue = Dialogue::new(observers.mode);
    loop {
        match dialogue.next_need() {
            DialogueNeed::Question => dialogue.take_question(observers.asker.next_question(dialogue.transcript())?),
            DialogueNeed::Answer(question) => {
                let history: Vec<DialogueExchange> = dialogue.transcript().to_vec();
                let ask = ViewQuestion { view, question: &question, history: &history, answer: AnswerForm::Words };
                let answer = observers
                    .answerer
                    .answer_questions(&[ask])
                    .pop()
                    .unwrap_or_else(|| Err(observers.unanswered_error()));
                dialogue.take_answer(&answer?);
            }
            DialogueNeed::Summary => return caption_of_dialogue(dialogue.transcript(), observers),
        }
    }
}

/// The caption of a dialogue. In the modes without a dialogue no language model summarises: the only answer is the
/// caption, or rules join the answers to the fixed queries.
fn caption_of_dialogue(
    transcript: &[DialogueExchange],
    observers: ObservationRoles<'_>,
) -> Result<Caption, ModelError> {
    let answerer = observers.answerer.name();
    let rules = || RulesSummariser.sum_up(transcript, answerer);
    match (observers.mode, transcript) {
        (DialogueMode::Dialogue { .. }, _) => observers.summariser.sum_up(transcript, answerer),
        (DialogueMode::Single, [only]) => {
            Ok(Caption { text: only.answer.clone(), by: Some(answerer.to_owned()), ..rules()? })
        }
        (DialogueMode::Fixed | DialogueMode::Single | DialogueMode::Structured { .. }, _) => rules(),
    }
}

/// One description of all looks of a frame. A single look needs none of its own: its caption is the description.
fn summarise_looks(
    frame: &Frame,
    looks: &[CaptionedView],
    observers: ObservationRoles<'_>,
) -> Result<CondensedCaption, ModelError> {
    if let [only] = looks {
        return Ok(CondensedCaption { text: only.caption.text.clone(), by: None });
    }
    let directed = |look| (look_direction(frame, look), &look.caption);
    // A structured answer costs one call of a model, and its caption none: so the summary has to cost none either.
    let uses_rules = matches!(observers.mode, DialogueMode::Structured { .. });
    let summariser: &dyn CaptionSummariser = if uses_rules { &RulesSummariser } else { observers.summariser };
    summariser.condense(&looks.iter().map(directed).collect::<Vec<_>>(), CONDENSED_WORD_LIMIT)
}

/// The direction of a look in words, as seen by the walker.
fn look_direction(frame: &Frame, look: &CaptionedView) -> &'static str {
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
    use wayword_core::{AnswerText, DVec3, Heading, Pose, ViewAnswerer};

    /// An answerer that gives no answer to a question.
    struct Mute;

    impl ViewAnswerer for Mute {
        fn name(&self) -> &str {
            "test/mute"
        }

        fn answer_questions(&self, _: &[ViewQuestion<'_>]) -> Vec<Result<AnswerText, ModelError>> {
            Vec::new()
        }
    }

    #[test]
    fn an_answerer_that_leaves_a_question_out_is_not_asked_for_ever() {
        let view = View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), 1.0, None, None);
        let asker = RulesAsker::default();
        let observers = ObservationRoles {
            asker: &asker,
            answerer: &Mute,
            summariser: &RulesSummariser,
            mode: DialogueMode::Dialogue { questions: 9 },
            prompts_hash: None,
            detector: None,
        };
        assert!(
            matches!(caption_view(&view, observers), Err(ModelError::Failed { model, .. }) if model == "test/mute")
        );
    }
}
