//! `wayword robustness`: writes the texts of a run again in changed worlds, and measures how much the texts change.

pub mod args;
mod arm;
mod base;
mod compared_sets;
mod eye;
mod figures;
mod other_path;
mod other_platform;
mod reader;
mod record;
mod scene_names;
mod screen;
mod world;
mod write_texts;

use crate::{demands::PlatformDemands, robustness::args::RobustnessArgs};
use arm::RobustnessArm;
use base::BaseRun;
use figures::RecordsByArm;
use other_platform::OtherPlatformScenes;
use record::{ArmPathRecord, UnchangedRecords, record_key};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path as FilePath, PathBuf},
};
use wayword_core::{Path, Platform};
use wayword_report::pages;
use wayword_report::pages::robustness::results::{RefusedChange, RobustnessResults};
use wayword_robustness::{Change, ChangeSetting, SightSource, ratio::BootstrapOptions, worlds::EyeQuality};
use wayword_run::{
    calls::ModelCalls,
    error::{CommandError, Exit},
    follow::KnownScenes,
    in_order::{core_count, in_order},
    interrupt,
    lookout::DetectorLookout,
    output::CommandOutput,
    own_format::OwnFormat,
    plan::JobModels,
    platforms::{self, RememberingPlatform},
    run_folder,
    run_folder::{Journal, hash_of_file, lines},
    settings::{AskedSettings, RolePlayer, RunJob, RunSettings},
    settings_file,
    team::RoleTeam,
    written_files::write_file,
};
use write_texts::{ArmContext, ArmTextWriter};

/// Names of the files in the folder, except `config.toml`.
mod file {
    /// The texts, a line for each arm and path.
    pub(super) const TEXTS: &str = "texts.jsonl";
    /// The results.
    pub(super) const RESULTS: &str = "robustness.json";
}

/// Level of the intervals.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// The settings with which a folder was begun. They stay the same, but more changes may be added later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RobustnessSettings {
    /// The run.
    run: PathBuf,
    /// Hash of its paths.
    walks: String,
    /// The scripted eye.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    eye: Option<String>,
    /// The names that the run's scenes have on other platforms.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    scene_names: scene_names::SceneNames,
    /// Only this many paths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    limit: Option<u32>,
    /// Seed of everything random.
    seed: u64,
}

impl OwnFormat for RobustnessSettings {
    const NAME: &str = "wayword-robustness/1";
}

/// Runs `wayword robustness`: writes the texts of a run again in changed worlds, and stores and prints how far they change.
///
/// # Errors
/// When the flags do not fit together, the run or its platform cannot be read, no change can be made, a model fails, or a file
/// cannot be written.
pub fn run_robustness(args: &RobustnessArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let changes = parse_changes(&args.change)?;
    if args.list {
        output.print_result(&screen::list_changes(), screen::format_change_list());
        return Ok(Exit::Done);
    }
    if !args.compared.is_empty() {
        let drawing = BootstrapOptions { resamples: args.resamples as usize, level: CONFIDENCE_LEVEL, seed: args.seed };
        let found = compared_sets::compare_sets(&args.compared, drawing)?;
        output.print_result(&found, &found);
        return Ok(Exit::Done);
    }
    let (Some(folder), Some(out)) = (&args.run, &args.out) else {
        return Err(CommandError::usage("a run and a folder are needed", "give --run DIR and --out DIR"));
    };
    let base = BaseRun::read_run(folder, args.limit)?;
    let eye = args.eye.as_deref().map(eye::parse_eye).transpose()?;
    if eye.is_some() && base.settings.roles.see != RolePlayer::Labels {
        let problem = format!(
            "--eye: in {} {} sees, and the eye would take its place",
            folder.display(),
            base.settings.roles.see
        );
        return Err(CommandError::usage(problem, "give a run in which labels see"));
    }
    let job = job_with_service(args, &base.settings)?;
    ModelCalls::check_ready(&job, output)?;
    let platform = platforms::open_platform(&job.settings)?;
    let (changes, refused) = sort_changes(changes, &change_setting(&base, platform.as_ref(), eye.is_some())?);
    for RefusedChange { reason, .. } in &refused {
        output.say(format_args!("not made: {reason}"));
    }
    if changes.is_empty() {
        return Err(CommandError::usage("no change is left to make", "see `wayword robustness --list`"));
    }
    let _folder_lock = begin_folder(args, &base, out)?;
    let id = run_folder::run_id_or_fresh(out, "robustness")?;
    let calls = JobModels::for_job(&job)?.open_calls(&id, output)?;
    if calls.is_some() {
        run_folder::keep_id(out, &id)?;
    }
    let failed = make_texts(args, &base, &changes, eye, (platform.as_ref(), calls.as_ref()), output)?;
    if let Some(calls) = &calls {
        calls.finish(output)?;
        output.say(format_args!("models: {}", calls.spent_so_far()));
    }
    let results = compute_results(args, &base, &changes, eye, refused, &read_text_records(out)?);
    let json = serde_json::to_string_pretty(&results).map_err(|error| {
        CommandError::usage(format!("the results cannot be written: {error}"), "report this as a bug")
    })?;
    write_file(&out.join(file::RESULTS), &json)?;
    pages::robustness::write_robustness(&out.join(run_folder::file::REPORT), &results)?;
    output.print_result(&results, screen::format_results(&results));
    output.say(format_args!("texts, figures and page: {}", out.display()));
    Ok(if failed == 0 { Exit::Done } else { Exit::WithLoss })
}

/// The changes that were typed, or the default set.
fn parse_changes(typed: &[String]) -> Result<Vec<Change>, CommandError> {
    let mut changes: Vec<Change> = Vec::new();
    for text in typed {
        let parsed = Change::parse_list(text).map_err(|error| {
            CommandError::usage(format!("--change {text}: {error}"), "see `wayword robustness --list`")
        })?;
        for change in parsed {
            if !changes.contains(&change) {
                changes.push(change);
            }
        }
    }
    Ok(if typed.is_empty() { Change::default_set() } else { changes })
}

/// The job of the run. Its models are reached as the flags and the settings file of this command require, and not as in the run.
fn job_with_service(args: &RobustnessArgs, settings: &RunSettings) -> Result<RunJob, CommandError> {
    let AskedSettings { service, providers, .. } = settings_file::read_call_settings(args.config.as_deref())?;
    let asked = AskedSettings { service: args.service.clone(), ..AskedSettings::default() };
    let asked = asked.or_file(AskedSettings { service, providers, ..AskedSettings::default() });
    Ok(RunJob { settings: settings.clone(), ..asked.into_job()? })
}

/// The properties of the run on which it depends which changes can be made.
fn change_setting<'a>(
    base: &'a BaseRun,
    platform: &dyn Platform,
    has_eye: bool,
) -> Result<ChangeSetting<'a>, CommandError> {
    let name = base.settings.platform.as_str();
    let graph =
        name == "matterport" || name == "process" && !platform.graph_for_scene(&base.paths[0].scene)?.is_empty();
    Ok(ChangeSetting {
        platform: name,
        sees: match &base.settings.roles.see {
            _ if has_eye => SightSource::Eye,
            RolePlayer::Labels => SightSource::Labels,
            _ => SightSource::Pictures,
        },
        has_poses: base.paths.iter().all(|path| path.motion.is_known()),
        can_render: !matches!(name, "matterport" | "recording"),
        is_graph_bound: graph,
    })
}

/// Separates the changes that can be made from the refused ones, which get a reason.
fn sort_changes(changes: Vec<Change>, setting: &ChangeSetting<'_>) -> (Vec<Change>, Vec<RefusedChange>) {
    let (mut made, mut refused) = (Vec::new(), Vec::new());
    for change in changes {
        let platform_reason =
            || if let Change::Platform(spec) = &change { other_platform::platform_refusal(spec) } else { None };
        match platform_reason().or_else(|| change.refusal_reason(setting)) {
            Some(reason) => refused.push(RefusedChange { change: change.to_string(), reason }),
            None => made.push(change),
        }
    }
    (made, refused)
}

/// Makes or continues the folder, and locks it against other processes.
fn begin_folder(args: &RobustnessArgs, base: &BaseRun, out: &FilePath) -> Result<run_folder::FolderLock, CommandError> {
    run_folder::expect_run_place(out)?;
    let folder = &base.folder;
    let kept = RobustnessSettings {
        run: folder.canonicalize().map_err(CommandError::io(folder, "find"))?,
        walks: hash_of_file(&folder.join(run_folder::file::WALKS))?,
        eye: args.eye.clone(),
        scene_names: scene_names::parse_names(&args.scene_name)?,
        limit: args.limit,
        seed: args.seed,
    };
    fs::create_dir_all(out).map_err(CommandError::io(out, "make the folder"))?;
    let held = run_folder::lock_folder(out)?;
    run_folder::keep_config(out, &kept)?;
    Ok(held)
}

/// Writes all texts that are not in the folder yet. Returns how many items failed.
fn make_texts(
    args: &RobustnessArgs,
    base: &BaseRun,
    changes: &[Change],
    eye: Option<EyeQuality>,
    (platform, calls): (&dyn Platform, Option<&ModelCalls>),
    output: &CommandOutput,
) -> Result<usize, CommandError> {
    let settings = &base.settings;
    let out = args.out.as_deref().unwrap_or(FilePath::new("."));
    let labels = RememberingPlatform::for_labels(platform);
    // If no model takes part, no pictures are needed, and all views of the run fit into memory.
    let world: &dyn Platform = if settings.roles.model_names().is_empty() { &labels } else { platform };
    let team = |sample| {
        let lookout = DetectorLookout::from_settings(settings, calls, &base.styles)?;
        Ok::<_, CommandError>(RoleTeam::for_sample(settings, calls, platform, sample)?.with_lookout(lookout))
    };
    let (team, again) = (team(0)?, team(1)?);
    let threads = calls.map_or(1, |calls| calls.views_at_once(base.paths.len()));
    let text_writer =
        ArmTextWriter { base, platform: world, team: &team, again: &again, eye, seed: args.seed, threads };
    let mut journal = Journal::open(&out.join(file::TEXTS), ArmPathRecord::key_of)?;
    let _interrupt_guard = interrupt::finish_items_first(calls);
    let workers = calls.map_or_else(core_count, ModelCalls::worker_count);
    let arms = RobustnessArm::for_changes(changes);
    let names = scene_names::parse_names(&args.scene_name)?;
    let bar = output.progress_bar(arms.len() * base.paths.len(), "texts");
    let mut failed = 0;
    let mut unchanged = UnchangedRecords::new();
    for arm in &arms {
        bar.set_message(arm.progress_label());
        let walked_platform = write_texts::walked_platform(arm, world);
        let unwritten: Vec<&Path> =
            base.paths.iter().filter(|path| !journal.has_key(&record_key(&arm.id(), &path.id))).collect();
        let elsewhere = match arm {
            RobustnessArm::Changed(Change::Platform(spec)) if !unwritten.is_empty() => {
                Some(OtherPlatformScenes::open(spec, base, platform, (out, &names))?)
            }
            _ => None,
        };
        let (scenes, demands) = (KnownScenes::new(), PlatformDemands::new(walked_platform.as_ref()));
        let context = ArmContext {
            arm,
            scenes,
            walk_platform: walked_platform.as_ref(),
            demands,
            elsewhere,
            unchanged: &unchanged,
        };
        bar.inc((base.paths.len() - unwritten.len()) as u64);
        let make = |path: &&Path| {
            interrupt::check_interrupt()?;
            text_writer.make_record(&context, path)
        };
        let mut keep = |path: &&Path, made: Result<ArmPathRecord, CommandError>| {
            bar.inc(1);
            match made {
                Ok(line) => journal.append(&line)?,
                Err(error) if error.item_failure().is_none() => return Err(error),
                Err(error) => {
                    failed += 1;
                    output.say(format_args!("{}, path {}: {error}", arm.progress_label(), path.id));
                }
            }
            Ok(true)
        };
        if context.elsewhere.is_some() {
            // A simulator shows one scene at a time, and takes seconds to show another.
            for paths in by_scene(unwritten) {
                in_order(&paths, workers, make, &mut keep)?;
            }
        } else {
            in_order(&unwritten, workers, make, &mut keep)?;
        }
        if *arm == RobustnessArm::Unchanged {
            unchanged = read_text_records(out)?.remove(&arm.id()).unwrap_or_default();
        }
    }
    bar.finish_and_clear();
    journal.sync()?;
    Ok(failed)
}

/// Groups paths by scene.
fn by_scene(paths: Vec<&Path>) -> impl Iterator<Item = Vec<&Path>> {
    let mut scenes: BTreeMap<_, Vec<&Path>> = BTreeMap::new();
    for path in paths {
        scenes.entry(&path.scene).or_default().push(path);
    }
    scenes.into_values()
}

/// Reads all lines of `texts.jsonl`, by arm and path.
fn read_text_records(out: &FilePath) -> Result<RecordsByArm, CommandError> {
    let mut all = RecordsByArm::new();
    lines::each_line(&out.join(file::TEXTS), |line| {
        let line: ArmPathRecord = line.parse()?;
        all.entry(line.arm.clone()).or_default().insert(line.path.id.clone(), line);
        Ok(())
    })?;
    Ok(all)
}

/// Computes all figures from the lines.
fn compute_results(
    args: &RobustnessArgs,
    base: &BaseRun,
    changes: &[Change],
    eye: Option<EyeQuality>,
    refused: Vec<RefusedChange>,
    lines: &RecordsByArm,
) -> RobustnessResults {
    let drawing = BootstrapOptions { resamples: args.resamples as usize, level: CONFIDENCE_LEVEL, seed: args.seed };
    let unchanged = lines.get(&RobustnessArm::Unchanged.id());
    let texts = unchanged.into_iter().flat_map(BTreeMap::values).flat_map(|line| {
        line.texts.iter().map(|arm_text| (line.path.id.as_str(), arm_text.style.as_str(), arm_text.text.as_deref()))
    });
    let roles = &base.settings.roles;
    let styles =
        base.styles.iter().map(|style| figures::figures_for_style(base, &style.style.name, changes, lines, drawing));
    let sees = eye.map_or_else(|| format!("Who sees: {}", roles.see), |eye| eye::describe_eye(&eye));
    RobustnessResults {
        platform: base.settings.platform.clone(),
        roles: format!("{sees}; who writes: {}", roles.write),
        paths: base.paths.len(),
        scenes: base.paths.iter().map(|path| &path.scene).collect::<BTreeSet<_>>().len(),
        again: base.count_equal_texts(texts),
        agent: reader::READER_AGENT_NAME.to_owned(),
        level: CONFIDENCE_LEVEL,
        styles: styles.collect(),
        refused,
    }
}
