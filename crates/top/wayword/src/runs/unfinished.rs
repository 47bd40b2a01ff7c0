//! Counts what unfinished chunks of a run hold already: a worker that goes on keeps it.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    io::ErrorKind,
    path::Path,
};
use wayword_queue::{CHUNKS_FOLDER, chunk_of_folder};
use wayword_run::{
    error::CommandError,
    run_folder::{file, lines},
};

/// The number of items that are made in chunks which are not finished. Of several tries of a chunk, the one that came farthest counts.
///
/// # Errors
/// When a folder or a file of walks cannot be read.
pub(super) fn items_in_unfinished(run: &Path, finished: &BTreeSet<usize>) -> Result<usize, CommandError> {
    let folder = run.join(CHUNKS_FOLDER);
    let entries = match fs::read_dir(&folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(0),
        entries => entries.map_err(CommandError::io(&folder, "look into"))?,
    };
    let mut made: BTreeMap<usize, usize> = BTreeMap::new();
    for entry in entries {
        let entry = entry.map_err(CommandError::io(&folder, "look into"))?;
        let Some(chunk) = chunk_of_folder(&entry.file_name().to_string_lossy()) else { continue };
        if !finished.contains(&chunk) {
            let mut items = 0;
            lines::each_line(&entry.path().join(file::WALKS), |_| {
                items += 1;
                Ok(())
            })?;
            let most = made.entry(chunk).or_default();
            *most = items.max(*most);
        }
    }
    Ok(made.into_values().sum())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn whole_lines_of_unfinished_chunks_count_once_for_each_chunk() {
        let run = tempfile::tempdir().unwrap();
        assert_eq!(items_in_unfinished(run.path(), &BTreeSet::new()).unwrap(), 0);
        for (name, walks) in [
            ("000000", "{}\n{}\n"),
            ("000001", "{}\n{}\n{\"cut"),
            ("000001.2", "{}\n"),
            ("000002.damaged-1", "{}\n"),
            ("000003", "{}\n"),
        ] {
            let chunk = run.path().join(CHUNKS_FOLDER).join(name);
            fs::create_dir_all(&chunk).unwrap();
            fs::write(chunk.join(file::WALKS), walks).unwrap();
        }
        fs::write(run.path().join(CHUNKS_FOLDER).join("000000.done"), "").unwrap();
        assert_eq!(items_in_unfinished(run.path(), &BTreeSet::from([0])).unwrap(), 3);
    }
}
