//! Puts texts about recordings back into the layout that the recordings were read from: the same walks with other texts, in a file of
//! another name.

use super::{replace_file, tell_terms};
use crate::export::args::{ExportArgs, ExportFormat};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_formats::{
    FormatError, detect_format,
    jsonl::InstructionRecord,
    training::{episode_lines::write_internnav_texts, navila::write_navila_texts, streamvln::write_streamvln_texts},
};
use wayword_run::{
    count::count_phrase, error::CommandError, item::RECORDING_PLATFORM, output::CommandOutput,
    run_folder::read_run_settings,
};

/// Result of putting texts back.
#[derive(Debug, Serialize)]
struct WrittenTexts {
    instructions: usize,
    /// The file of the walks that they are about.
    source: PathBuf,
    file: PathBuf,
}

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
) -> Result<(), CommandError> {
    let [run] = args.run.as_slice() else { return Err(CommandError::usage("--run is missing", "give one run")) };
    let source = read_run_settings(run)?
        .episodes
        .filter(|source| detect_format(source).is_ok_and(|found| found.name() == format.to_string()));
    let Some(source) = source else {
        let problem = format!("the walks of this run are recordings, and its episodes are no file of layout {format}");
        let hint = "make the run with --episodes FILE, the layout's own list of walks, or export in another format";
        return Err(CommandError::usage(problem, hint));
    };
    let write = match format {
        ExportFormat::Streamvln => put_streamvln,
        ExportFormat::Navila => put_navila,
        ExportFormat::Internnav => put_internnav,
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
    let source = ["annotations.json", "meta/episodes.jsonl"]
        .map(|name| source.join(name))
        .into_iter()
        .find(|file| file.is_file())
        .unwrap_or(source);
    replace_file(out, output, || Ok(write(&source, out, &of_scene)?))?;
    tell_terms(records, output);
    let written = WrittenTexts { instructions: records.len(), source, file: out.to_owned() };
    output.print_result(
        &written,
        format_args!(
            "{} put beside those of {}, in {}",
            count_phrase(written.instructions, "instruction"),
            written.source.display(),
            out.display()
        ),
    );
    Ok(())
}

/// The texts about the walk of a name.
type TextsOfWalk<'a> = &'a dyn Fn(&str) -> Vec<String>;

fn put_streamvln(source: &Path, out: &Path, texts: TextsOfWalk<'_>) -> Result<(), FormatError> {
    write_streamvln_texts(source, out, texts)
}

fn put_navila(source: &Path, out: &Path, texts: TextsOfWalk<'_>) -> Result<(), FormatError> {
    write_navila_texts(source, out, texts)
}

fn put_internnav(source: &Path, out: &Path, texts: TextsOfWalk<'_>) -> Result<(), FormatError> {
    write_internnav_texts(source, out, texts)
}
