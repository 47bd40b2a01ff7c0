//! Compares finished chunks with their marks and with the plan, so that no torn, exchanged or edited chunk is merged.

use crate::{
    count::count_phrase,
    error::CommandError,
    run_folder::{file, lines},
};
use serde::Serialize;
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt, fs,
    path::Path,
};
use wayword_queue::{
    ChunkPlan, ChunkRecord, CompareDepth, FileDifference, QueueError, chunk_folder, compare_files, done_path,
    read_done_mark,
};

/// The files and folders of a chunk that are merged.
pub const CHUNK_FILES: [&str; 6] =
    [file::WALKS, file::INSTRUCTIONS, file::REJECTED, file::ERRORS, file::DATA, file::FRAMES];

/// A file of a finished chunk that is not as it was when the chunk was finished.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ChunkDamage {
    /// The number of the chunk.
    pub chunk: usize,
    /// The file, within the run folder.
    pub file: String,
    /// What is wrong with it.
    pub problem: String,
}

/// Compares finished chunks of a run. A chunk that fits its mark is not read again by the same checker.
pub struct ChunkChecker<'a> {
    folder: &'a Path,
    plan: &'a ChunkPlan,
    depth: CompareDepth,
    /// The chunks that fit their marks, with the time at which they were finished.
    whole: BTreeMap<usize, u64>,
}

/// The finished chunks of a run as a check found them.
#[derive(Debug, Default)]
pub struct CheckedChunks {
    /// The marks of the finished chunks.
    pub done: Vec<ChunkRecord>,
    /// What is wrong with them.
    pub damaged: Vec<ChunkDamage>,
    /// Chunks with marks without hashes, because an older version finished them. Of these an edited word is not found.
    pub without_hashes: Vec<usize>,
}

impl CheckedChunks {
    /// The numbers of the chunks that are damaged.
    #[must_use]
    pub fn damaged_chunks(&self) -> BTreeSet<usize> {
        self.damaged.iter().map(|damage| damage.chunk).collect()
    }
}

impl<'a> ChunkChecker<'a> {
    /// A checker of the chunks in a run folder.
    #[must_use]
    pub fn new(folder: &'a Path, plan: &'a ChunkPlan, depth: CompareDepth) -> Self {
        Self { folder, plan, depth, whole: BTreeMap::new() }
    }

    /// Checks all finished chunks, and calls `chunk_is_checked` after each chunk.
    ///
    /// # Errors
    /// When a mark or a file cannot be read.
    pub fn check_chunks(&mut self, chunk_is_checked: impl Fn()) -> Result<CheckedChunks, CommandError> {
        let mut checked = CheckedChunks::default();
        let mut changed: Vec<(usize, String)> = Vec::new();
        for number in 0..self.plan.chunk_count() {
            let done = match read_done_mark(self.folder, number) {
                Err(QueueError::Broken { path, problem }) => {
                    let file = self.within_run(&path);
                    checked.damaged.push(ChunkDamage { chunk: number, file, problem });
                    None
                }
                done => done?,
            };
            if let Some(done) = done {
                if self.whole.get(&number) != Some(&done.at_unix_s) {
                    let before = checked.damaged.len();
                    self.check_chunk(number, &done, &mut checked, &mut changed)?;
                    if checked.damaged.len() == before {
                        self.whole.insert(number, done.at_unix_s);
                    }
                }
                if done.files.is_empty() {
                    checked.without_hashes.push(number);
                }
                checked.done.push(done);
            }
            chunk_is_checked();
        }
        name_exchanged(&mut checked, &changed);
        Ok(checked)
    }

    /// A path as it is shown: within the run folder.
    fn within_run(&self, path: &Path) -> String {
        path.strip_prefix(self.folder).unwrap_or(path).display().to_string()
    }

    /// Checks one chunk. Adds to `changed` the place in the list of damages, and the hash, of each file with another content.
    fn check_chunk(
        &self,
        number: usize,
        done: &ChunkRecord,
        checked: &mut CheckedChunks,
        changed: &mut Vec<(usize, String)>,
    ) -> Result<(), CommandError> {
        let mut damage = |file: String, problem: String| {
            checked.damaged.push(ChunkDamage { chunk: number, file, problem });
            checked.damaged.len() - 1
        };
        let mark = self.within_run(&done_path(self.folder, number));
        if done.chunk != number {
            damage(mark, format!("it is the mark of chunk {}", done.chunk));
            return Ok(());
        }
        if !done.run.is_empty() && done.run != self.plan.run {
            damage(mark, format!("it is a mark of another run ({})", done.run));
            return Ok(());
        }
        if self.depth == CompareDepth::Marks {
            return Ok(());
        }
        let results = chunk_folder(self.folder, number, done.epoch);
        if !results.is_dir() {
            damage(self.within_run(&results), "the chunk's folder is missing".to_owned());
            return Ok(());
        }
        if done.files.is_empty() {
            if let Some((name, problem)) = self.check_counts(number, done, &results)? {
                damage(self.within_run(&results.join(name)), problem);
            }
            return Ok(());
        }
        for (name, difference) in compare_files(&results, &done.files, &CHUNK_FILES, self.depth)? {
            let at = damage(
                self.within_run(&results.join(&name)),
                DifferenceWords { name: &name, difference: &difference }.to_string(),
            );
            if let FileDifference::Content(sha256) | FileDifference::Count { sha256, .. } = difference {
                changed.push((at, sha256));
            }
        }
        Ok(())
    }

    /// Checks a chunk that has a mark without hashes: the number of lines of each file, and that each line is of an item of this chunk.
    fn check_counts(
        &self,
        number: usize,
        done: &ChunkRecord,
        results: &Path,
    ) -> Result<Option<(&'static str, String)>, CommandError> {
        let items = self.plan.items.get(self.plan.chunk_range(number)).unwrap_or_default();
        let items: BTreeSet<&str> = items.iter().map(String::as_str).collect();
        let files = [
            (file::WALKS, done.made),
            (file::INSTRUCTIONS, done.written),
            (file::REJECTED, done.rejected),
            (file::ERRORS, done.failed_items()),
        ];
        for (name, marked) in files {
            let path = results.join(name);
            if !path.is_file() {
                return Ok(Some((name, "it is missing".to_owned())));
            }
            let (mut found, mut bytes, mut problem) = (0, 0, None);
            lines::each_line(&path, |line| {
                found += 1;
                bytes += line.byte_count() as u64;
                if problem.is_none() {
                    problem = match line.parse::<Value>() {
                        Err(_) => Some(format!("line {found} is no JSON")),
                        Ok(value) if !item_of(&value).is_some_and(|item| items.contains(item)) => {
                            Some(format!("line {found} is of no item of this chunk"))
                        }
                        Ok(_) => None,
                    };
                }
                Ok(())
            })?;
            let length = fs::metadata(&path).map_err(CommandError::io(&path, "look at"))?.len();
            if found == marked && length > bytes {
                problem = Some("its last line is not whole".to_owned());
            }
            if found != marked {
                problem = Some(format!("it has {}, and its mark counts {marked}", count_phrase(found, "whole line")));
            }
            if let Some(problem) = problem {
                return Ok(Some((name, problem)));
            }
        }
        Ok(None)
    }
}

/// The item of a line of any of the files.
fn item_of(line: &Value) -> Option<&str> {
    line.get("item").or_else(|| line.get("path")?.get("id"))?.as_str()
}

/// Says of changed files which are those of other chunks.
fn name_exchanged(checked: &mut CheckedChunks, changed: &[(usize, String)]) {
    let mut owners: BTreeMap<&str, usize> = BTreeMap::new();
    for done in &checked.done {
        owners.extend(done.files.values().filter(|mark| mark.bytes > 0).map(|mark| (mark.sha256.as_str(), done.chunk)));
    }
    for (at, sha256) in changed {
        if let (Some(owner), Some(damage)) = (owners.get(sha256.as_str()), checked.damaged.get_mut(*at)) {
            damage.problem = format!("it is the file of chunk {owner}");
        }
    }
}

/// A difference as words about its file.
struct DifferenceWords<'a> {
    name: &'a str,
    difference: &'a FileDifference,
}

impl fmt::Display for DifferenceWords<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |number: u64| {
            let unit = if self.name == file::FRAMES { "picture" } else { "line" };
            count_phrase(usize::try_from(number).unwrap_or(usize::MAX), unit)
        };
        match self.difference {
            FileDifference::Missing(marked) => write!(f, "it is missing; its mark counts {}", count(*marked)),
            FileDifference::Added => write!(f, "it was not there when the chunk was finished"),
            FileDifference::Empty(marked) => write!(f, "it is empty; its mark counts {}", count(*marked)),
            FileDifference::CutOff { found, marked } => {
                write!(f, "its last line is not whole, after {}; its mark counts {marked}", count(*found))
            }
            FileDifference::Count { found, marked, .. } => {
                write!(f, "it has {}; its mark counts {marked}", count(*found))
            }
            FileDifference::Content(_) => write!(f, "its content was changed since the chunk was finished"),
            FileDifference::Length { found, marked } => write!(f, "it has {found} bytes; its mark counts {marked}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use wayword_queue::mark_files;

    /// A run of two chunks with two items each, all of them made. Old marks hold no hashes.
    fn run(is_old: bool) -> (tempfile::TempDir, ChunkPlan) {
        let folder = tempfile::tempdir().unwrap();
        let items = (0..4).map(|number| format!("item-{number}")).collect();
        let plan = ChunkPlan::new("run".into(), 2, String::new(), items);
        for chunk in 0..2 {
            let results = chunk_folder(folder.path(), chunk, 0);
            fs::create_dir_all(&results).unwrap();
            let lines = |kind: &str| {
                let items = plan.items[plan.chunk_range(chunk)].iter();
                items.map(|item| format!("{}\n", json!({"path": {"id": item}, "kind": kind}))).collect::<String>()
            };
            fs::write(results.join(file::WALKS), lines("walk")).unwrap();
            fs::write(results.join(file::INSTRUCTIONS), lines("text")).unwrap();
            fs::write(results.join(file::REJECTED), "").unwrap();
            fs::write(results.join(file::ERRORS), "").unwrap();
            let files = if is_old { BTreeMap::new() } else { mark_files(&results, &CHUNK_FILES).unwrap() };
            let run = if is_old { String::new() } else { "run".to_owned() };
            let done = ChunkRecord { chunk, made: 2, written: 2, run, files, ..ChunkRecord::default() };
            done.write_mark(folder.path()).unwrap();
        }
        (folder, plan)
    }

    fn check(folder: &Path, plan: &ChunkPlan) -> CheckedChunks {
        ChunkChecker::new(folder, plan, CompareDepth::Everything).check_chunks(|| ()).unwrap()
    }

    /// The damages after a change in the folder, as lines.
    fn damages(is_old: bool, change: impl Fn(&Path)) -> Vec<String> {
        let (folder, plan) = run(is_old);
        assert_eq!(check(folder.path(), &plan).damaged, [], "it was whole before");
        change(&folder.path().join("chunks"));
        let checked = check(folder.path(), &plan);
        assert_eq!(checked.without_hashes.len(), if is_old { checked.done.len() } else { 0 });
        checked.damaged.iter().map(|damage| format!("{} {}: {}", damage.chunk, damage.file, damage.problem)).collect()
    }

    fn exchange(a: &Path, b: &Path) {
        let aside = a.with_extension("aside");
        fs::rename(a, &aside).unwrap();
        fs::rename(b, a).unwrap();
        fs::rename(aside, b).unwrap();
    }

    fn rewrite(path: &Path, change: impl Fn(String) -> String) {
        fs::write(path, change(fs::read_to_string(path).unwrap())).unwrap();
    }

    #[test]
    fn exchanged_chunks_are_named() {
        let of_texts = |damages: Vec<String>| {
            assert_eq!(damages.len(), 2, "{damages:?}");
            damages
        };
        let texts = |folder: &Path| exchange(&folder.join("000000/walks.jsonl"), &folder.join("000001/walks.jsonl"));
        assert_eq!(
            of_texts(damages(false, texts)),
            [
                "0 chunks/000000/walks.jsonl: it is the file of chunk 1",
                "1 chunks/000001/walks.jsonl: it is the file of chunk 0"
            ]
        );
        assert_eq!(
            of_texts(damages(true, texts))[0],
            "0 chunks/000000/walks.jsonl: line 1 is of no item of this chunk"
        );
        let marks = |folder: &Path| exchange(&folder.join("000000.done"), &folder.join("000001.done"));
        for is_old in [false, true] {
            assert_eq!(of_texts(damages(is_old, marks))[0], "0 chunks/000000.done: it is the mark of chunk 1");
        }
        let folders = |folder: &Path| exchange(&folder.join("000000"), &folder.join("000001"));
        assert_eq!(damages(false, folders).len(), 4);
        assert_eq!(damages(true, folders).len(), 2);
    }

    #[test]
    fn torn_emptied_doubled_and_missing_files_are_named_by_old_marks_too() {
        let cut =
            |folder: &Path| rewrite(&folder.join("000001/instructions.jsonl"), |text| text[..text.len() - 3].into());
        assert_eq!(
            damages(false, cut),
            ["1 chunks/000001/instructions.jsonl: its last line is not whole, after 1 line; its mark counts 2"]
        );
        assert_eq!(
            damages(true, cut),
            ["1 chunks/000001/instructions.jsonl: it has 1 whole line, and its mark counts 2"]
        );
        for is_old in [false, true] {
            let one = |change: &dyn Fn(&Path)| {
                let damages = damages(is_old, change);
                assert_eq!(damages.len(), 1, "{damages:?}");
            };
            one(&|folder| rewrite(&folder.join("000000/walks.jsonl"), |_| String::new()));
            one(&|folder| rewrite(&folder.join("000000/walks.jsonl"), |text| format!("{text}{text}")));
            one(&|folder| fs::remove_file(folder.join("000000/rejected.jsonl")).unwrap());
            one(&|folder| fs::remove_dir_all(folder.join("000001")).unwrap());
            one(&|folder| rewrite(&folder.join("000001/walks.jsonl"), |text| format!("{text}{{\"path\":")));
            one(&|folder| rewrite(&folder.join("000001.done"), |text| text[..text.len() / 2].into()));
            one(&|folder| rewrite(&folder.join("000001/errors.jsonl"), |_| "{\"item\":\"item-2\"}\n".into()));
        }
    }

    #[test]
    fn a_changed_word_is_found_by_the_hash_alone() {
        let edit =
            |folder: &Path| rewrite(&folder.join("000000/instructions.jsonl"), |text| text.replace("text", "TEXT"));
        assert_eq!(
            damages(false, edit),
            ["0 chunks/000000/instructions.jsonl: its content was changed since the chunk was finished"]
        );
        assert_eq!(damages(true, edit), <[&str; 0]>::default());
        let added = |folder: &Path| fs::write(folder.join("000000/data.json"), "{}").unwrap();
        assert_eq!(damages(false, added).len(), 1);
        let of_another_run = |folder: &Path| {
            rewrite(&folder.join("000000.done"), |text| text.replace("\"run\":\"run\"", "\"run\":\"run-2\""));
        };
        assert_eq!(damages(false, of_another_run), ["0 chunks/000000.done: it is a mark of another run (run-2)"]);
    }
}
