//! Decides which scenes a run uses. A scene with damaged files is left out and named; it does not stop the run over the others.

use crate::{
    count::count_phrase,
    error::CommandError,
    in_order::{core_count, in_order},
    interrupt,
    item::RunItem,
    output::CommandOutput,
    settings::RunSettings,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{Platform, PlatformError, SceneCondition, SceneId, SceneLack};

/// Most scenes that are examined at the same time, because one may take some hundred megabytes of memory.
const MAX_CONCURRENT_SCENES: usize = 4;
/// From this number of scenes on, a message announces that they are being examined, because that takes a while.
const MIN_ANNOUNCED_SCENES: usize = 20;
/// Most scenes that an error names; it counts the others.
const MAX_NAMED_SCENES: usize = 3;

/// The settings of a new run, completed by the scenes that its random paths leave out. A message names each of them once, with
/// the reason. A continued run keeps leaving out the same scenes.
///
/// # Errors
/// When no scene can be used, or the platform's data is lost.
pub fn settle_left_out(
    settings: &RunSettings,
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<RunSettings, CommandError> {
    if settings.connectivity.is_none() || settings.episodes.is_some() || !settings.left_out.is_empty() {
        return Ok(settings.clone());
    }
    let asked = match &settings.scan[..] {
        [] => platform.files().candidate_scenes()?,
        names => names.iter().filter_map(|name| SceneId::new(name.as_str()).ok()).collect(),
    };
    let left_out = examine_unusable(&asked, platform, output)?;
    Ok(RunSettings { left_out, ..settings.clone() })
}

/// Reports which scenes of a run's episodes cannot be used, before the run begins. Items in these scenes fail; the others are
/// made.
///
/// # Errors
/// When no scene can be used, or the platform's data is lost.
pub(crate) fn report_unusable_scenes(
    settings: &RunSettings,
    items: &[RunItem],
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    if settings.connectivity.is_none() || settings.episodes.is_none() {
        return Ok(());
    }
    let scenes: BTreeSet<&SceneId> = items.iter().map(RunItem::scene).collect();
    let scenes: Vec<SceneId> = scenes.into_iter().cloned().collect();
    examine_unusable(&scenes, platform, output).map(drop)
}

/// Examines scenes, and reports those that cannot be used.
fn examine_unusable(
    scenes: &[SceneId],
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<BTreeMap<String, SceneLack>, CommandError> {
    let conditions = examine_scenes(scenes, platform, output)?;
    let unusable =
        conditions.into_iter().filter_map(|condition| Some((condition.scene.to_string(), condition.unusable?)));
    let unusable: BTreeMap<String, SceneLack> = unusable.collect();
    if !scenes.is_empty() && unusable.len() >= scenes.len() {
        let reasons: Vec<&str> = unusable.values().take(MAX_NAMED_SCENES).map(|lack| lack.what.as_str()).collect();
        let more = unusable.len().saturating_sub(MAX_NAMED_SCENES);
        let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
        let hint = unusable.values().next().map(|lack| lack.hint.clone()).unwrap_or_default();
        return Err(CommandError::usage(format!("no scene can be used: {}{rest}", reasons.join("; ")), hint));
    }
    for (scene, SceneLack { what, hint }) in &unusable {
        output.say(format_args!("left out: scene {scene}: {what}\nhint: {hint}"));
    }
    if !unusable.is_empty() {
        output.say(format_args!(
            "{} of {} are used",
            scenes.len() - unusable.len(),
            count_phrase(scenes.len(), "scene")
        ));
    }
    Ok(unusable)
}

/// The conditions of scenes, in their order. A scene that the platform cannot examine is skipped.
///
/// # Errors
/// When the user interrupts, or the platform's data is lost.
pub fn examine_scenes(
    scenes: &[SceneId],
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<Vec<SceneCondition>, CommandError> {
    if scenes.len() >= MIN_ANNOUNCED_SCENES {
        output.say(format_args!("examining {} ...", count_phrase(scenes.len(), "scene")));
    }
    let mut conditions = Vec::with_capacity(scenes.len());
    let examine = |scene: &SceneId| {
        interrupt::check_interrupt()?;
        match platform.files().examine_scene(scene) {
            Ok(found) => Ok(found),
            Err(PlatformError::UnknownScene { hint, .. }) => {
                let why = SceneLack { what: format!("there is no scene {scene}"), hint };
                Ok(Some(SceneCondition::for_unusable(scene.clone(), why)))
            }
            Err(error) => Err(CommandError::from(error)),
        }
    };
    in_order(scenes, core_count().min(MAX_CONCURRENT_SCENES), examine, |_, found| {
        conditions.extend(found?);
        Ok::<bool, CommandError>(true)
    })?;
    Ok(conditions)
}
