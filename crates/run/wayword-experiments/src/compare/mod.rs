//! `wayword compare`: agents walk by the texts of several sets, and their success shows which texts guide best.

mod agents;
pub mod args;
mod estimate;
mod grounders;
mod instruction_sets;
mod make_walks;
mod outputs;
mod page;
mod score;
mod settings;
mod thresholds;
pub mod tool_agent_eyes;
mod tools;

use crate::{compare::args::CompareArgs, demands::PlatformDemands};
use agents::WalkingAgent;
use estimate::ComparisonEstimate;
use grounders::ComparisonGrounders;
use instruction_sets::ComparisonItem;
use make_walks::ItemWalkMaker;
use outputs::ComparisonOutputs;
use score::WalkJudge;
use std::{fs, path::Path};
use tools::{AgentToolbox, WithheldWalks};
use wayword_core::{FailureKind, ModelError, RecentCache};
use wayword_navigation::{
    WalkError,
    directions::{InstructionSplitter, ModelSplitter, RuleSplitter},
};
use wayword_run::{
    calls::ModelCalls,
    count::count_phrase,
    error::{CommandError, Exit},
    in_order::{core_count, in_order},
    interrupt,
    losses::LossCounter,
    output::CommandOutput,
    plan::JobModels,
    platforms::MAX_KEPT_SURVEYS,
    run_folder,
    run_folder::Journal,
    settings::RolePlayer,
    settings_file,
    text_language::warn_of_foreign,
};

pub(crate) use outputs::followed_set;
pub use page::write_page_from_folder;
pub(crate) use settings::ComparisonSettings;

/// Names of the files in a comparison's folder, except `config.toml`.
pub(crate) mod file {
    /// The walks, one line each.
    pub(crate) const WALKS: &str = "walks.jsonl";
    /// The result.
    pub(crate) const COMPARISON: &str = "comparison.json";
    /// The success of each walk, one line each, for `robustness --compared`.
    pub(crate) const FOLLOWED: &str = "followed.jsonl";
    /// The tables.
    pub(super) const MARKDOWN: &str = "comparison.md";
    pub(super) const LATEX: &str = "comparison.tex";
    /// The agents' trajectories as evaluators take them.
    pub(super) const SUBMISSIONS: &str = "submissions";
}

/// The command gives up when this many items have failed and none was walked.
const MAX_FRUITLESS_ITEMS: usize = 20;

/// Items between two flushes to the disk.
const ITEMS_PER_FLUSH: usize = 16;

/// Runs `wayword compare`: makes or continues the walks, writes tables and page, and prints the result.
///
/// # Errors
/// When the flags do not fit together, a set cannot be read, or no item could be walked.
pub fn run_comparison(args: &CompareArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    if let Some(file) = &args.calibration {
        let problem = format!(
            "--calibration {} has no effect: no agent judges claims by what labels do not list",
            file.display()
        );
        return Err(CommandError::usage(problem, "leave it out; `wayword check` and `wayword generate` take it"));
    }
    settings::refuse_flags_of_tools(args)?;
    let job = args.asked_settings().or_file(settings_file::read_call_settings(args.config.as_deref())?).into_job()?;
    let config = ComparisonSettings::from_args(args, &job.settings)?;
    let models = JobModels::for_job(&job)?;
    tools::refuse_unknown_price(&config, &models)?;
    if !args.dry_run {
        ModelCalls::check_ready(&job, output)?;
    }
    let platform = config.open_platform()?;
    let demands = PlatformDemands::new(platform.as_ref());
    let (items, sizes, episode_count) = instruction_sets::load_items(&config, platform.as_ref(), &demands)?;
    for (set, _) in &config.instructions {
        let texts = items.iter().flat_map(|item| &item.texts).filter(|text| text.set == *set);
        warn_of_foreign(&format!(" of set {set}"), texts.map(|text| text.text.as_str()), output);
    }
    let judge = WalkJudge::new(&config, &items, &demands, args.rule.map(Into::into))?;
    if let Some(item) = judge.without_object.filter(|_| args.rule.is_none()) {
        output.say(format_args!(
            "success is judged by distance, because not every item names an object whose place is known, such as {item}"
        ));
    }
    let agents = WalkingAgent::all_for_comparison(&config, args.prior.unwrap_or_default());
    if args.dry_run {
        let estimate =
            ComparisonEstimate::for_comparison(&config, &job.settings, &items, &agents, (platform.as_ref(), &models))?;
        output.print_result(&estimate, &estimate);
        return Ok(Exit::Done);
    }
    if config.tools.is_some() {
        tools::warn_of_long_texts(&items, output);
    }
    let grounders = ComparisonGrounders::open(&config, output)?;
    // A folder that exists is locked now. A new one is made after the models are loaded, so that a model that does not fit into
    // the memory leaves no folder.
    run_folder::expect_run_place(&args.out)?;
    let old_folder_lock = run_folder::is_begun(&args.out).then(|| begin_folder(&args.out, &config)).transpose()?;
    let id = run_folder::run_id_or_fresh(&args.out, "compare")?;
    let calls = models.open_calls(&id, output)?;
    let grounders = grounders.with_detector(&config, calls.as_ref())?;
    let splitter = open_splitter(&config.split, calls.as_ref())?;
    let _folder_lock = old_folder_lock.map_or_else(|| begin_folder(&args.out, &config), Ok)?;
    if calls.is_some() {
        run_folder::keep_id(&args.out, &id)?;
    }
    let toolbox =
        AgentToolbox::open(&config, &job.settings, (calls.as_ref(), &models, items.len()), platform.as_ref())?;
    let surveys = RecentCache::new(MAX_KEPT_SURVEYS);
    let walk_maker = ItemWalkMaker {
        platform: platform.as_ref(),
        grounders: &grounders,
        splitter: splitter.as_ref(),
        agents: &agents,
        toolbox: toolbox.as_ref(),
        surveys: &surveys,
        seed: config.seed,
    };
    let failed = walk_all(&args.out, &items, &walk_maker, calls.as_ref(), output)?;
    if let Some(calls) = &calls {
        calls.finish(output)?;
        output.say(format_args!("models: {}", calls.spent_so_far()));
    }
    let gathered = ComparisonOutputs::from_folder(&args.out, &judge)?;
    if gathered.results.count_items_and_paths().0 == 0 {
        let problem = "no item could be walked: a model failed on every one of them";
        return Err(CommandError::usage(problem, "see the reasons above; give the same command again to try again"));
    }
    let sets = instruction_sets::describe_sets(&config, &items, &sizes, |item| gathered.results.has_item(item));
    let (resamples, results) = (args.resamples as usize, &gathered.results);
    let comparison = score::build_comparison(&config, &walk_maker, sets, &judge, results, (resamples, failed));
    outputs::write_outputs(&args.out, &comparison, &gathered)?;
    let page = args.out.join(run_folder::file::REPORT);
    page::write_page(&args.out, &page, &comparison, &judge, platform.as_ref(), args.replays)?;
    output.print_result(&comparison, wayword_report::pages::comparison::screen_text(&comparison));
    output.say(format_args!("walks, tables and page: {}", args.out.display()));
    let walked = gathered.results.count_items_and_paths().0;
    if walked < episode_count {
        let all_items = count_phrase(episode_count, "item");
        output.say(format_args!(
            "the submissions cover {walked} of {all_items}; score them with `wayword evaluate --partial`"
        ));
    }
    Ok(if failed == 0 { Exit::Done } else { Exit::WithLoss })
}

/// Makes or continues the folder, and locks it against other processes.
fn begin_folder(folder: &Path, config: &ComparisonSettings) -> Result<run_folder::FolderLock, CommandError> {
    fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the folder"))?;
    let held = run_folder::lock_folder(folder)?;
    run_folder::keep_config(folder, config)?;
    Ok(held)
}

/// Opens the splitter that takes instructions apart into phrases.
fn open_splitter(
    player: &RolePlayer,
    calls: Option<&ModelCalls>,
) -> Result<Box<dyn InstructionSplitter>, CommandError> {
    match calls.zip(player.model_name()) {
        Some((calls, name)) => Ok(Box::new(ModelSplitter::new(calls.open_model(name)?))),
        None => Ok(Box::new(RuleSplitter)),
    }
}

/// Makes the walks that are not in the folder yet. Returns how many items failed.
fn walk_all(
    folder: &Path,
    items: &[ComparisonItem],
    walk_maker: &ItemWalkMaker<'_>,
    calls: Option<&ModelCalls>,
    output: &CommandOutput,
) -> Result<usize, CommandError> {
    let mut walks = Journal::open(&folder.join(file::WALKS), walk_line_key)?;
    let is_done = |item: &&ComparisonItem| {
        let mut names = walk_maker.walk_names(item).into_iter();
        names
            .all(|(agent, set, text_index)| walks.has_key(&walk_key(&agent, &set, &item.episode.id, text_index as u64)))
    };
    let unwalked: Vec<&ComparisonItem> = items.iter().filter(|item| !is_done(item)).collect();
    if unwalked.len() < items.len() {
        output.say(format_args!(
            "continuing: {} of {} done",
            items.len() - unwalked.len(),
            count_phrase(items.len(), "item")
        ));
    }
    let _interrupt_guard = interrupt::finish_items_first(calls);
    let bar = output.progress_bar(items.len(), "items");
    bar.set_position((items.len() - unwalked.len()) as u64);
    bar.reset_eta();
    let (mut walked, mut failed, mut unflushed) = (0, 0, 0);
    let mut losses = LossCounter::default();
    let mut held_back = WithheldWalks::default();
    let workers = calls.map_or_else(core_count, ModelCalls::worker_count);
    in_order(
        &unwalked,
        workers,
        |item| walk_maker.make_walks(item),
        |item, made| {
            bar.inc(1);
            let is_service_gone = losses.ends_command(made.as_ref().err().and_then(model_failure));
            match made {
                Ok(made) => {
                    walked += 1;
                    held_back.take_walks(made)?.iter().flatten().try_for_each(|walk| walks.append(walk))?;
                }
                // The service is gone: the other items would wait for it too.
                Err(error) if is_service_gone => return Err(error.into()),
                Err(error) if concerns_one_item(&error) && walked == 0 && failed + 1 == MAX_FRUITLESS_ITEMS => {
                    return Err(error.into());
                }
                Err(error) if concerns_one_item(&error) => {
                    failed += 1;
                    output.say(format_args!("item {}: {error}", item.episode.id));
                }
                Err(error) => return Err(error.into()),
            }
            unflushed += 1;
            if unflushed == ITEMS_PER_FLUSH {
                walks.sync()?;
                unflushed = 0;
            }
            interrupt::check_interrupt().map(|()| true)
        },
    )?;
    held_back.into_rest().iter().flatten().try_for_each(|walk| walks.append(walk))?;
    walks.sync()?;
    bar.finish_and_clear();
    Ok(failed)
}

/// The kind of the failure, if a model failed; `None` for other errors.
fn model_failure(error: &WalkError) -> Option<FailureKind> {
    match error {
        WalkError::Model(error) => Some(error.failure_kind()),
        _ => None,
    }
}

/// Whether a failure concerns one item only, so that the others may still be walked.
fn concerns_one_item(error: &WalkError) -> bool {
    matches!(error, WalkError::Model(ModelError::Failed { .. } | ModelError::Lost { .. }))
}

/// The key of a walk's line.
fn walk_line_key(line: &serde_json::Value) -> Option<String> {
    let text = |field: &str| line.get(field)?.as_str();
    Some(walk_key(text("agent")?, text("set")?, text("item")?, line.get("text_index")?.as_u64()?))
}

fn walk_key(agent: &str, set: &str, item: &str, text_index: u64) -> String {
    format!("{agent}\n{set}\n{item}\n{text_index}")
}
