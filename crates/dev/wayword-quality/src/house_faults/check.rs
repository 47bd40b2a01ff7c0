//! Runs the program's own check over texts about houses, in a closed world with labels as evidence.

use wayword_core::Verdict;
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_run::{
    check::{CheckOptions, CheckReport, args::AskedWorld, check_file},
    error::CommandError,
    output::CommandOutput,
    settings::RunSettings,
};

/// Before the number of a text in the name of its path.
const TEXT_NAME_PREFIX: &str = "text-";

/// The verdict of each text. A text is given with the record of its walk, and checked in the style and as of the
/// origin of that record.
///
/// # Errors
/// As `wayword check`.
pub(super) fn check_house_texts(
    texts: &[(&InstructionRecord, &str)],
    settings: &RunSettings,
    output: &CommandOutput,
) -> Result<Vec<Verdict>, CommandError> {
    if texts.is_empty() {
        return Ok(Vec::new());
    }
    let io = |source| CommandError::Io { path: std::env::temp_dir(), doing: "write a file of texts in", source };
    let folder = tempfile::tempdir().map_err(io)?;
    let file = folder.path().join("texts.jsonl");
    let records: Vec<InstructionRecord> =
        texts.iter().enumerate().map(|(number, (record, text))| make_text_record(number, record, text)).collect();
    jsonl::write_records(&file, &records)?;
    let how = CheckOptions { world: AskedWorld::Closed, ..CheckOptions::default() };
    sort_verdicts(&check_file(&file, settings, how, output)?, texts.len())
}

/// A record for one text about the walk of `record`. The report names texts by their paths, so the path is named by
/// the text's number.
fn make_text_record(number: usize, record: &InstructionRecord, text: &str) -> InstructionRecord {
    let mut copy = InstructionRecord::new(record.platform.clone(), record.path.clone(), record.instruction.clone());
    copy.path.id = format!("{TEXT_NAME_PREFIX}{number}");
    text.clone_into(&mut copy.instruction.text);
    // They point into the old text.
    copy.instruction.mentions.clear();
    copy.instruction.parts.clear();
    copy.instruction.findings.clear();
    copy.instruction.ambiguity = None;
    copy
}

/// The verdicts of a report, in the order of the texts: those that it does not list have passed.
fn sort_verdicts(report: &CheckReport, texts: usize) -> Result<Vec<Verdict>, CommandError> {
    let mut verdicts = vec![Verdict::Pass; texts];
    for text in &report.not_passed {
        let number = text.path.strip_prefix(TEXT_NAME_PREFIX).and_then(|number| number.parse::<usize>().ok());
        let Some(verdict) = number.and_then(|number| verdicts.get_mut(number)) else {
            let problem = format!("check named a text {} that there is not", text.path);
            return Err(CommandError::usage(problem, "report this as a bug"));
        };
        *verdict = text.verdict;
    }
    Ok(verdicts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::{house_hop_record, test_instruction, test_record};
    use wayword_run::settings::AskedSettings;

    #[test]
    fn make_text_record_keeps_the_walk_and_drops_what_points_into_the_old_text() {
        let old = test_instruction("r2r", "Turn left.", &[("left", wayword_core::MentionKind::Turn)]);
        let record = make_text_record(7, &test_record("p", old), "Go.");
        assert_eq!((record.path.id.as_str(), record.instruction.text.as_str()), ("text-7", "Go."));
        assert!(record.instruction.mentions.is_empty() && record.path.frames.len() == 3);
    }

    #[test]
    fn check_house_texts_gives_verdicts_in_the_order_of_the_texts() {
        let record = house_hop_record();
        let texts = [(&record, "Walk past the treadmill. Stop."), (&record, "Stop.")];
        let quiet = CommandOutput::new(true, true);
        let verdicts = check_house_texts(&texts, &AskedSettings::default().resolve().unwrap(), &quiet).unwrap();
        assert_eq!(verdicts.len(), 2);
        assert!(verdicts[0] == Verdict::Fail && verdicts[1] != Verdict::Fail, "{verdicts:?}");
        assert!(check_house_texts(&[], &AskedSettings::default().resolve().unwrap(), &quiet).unwrap().is_empty());
    }
}
