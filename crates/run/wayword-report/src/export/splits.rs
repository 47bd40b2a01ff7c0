//! Finds the split of each text. Without `--split` and `--val-share` it is the split of the run's episodes, else the official split
//! of the scene, else train. A scene that a dataset officially holds out (val_unseen, test) must not get into another split, because
//! agents are tested in it.

use crate::export::args::ExportArgs;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::SceneId;
use wayword_formats::{DatasetFormat, OfficialSplit, jsonl, jsonl::InstructionRecord};
use wayword_run::{
    count::count_phrase,
    error::CommandError,
    output::CommandOutput,
    run_folder::{self, file},
};

/// The split of a text if neither its episode nor its scene determines one.
const DEFAULT_SPLIT: &str = "train";
/// Splits that occur in file names of the known datasets; a name that contains another comes first.
const KNOWN_SPLITS: [&str; 6] = ["val_train_seen", "val_unseen", "val_seen", "minival", "train", "test"];
/// Longest name of a split.
const MAX_SPLIT_NAME_BYTES: usize = 64;

/// Splits by platform and name of the item.
type DeclaredSplits = BTreeMap<(String, String), String>;

/// The split of each record, in their order.
///
/// # Errors
/// When a name is no name of a split, a scene that is officially held out would come into another split, or the run's files
/// cannot be read.
pub(super) fn splits_of_records(args: &ExportArgs, records: &[InstructionRecord]) -> Result<Vec<String>, CommandError> {
    let declared = match args.split {
        Some(_) => DeclaredSplits::new(),
        None => read_declared_splits(&args.run, records)?,
    };
    let split_of_record = |record: &InstructionRecord| {
        let official = OfficialSplit::for_scene(&record.path.scene);
        let split = match (&args.split, record.split) {
            (Some(split), _) => split.clone(),
            // The drawn share decides, except for scenes that are officially held out: they stay in their own split.
            (None, Some(drawn)) => {
                official.filter(|official| official.is_held_out()).map_or(drawn.name(), OfficialSplit::name).to_owned()
            }
            (None, None) => {
                let declared = declared.get(&(record.platform.clone(), record.path.id.clone())).cloned();
                declared.unwrap_or_else(|| official.map_or(DEFAULT_SPLIT, OfficialSplit::name).to_owned())
            }
        };
        check_name(&split)?;
        refuse_held_out(&split, official, &record.path.scene)?;
        Ok(split)
    };
    records.iter().map(split_of_record).collect()
}

/// Reports how many texts lie in scenes that are officially held out, for files that do not name their split.
pub(super) fn tell_held_out(records: &[InstructionRecord], output: &CommandOutput) {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let official = records.iter().filter_map(|record| OfficialSplit::for_scene(&record.path.scene));
    for split in official.filter(|split| split.is_held_out()) {
        *counts.entry(split.name()).or_default() += 1;
    }
    for (split, number) in counts {
        let texts = count_phrase(number, "text");
        output.say(format_args!("{texts} in scenes of the official split {split}: do not train on what you test with"));
    }
}

/// Refuses names that are unsafe in a file name, because the split's name becomes part of one.
fn check_name(split: &str) -> Result<(), CommandError> {
    let is_name = (1..=MAX_SPLIT_NAME_BYTES).contains(&split.len())
        && split.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
        && split.bytes().any(|byte| byte.is_ascii_alphanumeric());
    if is_name {
        return Ok(());
    }
    let problem = format!("{split:?} is not the name of a split");
    Err(CommandError::usage(problem, "use letters, digits and _, at most 64: --split val_seen"))
}

fn refuse_held_out(split: &str, official: Option<OfficialSplit>, scene: &SceneId) -> Result<(), CommandError> {
    let Some(official) = official.filter(|official| !official.may_be_in(split)) else { return Ok(()) };
    let name = official.name();
    let problem = format!("scene {scene} is of the official split {name}, and may not come into split {split}");
    let hint = format!(
        "give --split {name}, or generate without this scene; without --split, and without episodes that say \
                        otherwise, each scene goes into its official split"
    );
    Err(CommandError::usage(problem, hint))
}

/// The splits that the episode files of the runs declare, by platform and item.
fn read_declared_splits(runs: &[PathBuf], records: &[InstructionRecord]) -> Result<DeclaredSplits, CommandError> {
    let mut declared = DeclaredSplits::new();
    for run in runs {
        // A run folder that a user put together has no settings.
        let episodes = run_folder::read_run_settings(run).ok().and_then(|settings| settings.episodes);
        let Some(episodes) = episodes else { continue };
        let by_item = splits_in_file(&episodes);
        let split_of_file = split_in_file_name(&episodes);
        let run_records = match runs {
            [_] => records.to_vec(),
            _ => jsonl::read_records(&run.join(file::INSTRUCTIONS))?,
        };
        for record in run_records {
            if let Some(split) = by_item.get(&record.path.id).map(String::as_str).or(split_of_file) {
                declared.insert((record.platform, record.path.id), split.to_owned());
            }
        }
    }
    Ok(declared)
}

/// The split of each item of a file; empty if the file is gone or its format has no field for splits.
fn splits_in_file(episodes: &Path) -> BTreeMap<String, String> {
    let has_splits =
        matches!(wayword_formats::detect_format(episodes), Ok(DatasetFormat::Rxr | DatasetFormat::Wayword));
    let read = has_splits.then(|| wayword_formats::read_any_format(episodes).ok()).flatten().unwrap_or_default();
    read.into_iter().filter_map(|episode| Some((episode.id, episode.split?))).collect()
}

/// The split in a file's name: `val_seen` of `R2R_val_seen.json`, `train` of `rxr_train_guide.jsonl.gz`.
fn split_in_file_name(file: &Path) -> Option<&'static str> {
    let name = file.file_name()?.to_string_lossy().to_lowercase().replace('-', "_");
    let stem = format!("_{}_", name.split('.').next()?);
    KNOWN_SPLITS.into_iter().find(|split| stem.contains(&format!("_{split}_")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn split_in_file_name_finds_the_split() {
        for (file, split) in [
            ("R2R_val_seen.json", Some("val_seen")),
            ("a/REVERIE_val_unseen_enc.json", Some("val_unseen")),
            ("rxr_train_guide.jsonl.gz", Some("train")),
            ("REVERIE_val_train_seen.json", Some("val_train_seen")),
            ("R2R_test.json", Some("test")),
            ("train/paths.json", None),
            ("restrained.json", None),
            ("", None),
        ] {
            assert_eq!(split_in_file_name(Path::new(file)), split, "{file}");
        }
    }

    #[test]
    fn check_name_refuses_paths_and_odd_characters() {
        for good in ["train", "val_unseen", "v2"] {
            assert!(check_name(good).is_ok());
        }
        for bad in ["", "../train", "a/b", "val seen", "val-seen", "_", "a\n", &"x".repeat(65)] {
            assert!(check_name(bad).unwrap_err().to_string().contains("hint: "), "{bad:?}");
        }
    }

    #[test]
    fn refuse_held_out_names_the_scene_and_its_split() {
        let scene = SceneId::new("2azQ1b91cZZ").unwrap();
        let official = OfficialSplit::for_scene(&scene);
        assert!(refuse_held_out("val_unseen", official, &scene).is_ok());
        let error = refuse_held_out("train", official, &scene).unwrap_err().to_string();
        assert!(error.contains("2azQ1b91cZZ") && error.contains("hint: give --split val_unseen"), "{error}");
    }
}
