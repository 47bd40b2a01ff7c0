//! Writes the lines from which VLN-DUET and ScaleVLN pre-train, and the table of the views in which a viewpoint's neighbours lie.

use super::{
    duet::{EncodedInstructions, encode_instructions, refuse_without_viewpoints, usual_dataset},
    splits, tell_terms, tell_written,
};
use crate::export::args::{AgentDataset, ExportArgs};
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};
use wayword_core::{Heading, Platform, SceneId, ViewpointId};
use wayword_formats::{
    jsonl::InstructionRecord,
    training::pretraining::{PretrainingLine, neighbour_views, write_neighbour_views, write_pretraining_lines},
};
use wayword_run::{
    count::count_phrase, error::CommandError, output::CommandOutput, platforms, run_folder::read_run_settings,
};

/// The table of neighbours' views.
const VIEWS_FILE: &str = "scanvp_candview_relangles.json";

pub(super) fn write_pretraining(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    refuse_without_viewpoints(records)?;
    let dataset = args.dataset.unwrap_or_else(|| usual_dataset(records));
    let name = match dataset {
        AgentDataset::R2r => "R2R",
        AgentDataset::Reverie => "REVERIE",
        AgentDataset::Rxr => {
            let problem = "VLN-DUET and ScaleVLN pre-train on R2R and REVERIE";
            return Err(CommandError::usage(problem, "give --dataset r2r or reverie"));
        }
    };
    let record_splits = splits::splits_of_records(args, records)?;
    let EncodedInstructions { is_xlm, ids } = encode_instructions(args.tokenizer.as_deref(), records, output)?;
    if is_xlm {
        let problem = "these lines hold the ids of BERT's tokenizer, and this one is XLM-RoBERTa's";
        return Err(CommandError::usage(problem, "give BERT's: --tokenizer hf/google-bert/bert-base-uncased"));
    }
    let platform = platforms::open_platform(&read_run_settings(args.only_run()?)?)?;
    let (mut numbers, mut left_out) = (BTreeMap::<String, usize>::new(), 0);
    let mut lines_by_split: BTreeMap<&str, Vec<PretrainingLine>> = BTreeMap::new();
    let mut written_splits = Vec::new();
    for ((record, split), ids) in records.iter().zip(&record_splits).zip(ids) {
        let number = numbers.entry(record.path.id.clone()).or_default();
        match line_of_record(&*platform, dataset, record, *number, ids)? {
            Some(line) => {
                lines_by_split.entry(split).or_default().push(line);
                written_splits.push(split.clone());
            }
            None => left_out += 1,
        }
        *number += 1;
    }
    fs::create_dir_all(out).map_err(CommandError::io(out, "make the folder"))?;
    let mut files = Vec::new();
    for (split, lines) in lines_by_split {
        let file = out.join(format!("{name}_{split}_enc.jsonl"));
        write_pretraining_lines(&file, &lines)?;
        files.push(file);
    }
    let scenes: BTreeSet<&SceneId> = records.iter().map(|record| &record.path.scene).collect();
    let mut views: BTreeMap<String, Value> = BTreeMap::new();
    for scene in scenes {
        views.extend(neighbour_views(scene.as_str(), &*platform.graph_for_scene(scene)?));
    }
    let file = out.join(VIEWS_FILE);
    write_neighbour_views(&file, &views)?;
    files.push(file);
    if left_out > 0 {
        let texts = count_phrase(left_out, "text");
        output.say(format_args!(
            "{texts} left out: a path of less than two viewpoints, or one that passes a viewpoint twice, has no next step to learn, and a \
             line of REVERIE needs an object with a name without \"_\""
        ));
    }
    tell_terms(records, output);
    tell_written(out, files, &written_splits, output);
    Ok(())
}

/// The line of a text; `None` for one from which nothing can be learnt: its path is too short, or has a viewpoint twice, for which the label
/// of the next step would be hidden; or it lacks REVERIE's object.
fn line_of_record(
    platform: &dyn Platform,
    dataset: AgentDataset,
    record: &InstructionRecord,
    number: usize,
    ids: Vec<u32>,
) -> Result<Option<PretrainingLine>, CommandError> {
    let mut path: Vec<ViewpointId> = record.path.frames.iter().filter_map(|frame| frame.viewpoint.clone()).collect();
    path.dedup();
    let places: BTreeSet<&ViewpointId> = path.iter().collect();
    if path.len() < 2 || places.len() < path.len() {
        return Ok(None);
    }
    // Loaders split the name at "_".
    let path_name = record.path_id().replace('_', "-");
    let target = record.path.target.as_ref().filter(|_| dataset == AgentDataset::Reverie);
    if dataset == AgentDataset::Reverie && target.is_none_or(|target| target.object.as_str().contains('_')) {
        return Ok(None);
    }
    let seen_from = match target {
        Some(target) => platform.catalogue().visible_from(&record.path.scene, &target.object)?,
        None => None,
    };
    let pos_vps = target.map(|_| match seen_from {
        Some(seen_from) if !seen_from.is_empty() => seen_from.into_iter().collect(),
        _ => path.last().cloned().into_iter().collect(),
    });
    let instr_id = match target {
        Some(target) => format!("{path_name}_{}_{number}", target.object),
        None => format!("{path_name}_{number}"),
    };
    let heading = record.path.frames.first().map_or(Heading::NORTH, |frame| frame.pose.heading).rad();
    Ok(Some(PretrainingLine {
        instr_id,
        scan: record.path.scene.to_string(),
        path,
        heading,
        instr_encoding: ids,
        pos_vps,
    }))
}
