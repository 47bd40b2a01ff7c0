//! Prepares a run: opens its platform, settles which scenes it uses, and plans it. The dry run, the run of one machine and each
//! worker begin with this.

use crate::{
    calls::ModelCalls,
    error::CommandError,
    item::RunItem,
    output::CommandOutput,
    plan::RunPlan,
    platforms, scene_selection,
    settings::{RunJob, RunSettings},
};
use wayword_core::{Platform, PlatformError};

/// When a preparation asks whether the run's models can be called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ModelCheck {
    /// Before the platform is opened, and only for names, prices and files, because no model will be called.
    Rehearsal,
    /// Before the platform is opened.
    ReadyFirst,
    /// After the run is planned.
    ReadyLast,
    /// Never, beyond the checks that every plan makes.
    PlanAlone,
}

/// A run with its platform, before it is planned.
pub(super) struct PreparedRun {
    /// The settings with the scenes that the run leaves out, and how models are reached.
    job: RunJob,
    /// The platform.
    platform: Box<dyn Platform>,
    /// Whether no earlier command began the run.
    pub(super) is_new: bool,
    check: ModelCheck,
}

impl PreparedRun {
    /// Opens the platform of a job. `continued` are the settings with which a run that was begun goes on; without them the run is
    /// new, and its scenes are examined.
    ///
    /// # Errors
    /// When a model is not ready, the platform cannot be opened, or no scene can be used.
    pub(super) fn open(
        job: &RunJob,
        continued: Option<RunSettings>,
        check: ModelCheck,
        output: &CommandOutput,
    ) -> Result<Self, CommandError> {
        let is_new = continued.is_none();
        let mut job = RunJob { settings: continued.unwrap_or_else(|| job.settings.clone()), ..job.clone() };
        match check {
            ModelCheck::Rehearsal => drop(ModelCalls::rehearse_job(&job)?),
            ModelCheck::ReadyFirst => ModelCalls::check_ready(&job, output)?,
            ModelCheck::ReadyLast | ModelCheck::PlanAlone => {}
        }
        let platform = platforms::open_platform(&job.settings)?;
        if is_new {
            job.settings = scene_selection::settle_left_out(&job.settings, platform.as_ref(), output)?;
        }
        Ok(Self { job, platform, is_new, check })
    }

    /// The items, styles and models of the run.
    ///
    /// # Errors
    /// As for [`RunPlan::for_writing`], or when a model is not ready.
    pub(super) fn plan_run(&self, output: &CommandOutput) -> Result<RunPlan<'_>, CommandError> {
        let platform = self.platform.as_ref();
        let plan =
            RunPlan::for_writing(&self.job, platform).map_err(|error| platforms::suggest_scene(error, platform))?;
        if self.check == ModelCheck::ReadyLast {
            ModelCalls::check_ready(&self.job, output)?;
        }
        Ok(plan)
    }

    /// The plan, and the settings as the run folder keeps them. Of a new run, reports which scenes of its episodes cannot be used,
    /// and refuses random paths that no scene has.
    ///
    /// # Errors
    /// As for [`Self::plan_run`]; when a file that the settings name cannot be read; or when a new run has no usable scene or path.
    pub(super) fn plan_with_settings(
        &self,
        output: &CommandOutput,
    ) -> Result<(RunPlan<'_>, RunSettings), CommandError> {
        let plan = self.plan_run(output)?;
        let settings = plan.settings_with_hashes()?;
        if self.is_new {
            scene_selection::report_unusable_scenes(&settings, &plan.items, self.platform.as_ref(), output)?;
            refuse_impossible_paths(&plan.items, &settings, self.platform.as_ref())?;
        }
        Ok((plan, settings))
    }
}

/// Number of failed searches for a path after which a run is refused. More than one, because places are drawn at random, and one
/// search of a single scene can miss an existing path.
const MAX_PATH_SEARCHES: usize = 3;

/// Refuses random paths that no scene has, before a folder is made. Other failures are reported later, as those of
/// their items.
fn refuse_impossible_paths(
    items: &[RunItem],
    settings: &RunSettings,
    platform: &dyn Platform,
) -> Result<(), CommandError> {
    let Some(RunItem::Random { scenes, .. }) = items.first() else { return Ok(()) };
    let mut lack = None;
    for item in items.iter().take(MAX_PATH_SEARCHES.div_ceil(scenes.len().max(1))) {
        match item.find_path(settings, platform) {
            Err(error @ PlatformError::NoSuchPath { .. }) => lack = Some(error),
            _ => return Ok(()),
        }
    }
    match lack {
        Some(PlatformError::NoSuchPath { scene, request, hint }) if scenes.len() > 1 => {
            let problem =
                format!("none of the {} scenes has a path with {request} (first tried: {scene})", scenes.len());
            Err(CommandError::usage(problem, format!("{hint}, or name other scenes with --scan")))
        }
        Some(error) => Err(error.into()),
        None => Ok(()),
    }
}
