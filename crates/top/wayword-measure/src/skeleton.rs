//! Sentence skeletons: what is left of a sentence when landmarks, rooms and turns are masked.

use std::{collections::BTreeMap, path::PathBuf};
use wayword::{error::Error, output::Output, run::file};
use wayword_core::{Instruction, MentionKind};
use wayword_formats::jsonl;

pub(super) fn measure(folders: &[PathBuf], show: usize, output: &Output) -> Result<(), Error> {
    let mut styles: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for folder in folders {
        for record in jsonl::read(&folder.join(file::INSTRUCTIONS))? {
            let skeletons = styles.entry(record.instruction.style.clone()).or_default();
            for skeleton in skeletons_of(&record.instruction) {
                *skeletons.entry(skeleton).or_default() += 1;
            }
        }
    }
    let mut lines = Vec::new();
    for (style, skeletons) in styles {
        let total: usize = skeletons.values().sum();
        let mut ranked: Vec<_> = skeletons.iter().collect();
        ranked.sort_by_key(|(skeleton, count)| (std::cmp::Reverse(**count), *skeleton));
        lines.push(format!("{style}: {total} sentences, {} skeletons", skeletons.len()));
        lines.extend(
            ranked
                .iter()
                .take(show)
                .map(|(skeleton, count)| format!("  {:>5.2} %  {skeleton}", 100.0 * **count as f64 / total as f64)),
        );
    }
    output.data(&(), lines.join("\n"));
    Ok(())
}

fn skeletons_of(instruction: &Instruction) -> Vec<String> {
    let mut masked = instruction.text.clone();
    let mut mentions = instruction.mentions.clone();
    mentions.sort_by_key(|mention| std::cmp::Reverse(mention.span));
    for mention in mentions {
        let mask = match mention.kind {
            MentionKind::Landmark | MentionKind::Target => "LANDMARK",
            MentionKind::Room => "ROOM",
            MentionKind::Turn => "TURN",
            MentionKind::Floor => continue,
        };
        masked.replace_range(mention.span[0]..mention.span[1], mask);
    }
    masked
        .split_inclusive(['.', '!', '?'])
        .map(|sentence| sentence.trim().to_lowercase())
        .filter(|sentence| !sentence.is_empty())
        .collect()
}
