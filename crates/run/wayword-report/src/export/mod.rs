//! `wayword export`: checks the flags, reads and merges the runs' records, and writes them in the chosen format.

pub mod args;
#[cfg(any(feature = "habitat", feature = "parquet"))]
mod card;
mod decided;
mod duet;
mod duet_pretraining;
mod habitat_scenes;
mod highlight;
pub mod items;
#[cfg(not(feature = "habitat"))]
#[path = "no_layouts.rs"]
mod layouts;
#[cfg(feature = "habitat")]
mod layouts;
mod rxrce;
mod splits;
#[cfg(not(feature = "habitat"))]
#[path = "no_steps.rs"]
mod steps;
#[cfg(feature = "habitat")]
mod steps;
pub mod steps_args;
mod training_texts;
#[cfg(any(feature = "habitat", feature = "parquet"))]
mod unfinished_folder;
#[cfg(feature = "habitat")]
pub use habitat_scenes::lay_on_navmesh;
#[cfg(feature = "habitat")]
pub use steps::{TrajectoryReplay, replay_export};
#[cfg(not(feature = "parquet"))]
#[path = "no_table.rs"]
mod table;
#[cfg(feature = "parquet")]
mod table;

use crate::export::{
    args::{ExportArgs, ExportFormat},
    steps_args::AskedSteps,
};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_formats::{DatasetFormat, jsonl, jsonl::InstructionRecord, split_by_scene};
use wayword_run::{
    check::args::AskedWorld,
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    run_folder::{expect_texts, file, files_of_run, refuse_torn_line},
    settings::AskedPlatform,
    terms,
    written_files::{expect_output_folder, find_output_place, refuse_over_input},
};

/// Most scenes for which the screen lists what the user has to do.
const MAX_SHOWN_SCENE_NEEDS: usize = 5;

/// Result of an export into one file.
#[derive(Debug, Serialize)]
struct WrittenDataset {
    instructions: usize,
    file: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    provenance: Option<PathBuf>,
    /// Steps that the user has to take before Habitat finds the scenes.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    scene_needs: BTreeSet<String>,
}

/// Result of an export into several files.
#[derive(Debug, Serialize)]
struct WrittenSplits {
    instructions: usize,
    /// Instructions by split.
    splits: BTreeMap<String, usize>,
    files: Vec<PathBuf>,
}

/// Runs `wayword export`: writes the instructions of runs as a dataset, or, with `--highlight`, as a page with
/// the doubtful words marked.
///
/// # Errors
/// When the flags do not fit together, a run cannot be read or has no instruction, or a file cannot be written.
pub fn run_export(args: &ExportArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    if let Some(name) = &args.highlight {
        return highlight::write_highlights(args, name, output);
    }
    if let Some(dataset) = &args.pairs {
        return decided::write_accepted(args, dataset, output);
    }
    let (format, out) = check_dataset_args(args)?;
    refuse_what_does_not_fit(args, format)?;
    refuse_over_input("--out", out, args.run.iter().flat_map(|run| files_of_run(run)))?;
    let records = read_records(args, args.style.as_deref())?;
    refuse_several_styles(format, &records)?;
    if format.is_layout() && training_texts::are_of_recordings(&records) {
        return training_texts::put_texts_back(args, (format, out), &records, output);
    }
    let output = &output_beside(format, out, output)?;
    match format {
        ExportFormat::Duet => duet::write_duet(args, out, &records, output)?,
        ExportFormat::Parquet => table::write_table(args, out, &records, output)?,
        ExportFormat::Hf => table::publish_tables(args, out, &records, output)?,
        ExportFormat::Steps => return steps::write_steps(args, out, &records, output),
        ExportFormat::Rxrce => return rxrce::write_rxrce(args, out, &records, output),
        ExportFormat::DuetPretrain => duet_pretraining::write_pretraining(args, out, &records, output)?,
        ExportFormat::Streamvln
        | ExportFormat::Internnav
        | ExportFormat::InternnavN1
        | ExportFormat::Navila
        | ExportFormat::Uninavid
        | ExportFormat::Lerobot => return layouts::export_layout(args, (format, out), output),
        ExportFormat::R2r | ExportFormat::Reverie | ExportFormat::Rxr | ExportFormat::Vlnce | ExportFormat::Wayword => {
            write_one_file(args, format, out, &records, output)?;
        }
    }
    Ok(Exit::Done)
}

/// Refuses flags that belong to `--highlight`, and returns the format and the place to write to.
fn check_dataset_args(args: &ExportArgs) -> Result<(ExportFormat, &Path), CommandError> {
    if args.texts.is_some() || args.platform != AskedPlatform::default() || args.world != AskedWorld::default() {
        let problem = "--texts, --world and the flags of a platform are for --highlight";
        return Err(CommandError::usage(problem, "leave them out, or give --highlight NAME"));
    }
    let lacks = |what: &str| {
        CommandError::usage(
            format!("{what} is missing"),
            "give --run, --format and --out for a dataset, or --highlight NAME",
        )
    };
    if args.run.is_empty() {
        return Err(lacks("--run"));
    }
    let format = args.format.ok_or_else(|| lacks("--format"))?;
    Ok((format, args.out.as_deref().ok_or_else(|| lacks("--out"))?))
}

/// Refuses a place that cannot take the format. The returned output keeps standard output free if the data goes there.
fn output_beside(format: ExportFormat, out: &Path, output: &CommandOutput) -> Result<CommandOutput, CommandError> {
    if format.is_folder() {
        expect_output_folder(out)?;
        return Ok(output.clone());
    }
    Ok(output.beside_data(&find_output_place(out)?))
}

fn refuse_what_does_not_fit(args: &ExportArgs, format: ExportFormat) -> Result<(), CommandError> {
    let refused = |problem: String, hint: &str| Err(CommandError::usage(problem, hint));
    if !format.takes_several_runs() && args.run.len() > 1 {
        return refused(
            format!("format {format} takes one run only"),
            "merge runs with --format wayword, parquet or hf",
        );
    }
    let splits_itself = format.names_splits() || format == ExportFormat::Wayword;
    if args.val_share.is_some() && !splits_itself {
        let problem = format!("format {format} has no splits within a file");
        return refused(
            problem,
            "use --val-share with --format wayword, rxr, duet, parquet, hf, steps, or a layout for training",
        );
    }
    if let Some(share) = args.val_share.filter(|share| !(0.0..=1.0).contains(share)) {
        return refused(format!("--val-share {share} is not a share"), "give a number from 0 to 1");
    }
    if args.split.is_some() && args.val_share.is_some() {
        let problem = "--split puts all texts into one split, and --val-share divides them";
        return refused(problem.to_owned(), "give one of the two");
    }
    if args.split.is_some() && format == ExportFormat::Wayword {
        let problem = "records of --format wayword have a split only with --val-share".to_owned();
        return refused(problem, "leave --split out, or give --val-share");
    }
    let has_tokens = matches!(format, ExportFormat::Duet | ExportFormat::DuetPretrain);
    if !has_tokens && (args.tokenizer.is_some() || args.dataset.is_some()) {
        return refused(
            "--tokenizer and --dataset are for --format duet and duet-pretrain".to_owned(),
            "leave them out",
        );
    }
    refuse_unused_steps(format, &args.steps)
}

/// Refuses the flags of single actions for formats without them.
fn refuse_unused_steps(format: ExportFormat, steps: &AskedSteps) -> Result<(), CommandError> {
    let of_walks = AskedSteps { steps: None, shard: None, ..steps.clone() };
    let of_gait = AskedSteps { size_px: None, fov_deg: None, camera: Vec::new(), ..of_walks.clone() };
    let (used, problem) = match format {
        ExportFormat::Steps => {
            (AskedSteps { shard: steps.shard, ..of_walks }, "--steps is for what is packed from steps")
        }
        ExportFormat::Rxrce => {
            (of_gait, "--steps and the flags of pictures are for --format steps and what is packed from it")
        }
        _ if format.is_layout() => (AskedSteps { shard: None, ..steps.clone() }, "--shard is for --format steps"),
        _ => (AskedSteps::default(), "the flags of steps are for --format steps and what is packed from it"),
    };
    if used == *steps { Ok(()) } else { Err(CommandError::usage(problem, "leave them out")) }
}

/// Refuses texts of several styles for a format that has one.
fn refuse_several_styles(format: ExportFormat, records: &[InstructionRecord]) -> Result<(), CommandError> {
    let styles: BTreeSet<&str> = records.iter().map(|record| record.instruction.style.as_str()).collect();
    if format.takes_all_styles() || styles.len() < 2 {
        return Ok(());
    }
    let styles = styles.into_iter().collect::<Vec<_>>().join(", ");
    let problem = format!("a file of format {format} has texts of one style only, and the run has texts of {styles}");
    Err(CommandError::usage(problem, "choose one with --style"))
}

/// The records of the runs, merged; only those of one style if it is named. With `--val-share` each has its split.
fn read_records(args: &ExportArgs, style: Option<&str>) -> Result<Vec<InstructionRecord>, CommandError> {
    let runs = &args.run;
    for run in runs {
        expect_texts(run)?;
        refuse_torn_line(run)?;
    }
    let files: Vec<PathBuf> = runs.iter().map(|run| run.join(file::INSTRUCTIONS)).collect();
    let mut records = jsonl::merge_records(&files)?;
    let styles: BTreeSet<String> = records.iter().map(|record| record.instruction.style.clone()).collect();
    decided::leave_out_rejected(&mut records, &args.decisions)?;
    records.retain(|record| style.is_none_or(|style| record.instruction.style == style));
    if records.is_empty() {
        let runs = runs.iter().map(|run| run.display().to_string()).collect::<Vec<_>>().join(", ");
        return Err(match style.filter(|_| !styles.is_empty()) {
            Some(style) => {
                let styles = styles.into_iter().collect::<Vec<_>>().join(", ");
                CommandError::usage(format!("{runs}: no instruction of style {style}"), format!("there are: {styles}"))
            }
            None => {
                CommandError::usage(format!("{runs}: no instruction"), "see errors.jsonl and rejected.jsonl of the run")
            }
        });
    }
    if let Some(share) = args.val_share {
        split_by_scene(&mut records, share, args.seed);
    }
    Ok(records)
}

/// Writes a format that is one file.
fn write_one_file(
    args: &ExportArgs,
    format: ExportFormat,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let Some(file_format) = format.file_format() else { return Ok(()) };
    let splits = splits_of(args, format, records, output)?;
    let mut scene_needs = BTreeSet::new();
    let provenance = if file_format == DatasetFormat::Wayword {
        replace_file(out, output, || Ok(jsonl::write_records(out, records)?))?;
        None
    } else {
        items::refuse_without_poses(format, records)?;
        let mut episodes = items::episodes_from_records(file_format, &args.run, records, output);
        for (episode, split) in episodes.iter_mut().zip(splits) {
            episode.split = Some(split);
        }
        scene_needs.extend(episodes.iter().filter_map(|episode| episode.in_habitat.scene_needs.clone()));
        replace_file(out, output, || items::write_items(file_format, out, records, episodes))?
    };
    tell_needs(&scene_needs, output);
    tell_terms(records, output);
    let written = WrittenDataset { instructions: records.len(), file: out.to_owned(), provenance, scene_needs };
    let beside =
        written.provenance.as_ref().map_or(String::new(), |file| format!("; provenance in {}", file.display()));
    output.print_result(
        &written,
        format_args!("{} written to {}{beside}", count_phrase(written.instructions, "instruction"), out.display()),
    );
    Ok(())
}

/// The split of each record, if the format contains splits or the user chose one. Otherwise the list is empty, and texts in scenes
/// that are officially held out cause only a message.
fn splits_of(
    args: &ExportArgs,
    format: ExportFormat,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Vec<String>, CommandError> {
    if format.names_splits() || args.split.is_some() {
        return splits::splits_of_records(args, records);
    }
    if args.val_share.is_none() {
        splits::tell_held_out(records, output);
    }
    Ok(Vec::new())
}

/// Runs `write`, and says so if it replaced an old file.
fn replace_file<T>(
    file: &Path,
    output: &CommandOutput,
    write: impl FnOnce() -> Result<T, CommandError>,
) -> Result<T, CommandError> {
    let has_old_file = find_output_place(file)?.has_old_file();
    let written = write()?;
    if has_old_file {
        output.say(format_args!("replaced the old file {}", file.display()));
    }
    Ok(written)
}

fn tell_terms(records: &[InstructionRecord], output: &CommandOutput) {
    terms::print_terms(records.iter().map(|record| record.platform.as_str()), output);
}

fn tell_needs(scene_needs: &BTreeSet<String>, output: &CommandOutput) {
    if scene_needs.is_empty() {
        return;
    }
    output.say(format_args!("do this so that Habitat finds the scenes (SCENES is its folder of scenes, scenes_dir):"));
    scene_needs.iter().take(MAX_SHOWN_SCENE_NEEDS).for_each(|needs| output.say(format_args!("  {needs}")));
    if let Some(more) = scene_needs.len().checked_sub(MAX_SHOWN_SCENE_NEEDS).filter(|more| *more > 0) {
        output.say(format_args!("  and {more} more; info.scene_needs of each episode says what it needs"));
    }
}

/// Prints the result of an export into several files.
fn tell_written(out: &Path, files: Vec<PathBuf>, splits: &[String], output: &CommandOutput) {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for split in splits {
        *counts.entry(split.clone()).or_default() += 1;
    }
    let each: Vec<String> = counts.iter().map(|(split, count)| format!("{split} {count}")).collect();
    let instructions = count_phrase(splits.len(), "instruction");
    let written = WrittenSplits { instructions: splits.len(), splits: counts, files };
    output.print_result(&written, format_args!("{instructions} written to {} ({})", out.display(), each.join(", ")));
}
