//! Writes the files that the loaders of the agents VLN-DUET and VLN-HAMT read: the items of R2R, REVERIE or RxR, to which the token
//! ids of each instruction are added. One file for each split.

use super::{items, replace_file, splits, tell_terms, tell_written};
use crate::export::args::{AgentDataset, ExportArgs, ExportFormat};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};
use wayword_core::MentionKind;
use wayword_formats::{DatasetFormat, jsonl::InstructionRecord};
use wayword_run::{error::CommandError, output::CommandOutput};

/// The models with the tokenizers that these agents use.
#[cfg(feature = "local")]
const BERT_MODEL: &str = "hf/google-bert/bert-base-uncased";
const XLM_ROBERTA: &str = "hf/FacebookAI/xlm-roberta-base";

/// The token ids of each text, and whether the tokenizer is XLM-RoBERTa's.
pub(super) struct EncodedInstructions {
    pub(super) is_xlm: bool,
    pub(super) ids: Vec<Vec<u32>>,
}

pub(super) fn write_duet(
    args: &ExportArgs,
    out: &Path,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<(), CommandError> {
    items::refuse_without_poses(ExportFormat::Duet, records)?;
    refuse_without_viewpoints(records)?;
    let splits = splits::splits_of_records(args, records)?;
    let dataset = args.dataset.unwrap_or_else(|| usual_dataset(records));
    let EncodedInstructions { is_xlm, ids } = encode_instructions(args.tokenizer.as_deref(), records, output)?;
    if dataset == AgentDataset::Rxr && !is_xlm {
        let problem = "RxR's agents read the ids of XLM-RoBERTa's tokenizer, and this one is of BERT's family";
        return Err(CommandError::usage(problem, format!("give --tokenizer {XLM_ROBERTA}, or another --dataset")));
    }
    fs::create_dir_all(out).map_err(CommandError::io(out, "make the folder"))?;
    let mut indices_by_split: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, split) in splits.iter().enumerate() {
        indices_by_split.entry(split).or_default().push(index);
    }
    let mut files = Vec::new();
    for (split, indices) in indices_by_split {
        let file = out.join(file_name(dataset, split, is_xlm));
        files.extend(write_split(args, dataset, split, &file, (records, &ids, &indices), output)?);
    }
    tell_terms(records, output);
    tell_written(out, files, &splits, output);
    Ok(())
}

/// Refuses paths over open ground, because these agents walk a viewpoint graph.
pub(super) fn refuse_without_viewpoints(records: &[InstructionRecord]) -> Result<(), CommandError> {
    let is_blind = |record: &&InstructionRecord| record.path.frames.iter().any(|frame| frame.viewpoint.is_none());
    let Some(record) = records.iter().find(is_blind) else { return Ok(()) };
    let problem = format!(
        "path {} of platform {} names no viewpoints, and these agents need them",
        record.path.id, record.platform
    );
    Err(CommandError::usage(problem, "use --format vlnce, wayword, parquet or hf"))
}

/// Writes the records of a split, and returns the files.
fn write_split(
    args: &ExportArgs,
    dataset: AgentDataset,
    split: &str,
    file: &Path,
    (records, ids, indices): (&[InstructionRecord], &[Vec<u32>], &[usize]),
    output: &CommandOutput,
) -> Result<Vec<PathBuf>, CommandError> {
    let format = match dataset {
        AgentDataset::R2r => DatasetFormat::R2r,
        AgentDataset::Reverie => DatasetFormat::Reverie,
        AgentDataset::Rxr => DatasetFormat::Rxr,
    };
    let split_records: Vec<InstructionRecord> = indices.iter().map(|index| records[*index].clone()).collect();
    let mut episodes = items::episodes_from_records(format, &args.run, &split_records, output);
    for (episode, index) in episodes.iter_mut().zip(indices) {
        episode.split = Some(split.to_owned());
        episode.encodings = vec![ids[*index].clone()];
    }
    let provenance_file = replace_file(file, output, || items::write_items(format, file, &split_records, episodes))?;
    Ok([file.to_owned()].into_iter().chain(provenance_file).collect())
}

/// The dataset that the texts resemble: the one that their style is named after, else REVERIE if most of them name a target, else R2R.
pub(super) fn usual_dataset(records: &[InstructionRecord]) -> AgentDataset {
    let all_have_style = |name: &str| records.iter().all(|record| record.instruction.style == name);
    let names_target = |record: &&InstructionRecord| {
        record.path.target.is_some()
            && record.instruction.mentions.iter().any(|mention| mention.kind == MentionKind::Target)
    };
    if all_have_style("r2r") {
        AgentDataset::R2r
    } else if all_have_style("rxr") {
        AgentDataset::Rxr
    } else if all_have_style("reverie") || records.iter().filter(names_target).count() * 2 > records.len() {
        AgentDataset::Reverie
    } else {
        AgentDataset::R2r
    }
}

/// The file name that the loaders expect.
fn file_name(dataset: AgentDataset, split: &str, is_xlm: bool) -> String {
    let tokens = if is_xlm { "enc_xlmr" } else { "enc" };
    match dataset {
        AgentDataset::R2r => format!("R2R_{split}_{tokens}.json"),
        AgentDataset::Reverie => format!("REVERIE_{split}_{tokens}.json"),
        AgentDataset::Rxr => format!("rxr_{split}_guide_{tokens}.jsonl"),
    }
}

#[cfg(feature = "local")]
fn no_tokenizer() -> CommandError {
    let problem = "--tokenizer is missing: these files hold the ids of the tokens that an agent was trained with";
    let hint = format!(
        "`wayword models fetch --tokenizer {BERT_MODEL}` fetches that of VLN-DUET and VLN-HAMT; then give --tokenizer {BERT_MODEL}. For RxR \
         it is {XLM_ROBERTA}. A tokenizer.json of your own serves too"
    );
    CommandError::usage(problem, hint)
}

#[cfg(feature = "local")]
pub(super) fn encode_instructions(
    tokenizer: Option<&str>,
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Result<EncodedInstructions, CommandError> {
    use wayword_local::{InstructionTokenizer, TokenizerKind};
    let file = find_tokenizer_file(tokenizer.ok_or_else(no_tokenizer)?, output)?;
    let tokenizer = InstructionTokenizer::load(&file)?;
    let ids =
        records.iter().map(|record| tokenizer.instruction_ids(&record.instruction.text)).collect::<Result<_, _>>()?;
    Ok(EncodedInstructions { is_xlm: tokenizer.kind() == TokenizerKind::XlmRoberta, ids })
}

/// The file of a tokenizer. If a model is named instead of a file, its tokenizer is downloaded unless it is on this machine already.
#[cfg(feature = "local")]
fn find_tokenizer_file(tokenizer: &str, output: &CommandOutput) -> Result<PathBuf, CommandError> {
    use wayword_local::{HubConfig, ModelHub, ModelName, NeededFiles};
    use wayword_run::download_bar::DownloadBar;
    let path = Path::new(tokenizer);
    if path.exists() || !tokenizer.starts_with("hf/") {
        return Ok(if path.is_dir() { path.join("tokenizer.json") } else { path.to_owned() });
    }
    let name = ModelName::parse(tokenizer)?;
    let hub = ModelHub::new(HubConfig::from_env()?)?;
    let folder = hub.model_folder(&name, &NeededFiles::for_tokenizer(), &DownloadBar::new(output))?;
    Ok(folder.path.join("tokenizer.json"))
}

#[cfg(not(feature = "local"))]
pub(super) fn encode_instructions(
    _tokenizer: Option<&str>,
    _records: &[InstructionRecord],
    _output: &CommandOutput,
) -> Result<EncodedInstructions, CommandError> {
    Err(CommandError::not_built("--format duet: this build has no tokenizers"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_as_the_loaders_ask() {
        for (dataset, is_xlm, name) in [
            (AgentDataset::R2r, false, "R2R_val_seen_enc.json"),
            (AgentDataset::R2r, true, "R2R_val_seen_enc_xlmr.json"),
            (AgentDataset::Reverie, false, "REVERIE_val_seen_enc.json"),
            (AgentDataset::Reverie, true, "REVERIE_val_seen_enc_xlmr.json"),
            (AgentDataset::Rxr, true, "rxr_val_seen_guide_enc_xlmr.jsonl"),
        ] {
            assert_eq!(file_name(dataset, "val_seen", is_xlm), name);
        }
    }
}
