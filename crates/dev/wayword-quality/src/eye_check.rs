//! Checks texts against what a scripted, flawed eye sees along their walks, as on a platform that has poses and pictures but no labels.

use crate::stage::{MeasuredWorldArgs, MeasurementStage};
use rayon::prelude::*;
use std::collections::BTreeMap;
use wayword_checks::{CheckSubject, Evidence, WalkMemory, check_own_text};
use wayword_core::{InstructionStyle, Path, Verdict};
use wayword_formats::jsonl::InstructionRecord;
use wayword_run::{
    error::CommandError, output::CommandOutput, plan::RunPlan, platforms::RememberingPlatform, run_folder::fresh_id,
    team::RoleTeam,
};
use wayword_synthesis::{
    observe::observe_path,
    walk::{FrameSelection, ObservedWalk},
};
use wayword_testkit::provider::scripts::FlawedEye;

/// How the eye errs, as shares of the things in a view.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EyeErrors {
    /// Things that it leaves out.
    pub(crate) missed: f64,
    /// Things that it names, but is unsure of.
    pub(crate) hedged: f64,
}

/// The eye's evidence for a walk.
struct SeenWalk {
    evidence: Evidence,
    memory: WalkMemory,
}

/// The verdict of each text by what the eye sees along its walk through a generated house. The eye looks once along each walk; walks are
/// told apart by their ids.
///
/// # Errors
/// When the eye's provider cannot be started, or a view cannot be had.
pub(crate) fn check_by_eye(
    texts: &[(&InstructionRecord, &str)],
    errors: EyeErrors,
    seed: u64,
    output: &CommandOutput,
) -> Result<Vec<Verdict>, CommandError> {
    let paths: BTreeMap<&str, &Path> =
        texts.iter().map(|(record, _)| (record.path.id.as_str(), &record.path)).collect();
    let walks = see_walks(&paths, errors, seed, output)?;
    let style = InstructionStyle { name: "r2r".to_owned(), ..InstructionStyle::default() };
    let verdict = |(record, text): &(&InstructionRecord, &str)| {
        walks.get(record.path.id.as_str()).map_or(Verdict::Unverified, |seen| {
            let subject = CheckSubject::closed_world(&seen.evidence, &style, None).with_memory(&seen.memory);
            check_own_text(text, subject).verdict()
        })
    };
    Ok(texts.par_iter().map(verdict).collect())
}

fn see_walks<'a>(
    paths: &BTreeMap<&'a str, &Path>,
    errors: EyeErrors,
    seed: u64,
    output: &CommandOutput,
) -> Result<BTreeMap<&'a str, SeenWalk>, CommandError> {
    let world = MeasuredWorldArgs { platform: "house".to_owned(), data: None, scan: None, seed };
    let stage = MeasurementStage::with_eye(&world, |eye| FlawedEye {
        miss_share: errors.missed,
        hedge_share: errors.hedged,
        ..eye
    })?;
    let job = stage.looking_job(1)?;
    let plan = RunPlan::for_looking(&job, &stage.world)?;
    let calls = plan.models.open_calls(&fresh_id("eye-check"), output)?;
    let team = RoleTeam::new(&job.settings, calls.as_ref(), &stage.world)?;
    let see = |(id, path): (&&'a str, &&Path)| {
        let world = RememberingPlatform::new(&stage.world);
        // All around, as labels see: texts also name what lies at the side.
        let seen = observe_path(&world, path, FrameSelection::Panoramic, team.observers())?;
        let walk = ObservedWalk::new((*path).clone(), seen);
        let evidence = walk.evidence();
        Ok(evidence.map(|evidence| (*id, SeenWalk { memory: WalkMemory::from_path(&evidence, &walk.path), evidence })))
    };
    let walks: Vec<_> = paths.par_iter().map(see).collect::<Result<_, CommandError>>()?;
    Ok(walks.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::test_instruction;
    use wayword_core::{PathRequest, Platform};
    use wayword_house::HousePlatform;

    #[test]
    fn check_by_eye_fails_a_thing_that_the_eye_did_not_see() {
        let (platform, scene) = (HousePlatform::default(), HousePlatform::scene_of(0).unwrap());
        let mut path = platform.sample_path(&scene, &PathRequest::default(), 0).unwrap();
        path.frames.truncate(2);
        let record = InstructionRecord::new("house", path, test_instruction("r2r", "Stop.", &[]));
        let texts = [(&record, "Walk past the treadmill. Stop."), (&record, "Stop.")];
        let errors = EyeErrors { missed: 0.15, hedged: 0.1 };
        let verdicts = check_by_eye(&texts, errors, 1, &CommandOutput::new(true, true)).unwrap();
        assert!(verdicts[0] == Verdict::Fail && verdicts[1] != Verdict::Fail, "{verdicts:?}");
        assert!(check_by_eye(&[], errors, 1, &CommandOutput::new(true, true)).unwrap().is_empty());
    }
}
