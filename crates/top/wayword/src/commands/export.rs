//! `wayword export`.

use crate::{
    cli::Export,
    error::{Error, Exit},
    output::Output,
    run::file,
};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use wayword_formats::{
    Episode, Format, jsonl,
    jsonl::Record,
    r2r, reverie, rxr, split,
    vlnce::{self, Dataset},
    write_sidecar,
};

/// Height of the eye over the floor, metres: Matterport3D's camera and the houses' walker. VLN-CE's positions lie on the floor.
const EYE_HEIGHT_M: f64 = 1.5;

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    instructions: usize,
    file: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    provenance: Option<PathBuf>,
}

pub(super) fn run(args: &Export, output: &Output) -> Result<Exit, Error> {
    let format: Format =
        args.format.parse().map_err(|error| Error::usage(format!("{error}"), "see wayword export --help"))?;
    let mut records = records(&args.run, args.style.as_deref())?;
    let provenance = if format == Format::Wayword {
        if let Some(share) = args.val_share {
            if !(0.0..=1.0).contains(&share) {
                return Err(Error::usage(format!("--val-share {share} is no share"), "give a number from 0 to 1"));
            }
            split(&mut records, share, args.seed);
        }
        jsonl::write(&args.out, &records)?;
        None
    } else {
        refuse_what_only_records_bear(args)?;
        write_as(format, &args.out, &records)?
    };
    let written = Written { instructions: records.len(), file: args.out.clone(), provenance };
    let beside =
        written.provenance.as_ref().map_or(String::new(), |file| format!(", provenance in {}", file.display()));
    output.data(&written, format_args!("{} instructions in {}{beside}", written.instructions, args.out.display()));
    Ok(Exit::Done)
}

/// The records of runs, merged; only those of a style where one is named.
fn records(runs: &[PathBuf], style: Option<&str>) -> Result<Vec<Record>, Error> {
    let files: Vec<PathBuf> = runs.iter().map(|run| run.join(file::INSTRUCTIONS)).collect();
    let mut records = jsonl::merge(&files)?;
    let styles: std::collections::BTreeSet<String> =
        records.iter().map(|record| record.instruction.style.clone()).collect();
    records.retain(|record| style.is_none_or(|style| record.instruction.style == style));
    if records.is_empty() {
        let styles = styles.into_iter().collect::<Vec<_>>().join(", ");
        return Err(Error::usage("there is no instruction to export", format!("the run has these styles: {styles}")));
    }
    Ok(records)
}

fn refuse_what_only_records_bear(args: &Export) -> Result<(), Error> {
    if args.run.len() > 1 {
        return Err(Error::usage(format!("format {} holds one run", args.format), "merge runs with --format wayword"));
    }
    if args.val_share.is_some() {
        return Err(Error::usage(
            format!("format {} has no splits within a file", args.format),
            "use --val-share with --format wayword",
        ));
    }
    if args.style.is_none() {
        return Err(Error::usage(
            format!("format {} does not say which style a text is in", args.format),
            "name one with --style",
        ));
    }
    Ok(())
}

/// Writes one of the field's formats, and provenance beside it where its items have no place for it: VLN-CE's loader
/// chokes on unknown fields, and R2R's items gather several instructions.
fn write_as(format: Format, file: &Path, records: &[Record]) -> Result<Option<PathBuf>, Error> {
    let within = matches!(format, Format::Reverie | Format::Rxr);
    let episodes: Vec<Episode> = records.iter().map(|record| episode(record, within)).collect();
    match format {
        Format::R2r => r2r::write(file, &episodes)?,
        Format::Reverie => reverie::write(file, &episodes)?,
        Format::Rxr => rxr::write(file, &episodes)?,
        Format::Vlnce => vlnce::write(file, &Dataset::of(episodes))?,
        Format::Wayword => jsonl::write(file, records)?,
    }
    if within {
        return Ok(None);
    }
    let lines: Vec<Value> = records
        .iter()
        .map(|record| json!({"path": record.path.id, "text": record.instruction.text, "wayword": about(record)}))
        .collect();
    Ok(Some(write_sidecar(file, &lines)?))
}

/// A record as an item of a dataset.
fn episode(record: &Record, with_provenance: bool) -> Episode {
    let mut episode =
        Episode::from_path(&record.path, vec![record.instruction.text.clone()]).on_floor_of(&record.path, EYE_HEIGHT_M);
    if let Some(path_id) = record.extra.get("path_id").and_then(Value::as_str) {
        path_id.clone_into(&mut episode.path_id);
    }
    if with_provenance {
        episode.extra.insert("wayword".into(), about(record));
    }
    episode
}

fn about(record: &Record) -> Value {
    json!({
        "verdict": record.instruction.verdict,
        "provenance": record.instruction.provenance,
    })
}
