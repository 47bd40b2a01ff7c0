//! Writes RxR-CE's files, as VLN-CE's code for RxR loads them: for each split the guides' episodes and, where the ground is known, the
//! actions along the walk. Its task turns by 30 degrees.

use super::{items, splits, tell_terms, tell_written};
use crate::export::args::{ExportArgs, ExportFormat};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};
use wayword_formats::{DatasetFormat, jsonl::InstructionRecord, vlnce, vlnce_actions, vlnce_actions::EpisodeActions};
use wayword_run::{
    error::{CommandError, Exit},
    output::CommandOutput,
};

pub(super) fn write_rxrce(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<Exit, CommandError> {
    items::refuse_without_poses(ExportFormat::Rxrce, records)?;
    let record_splits = splits::splits_of_records(args, records)?;
    let actions = walk_actions(args, records, &record_splits, output)?;
    if actions.is_none() {
        output.say(format_args!(
            "no actions: this platform has no ground on which single steps can be taken; Habitat's own follower can take them"
        ));
    }
    let mut records_by_split: BTreeMap<&str, Vec<InstructionRecord>> = BTreeMap::new();
    let mut written_splits = Vec::new();
    for (record, split) in records.iter().zip(&record_splits) {
        // The measure needs the actions of each episode.
        if actions.as_ref().is_none_or(|actions| actions.contains_key(&record.path.id)) {
            records_by_split.entry(split).or_default().push(record.clone());
            written_splits.push(split.clone());
        }
    }
    let mut files: Vec<PathBuf> = Vec::new();
    for (split, records) in records_by_split {
        let folder = out.join(split);
        fs::create_dir_all(&folder).map_err(CommandError::io(&folder, "make the folder"))?;
        let mut place = |name: &str| {
            files.push(folder.join(format!("{split}_{name}.json.gz")));
            folder.join(format!("{split}_{name}.json.gz"))
        };
        let episodes = items::episodes_from_records(DatasetFormat::Vlnce, &args.run, &records, output);
        let guide = place("guide");
        let names = vlnce::write_rxrce_file(&guide, &episodes)?;
        if let Some(actions) = &actions {
            let acted = names.into_iter().zip(&records);
            let acted: BTreeMap<String, EpisodeActions> =
                acted.filter_map(|(name, record)| Some((name, actions.get(&record.path.id)?.clone()))).collect();
            vlnce_actions::write_actions(&place("guide_gt"), &acted)?;
            // The measure opens the actions of both roles, whichever is loaded.
            vlnce_actions::write_actions(&place("follower_gt"), &BTreeMap::new())?;
        }
        items::write_provenance(&guide, &records)?.into_iter().for_each(|file| files.push(file));
    }
    tell_terms(records, output);
    tell_written(out, files, &written_splits, output);
    Ok(if written_splits.len() < records.len() { Exit::WithLoss } else { Exit::Done })
}

/// The actions along each walk, by the name of its path; `None` if the platform has no ground.
#[cfg(feature = "habitat")]
fn walk_actions(
    args: &ExportArgs,
    records: &[InstructionRecord],
    record_splits: &[String],
    output: &CommandOutput,
) -> Result<Option<BTreeMap<String, EpisodeActions>>, CommandError> {
    super::steps::walk_actions(args, records, record_splits, output)
}

#[cfg(not(feature = "habitat"))]
fn walk_actions(
    _args: &ExportArgs,
    _records: &[InstructionRecord],
    _record_splits: &[String],
    _output: &CommandOutput,
) -> Result<Option<BTreeMap<String, EpisodeActions>>, CommandError> {
    Ok(None)
}
