//! Fills every prompt once with made-up values when the prompts are loaded. So a template that uses an unknown variable
//! is reported before a run begins, not at its first frame.

use super::{Manner, PromptError, Prompts};
use crate::{
    style::{Profile, built_in},
    walk::Walk,
    writer::{Brief, Complaint},
};
use wayword_core::{
    Check, DVec3, Exchange, Finding, Motion, ObjectId, Observation, Path, SceneId, Sighting, Target, Verdict, Witness,
    path::Stop,
};

pub(super) fn fill_all(prompts: &Prompts) -> Result<(), PromptError> {
    let transcript = [Exchange::new("Is there a bed?", "No.")];
    let denied = Sighting::new("bed", Witness::Denied, "");
    let complaints = ["it names a bed".to_owned()];
    prompts.question(&transcript)?;
    prompts.see(Some("there is no JSON in it"))?;
    for manner in [Manner::Chat, Manner::Question, Manner::Completion] {
        prompts.answer(manner, "Is there a bed?", &transcript)?;
    }
    prompts.summary(&transcript, &[denied], &complaints)?;
    prompts.condense(&[("ahead", "A hallway.")], 20, &complaints)?;
    // Every build has this style.
    let Ok(style) = built_in("r2r") else { return Ok(()) };
    let finding = Finding { check: Check::Form, verdict: Verdict::Fail, reason: "too long".to_owned(), span: None };
    let complaints = [Complaint { text: "Go.".to_owned(), findings: vec![finding] }];
    let profile = Profile::of(&style);
    for walk in [Motion::Known, Motion::Unknown].into_iter().filter_map(walk) {
        let earlier = ["Go on.".to_owned()];
        prompts.write(&Brief {
            complaints: &complaints,
            earlier: &earlier,
            ..Brief::new(&walk, &walk.memory(), &style, &profile, 0)
        })?;
    }
    Ok(())
}

/// A walk from a hallway into a bedroom.
pub(crate) fn walk(motion: Motion) -> Option<Walk> {
    let stop = |y: f64| Stop { position: DVec3::new(0.0, y, 1.5), viewpoint: None, level: None };
    let target = Target {
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
    let seen = |summary: &str| Observation { summary: summary.to_owned(), ..Observation::default() };
    Some(Walk::new(path, vec![seen("A hallway."), seen("A bedroom with a lamp.")]))
}
