//! `wayword generate`: makes or continues a run in a folder, or this worker's part of one.

pub mod args;
mod fill;
mod item_span;
mod keep;
mod pace;
mod progress;
mod summary;
pub mod workers;

use crate::{
    calls::ModelCalls,
    error::{CommandError, Exit},
    follow::KnownScenes,
    generate::args::GenerateArgs,
    interrupt,
    item::RunItem,
    lookout::DetectorLookout,
    output::CommandOutput,
    plan::RunPlan,
    platforms::{self, has_hops},
    run_folder::{RunFolder, WorldData, continued_settings, id_of, is_begun, keep_id, refuse_file},
    scene_selection,
    settings::{RunJob, RunSettings},
    settings_file as config, stores,
    team::RoleTeam,
    watch::{self, CommandWatch},
};
use fill::ItemWorkshop;
use std::path::Path;
use wayword_core::{PathRequest, Platform, PlatformError};

pub use summary::{DetectorSummary, RunSummary};
pub use workers::ChunkHandout;

pub fn run_generate(args: &GenerateArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let job = args.asked.clone().or_file(config::read_settings(args.config.as_deref())?).into_job()?;
    if args.dry_run {
        ModelCalls::rehearse_job(&job)?;
        let platform = platforms::open_platform(&job.settings)?;
        let job =
            RunJob { settings: scene_selection::settle_left_out(&job.settings, platform.as_ref(), output)?, ..job };
        let chunk = args.workers.is_asked().then(|| args.workers.chunk_items());
        let estimate = RunPlan::for_writing(&job, platform.as_ref())?.estimate_calls(chunk)?;
        output.print_result(&estimate, &estimate);
        return Ok(Exit::Done);
    }
    let out = args.out.as_deref().ok_or_else(|| {
        CommandError::usage("a run needs a folder", "give --out DIR, or --dry-run to see what the run would cost")
    })?;
    let watch = CommandWatch::start(args.spans.as_deref(), output)?;
    watch.watch_work(|worker| make_run(args, out, &job, worker, output))
}

/// Makes a run, or this worker's part of it.
fn make_run(
    args: &GenerateArgs,
    out: &Path,
    job: &RunJob,
    worker: &str,
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    if args.workers.is_asked() {
        return workers::run_worker(out, job, &args.workers, worker, output);
    }
    // A run of one machine appends lines to files, which object stores cannot do.
    stores::refuse_address(
        out,
        "a run of one machine cannot lie in an object store",
        "give --queue or --shard 0/1, whose chunks are sent when they are finished; or name a folder",
    )?;
    if wayword_queue::ChunkPlan::find_plan(out)?.is_some() && !is_begun(out) {
        return Err(CommandError::usage(
            format!("{} holds a run that workers make", out.display()),
            "give --shard or --queue to make a part of it, or another --out",
        ));
    }
    let summary = generate_into(out, job, output)?;
    output.print_result(&summary, &summary);
    Ok(summary.exit)
}

/// Warns of settings that this run ignores.
fn warn_of_no_effect(settings: &RunSettings, output: &CommandOutput) {
    let asks_hops = settings.request.hops != PathRequest::default().hops;
    if asks_hops && settings.episodes.is_none() && !has_hops(settings) {
        output.say(format_args!(
            "warning: --hops has no effect, because paths of platform {} have no hops; use --metres",
            settings.platform
        ));
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

/// Makes or continues a run.
///
/// # Errors
/// When the settings, the platform, the styles, the folder or the ledger are wrong. An item that fails is a line of
/// `errors.jsonl`, and the next command tries it again.
pub fn generate_into(folder: &Path, job: &RunJob, output: &CommandOutput) -> Result<RunSummary, CommandError> {
    warn_of_no_effect(&job.settings, output);
    let job = &RunJob { settings: continued_settings(folder, &job.settings)?, ..job.clone() };
    // An unreadable recording is reported before models that cannot be called, because the user would start these in vain.
    let is_recording = job.settings.platform == "recording";
    if !is_recording {
        ModelCalls::check_ready(job, output)?;
    }
    let platform = platforms::open_platform(&job.settings)?;
    let is_new = !is_begun(folder);
    let mut job = job.clone();
    if is_new {
        job.settings = scene_selection::settle_left_out(&job.settings, platform.as_ref(), output)?;
    }
    let job = &job;
    let plan = RunPlan::for_writing(job, platform.as_ref())?;
    if is_recording {
        ModelCalls::check_ready(job, output)?;
    }
    let settings = &plan.settings_with_hashes()?;
    if is_new {
        scene_selection::tell_of_episodes(settings, &plan.items, platform.as_ref(), output)?;
        refuse_impossible_paths(&plan.items, settings, platform.as_ref())?;
    }
    // A new folder is made after the models are loaded, so that a model that does not fit into the memory leaves none.
    refuse_file(folder)?;
    let begun = is_begun(folder).then(|| RunFolder::open(folder, settings)).transpose()?;
    let id = id_of(folder, "run")?;
    watch::is_of_run(&id);
    let calls = plan.models.open_calls(&id, output)?;
    let RunPlan { items, styles, .. } = &plan;
    let lookout = DetectorLookout::from_settings(settings, calls.as_ref(), styles)?;
    let team = RoleTeam::new(settings, calls.as_ref(), platform.as_ref())?.with_lookout(lookout);
    let mut run = begun.map_or_else(|| RunFolder::open(folder, settings), Ok)?;
    // A run without models spends no money and needs no id. Without one, the same run gives the same folder byte for byte.
    if calls.is_some() {
        keep_id(folder, &id)?;
    }
    let data = WorldData::from_folder(folder)?;

    let shop = ItemWorkshop { plan: &plan, settings, calls: calls.as_ref(), team: &team, scenes: KnownScenes::new() };
    let _graceful = interrupt::finish_first(calls.as_ref());
    let stopped = shop.fill_folder(&mut run, &data, items, output)?;
    if let Some(calls) = &calls {
        calls.write_recording()?;
    }
    let mut summary =
        summary::summarise_run(folder, &run, items.len(), calls.as_ref().map(ModelCalls::spent_so_far), stopped)?;
    summary.detector = team.lookout().map(DetectorSummary::from_lookout);
    summary.left_out = settings.left_out.clone();
    summary.calibration = settings.calibration.as_ref().map(|file| file.display().to_string());
    Ok(summary)
}
