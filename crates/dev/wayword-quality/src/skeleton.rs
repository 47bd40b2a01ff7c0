//! Counts sentence skeletons (sentences with landmarks, rooms and turns masked), which show how often a style repeats itself.

use std::{collections::BTreeMap, path::PathBuf};
use wayword_core::{Instruction, MentionKind};
use wayword_formats::jsonl;
use wayword_run::{error::CommandError, output::CommandOutput, run_folder::file};

/// Prints the most frequent sentence skeletons of each style in the runs, `show` of each.
///
/// # Errors
/// When the instructions of a run cannot be read.
pub fn measure_skeletons(folders: &[PathBuf], show: usize, output: &CommandOutput) -> Result<(), CommandError> {
    let mut instructions = Vec::new();
    for folder in folders {
        instructions.extend(
            jsonl::read_records(&folder.join(file::INSTRUCTIONS))?.into_iter().map(|record| record.instruction),
        );
    }
    output.print_result(&(), skeleton_lines(&instructions, show).join("\n"));
    Ok(())
}

fn skeleton_lines(instructions: &[Instruction], show: usize) -> Vec<String> {
    let mut styles: BTreeMap<&str, BTreeMap<String, usize>> = BTreeMap::new();
    for instruction in instructions {
        let skeletons = styles.entry(&instruction.style).or_default();
        for skeleton in mask_sentences(instruction) {
            *skeletons.entry(skeleton).or_default() += 1;
        }
    }
    let mut lines = Vec::new();
    for (style, skeletons) in styles {
        let total: usize = skeletons.values().sum();
        let mut ranked: Vec<_> = skeletons.iter().collect();
        ranked.sort_by_key(|(skeleton, count)| (std::cmp::Reverse(**count), *skeleton));
        lines.push(format!("{style} (sentences: {total}, skeletons: {})", skeletons.len()));
        lines.extend(
            ranked
                .iter()
                .take(show)
                .map(|(skeleton, count)| format!("  {:>5.2} %  {skeleton}", 100.0 * **count as f64 / total as f64)),
        );
    }
    lines
}

/// The skeletons of an instruction's sentences. Mentions are masked from the end, so that earlier byte ranges stay valid.
fn mask_sentences(instruction: &Instruction) -> Vec<String> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::test_instruction;
    use MentionKind::{Floor, Landmark, Room, Target, Turn};

    /// Six sentences: three with one skeleton, two with another, one with a third.
    #[test]
    fn a_skeleton_s_share_is_that_of_all_sentences_of_its_style() {
        let texts = [
            test_instruction("r2r", "Turn left at the sofa. Stop.", &[("left", Turn), ("sofa", Landmark)]),
            test_instruction(
                "r2r",
                "Turn right at the piano. Wait in the kitchen.",
                &[("right", Turn), ("piano", Landmark), ("kitchen", Room)],
            ),
            test_instruction("r2r", "Turn left at the floor lamp. Stop.", &[("left", Turn), ("floor lamp", Landmark)]),
            test_instruction("reverie", "Go up to level 2 and clean the sink", &[("level 2", Floor), ("sink", Target)]),
        ];
        assert_eq!(
            skeleton_lines(&texts, 2),
            [
                "r2r (sentences: 6, skeletons: 3)",
                "  50.00 %  turn turn at the landmark.",
                "  33.33 %  stop.",
                "reverie (sentences: 1, skeletons: 1)",
                "  100.00 %  go up to level 2 and clean the landmark",
            ]
        );
    }
}
