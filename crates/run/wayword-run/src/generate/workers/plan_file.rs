//! Writes the plan of a run (`plan.json`), and compares the plan in a folder with the settings and items of this worker.

use crate::{
    error::CommandError,
    generate::workers::args::AskedWorkers,
    item::RunItem,
    own_format,
    plan::RunPlan,
    run_folder::{config_text, expect_run_place, fresh_id, is_begun, scene_hashes, setting_differences},
    settings::RunSettings,
};
use std::{collections::BTreeSet, fs, path::Path};

/// Refuses a folder that holds a run of one machine.
pub(super) fn refuse_other_folder(out: &Path) -> Result<(), CommandError> {
    expect_run_place(out)?;
    if is_begun(out) && wayword_queue::ChunkPlan::find_plan(out)?.is_none() {
        return Err(CommandError::usage(
            format!("{} holds a run that one machine makes", out.display()),
            "continue it without --plan, --shard and --queue, or give another --out",
        ));
    }
    Ok(())
}

/// The settings in a plan.
pub(crate) fn settings_in_plan(out: &Path, plan: &wayword_queue::ChunkPlan) -> Result<RunSettings, CommandError> {
    own_format::parse_document(&plan.config).map_err(|unread| {
        let hint = unread.hint_or("it was changed by hand or by another version: use another folder");
        CommandError::usage(format!("{}: {unread}", out.join(wayword_queue::PLAN).display()), hint)
    })
}

/// Writes the plan, unless another worker has just done so.
pub(super) fn write_plan(
    out: &Path,
    plan: &RunPlan<'_>,
    settings: &RunSettings,
    asked: &AskedWorkers,
) -> Result<(), CommandError> {
    fs::create_dir_all(out.join(wayword_queue::CHUNKS_FOLDER)).map_err(CommandError::io(out, "make the run folder"))?;
    let items: Vec<String> = plan.items.iter().map(RunItem::id).collect();
    let chunk = asked.chunk_items(items.len(), None);
    let mut new = wayword_queue::ChunkPlan::new(fresh_id("run"), chunk, config_text(settings)?, items);
    let scenes: BTreeSet<_> = plan.items.iter().map(RunItem::scene).collect();
    new.data = scene_hashes(plan.platform, scenes)?;
    new.estimate = serde_json::to_value(plan.estimate_calls(Some(chunk))?).unwrap_or_default();
    new.write_plan(out)?;
    Ok(())
}

/// Refuses to work on a plan with other settings, items or chunks than this worker has.
pub(super) fn check_agreement(
    out: &Path,
    kept: &wayword_queue::ChunkPlan,
    plan: &RunPlan<'_>,
    settings: &RunSettings,
    asked: &AskedWorkers,
) -> Result<(), CommandError> {
    let before = settings_in_plan(out, kept)?;
    let mut differs = setting_differences(&before, settings);
    if asked.chunk.is_some_and(|chunk| chunk.get() != kept.chunk) {
        differs.push(format!("chunk ({} in the plan)", kept.chunk));
    }
    if differs.is_empty() && !plan.items.iter().map(RunItem::id).eq(kept.items.iter().cloned()) {
        differs.push("the items that the data gives".to_owned());
    }
    if differs.is_empty() {
        return Ok(());
    }
    Err(CommandError::usage(
        format!("{} holds the plan of another run; these differ: {}", out.display(), differs.join(", ")),
        format!(
            "give all workers the settings, files and data of the plan ({}), or give another --out",
            out.join(wayword_queue::PLAN).display()
        ),
    ))
}
