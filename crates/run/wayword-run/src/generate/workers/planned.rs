//! Writes the plan of a run (`plan.json`), and compares the plan in a folder with the settings and items of this worker.

use crate::{
    error::Error,
    generate::workers::args::AskedWorkers,
    item::Item,
    own_format,
    plan::Plan,
    run_folder::{config_text, differing, fresh_id, hashes, is_begun},
    settings::Settings,
};
use std::{collections::BTreeSet, fs, path::Path};

/// Refuses a folder that holds a run of one machine.
pub(super) fn refuse_other_folder(out: &Path) -> Result<(), Error> {
    crate::run_folder::refuse_file(out)?;
    if is_begun(out) && wayword_queue::Plan::find(out)?.is_none() {
        return Err(Error::usage(
            format!("{} holds a run that one machine makes", out.display()),
            "continue it without --plan, --shard and --queue, or give another --out",
        ));
    }
    Ok(())
}

/// The settings in a plan.
pub(crate) fn settings_of(out: &Path, plan: &wayword_queue::Plan) -> Result<Settings, Error> {
    own_format::read(&plan.config).map_err(|unread| {
        let hint = unread.hint("it was changed by hand or by another version: use another folder");
        Error::usage(format!("{}: {unread}", out.join(wayword_queue::PLAN).display()), hint)
    })
}

/// Writes the plan, unless another worker has just done so.
pub(super) fn put(out: &Path, plan: &Plan<'_>, settings: &Settings, asked: &AskedWorkers) -> Result<(), Error> {
    fs::create_dir_all(out.join("chunks")).map_err(Error::io(out, "make the run folder"))?;
    let chunk = asked.chunk();
    let items: Vec<String> = plan.items.iter().map(Item::id).collect();
    let mut new = wayword_queue::Plan::new(fresh_id("run"), chunk, config_text(settings)?, items);
    let scenes: BTreeSet<_> = plan.items.iter().map(Item::scene).collect();
    new.data = hashes(plan.platform, scenes)?;
    new.estimate = serde_json::to_value(plan.estimate(Some(chunk))?).unwrap_or_default();
    new.put(out)?;
    Ok(())
}

/// Refuses to work on a plan with other settings, items or chunks than this worker has.
pub(super) fn agree(
    out: &Path,
    kept: &wayword_queue::Plan,
    plan: &Plan<'_>,
    settings: &Settings,
    asked: &AskedWorkers,
) -> Result<(), Error> {
    let before = settings_of(out, kept)?;
    let mut differs: Vec<String> = differing(&before, settings).into_iter().collect();
    if asked.chunk.is_some_and(|chunk| chunk.get() != kept.chunk) {
        differs.push(format!("chunk ({} in the plan)", kept.chunk));
    }
    if differs.is_empty() && !plan.items.iter().map(Item::id).eq(kept.items.iter().cloned()) {
        differs.push("the items that the data gives".to_owned());
    }
    if differs.is_empty() {
        return Ok(());
    }
    Err(Error::usage(
        format!("{} holds the plan of another run; these differ: {}", out.display(), differs.join(", ")),
        format!(
            "give all workers the settings, files and data of the plan ({}), or give another --out",
            out.join(wayword_queue::PLAN).display()
        ),
    ))
}
