//! Writes Parquet tables: a single file, or a folder with a table for each split and a dataset card.

use super::{card, replace_file, splits, tell_terms, tell_written};
use crate::export::{args::ExportArgs, unfinished_folder::UnfinishedFolder};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_formats::{
    jsonl::InstructionRecord,
    table::{self, ParquetRow},
};
use wayword_run::{error::CommandError, interrupt, output::CommandOutput, terms, written_files::write_file};

/// The folder of the tables, and the card: what a published folder holds.
const DATA_FOLDER: &str = "data";
const CARD_FILE: &str = "README.md";

/// Writes one table, with the splits as a column.
pub(super) fn write_table(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let splits = splits::splits_of_records(args, records)?;
    let rows: Vec<ParquetRow<'_>> =
        records.iter().zip(&splits).map(|(record, split)| ParquetRow { record, split }).collect();
    replace_file(out, output, || Ok(table::write_table(out, &rows)?))?;
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
    let card = card::card_text(args, out, records, &splits, None)?;
    let folder = UnfinishedFolder::begin(out)?;
    let mut rows_by_split: BTreeMap<&str, Vec<ParquetRow<'_>>> = BTreeMap::new();
    for (record, split) in records.iter().zip(&splits) {
        rows_by_split.entry(split).or_default().push(ParquetRow { record, split });
    }
    let mut files = Vec::new();
    for (split, rows) in rows_by_split {
        interrupt::check_interrupt()?;
        let name = Path::new(DATA_FOLDER).join(card::file_name(split));
        table::write_table(&folder.place().join(&name), &rows)?;
        files.push(out.join(name));
    }
    write_file(&folder.place().join(CARD_FILE), card)?;
    files.push(out.join(CARD_FILE));
    folder.finish([DATA_FOLDER, CARD_FILE])?;
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
