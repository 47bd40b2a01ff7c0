//! Shows instructions that a seed picks from a run, each with a person's text about the same path.

use rand::seq::IndexedRandom;
use std::{collections::BTreeMap, path::Path};
use wayword_core::seeded_rng;
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    run_folder::{WalkRecord, file, read_lines},
};

/// Prints `count` instructions of each style of a run, picked by seed, next to people's texts.
///
/// # Errors
/// When the walks or the instructions of the run cannot be read.
pub fn show_sample(run: &Path, count: usize, seed: u64, output: &CommandOutput) -> Result<(), CommandError> {
    let walks: Vec<WalkRecord> = read_lines(&run.join(file::WALKS))?;
    let originals = walks.into_iter().map(|walk| (walk.path.id, walk.originals)).collect();
    let records = jsonl::read_records(&run.join(file::INSTRUCTIONS))?;
    output.print_result(&(), sample_lines(records, &originals, count, seed).join("\n"));
    Ok(())
}

/// People's texts about each path, by the path's id.
type OriginalTexts = BTreeMap<String, Vec<String>>;

fn sample_lines(records: Vec<InstructionRecord>, originals: &OriginalTexts, count: usize, seed: u64) -> Vec<String> {
    let mut styles: BTreeMap<String, Vec<InstructionRecord>> = BTreeMap::new();
    for record in records {
        styles.entry(record.instruction.style.clone()).or_default().push(record);
    }
    let mut lines = Vec::new();
    for (style, records) in &styles {
        lines.push(format!("{style}:"));
        for record in records.choose_multiple(&mut seeded_rng(seed, &["sample", style]), count) {
            lines.push(format!("- {} | {}", record.path.id, record.instruction.text));
            let people = originals.get(&record.path.id).and_then(|texts| texts.first());
            lines.extend(people.map(|text| format!("    human: {text}")));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::{test_instruction, test_record};
    use std::collections::BTreeSet;

    fn made(count: usize) -> Vec<InstructionRecord> {
        (0..count)
            .map(|number| test_record(&format!("p{number}"), test_instruction("r2r", &format!("Text {number}."), &[])))
            .collect()
    }

    #[test]
    fn lines_pick_count_different_instructions_each_with_the_first_human_text() {
        let said = |number: usize| (format!("p{number}"), vec![format!("People {number}."), "Others.".to_owned()]);
        let originals: OriginalTexts = (0..9).map(said).collect();
        let picked = sample_lines(made(9), &originals, 4, 0);
        assert_eq!(picked[0], "r2r:");
        assert_eq!(picked.len(), 1 + 2 * 4);
        for pair in picked[1..].chunks(2) {
            let number = pair[0].strip_prefix("- p").unwrap().chars().next().unwrap();
            assert_eq!(pair, [format!("- p{number} | Text {number}."), format!("    human: People {number}.")]);
        }
        assert_eq!(picked[1..].iter().collect::<BTreeSet<_>>().len(), 8, "none twice: {picked:?}");
        assert_eq!(sample_lines(made(9), &originals, 4, 0), picked, "the same seed picks the same");
    }

    #[test]
    fn where_there_are_fewer_all_are_shown() {
        assert_eq!(sample_lines(made(2), &OriginalTexts::new(), 10, 0).len(), 1 + 2);
    }
}
