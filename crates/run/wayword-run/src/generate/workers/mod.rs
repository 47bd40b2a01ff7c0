//! `wayword generate` as one of many workers: makes chunks of a plan.

pub mod args;
mod board;
mod chunk;
mod planned;
mod told;

use super::{Workshop, refuse_impossible_paths, warn_of_no_effect};
use crate::{
    calls::{Calls, Keeping},
    error::{Error, Exit},
    follow::KnownScenes,
    generate::workers::args::AskedWorkers,
    interrupt,
    looking_for::Lookout,
    output::Output,
    plan::Plan,
    platforms,
    settings::{Job, Settings},
    stores::RunPlace,
    team::Team,
    usable, watch,
};
use board::Counter;
pub use board::Way;
use std::path::Path;
use told::{Planned, Worked};
use wayword_queue::{Finished, PLAN, work};

/// Why a worker stops although chunks are left.
pub(super) struct Why {
    reason: String,
    exit: Exit,
}

pub fn run(out: &Path, job: &Job, asked: &AskedWorkers, worker: &str, output: &Output) -> Result<Exit, Error> {
    let place = RunPlace::of(out)?;
    let out = place.folder();
    warn_of_no_effect(&job.settings, output);
    planned::refuse_other_folder(out)?;
    let kept = wayword_queue::Plan::find(out)?;
    let before = kept.as_ref().map(|kept| planned::settings_of(out, kept)).transpose()?;
    let service = board::part_of(&job.service, asked, output)?;
    // The list of recordings is filled in once this worker has its part.
    let mut job = Job { service, keeping: Keeping::Chunks(Vec::new()), ..job.clone() };
    if let Some(before) = &before {
        job.settings.left_out.clone_from(&before.left_out);
    }
    if !asked.plan {
        Calls::ready(&job, output)?;
    }
    let platform = platforms::open(&job.settings)?;
    if before.is_none() {
        job.settings = usable::settled(&job.settings, platform.as_ref(), output)?;
    }
    let plan = Plan::writing(&job, platform.as_ref())?;
    let settings = plan.settings()?;
    if before.is_none() {
        usable::tell_of_episodes(&settings, &plan.items, platform.as_ref(), output)?;
        refuse_impossible_paths(&plan.items, &settings, platform.as_ref())?;
        place.check()?;
        planned::put(out, &plan, &settings, asked)?;
        place.publish(PLAN)?;
    }
    // Another worker may have written the plan meanwhile, and the plan in the folder counts.
    let kept = kept.map_or_else(|| wayword_queue::Plan::of(out), Ok)?;
    planned::agree(place.named(), &kept, &plan, &settings, asked)?;
    if asked.plan {
        let told = Planned::of(place.named(), &kept);
        output.data(&told, &told);
        return Ok(Exit::Done);
    }
    watch::is_of_run(&kept.run);
    let worked = make_chunks(&place, &kept, &plan, &settings, asked, worker, output)?;
    output.data(&worked, &worked);
    Ok(worked.exit)
}

fn make_chunks(
    place: &RunPlace,
    kept: &wayword_queue::Plan,
    plan: &Plan<'_>,
    settings: &Settings,
    asked: &AskedWorkers,
    worker: &str,
    output: &Output,
) -> Result<Worked, Error> {
    let out = place.folder();
    if place.is_stored() && asked.shard.is_some() && !plan.models.is_empty() {
        return Err(Error::usage(
            format!("{}: a shard cannot keep the calls of models in an object store", place.named().display()),
            "give --queue DATABASE, which keeps them; or --out a folder that all workers share",
        ));
    }
    if asked.shard.is_some() {
        place.fetch_marks(kept)?;
    }
    let counter = Counter::open(place, kept, worker, asked)?;
    let job = Job { keeping: counter.kept_calls(), ..plan.job.clone() };
    let calls = Calls::open(&job, &kept.run, output)?;
    let lookout = Lookout::of(settings, calls.as_ref(), &plan.styles)?;
    let team = Team::new(settings, calls.as_ref(), plan.platform)?.with(lookout);
    let shop = Workshop { plan, settings, calls: calls.as_ref(), team: &team, scenes: KnownScenes::new() };
    let _graceful = interrupt::finish_first(calls.as_ref());
    let make = |claimed| watch::chunk(claimed, || chunk::make(out, kept, &shop, claimed, worker, output));
    let finished: Finished<Why> = counter.with(|board| place.sending(board, |board| work(board, make, interrupted)))?;
    counter.close()?;
    match asked.shard {
        // Others have finished chunks meanwhile.
        Some(_) => place.fetch_marks(kept)?,
        None => place.send_marks(kept)?,
    }
    Worked::of(place, kept, finished, calls.as_ref().map(Calls::spent))
}

fn interrupted() -> Option<Why> {
    interrupt::is_asked()
        .then(|| Why { reason: "interrupted: its chunk was handed back".to_owned(), exit: Exit::Interrupted })
}
