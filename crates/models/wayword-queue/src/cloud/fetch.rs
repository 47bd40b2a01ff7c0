//! Fetches all objects below a prefix into a folder, and continues an interrupted fetch. Names come from the store and are
//! checked before any file is written.

use super::{
    CloudBucket, CloudError, StoredObject, bucket,
    index::{FETCH_INDEX_FILE, FetchIndex},
    lock,
    lock::FetchLock,
    names,
};
use futures_util::{StreamExt, stream};
use object_store::{GetOptions, GetRange, ObjectStore};
use std::{
    collections::BTreeSet,
    fs::{self, File},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// How many files are fetched at the same time.
const CONCURRENT_FILES: usize = 6;

/// The most bytes of one request. A larger file is requested in pieces, so that a broken connection costs only one piece.
const MAX_PIECE_BYTES: u64 = 32 << 20;

/// How often the index is written. Files that are not yet in it when the program is killed are fetched again.
const INDEX_WRITE_INTERVAL: Duration = Duration::from_secs(2);

/// Counts of a fetch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FetchSummary {
    /// How many files were fetched.
    pub files: usize,
    /// How many bytes the fetched files have.
    pub bytes: u64,
    /// How many files were there already.
    pub kept: usize,
}

/// One fetch.
struct FolderFetch<'a> {
    bucket: &'a CloudBucket,
    /// The prefix of the objects in the bucket; empty for all.
    name: &'a str,
    /// The folder of this machine that gets the files.
    local: &'a Path,
    /// Gets the bytes that are there, and all bytes.
    progress: &'a dyn Fn(u64, u64),
    all_bytes: u64,
    /// The ending of a file's name until the file is whole.
    ending: String,
}

impl CloudBucket {
    /// Fetches all objects below the prefix `name` (all of the bucket, if it is empty) into a folder, several at a
    /// time. A file that was fetched before is kept if its size and the object's version are the same, which [`FETCH_INDEX_FILE`]
    /// records. Each file is whole or absent. Files that are no longer in the store stay. Where several programs
    /// fetch into the same folder, one does and the others wait. `progress` gets the bytes that are there, and all
    /// bytes.
    ///
    /// # Errors
    /// When there are more than `most_bytes`, a name leaves the folder, an object changes meanwhile, the store cannot
    /// be used, or a file cannot be written. What has been fetched stays, and the same call continues.
    pub fn fetch_folder(
        &self,
        name: &str,
        local: &Path,
        most_bytes: u64,
        progress: &dyn Fn(u64, u64),
    ) -> Result<FetchSummary, CloudError> {
        let entries = objects_below(name, self.list_objects(name)?)?;
        let all_bytes = entries.iter().fold(0u64, |sum, entry| sum.saturating_add(entry.bytes));
        if all_bytes > most_bytes {
            return Err(CloudError::TooLarge { at: self.shown_address(name), bytes: all_bytes, most: most_bytes });
        }
        fs::create_dir_all(local).map_err(CloudError::for_local_file(local, "make this folder"))?;
        let lock = FetchLock::wait_for(local)?;
        let mut index = FetchIndex::read_index(local, &self.shown_address(name))?;
        let fetching = FolderFetch { bucket: self, name, local, progress, all_bytes, ending: lock.unfinished_suffix() };
        let (kept, missing): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| index.has_object(local, entry));
        let done = kept.iter().map(|entry| entry.bytes).sum();
        progress(done, all_bytes);
        let fetched = self.block_on_store(fetching.fetch_all(&missing, done, &mut index));
        // After a failure too, so that the files that arrived are not fetched again.
        let written = index.write_index(local);
        let fetched = fetched?;
        written.map(|()| FetchSummary { kept: kept.len(), ..fetched })
    }
}

impl FolderFetch<'_> {
    /// Fetches the missing files and adds each to the index. `done` is the bytes that are there already.
    async fn fetch_all(
        &self,
        missing: &[&StoredObject],
        mut done: u64,
        index: &mut FetchIndex,
    ) -> Result<FetchSummary, CloudError> {
        let mut fetched = FetchSummary::default();
        let mut last_write = Instant::now();
        let mut arriving =
            stream::iter(missing.iter().map(|entry| self.fetch_one(entry))).buffer_unordered(CONCURRENT_FILES);
        while let Some(entry) = arriving.next().await {
            let entry = entry?;
            index.add_object(entry);
            fetched.files += 1;
            fetched.bytes += entry.bytes;
            done += entry.bytes;
            (self.progress)(done, self.all_bytes);
            if last_write.elapsed() > INDEX_WRITE_INTERVAL {
                index.write_index(self.local)?;
                last_write = Instant::now();
            }
        }
        Ok(fetched)
    }

    /// Fetches a file under an unfinished name, and gives it its own name when it is whole.
    async fn fetch_one<'e>(&self, entry: &'e StoredObject) -> Result<&'e StoredObject, CloudError> {
        let relative = names::local_file_path(&entry.name)?;
        let path = self.local.join(&relative);
        make_parents(self.local, &relative)?;
        let mut part = path.clone().into_os_string();
        part.push(&self.ending);
        let part = PathBuf::from(part);
        // Removes the rest of a fetch that was killed, or a link.
        let _ = fs::remove_file(&part);
        let opened = File::options().write(true).create_new(true).open(&part);
        let fetched = match opened.map_err(CloudError::for_local_file(&part, "write")) {
            Ok(file) => self.fetch_pieces(entry, &part, file).await,
            Err(error) => Err(error),
        };
        let placed =
            fetched.and_then(|()| fs::rename(&part, &path).map_err(CloudError::for_local_file(&path, "write")));
        if placed.is_err() {
            // The first failure is the one to report.
            let _ = fs::remove_file(&part);
        }
        placed.map(|()| entry)
    }

    /// Fetches the content of an object into the file at `part`.
    async fn fetch_pieces(&self, entry: &StoredObject, part: &Path, mut file: File) -> Result<(), CloudError> {
        let mut start = 0;
        while start < entry.bytes {
            let end = entry.bytes.min(start + MAX_PIECE_BYTES);
            self.fetch_piece(entry, part, &mut file, start..end).await?;
            start = end;
        }
        file.sync_all().map_err(CloudError::for_local_file(part, "write"))
    }

    /// Appends a range of an object's bytes to the file, if the object is still the one that was listed.
    async fn fetch_piece(
        &self,
        entry: &StoredObject,
        part: &Path,
        file: &mut File,
        range: std::ops::Range<u64>,
    ) -> Result<(), CloudError> {
        let name = if self.name.is_empty() { entry.name.clone() } else { format!("{}/{}", self.name, entry.name) };
        let wrong = |error| self.bucket.object_error(&name, "read it", &error);
        let changed = || CloudError::Changed { at: self.bucket.shown_address(&name) };
        let mut remaining = range.end - range.start;
        let options = GetOptions { range: Some(GetRange::Bounded(range)), ..GetOptions::default() };
        let store: &dyn ObjectStore = &*self.bucket.store;
        let answer = store.get_opts(&self.bucket.object_path(&name)?, options).await.map_err(wrong)?;
        let is_same = bucket::object_version(&answer.meta) == entry.version && answer.meta.size == entry.bytes;
        if !is_same {
            return Err(changed());
        }
        let mut bytes = answer.into_stream();
        while let Some(piece) = bytes.next().await {
            let piece = piece.map_err(wrong)?;
            remaining = remaining.checked_sub(piece.len() as u64).ok_or_else(changed)?;
            file.write_all(&piece).map_err(CloudError::for_local_file(part, "write"))?;
        }
        if remaining == 0 { Ok(()) } else { Err(changed()) }
    }
}

/// The objects with their names relative to a prefix. All names are checked before anything is written.
fn objects_below(prefix: &str, entries: Vec<StoredObject>) -> Result<Vec<StoredObject>, CloudError> {
    let mut inside = Vec::with_capacity(entries.len());
    for mut entry in entries {
        if !prefix.is_empty() {
            let rest = entry.name.strip_prefix(prefix).and_then(|rest| rest.strip_prefix('/'));
            let Some(rest) = rest else { continue };
            entry.name = rest.to_owned();
        }
        names::local_file_path(&entry.name)?;
        if entry.name.starts_with(FETCH_INDEX_FILE) {
            return Err(names::name_error(&entry.name, "is kept for the list of what was fetched"));
        }
        if entry.name.ends_with(lock::UNFINISHED_SUFFIX) {
            return Err(names::name_error(&entry.name, "is kept for files that are not whole yet"));
        }
        inside.push(entry);
    }
    without_folders(inside)
}

/// Leaves out the empty objects that represent folders. An object with content and other objects below it is an error,
/// because it cannot be a file and a folder at once.
fn without_folders(entries: Vec<StoredObject>) -> Result<Vec<StoredObject>, CloudError> {
    let mut folders = BTreeSet::new();
    for entry in &entries {
        let ends = entry.name.match_indices('/').filter_map(|(end, _)| entry.name.get(..end));
        folders.extend(ends.map(str::to_owned));
    }
    let is_folder = |entry: &StoredObject| folders.contains(&entry.name);
    if let Some(both) = entries.iter().find(|entry| is_folder(entry) && entry.bytes > 0) {
        return Err(names::name_error(&both.name, "is a file and a folder at the same time"));
    }
    Ok(entries.into_iter().filter(|entry| !is_folder(entry)).collect())
}

/// Makes the folders of a file. None of them may be a link, because a link could lead out of the local folder.
fn make_parents(local: &Path, relative: &Path) -> Result<(), CloudError> {
    let mut folder = local.to_owned();
    for part in relative.parent().into_iter().flat_map(Path::components) {
        folder.push(part);
        match fs::create_dir(&folder) {
            Ok(()) => {}
            Err(error) if error.kind() == ErrorKind::AlreadyExists && is_folder(&folder) => {}
            Err(error) => return Err(CloudError::for_local_file(&folder, "make this folder")(error)),
        }
    }
    Ok(())
}

fn is_folder(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|about| about.is_dir())
}
