//! Fills every prompt once with made-up values when the prompts are loaded. So a template that uses an unknown variable
//! is reported before a run begins, not at its first frame.

use super::{PromptError, PromptManner, Prompts};
use crate::{
    style::{StyleProfile, built_in},
    walk::ObservedWalk,
    writer::{TextComplaint, WritingBrief},
};
use wayword_core::{
    CheckFinding, CheckKind, DVec3, DialogueExchange, FrameObservation, ObjectId, ObjectSighting, Path, PathMotion,
    PathTarget, SceneId, Verdict, WitnessAnswer, path::PathStop,
};

/// Fills every prompt with made-up values, and returns the error of the first that cannot be filled.
pub(super) fn fill_all(prompts: &Prompts) -> Result<(), PromptError> {
    let transcript = [DialogueExchange::new("Is there a bed?", "No.")];
    let denied = ObjectSighting::new("bed", WitnessAnswer::Denied, "");
    let complaints = ["it names a bed".to_owned()];
    prompts.question_prompt(&transcript)?;
    prompts.view_prompt(Some("there is no JSON in it"))?;
    for manner in [PromptManner::Chat, PromptManner::Question, PromptManner::Completion] {
        prompts.answer_prompt(manner, "Is there a bed?", &transcript)?;
    }
    prompts.summary_prompt(&transcript, &[denied], &complaints)?;
    prompts.condense_prompt(&[("ahead", "A hallway.")], 20, &complaints)?;
    // Every build has this style.
    let Ok(style) = built_in("r2r") else { return Ok(()) };
    let finding =
        CheckFinding { check: CheckKind::Form, verdict: Verdict::Fail, reason: "too long".to_owned(), span: None };
    let complaints = [TextComplaint { text: "Go.".to_owned(), findings: vec![finding] }];
    let profile = StyleProfile::for_style(&style);
    for walk in [PathMotion::Known, PathMotion::Unknown].into_iter().filter_map(trial_walk) {
        let earlier = ["Go on.".to_owned()];
        prompts.writing_prompt(&WritingBrief {
            complaints: &complaints,
            earlier: &earlier,
            ..WritingBrief::new(&walk, &walk.memory(), &style, &profile, 0)
        })?;
    }
    Ok(())
}

/// A walk from a hallway into a bedroom.
pub(crate) fn trial_walk(motion: PathMotion) -> Option<ObservedWalk> {
    let stop = |y: f64| PathStop { position: DVec3::new(0.0, y, 1.5), viewpoint: None, level: None };
    let target = PathTarget {
        object: ObjectId::new("1").ok()?,
        name: "lamp".to_owned(),
        told_by: Vec::new(),
        has_namesake: false,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    };
    let path = Path {
        id: "trial".to_owned(),
        scene: SceneId::new("trial").ok()?,
        frames: Path::frames_along(vec![stop(0.0), stop(2.0)], None),
        motion,
        target: Some(target),
    };
    let seen = |summary: &str| FrameObservation { summary: summary.to_owned(), ..FrameObservation::default() };
    Some(ObservedWalk::new(path, vec![seen("A hallway."), seen("A bedroom with a lamp.")]))
}
