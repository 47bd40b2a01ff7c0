//! `wayword generate` as one of many workers: makes chunks of a plan.

pub mod args;
mod board;
mod chunk;
mod chunk_check;
mod plan_file;
mod summaries;
mod work_spread;

use super::{
    ItemWorkshop,
    prepare::{ModelCheck, PreparedRun},
    say_house_spread, warn_of_no_effect,
};
use crate::{
    calls::{CallKeeping, ModelCalls},
    error::{CommandError, Exit},
    follow::KnownScenes,
    generate::workers::args::AskedWorkers,
    interrupt,
    lookout::DetectorLookout,
    output::CommandOutput,
    plan::RunPlan,
    settings::{RunJob, RunSettings},
    stores::RunPlace,
    team::RoleTeam,
    watch,
};
pub use board::ChunkHandout;
use board::WorkerBoard;
pub use chunk_check::{CHUNK_FILES, CheckedChunks, ChunkChecker, ChunkDamage};
use std::path::Path;
use summaries::{PlanSummary, WorkerSummary};
use wayword_queue::{PLAN, WorkSummary, work_chunks};
pub use work_spread::ChunkedItems;

/// Why a worker stops although chunks are left.
pub(super) struct WorkerStop {
    /// The reason, for the user.
    reason: String,
    /// The exit code that goes with it.
    exit: Exit,
}

/// Writes the plan of a run that workers share, or makes this worker's part of it, and prints how far it came.
///
/// # Errors
/// When the settings differ from those of the plan, the folder, the queue or the platform cannot be used, or a model is not ready.
pub fn run_worker(
    out: &Path,
    job: &RunJob,
    asked: &AskedWorkers,
    worker: &str,
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    let place = RunPlace::open_named(out)?;
    let out = place.folder();
    warn_of_no_effect(&job.settings, output);
    plan_file::refuse_other_folder(out)?;
    let kept = wayword_queue::ChunkPlan::find_plan(out)?;
    let before = kept.as_ref().map(|kept| plan_file::settings_in_plan(out, kept)).transpose()?;
    let warn_idle = |items: ChunkedItems| {
        let warning = asked.shard.and_then(|part| items.idle_warning(part.n));
        warning.iter().for_each(|warning| output.say(warning));
    };
    // Known at once, and before models are loaded.
    kept.iter().for_each(|kept| warn_idle(ChunkedItems::of_plan(kept)));
    let service = board::worker_service(&job.service, asked, output)?;
    // The list of recordings is filled in once this worker has its part.
    let job = RunJob { service, keeping: CallKeeping::Chunks(Vec::new()), ..job.clone() };
    let continued = before.map(|before| RunSettings { left_out: before.left_out, ..job.settings.clone() });
    let check = if asked.plan { ModelCheck::PlanAlone } else { ModelCheck::ReadyFirst };
    let prepared = PreparedRun::open(&job, continued, check, output)?;
    let (plan, settings) = &prepared.plan_with_settings(output)?;
    if prepared.is_new {
        let items = plan.items.len();
        warn_idle(ChunkedItems { items, chunk: asked.chunk_items(items, None), is_planned: false });
        place.check_store()?;
        plan_file::write_plan(out, plan, settings, asked)?;
        place.publish_file(PLAN)?;
    }
    // Another worker may have written the plan meanwhile, and the plan in the folder counts.
    let kept = kept.map_or_else(|| wayword_queue::ChunkPlan::for_folder(out), Ok)?;
    plan_file::check_agreement(place.shown_path(), &kept, plan, settings, asked)?;
    if asked.plan {
        say_house_spread(plan, output);
        let summary = PlanSummary::from_plan(place.shown_path(), &kept);
        output.print_result(&summary, &summary);
        return Ok(Exit::Done);
    }
    watch::record_run_id(&kept.run);
    let worked = make_chunks(&place, &kept, plan, settings, asked, worker, output)?;
    output.print_result(&worked, &worked);
    Ok(worked.exit)
}

/// Makes chunks until the board has none for this worker, or the worker has to stop. `kept` is the plan in the folder,
/// which all workers share; `plan` has the items of this worker's own settings, which agree with it.
fn make_chunks(
    place: &RunPlace,
    kept: &wayword_queue::ChunkPlan,
    plan: &RunPlan<'_>,
    settings: &RunSettings,
    asked: &AskedWorkers,
    worker: &str,
    output: &CommandOutput,
) -> Result<WorkerSummary, CommandError> {
    let out = place.folder();
    if place.is_stored() && asked.shard.is_some() && !plan.models.is_empty() {
        return Err(CommandError::usage(
            format!("{}: a shard cannot keep the calls of models in an object store", place.shown_path().display()),
            "give --queue DATABASE, which keeps them; or --out a folder that all workers share",
        ));
    }
    if asked.shard.is_some() {
        place.fetch_marks(kept)?;
    }
    let worker_board = WorkerBoard::open(place, kept, worker, asked)?;
    let idle_warning =
        worker_board.worker_count()?.and_then(|workers| ChunkedItems::of_plan(kept).idle_warning(workers));
    idle_warning.iter().for_each(|warning| output.say(warning));
    let job = RunJob { keeping: worker_board.kept_calls(), ..plan.job.clone() };
    let calls = ModelCalls::open(&job, &kept.run, output)?;
    let lookout = DetectorLookout::from_settings(settings, calls.as_ref(), &plan.styles)?;
    let team = RoleTeam::new(settings, calls.as_ref(), plan.platform)?.with_lookout(lookout);
    say_house_spread(plan, output);
    let shop = ItemWorkshop { plan, settings, calls: calls.as_ref(), team: &team, scenes: KnownScenes::new() };
    let _graceful = interrupt::finish_items_first(calls.as_ref());
    let make =
        |claimed| watch::within_chunk_span(claimed, || chunk::make_chunk(out, kept, &shop, claimed, worker, output));
    let finished: WorkSummary<WorkerStop> =
        worker_board.with_board(|board| place.with_sending(board, |board| work_chunks(board, make, interrupt_stop)))?;
    worker_board.write_missing_marks()?;
    match asked.shard {
        // Others have finished chunks meanwhile.
        Some(_) => place.fetch_marks(kept)?,
        None => place.send_marks(kept)?,
    }
    WorkerSummary::from_finished(place, kept, finished, calls.as_ref().map(ModelCalls::spent_so_far))
}

fn interrupt_stop() -> Option<WorkerStop> {
    interrupt::is_interrupted().then(|| WorkerStop {
        reason: "interrupted: its chunk was handed back with the items made so far; the same command goes on"
            .to_owned(),
        exit: Exit::Interrupted,
    })
}
