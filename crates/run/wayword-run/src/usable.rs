//! Decides which scenes a run uses. A scene with damaged files is left out and named; it does not stop the run over the others.

use crate::{
    count::count,
    error::Error,
    in_order::{cores, in_order},
    interrupt,
    item::Item,
    output::Output,
    settings::Settings,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{Condition, Lack, Platform, PlatformError, SceneId};

/// Most scenes that are examined at a time: one may take some hundred megabytes.
const AT_A_TIME: usize = 4;
/// From this number of scenes on, a message announces that they are being examined, because that takes a while.
const MANY: usize = 20;
/// Scenes that an error names.
const NAMED: usize = 3;

/// The settings of a new run, completed by the scenes that its random paths leave out. A message names each of them once, with
/// the reason. A continued run keeps leaving out the same scenes.
///
/// # Errors
/// When no scene can be used, or the platform's data is lost.
pub fn settled(settings: &Settings, platform: &dyn Platform, output: &Output) -> Result<Settings, Error> {
    if settings.connectivity.is_none() || settings.episodes.is_some() || !settings.left_out.is_empty() {
        return Ok(settings.clone());
    }
    let asked = match &settings.scan[..] {
        [] => platform.candidates()?,
        names => names.iter().filter_map(|name| SceneId::new(name.as_str()).ok()).collect(),
    };
    let left_out = left_out(&asked, platform, output)?;
    Ok(Settings { left_out, ..settings.clone() })
}

/// Reports which scenes of a run's episodes cannot be used, before the run begins. Items in these scenes fail; the others are
/// made.
///
/// # Errors
/// When no scene can be used, or the platform's data is lost.
pub(crate) fn tell_of_episodes(
    settings: &Settings,
    items: &[Item],
    platform: &dyn Platform,
    output: &Output,
) -> Result<(), Error> {
    if settings.connectivity.is_none() || settings.episodes.is_none() {
        return Ok(());
    }
    let scenes: BTreeSet<&SceneId> = items.iter().map(Item::scene).collect();
    let scenes: Vec<SceneId> = scenes.into_iter().cloned().collect();
    left_out(&scenes, platform, output).map(drop)
}

/// Examines scenes, and reports those that cannot be used.
fn left_out(scenes: &[SceneId], platform: &dyn Platform, output: &Output) -> Result<BTreeMap<String, Lack>, Error> {
    let conditions = examined(scenes, platform, output)?;
    let bad = conditions.into_iter().filter_map(|found| Some((found.scene.to_string(), found.unusable?)));
    let bad: BTreeMap<String, Lack> = bad.collect();
    if !scenes.is_empty() && bad.len() >= scenes.len() {
        let reasons: Vec<&str> = bad.values().take(NAMED).map(|lack| lack.what.as_str()).collect();
        let more = bad.len().saturating_sub(NAMED);
        let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
        let hint = bad.values().next().map(|lack| lack.hint.clone()).unwrap_or_default();
        return Err(Error::usage(format!("no scene can be used: {}{rest}", reasons.join("; ")), hint));
    }
    for (scene, Lack { what, hint }) in &bad {
        output.say(format_args!("left out: scene {scene}: {what}\nhint: {hint}"));
    }
    if !bad.is_empty() {
        output.say(format_args!("{} of {} are used", scenes.len() - bad.len(), count(scenes.len(), "scene")));
    }
    Ok(bad)
}

/// The conditions of scenes, in their order. A scene that the platform cannot examine is skipped.
///
/// # Errors
/// When the user interrupts, or the platform's data is lost.
pub fn examined(scenes: &[SceneId], platform: &dyn Platform, output: &Output) -> Result<Vec<Condition>, Error> {
    if scenes.len() >= MANY {
        output.say(format_args!("examining {} ...", count(scenes.len(), "scene")));
    }
    let mut conditions = Vec::with_capacity(scenes.len());
    let examine = |scene: &SceneId| {
        interrupt::check()?;
        match platform.examine(scene) {
            Ok(found) => Ok(found),
            Err(PlatformError::UnknownScene { hint, .. }) => {
                let why = Lack { what: format!("there is no scene {scene}"), hint };
                Ok(Some(Condition::unusable(scene.clone(), why)))
            }
            Err(error) => Err(Error::from(error)),
        }
    };
    in_order(scenes, cores().min(AT_A_TIME), examine, |_, found| {
        conditions.extend(found?);
        Ok::<bool, Error>(true)
    })?;
    Ok(conditions)
}
