//! Reads the texts of a comparison, and which agents reached the goal by each, from a folder of `wayword compare`.

use super::{CriticMaterial, OutcomeText, TextOutcomes};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path};
use wayword_robustness::sets::FollowResult;
use wayword_run::{error::CommandError, run_folder::read_lines};

/// The file with the success of every walk.
pub(super) const FOLLOWED_FILE: &str = "followed.jsonl";

/// The fields of a walk in `walks.jsonl` that are read.
#[derive(Debug, Deserialize)]
struct ComparedWalk {
    set: String,
    item: String,
    text_index: usize,
    text: String,
}

/// The texts of a comparison, and the success of each agent.
pub(super) fn read_comparison(folder: &Path) -> Result<CriticMaterial, CommandError> {
    let followed: Vec<FollowResult> = read_lines(&folder.join(FOLLOWED_FILE))?;
    let walked: Vec<ComparedWalk> = read_lines(&folder.join("walks.jsonl"))?;
    if followed.is_empty() {
        let problem = format!("{}: no agent walked by a text there", folder.display());
        return Err(CommandError::usage(problem, "give a folder that `wayword compare` has finished"));
    }
    let text_by_key: BTreeMap<(&str, &str, usize), &str> =
        walked.iter().map(|walk| ((&*walk.set, &*walk.item, walk.text_index), &*walk.text)).collect();
    let mut numbers: BTreeMap<(&str, &str, usize), usize> = BTreeMap::new();
    let mut texts = Vec::new();
    let mut agents: BTreeMap<&str, Vec<(usize, f64)>> = BTreeMap::new();
    for result in &followed {
        let key = (&*result.set, &*result.item, result.text_index);
        let Some(text) = text_by_key.get(&key) else { continue };
        // Every agent walks by the same text: it counts once.
        let number = *numbers.entry(key).or_insert_with(|| {
            texts.push(OutcomeText {
                item: Some(result.item.clone()),
                path: result.path.clone(),
                scene: result.scene.clone(),
                text: (*text).to_owned(),
            });
            texts.len() - 1
        });
        agents.entry(&result.agent).or_default().push((number, result.success));
    }
    let outcomes = agents.into_iter().map(|(agent, of_texts)| TextOutcomes {
        who: agent.to_owned(),
        outcome: "success".to_owned(),
        answers: of_texts.len(),
        text_means: of_texts,
    });
    Ok(CriticMaterial { outcomes: outcomes.collect(), texts })
}
