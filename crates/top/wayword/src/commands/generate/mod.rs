//! `wayword generate`.

mod keep;
mod summary;

use crate::{
    calls::Calls,
    cli::Generate,
    commands::config,
    count::count,
    error::{Error, Exit},
    in_order::{cores, in_order},
    item::Item,
    output::Output,
    pipeline::make,
    plan::Plan,
    run::RunFolder,
    settings::Job,
    team::Team,
    world,
};
use keep::{Fate, keep};
use std::path::Path;

pub use summary::Summary;

/// Items between two flushes to the disk: few enough to lose little when the machine fails.
const FLUSH: usize = 16;

pub(super) fn run(args: &Generate, output: &Output) -> Result<Exit, Error> {
    let job = args.asked.clone().or(config::read(args.config.as_deref())?).job()?;
    if args.dry_run {
        Calls::rehearse(&job)?;
        let platform = world::open(&job.settings)?;
        let estimate = Plan::writing(&job, platform.as_ref())?.estimate()?;
        output.data(&estimate, &estimate);
        return Ok(Exit::Done);
    }
    let out = args.out.as_deref().ok_or_else(|| {
        Error::usage("a run needs a folder", "give --out DIR, or --dry-run to see what the run would cost")
    })?;
    let summary = generate_into(out, &job, output)?;
    output.data(&summary, &summary);
    Ok(summary.exit())
}

/// Makes or continues a run.
///
/// # Errors
/// When the settings, the world, the styles, the folder or the ledger are wrong. An item that fails is a line of
/// `rejected.jsonl`, or of `errors.jsonl` where a later run may do better.
pub fn generate_into(folder: &Path, job: &Job, output: &Output) -> Result<Summary, Error> {
    Calls::ready(job, output)?;
    let platform = world::open(&job.settings)?;
    let plan = Plan::writing(job, platform.as_ref())?;
    let settings = &plan.settings()?;
    let mut run = RunFolder::open(folder, settings)?;
    let calls = plan.models.open(|| run.id(), output)?;
    let team = Team::new(settings, calls.as_ref())?;
    let Plan { items, styles, .. } = &plan;

    let names: Vec<String> = styles.iter().map(|measured| measured.style.name.clone()).collect();
    let left: Vec<&Item> = items.iter().filter(|item| !run.is_done(&item.id(), &names)).collect();
    if left.len() < items.len() {
        output.say(format_args!("continuing: {} of {} done", items.len() - left.len(), count(items.len(), "item")));
    }
    let bar = output.progress(items.len(), "items");
    bar.set_position((items.len() - left.len()) as u64);
    // What earlier commands did tells nothing of the pace.
    bar.reset_eta();
    if let Some(calls) = &calls {
        calls.stop_on_interrupt(output);
    }
    let mut stopped = None;
    let (mut unflushed, mut unmade) = (0, left.len());
    let workers = calls.as_ref().map_or_else(cores, Calls::workers);
    let making = |item: &&Item| make(item, settings, platform.as_ref(), &team, styles);
    in_order(&left, workers, making, |item, made| {
        match keep(&mut run, platform.as_ref(), item, made, styles)? {
            Fate::Kept => bar.inc(1),
            Fate::Stopped(reason) => {
                stopped = Some(reason);
                return Ok(false);
            }
        }
        unflushed += 1;
        if unflushed == FLUSH {
            run.sync()?;
            unflushed = 0;
        }
        bar.set_message(message(&run, calls.as_ref()));
        unmade -= 1;
        stopped = calls.as_ref().and_then(Calls::interrupted).filter(|_| unmade > 0);
        Ok::<_, Error>(stopped.is_none())
    })?;
    run.sync()?;
    bar.finish_and_clear();
    if let Some(calls) = &calls {
        calls.record()?;
    }
    summary::summary(folder, &run, items.len(), calls.as_ref().map(Calls::spent), stopped)
}

fn message(run: &RunFolder, calls: Option<&Calls>) -> String {
    let done = format!("{} written, {} rejected", run.instructions.len(), run.rejected.len());
    calls.map_or(done.clone(), |calls| format!("{done}; {}", calls.spent()))
}
