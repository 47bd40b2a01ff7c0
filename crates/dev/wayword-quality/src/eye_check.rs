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

/// What an eye sees along walks through generated houses, by the ids of the walks.
pub(crate) struct EyeWitness<'a> {
    walks: BTreeMap<&'a str, SeenWalk>,
}

impl<'a> EyeWitness<'a> {
    /// Looks all around along each walk, once.
    ///
    /// # Errors
    /// When the eye's provider cannot be started, or a view cannot be had.
    pub(crate) fn look(
        records: impl IntoIterator<Item = &'a InstructionRecord>,
        errors: EyeErrors,
        seed: u64,
        output: &CommandOutput,
    ) -> Result<Self, CommandError> {
        let paths: BTreeMap<&str, &Path> =
            records.into_iter().map(|record| (record.path.id.as_str(), &record.path)).collect();
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
            let memory = |evidence: &Evidence| WalkMemory::from_path(evidence, &walk.path);
            Ok(walk.evidence().map(|evidence| (*id, SeenWalk { memory: memory(&evidence), evidence })))
        };
        let walks: Vec<_> = paths.par_iter().map(see).collect::<Result<_, CommandError>>()?;
        Ok(Self { walks: walks.into_iter().flatten().collect() })
    }

    /// The verdict of each text, in a closed world of what the eye saw along its walk; unverified where it saw nothing.
    pub(crate) fn check(&self, texts: &[(&InstructionRecord, &str)]) -> Vec<Verdict> {
        let style = InstructionStyle { name: "r2r".to_owned(), ..InstructionStyle::default() };
        let verdict = |(record, text): &(&InstructionRecord, &str)| {
            self.walks.get(record.path.id.as_str()).map_or(Verdict::Unverified, |seen| {
                let subject = CheckSubject::closed_world(&seen.evidence, &style, None).with_memory(&seen.memory);
                check_own_text(text, subject).verdict()
            })
        };
        texts.par_iter().map(verdict).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::house_hop_record;

    #[test]
    fn check_fails_a_thing_that_the_eye_did_not_see() {
        let record = house_hop_record();
        let texts = [(&record, "Walk past the treadmill. Stop."), (&record, "Stop.")];
        let errors = EyeErrors { missed: 0.15, hedged: 0.1 };
        let eye = EyeWitness::look([&record], errors, 1, &CommandOutput::new(true, true)).unwrap();
        let verdicts = eye.check(&texts);
        assert!(verdicts[0] == Verdict::Fail && verdicts[1] != Verdict::Fail, "{verdicts:?}");
        assert!(eye.check(&[]).is_empty());
    }
}
