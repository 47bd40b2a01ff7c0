//! `wayword generate`: makes or continues a run in a folder, or this worker's part of one.

pub mod args;
mod fill;
mod house_spread;
mod item_span;
mod keep;
mod pace;
mod prepare;
mod progress;
mod summary;
pub mod workers;

use crate::{
    calls::ModelCalls,
    error::{CommandError, Exit},
    follow::KnownScenes,
    generate::args::GenerateArgs,
    interrupt,
    lookout::DetectorLookout,
    output::CommandOutput,
    plan::RunPlan,
    platforms::has_hops,
    run_folder::{RunFolder, WorldData, continued_settings, expect_run_place, is_begun, keep_id, run_id_or_fresh},
    settings::{Perception, RunJob, RunSettings, TargetMode},
    settings_file, stores,
    styles::MeasuredStyle,
    team::RoleTeam,
    watch::{self, CommandWatch},
    written_files::expect_output_folder,
};
use fill::ItemWorkshop;
use prepare::{ModelCheck, PreparedRun};
use std::path::Path;
use wayword_core::PathRequest;
use wayword_synthesis::dialogue::DEFAULT_MAX_QUESTIONS;

pub use summary::{DetectorSummary, RunSummary};
pub use workers::{CHUNK_FILES, CheckedChunks, ChunkChecker, ChunkDamage, ChunkHandout, ChunkedItems};

/// Runs `wayword generate`: makes a run or this worker's part of it, or estimates the cost with `--dry-run`.
///
/// # Errors
/// When the settings or the flags do not fit together, a model is not ready, and as [`generate_into`].
pub fn run_generate(args: &GenerateArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let job = args.asked.clone().or_file(settings_file::read_settings(args.config.as_deref())?).into_job()?;
    if args.dry_run {
        let prepared = PreparedRun::open(&job, None, ModelCheck::Rehearsal, output)?;
        let plan = prepared.plan_run(output)?;
        let chunk = args.workers.is_asked().then(|| args.workers.chunk_items(plan.items.len(), None));
        let estimate = plan.estimate_calls(chunk)?;
        say_house_spread(&plan, output);
        output.print_result(&estimate, &estimate);
        return Ok(Exit::Done);
    }
    let out = args.out.as_deref().ok_or_else(|| {
        CommandError::usage("a run needs a folder", "give --out DIR, or --dry-run to see what the run would cost")
    })?;
    args.spans.as_deref().map_or(Ok(()), expect_output_folder)?;
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
    expect_run_place(out)?;
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
    if settings.episodes.is_some() && settings.request != PathRequest::default() {
        output.say(
            "warning: --hops and --metres have no effect with --episodes, because its paths are given; leave them out",
        );
    }
    let asks_questions = matches!(settings.perception, Perception::Dialogue | Perception::FollowUp);
    if settings.questions != DEFAULT_MAX_QUESTIONS && !asks_questions {
        output.say("warning: --questions has no effect without --perception dialogue or follow-up");
    }
    let cannot_follow = settings.no_route || !settings.evidence.labels || settings.platform == "recording";
    if settings.candidates > 1 && cannot_follow && settings.roles.write.model_name().is_some() {
        output.say(format_args!(
            "warning: {} texts are paid for for each text that is kept, but only the checks can choose between them, because the texts are not \
             followed (that needs labels of the scene, and no --no-route); --candidates 1 costs less",
            settings.candidates
        ));
    }
}

/// Says how many generated houses the random paths of a run lie in.
fn say_house_spread(plan: &RunPlan<'_>, output: &CommandOutput) {
    house_spread::house_spread(&plan.job.settings, &plan.items).iter().for_each(|spread| output.say(spread));
}

/// Warns of styles that do not fit the run: with reference texts in another language than English, or without a task whose target
/// could be free.
fn warn_of_styles(settings: &RunSettings, styles: &[MeasuredStyle], output: &CommandOutput) {
    for style in styles {
        if let Some(foreign) = style.foreign_references().filter(|_| style.style.language.is_empty()) {
            output.say(format_args!(
                "warning: the reference texts of style {} are in {}, which the checks do not read, so texts in it stay unverified",
                style.style.name, foreign.language
            ));
        }
    }
    let has_task = styles.iter().any(|style| style.style.constraints.ends_in_task);
    if settings.target == TargetMode::Free && !has_task {
        output.say("warning: --target free has no effect, because no style of this run ends in a task");
    }
}

/// Makes or continues a run.
///
/// # Errors
/// When the settings, the platform, the styles, the folder or the ledger are wrong. An item that fails is a line of
/// `errors.jsonl`, and the next command tries it again.
pub fn generate_into(folder: &Path, job: &RunJob, output: &CommandOutput) -> Result<RunSummary, CommandError> {
    expect_run_place(folder)?;
    warn_of_no_effect(&job.settings, output);
    let continued = is_begun(folder).then(|| continued_settings(folder, &job.settings)).transpose()?;
    // An unreadable recording is reported before models that cannot be called, because the user would start these in vain.
    let is_recording = job.settings.platform == "recording";
    let check = if is_recording { ModelCheck::ReadyLast } else { ModelCheck::ReadyFirst };
    let prepared = PreparedRun::open(job, continued, check, output)?;
    let (plan, settings) = &prepared.plan_with_settings(output)?;
    warn_of_styles(settings, &plan.styles, output);
    // A new folder is made after the models are loaded, so that a model that does not fit into the memory leaves none.
    let begun = is_begun(folder).then(|| RunFolder::open(folder, settings)).transpose()?;
    let id = run_id_or_fresh(folder, "run")?;
    watch::record_run_id(&id);
    let calls = plan.models.open_calls(&id, output)?;
    let RunPlan { items, styles, .. } = plan;
    let lookout = DetectorLookout::from_settings(settings, calls.as_ref(), styles)?;
    let team = RoleTeam::new(settings, calls.as_ref(), plan.platform)?.with_lookout(lookout);
    let mut run = begun.map_or_else(|| RunFolder::open(folder, settings), Ok)?;
    // A run without models spends no money and needs no id. Without one, the same run gives the same folder byte for byte.
    if calls.is_some() {
        keep_id(folder, &id)?;
    }
    let data = WorldData::from_folder(folder)?;
    say_house_spread(plan, output);

    let shop = ItemWorkshop { plan, settings, calls: calls.as_ref(), team: &team, scenes: KnownScenes::new() };
    let _graceful = interrupt::finish_items_first(calls.as_ref());
    let stopped = shop.fill_folder(&mut run, &data, items, output)?;
    if let Some(calls) = &calls {
        calls.finish(output)?;
    }
    let mut summary =
        summary::summarise_run(folder, &run, items.len(), calls.as_ref().map(ModelCalls::spent_so_far), stopped)?;
    summary.detector = team.lookout().map(DetectorSummary::from_lookout);
    summary.left_out = settings.left_out.clone();
    summary.calibration = settings.calibration.as_ref().map(|file| file.display().to_string());
    Ok(summary)
}
