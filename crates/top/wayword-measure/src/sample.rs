//! Instructions picked by seed, beside what people wrote.

use rand::seq::IndexedRandom;
use std::{collections::BTreeMap, path::Path};
use wayword::{
    error::Error,
    output::Output,
    run::{WalkRecord, file, read_lines},
};
use wayword_core::rng;
use wayword_formats::jsonl::{self, Record};

pub(super) fn show(run: &Path, count: usize, seed: u64, output: &Output) -> Result<(), Error> {
    let walks: Vec<WalkRecord> = read_lines(&run.join(file::WALKS))?;
    let originals: BTreeMap<&str, &[String]> =
        walks.iter().map(|walk| (walk.path.id.as_str(), walk.originals.as_slice())).collect();
    let mut styles: BTreeMap<String, Vec<Record>> = BTreeMap::new();
    for record in jsonl::read(&run.join(file::INSTRUCTIONS))? {
        styles.entry(record.instruction.style.clone()).or_default().push(record);
    }
    let mut lines = Vec::new();
    for (style, records) in &styles {
        lines.push(format!("{style}:"));
        for record in records.choose_multiple(&mut rng(seed, &["sample", style]), count) {
            lines.push(format!("- {} | {}", record.path.id, record.instruction.text));
            lines.extend(
                originals
                    .get(record.path.id.as_str())
                    .into_iter()
                    .flat_map(|texts| texts.first())
                    .map(|text| format!("    human: {text}")),
            );
        }
    }
    output.data(&(), lines.join("\n"));
    Ok(())
}
