//! What curators decided about pairs: files of JSON lines that the page saves.

use crate::{error::CommandError, run_folder::lines::each_line};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path};

/// The name under which the page saves decisions.
pub const DECISIONS: &str = "decisions.jsonl";

/// A line of a file of decisions.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct DecisionLine {
    pair: String,
    decision: PairDecision,
    at: String,
}

/// What was decided about a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairDecision {
    /// It stays.
    Accept,
    /// It is left out.
    Reject,
}

/// The decisions of files, by the names of the pairs. Of several about one pair the latest counts.
///
/// # Errors
/// When a file is missing, cannot be read, or a line is no decision.
pub fn read_decisions(files: &[impl AsRef<Path>]) -> Result<BTreeMap<String, PairDecision>, CommandError> {
    let mut latest: BTreeMap<String, (String, PairDecision)> = BTreeMap::new();
    for file in files {
        let file = file.as_ref();
        if !file.is_file() {
            return Err(CommandError::usage(
                format!("{}: there is no such file", file.display()),
                "give a file that the page for curators saved",
            ));
        }
        each_line(file, |line| {
            let DecisionLine { pair, decision, at } = line.parse()?;
            let is_later = latest.get(&pair).is_none_or(|(before, _)| *before <= at);
            if is_later {
                latest.insert(pair, (at, decision));
            }
            Ok(())
        })?;
    }
    Ok(latest.into_iter().map(|(pair, (_, decision))| (pair, decision)).collect())
}
