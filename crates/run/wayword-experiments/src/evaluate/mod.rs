//! `wayword evaluate`: scores a file of trajectories as the official evaluators of R2R and REVERIE do.

pub mod args;
mod figures;
mod refusal;

use crate::{
    episodes,
    evaluate::args::EvaluateArgs as Args,
    judge::{SubmissionScores, TrajectoryJudge},
};
use figures::{SubmissionReport, SubmissionResampling};
use refusal::{SubmissionRefusal, wrong_file_error};
use std::{collections::BTreeSet, path::Path};
use wayword_core::{Platform, PlatformError, graph::GraphError};
use wayword_formats::{
    DatasetFormat, Episode, detect_format,
    submission::{self, InstructionNaming, instr_id, name_as_episodes},
};
use wayword_metrics::TrajectorySuccessRule;
use wayword_run::{
    episode_paths::unusable_path,
    error::{CommandError, Exit},
    output::CommandOutput,
    platforms,
    written_files::{find_output_place, refuse_over_input, write_file},
};

/// How much of the episodes a submission was scored on.
#[derive(Clone, Copy)]
struct SubmissionCoverage {
    /// All instructions, with or without a trajectory.
    instructions: usize,
    /// All items.
    items: usize,
    /// Items whose way is hidden. They are not among `items`.
    hidden: usize,
    /// Trajectories for items beyond the limit, and for those whose way is hidden.
    left_out: usize,
}

/// Runs `wayword evaluate`: scores the trajectories of a submission, and prints the report.
///
/// # Errors
/// When an input cannot be read, the submission has problems or no trajectory, a rule cannot be applied, or `--per-item` names an input.
pub fn run_evaluate(args: &Args, output: &CommandOutput) -> Result<Exit, CommandError> {
    if let Some(per_item) = &args.per_item {
        refuse_over_input("--per-item", per_item, [args.submission.clone(), args.episodes.clone()])?;
    }
    let place = args.per_item.as_deref().map(find_output_place).transpose()?;
    let output = &place.map_or_else(|| output.clone(), |place| output.beside_data(&place));
    refuse_swapped(args)?;
    let platform = platforms::open_at(args.platform.name(), (&args.platform).into())?;
    let mut split = episodes::read_split(&args.episodes, platform.as_ref())?;
    let hidden = if args.partial && !split.known.is_empty() { std::mem::take(&mut split.hidden) } else { Vec::new() };
    let hidden_items = hidden.len();
    let hint =
        "only the leaderboard of a test split can score it; with --partial, the items whose way is known are scored";
    let mut all_episodes = split.refuse_hidden(&args.episodes, hint)?;
    let limit = args.limit.map_or(usize::MAX, |limit| limit as usize).min(all_episodes.len());
    all_episodes.extend(hidden);
    let (episodes, ignored_episodes) = all_episodes.split_at(limit);
    refuse_jumps(&args.episodes, episodes, platform.as_ref())?;
    let mut reading = submission::read_submission(&args.submission);
    if let Some(error) = wrong_file_error(&args.submission, &reading) {
        return Err(error);
    }
    let naming = name_as_episodes(&mut reading, &all_episodes);
    if naming != InstructionNaming::ItemAndPlace {
        output.say(format_args!("{} names an instruction by {}", args.submission.display(), naming.words()));
    }
    let judge = TrajectoryJudge::new(episodes, platform.as_ref())?;
    let instruction_names =
        |episode: &Episode| (0..episode.instructions.len()).map(|place| instr_id(episode, place)).collect();
    let ignored_instructions: BTreeSet<String> =
        ignored_episodes.iter().flat_map(|episode| -> Vec<String> { instruction_names(episode) }).collect();
    let (scores, left_out) = match judge.score_all(&reading, &ignored_instructions, args.partial) {
        Ok(scored) => scored,
        Err(problems) => {
            let refusal = SubmissionRefusal::new(&args.submission, problems);
            output.print_result(&refusal, &refusal);
            return Err(refusal.into_error());
        }
    };
    if scores.rows().is_empty() {
        let problem = format!("{}: no instruction has a trajectory; nothing was scored", args.submission.display());
        return Err(CommandError::usage(problem, "check that the submission and --episodes belong to the same split"));
    }
    let rules = success_rules(args, &scores)?;
    if let Some(file) = &args.per_item {
        write_score_lines(file, &scores)?;
    }
    let drawn = SubmissionResampling { resamples: args.resamples as usize, seed: args.seed };
    let covered = SubmissionCoverage {
        instructions: judge.instruction_count(),
        items: judge.item_count(),
        hidden: hidden_items,
        left_out,
    };
    let report = SubmissionReport::new(args, &scores, covered, &rules, drawn);
    output.print_result(&report, &report);
    Ok(Exit::Done)
}

/// Refuses episodes whose own way jumps between viewpoints that no edge joins: an agent that walks it could not be right. The ways of a
/// run's paths, and of positions, were put onto the graph, so viewpoints in a row need no edge there. Viewpoints that the scene lacks
/// are problems of the submission's list.
fn refuse_jumps(file: &Path, episodes: &[Episode], platform: &dyn Platform) -> Result<(), CommandError> {
    if detect_format(file)? == DatasetFormat::Wayword {
        return Ok(());
    }
    for episode in episodes.iter().filter(|episode| episode.floor_positions.is_empty()) {
        let graph = platform.graph_for_scene(&episode.scene)?;
        if let Err(source @ GraphError::NoEdge(..)) = graph.path_frames(&episode.viewpoints, None) {
            let jump = PlatformError::Graph { scene: episode.scene.clone(), source };
            return Err(unusable_path(file, &episode.id)(jump));
        }
    }
    Ok(())
}

/// Refuses a dataset in the place of the submission, where the submission is in its place.
fn refuse_swapped(args: &Args) -> Result<(), CommandError> {
    if detect_format(&args.episodes).is_ok() || detect_format(&args.submission).is_err() {
        return Ok(());
    }
    let (submission, episodes) = (args.submission.display(), args.episodes.display());
    let problem = format!("{submission} holds episodes, and --episodes {episodes} does not: they seem to be swapped");
    Err(CommandError::usage(problem, format!("write `wayword evaluate {episodes} --episodes {submission}`")))
}

/// The rules of success that are asked for and can be applied.
fn success_rules(args: &Args, scores: &SubmissionScores) -> Result<Vec<TrajectorySuccessRule>, CommandError> {
    let has_visible = scores.has_rule(TrajectorySuccessRule::Visible);
    match args.rule.map(TrajectorySuccessRule::from) {
        Some(TrajectorySuccessRule::Visible) if !has_visible => Err(CommandError::usage(
            format!("--rule visible: no item of {} names an object whose place is known", args.episodes.display()),
            "judge by distance with --rule distance",
        )),
        Some(rule) => Ok(vec![rule]),
        None if has_visible => Ok(vec![TrajectorySuccessRule::Visible, TrajectorySuccessRule::Distance]),
        None => Ok(vec![TrajectorySuccessRule::Distance]),
    }
}

/// Writes the figures of each instruction to the file of `--per-item`, one JSON object per line.
fn write_score_lines(file: &Path, scores: &SubmissionScores) -> Result<(), CommandError> {
    let mut lines = String::new();
    for line in scores.score_records() {
        let line = serde_json::to_string(&line).map_err(|error| CommandError::io(file, "write")(error.into()))?;
        lines.push_str(&line);
        lines.push('\n');
    }
    write_file(file, &lines)
}
