//! Leaves out the texts that curators rejected: of a run, or of somebody's dataset.

use super::replace_file;
use crate::export::args::ExportArgs;
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_formats::{
    DatasetFormat, Episode, FormatError, detect_format, file_in_dataset,
    jsonl::InstructionRecord,
    r2r, read_any_format, reverie, rxr,
    submission::instr_id,
    training::{
        TextsOfWalk, TextsPutBack, episode_lines::write_internnav_texts, navila::write_navila_texts,
        streamvln::write_streamvln_texts,
    },
};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    pairs::decisions::{PairDecision, read_decisions},
    run_folder::{number_of_text, text_label},
    written_files::{find_output_place, refuse_over_input},
};

/// The result of an export of somebody's dataset.
#[derive(Debug, Serialize)]
struct AcceptedTexts {
    /// Texts that are in the file.
    instructions: usize,
    /// Texts that were rejected.
    rejected: usize,
    /// Decisions about pairs that the dataset does not have.
    unknown: usize,
    file: PathBuf,
}

/// Removes the records whose pair was rejected. Their pairs have the names that `check RUN/instructions.jsonl` gives them.
pub(super) fn leave_out_rejected(records: &mut Vec<InstructionRecord>, files: &[PathBuf]) -> Result<(), CommandError> {
    if files.is_empty() {
        return Ok(());
    }
    let decisions = read_decisions(files)?;
    let name = |record: &InstructionRecord| {
        format!("{} ({})", record.path.id, text_label(&record.instruction.style, number_of_text(record)))
    };
    records.retain(|record| decisions.get(&name(record)) != Some(&PairDecision::Reject));
    Ok(())
}

/// Writes a dataset again without the texts that were rejected.
pub(super) fn write_accepted(args: &ExportArgs, dataset: &Path, output: &CommandOutput) -> Result<Exit, CommandError> {
    let (Some(out), false) = (args.out.as_deref(), args.decisions.is_empty()) else {
        let problem = "--pairs lacks what was decided, or where to write";
        return Err(CommandError::usage(problem, "give --decisions FILE and --out FILE"));
    };
    let output = &output.beside_data(&find_output_place(out)?);
    let decisions = read_decisions(&args.decisions)?;
    let format = detect_format(dataset)?;
    let source = file_in_dataset(dataset);
    refuse_over_input("--out", out, [source.clone()])?;
    let mut episodes = read_any_format(dataset)?;
    let names: BTreeSet<String> =
        episodes.iter().flat_map(|episode| (0..episode.instructions.len()).map(|at| instr_id(episode, at))).collect();
    let before: usize = episodes.iter().map(|episode| episode.instructions.len()).sum();
    for episode in &mut episodes {
        let kept = episode
            .instructions
            .iter()
            .enumerate()
            .filter(|(at, _)| decisions.get(&instr_id(episode, *at)) != Some(&PairDecision::Reject));
        episode.instructions = kept.map(|(_, text)| text.clone()).collect();
    }
    let instructions: usize = episodes.iter().map(|episode| episode.instructions.len()).sum();
    replace_file(out, output, || write_again(format, (&source, out), episodes))?;
    let unknown = decisions.keys().filter(|name| !names.contains(*name)).count();
    let written = AcceptedTexts { instructions, rejected: before - instructions, unknown, file: out.to_owned() };
    let unknown = match unknown {
        0 => String::new(),
        unknown => format!("; {} about pairs that it does not have", count_phrase(unknown, "decision")),
    };
    output.print_result(
        &written,
        format_args!(
            "{} written to {}, {} rejected{unknown}",
            count_phrase(written.instructions, "instruction"),
            out.display(),
            written.rejected
        ),
    );
    Ok(Exit::Done)
}

/// Writes a list of walks with the texts that are left, or a dataset with its items that have a text left.
fn write_again(
    format: DatasetFormat,
    (source, out): (&Path, &Path),
    mut episodes: Vec<Episode>,
) -> Result<(), CommandError> {
    let of_walks: fn(&Path, &Path, TextsOfWalk<'_>) -> Result<TextsPutBack, FormatError> = match format {
        DatasetFormat::Streamvln => write_streamvln_texts,
        DatasetFormat::Navila => write_navila_texts,
        DatasetFormat::Internnav => write_internnav_texts,
        _ => {
            episodes.retain(|episode| !episode.instructions.is_empty());
            let write = match format {
                DatasetFormat::R2r => r2r::write_r2r_file,
                DatasetFormat::Reverie => reverie::write_reverie_file,
                DatasetFormat::Rxr => rxr::write_rxr_file,
                other => {
                    let problem =
                        format!("{}: a dataset of format {} is not written again", source.display(), other.name());
                    let hint = "leave out yourself what the decisions reject; their field `pair` is the text's name";
                    return Err(CommandError::usage(problem, hint));
                }
            };
            return Ok(write(out, &episodes)?);
        }
    };
    let mut texts: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for episode in &episodes {
        texts.entry(episode.scene.as_str()).or_default().extend(episode.instructions.iter().cloned());
    }
    of_walks(source, out, &|scene: &str| texts.get(scene).cloned().unwrap_or_default())?;
    Ok(())
}
