//! Writes Parquet tables: a single file, or a folder with a table for each split and a dataset card.

use super::{card, splits, tell_overwriting, tell_terms, tell_written};
use crate::{export::args::ExportArgs, view::unfinished::UnfinishedFile};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};
use wayword_formats::{
    jsonl::InstructionRecord,
    table::{self, ParquetRow},
};
use wayword_run::{error::CommandError, output::CommandOutput, terms};

/// Writes one table, with the splits as a column.
pub(super) fn write_table(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let splits = splits::splits_of_records(args, records)?;
    tell_overwriting(out, output);
    let rows: Vec<ParquetRow<'_>> =
        records.iter().zip(&splits).map(|(record, split)| ParquetRow { record, split }).collect();
    table::write_table(out, &rows)?;
    tell_terms(records, output);
    tell_written(out, vec![out.to_owned()], &splits, output);
    Ok(())
}

/// Writes a folder that is made for publishing: a table for each split, and a card.
pub(super) fn publish_tables(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    check_terms(args, records)?;
    let splits = splits::splits_of_records(args, records)?;
    check_folder(out)?;
    let card = card::card_text(args, out, records, &splits)?;
    let data = out.join("data");
    fs::create_dir_all(&data).map_err(CommandError::io(&data, "make the folder"))?;
    let mut rows_by_split: BTreeMap<&str, Vec<ParquetRow<'_>>> = BTreeMap::new();
    for (record, split) in records.iter().zip(&splits) {
        rows_by_split.entry(split).or_default().push(ParquetRow { record, split });
    }
    let mut files = Vec::new();
    for (split, rows) in rows_by_split {
        let file = data.join(card::file_name(split));
        table::write_table(&file, &rows)?;
        files.push(file);
    }
    let file = out.join("README.md");
    UnfinishedFile::write_whole(&file, card.as_bytes())?;
    files.push(file);
    tell_terms(records, output);
    tell_written(out, files, &splits, output);
    Ok(())
}

/// Refuses to publish texts about somebody's scenes unless the user confirms the right to do so.
fn check_terms(args: &ExportArgs, records: &[InstructionRecord]) -> Result<(), CommandError> {
    let platforms: BTreeSet<&str> = records.iter().map(|record| record.platform.as_str()).collect();
    for platform in platforms {
        let problem = format!(
            "the scenes of platform {platform} are somebody's, and a folder of format hf is made for publishing texts about them"
        );
        terms::check_right(platform, args.i_have_the_right, problem, "publish texts about")?;
    }
    Ok(())
}

/// Refuses a folder with files in it, because they would be published with the dataset.
fn check_folder(out: &Path) -> Result<(), CommandError> {
    let is_empty = match fs::read_dir(out) {
        Ok(mut entries) => entries.next().is_none(),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => true,
        Err(error) => return Err(CommandError::io(out, "look into")(error)),
    };
    if is_empty {
        return Ok(());
    }
    let problem = format!("{}: the folder has files, and all of a dataset's folder is published", out.display());
    Err(CommandError::usage(problem, "give a new folder, or empty this one"))
}
