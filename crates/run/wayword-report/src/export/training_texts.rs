//! Puts texts about recordings back into the layout that the recordings were read from: the same walks with other texts, in a file of
//! another name.

use super::{replace_file, tell_terms};
use crate::export::{
    args::{ExportArgs, ExportFormat},
    steps_args::AskedSteps,
};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_formats::{
    FormatError, detect_format, file_in_dataset,
    jsonl::InstructionRecord,
    training::{
        TextsOfWalk, TextsPutBack, episode_lines::write_internnav_texts, navila::write_navila_texts,
        streamvln::write_streamvln_texts,
    },
};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    item::RECORDING_PLATFORM,
    output::CommandOutput,
    run_folder::read_run_settings,
    written_files::{find_output_place, refuse_over_input},
};

/// Result of putting texts back.
#[derive(Debug, Serialize)]
struct WrittenTexts {
    instructions: usize,
    walks: usize,
    /// Walks that have no text now, or that cannot be written again.
    left_out: usize,
    /// The file of the walks that they are about.
    source: PathBuf,
    file: PathBuf,
}

/// Writes the walks of a list again with other texts.
type TextWriter = fn(&Path, &Path, TextsOfWalk<'_>) -> Result<TextsPutBack, FormatError>;

/// Whether the texts are about recordings: their pictures exist already.
pub(super) fn are_of_recordings(records: &[InstructionRecord]) -> bool {
    records.iter().all(|record| record.platform == RECORDING_PLATFORM)
}

/// Writes the texts of a run into a file of the layout that its episodes came from.
pub(super) fn put_texts_back(
    args: &ExportArgs,
    (format, out): (ExportFormat, &Path),
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    if args.split.is_some() || args.val_share.is_some() || args.steps != AskedSteps::default() {
        let problem = "the walks of this run are recordings: their pictures and splits are as they are";
        return Err(CommandError::usage(problem, "leave out --split, --val-share and the flags of steps"));
    }
    let output = &output.beside_data(&find_output_place(out)?);
    let source = read_run_settings(args.only_run()?)?
        .episodes
        .filter(|source| detect_format(source).is_ok_and(|found| found.name() == format.to_string()));
    let Some(source) = source else {
        let problem = format!("the walks of this run are recordings, and its episodes are no file of layout {format}");
        let hint = "make the run with --episodes FILE, the layout's own list of walks, or export in another format";
        return Err(CommandError::usage(problem, hint));
    };
    let write: TextWriter = match format {
        ExportFormat::Streamvln => write_streamvln_texts,
        ExportFormat::Navila => write_navila_texts,
        ExportFormat::Internnav => write_internnav_texts,
        _ => {
            let problem = format!("texts cannot be put back into layout {format}");
            return Err(CommandError::usage(problem, "use streamvln, navila, internnav, or --format wayword"));
        }
    };
    let mut texts: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for record in records {
        texts.entry(record.path.scene.as_str()).or_default().push(record.instruction.text.clone());
    }
    let of_scene = |scene: &str| texts.get(scene).cloned().unwrap_or_default();
    let source = file_in_dataset(&source);
    refuse_over_input("--out", out, [source.clone()])?;
    let put = replace_file(out, output, || Ok(write(&source, out, &of_scene)?))?;
    tell_terms(records, output);
    let written = WrittenTexts {
        instructions: put.texts,
        walks: put.walks,
        left_out: put.left_out,
        source,
        file: out.to_owned(),
    };
    let left_out = match put.left_out {
        0 => String::new(),
        left_out => format!("; {} without a text left out", count_phrase(left_out, "walk")),
    };
    output.print_result(
        &written,
        format_args!(
            "{} for {} of {}, in {}{left_out}",
            count_phrase(written.instructions, "instruction"),
            count_phrase(written.walks, "walk"),
            written.source.display(),
            out.display()
        ),
    );
    Ok(Exit::Done)
}
