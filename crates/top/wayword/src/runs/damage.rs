//! What is shown of damaged chunks, and what to do about them.

use serde::Serialize;
use std::{collections::BTreeSet, fmt, path::Path};
use wayword_run::{
    count::count_phrase,
    error::CommandError,
    generate::{CheckedChunks, ChunkDamage},
};

/// Most files that the screen shows with what is wrong; `--json` lists all. The numbers of all damaged chunks are shown.
const MAX_SHOWN_FILES: usize = 20;

/// A run that is not merged, because of damaged chunks.
#[derive(Debug, Serialize)]
pub(super) struct DamagedRun {
    run: String,
    /// How many chunks were put together: always 0.
    merged: usize,
    /// Chunks of the run.
    chunks: usize,
    damaged: Vec<ChunkDamage>,
}

/// Where the chunks can be made again.
#[derive(Debug, Clone, Copy)]
pub(super) enum RetryPlace<'a> {
    /// In the folder of the run.
    Folder(&'a Path),
    /// In an object store, from which the chunks were fetched into a folder.
    Store {
        /// The run's address.
        address: &'a Path,
        /// The folder.
        folder: &'a Path,
    },
}

impl DamagedRun {
    pub(super) fn new(folder: &Path, chunks: usize, checked: &CheckedChunks) -> Self {
        Self { run: folder.display().to_string(), merged: 0, chunks, damaged: checked.damaged.clone() }
    }

    /// The error that ends the program, with the commands that make the chunks again.
    pub(super) fn into_error(self, place: RetryPlace<'_>) -> CommandError {
        let numbers: BTreeSet<usize> = self.damaged.iter().map(|damage| damage.chunk).collect();
        let problem = format!(
            "{}: {} of {} damaged; nothing was merged",
            self.run,
            numbers.len(),
            count_phrase(self.chunks, "chunk")
        );
        let hint = match place {
            RetryPlace::Folder(run) => format!(
                "make them again: `wayword runs retry {} --damaged`, then start workers with the same command as before",
                run.display()
            ),
            RetryPlace::Store { address, folder } => {
                let chunks = folder.join(wayword_queue::CHUNKS_FOLDER);
                format!(
                    "remove their folders in {} and merge again, which fetches them anew; if they are still damaged, make them \
                     again: `wayword runs retry {} --chunk {}`, then start workers with the same command as before",
                    chunks.display(),
                    address.display(),
                    join_numbers(&numbers)
                )
            }
        };
        CommandError::usage(problem, hint)
    }
}

fn join_numbers(numbers: &BTreeSet<usize>) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(",")
}

/// Damaged chunks as lines: the first files with what is wrong, and then the numbers of the chunks of the others.
pub(super) fn damage_lines(damaged: &[ChunkDamage]) -> Vec<String> {
    let (shown, others) = damaged.split_at(damaged.len().min(MAX_SHOWN_FILES));
    let line = |ChunkDamage { chunk, file, problem }: &ChunkDamage| format!("chunk {chunk}: {file}: {problem}");
    let mut lines: Vec<String> = shown.iter().map(line).collect();
    if !others.is_empty() {
        let numbers: BTreeSet<usize> = others.iter().map(|damage| damage.chunk).collect();
        let files = count_phrase(others.len(), "more file");
        lines.push(format!("{files}, of the chunks {} (--json lists them)", join_numbers(&numbers)));
    }
    lines
}

impl fmt::Display for DamagedRun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        damage_lines(&self.damaged).iter().try_for_each(|line| writeln!(f, "{line}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn damage(chunk: usize) -> ChunkDamage {
        ChunkDamage { chunk, file: format!("chunks/{chunk:06}/walks.jsonl"), problem: "it is empty".into() }
    }

    #[test]
    fn every_damaged_chunk_is_named_even_where_not_every_file_is() {
        let all: Vec<ChunkDamage> = (0..23).map(damage).collect();
        let lines = damage_lines(&all);
        assert_eq!(lines.len(), MAX_SHOWN_FILES + 1);
        assert_eq!(lines[3], "chunk 3: chunks/000003/walks.jsonl: it is empty");
        assert_eq!(lines[20], "3 more files, of the chunks 20,21,22 (--json lists them)");
        assert_eq!(damage_lines(&all[..2]).len(), 2);
    }

    #[test]
    fn the_error_names_the_command_for_the_place_of_the_run() {
        let checked = CheckedChunks { damaged: vec![damage(3), damage(3), damage(7)], ..CheckedChunks::default() };
        let told = |place| DamagedRun::new(Path::new("runs/big"), 9, &checked).into_error(place).to_string();
        let folder = told(RetryPlace::Folder(Path::new("runs/big")));
        assert!(folder.starts_with("runs/big: 2 of 9 chunks damaged; nothing was merged"), "{folder}");
        assert!(folder.contains("`wayword runs retry runs/big --damaged`"), "{folder}");
        let store = told(RetryPlace::Store { address: Path::new("s3://b/big"), folder: Path::new("runs/big") });
        assert!(store.contains("`wayword runs retry s3://b/big --chunk 3,7`"), "{store}");
    }
}
