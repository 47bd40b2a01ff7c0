//! Sends the files of a folder to an object store, large files in parts.

use super::{CloudBucket, CloudError, FETCH_INDEX_FILE, lock::UNFINISHED_SUFFIX, names};
use futures_util::{StreamExt, TryStreamExt, stream};
use object_store::{ObjectStoreExt, PutPayload, WriteMultipart, path::Path as Place};
use std::{
    fs::{self, File},
    io::Read,
    path::{Path, PathBuf},
};

/// How many files are sent at the same time.
const CONCURRENT_FILES: usize = 6;

/// How many parts of one file are sent at the same time.
const CONCURRENT_PARTS: usize = 2;

/// The size of a part, and the largest file that is sent in one request, bytes. Files with too many parts get larger ones.
const PART_BYTES: u64 = 8 << 20;

/// The most parts of a file: below the limit of S3, which is 10,000.
const MAX_PARTS: u64 = 9_000;

/// Counts of a send.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SendSummary {
    /// How many files.
    pub files: usize,
    /// How many bytes.
    pub bytes: u64,
}

/// A file to send: its path on this machine, its name in the bucket, and its size.
struct OutgoingFile {
    path: PathBuf,
    name: String,
    bytes: u64,
}

impl CloudBucket {
    /// Sends every plain file of a folder and of the folders in it, below the prefix `name`, several at a time. Links
    /// are neither followed nor sent, and neither are the index of fetched files ([`FETCH_INDEX_FILE`]) and the rest of a killed fetch.
    /// Objects of the same names are overwritten, so that a repeated call does no harm; give each attempt another prefix.
    ///
    /// After a crash some of the files are in the store, each of them whole. To mark a set as complete, make another object
    /// with [`CloudBucket::put_new`] afterwards.
    ///
    /// # Errors
    /// When a file cannot be read, has a name that stores do not take, changes meanwhile, or the store cannot be used.
    pub fn send_folder(&self, local: &Path, name: &str) -> Result<SendSummary, CloudError> {
        names::check_name(name)?;
        let items = list_files(local, name)?;
        self.block_on_store(async {
            let sent = stream::iter(items.iter().map(|item| self.send_file(item))).buffer_unordered(CONCURRENT_FILES);
            sent.try_fold(SendSummary::default(), |sum, bytes| async move {
                Ok(SendSummary { files: sum.files + 1, bytes: sum.bytes.saturating_add(bytes) })
            })
            .await
        })
    }

    /// Sends a file, and returns its size in bytes.
    async fn send_file(&self, item: &OutgoingFile) -> Result<u64, CloudError> {
        let place = self.object_path(&item.name)?;
        let file = File::open(&item.path).map_err(CloudError::for_local_file(&item.path, "open"))?;
        if item.bytes > PART_BYTES {
            return self.send_parts(item, &place, file).await;
        }
        let bytes = read_piece(&file, item, item.bytes)?;
        check_at_end(&file, item)?;
        let put = self.store.put(&place, PutPayload::from(bytes)).await;
        put.map(|_| item.bytes).map_err(|error| self.object_error(&item.name, "write it", &error))
    }

    /// Sends a large file in parts, and returns its size in bytes. After a failure no object has the parts.
    async fn send_parts(&self, item: &OutgoingFile, place: &Place, file: File) -> Result<u64, CloudError> {
        let wrong = |error| self.object_error(&item.name, "write it", &error);
        let part = part_size(item.bytes);
        let upload = self.store.put_multipart(place).await.map_err(wrong)?;
        let mut writer = WriteMultipart::new_with_chunk_size(upload, usize::try_from(part).unwrap_or(usize::MAX));
        if let Err(error) = self.write_parts(&mut writer, item, &file, part).await {
            // The first failure is the one to report. Parts that stay belong to no object, and the store's rules remove them.
            let _ = writer.abort().await;
            return Err(error);
        }
        writer.finish().await.map(|_| item.bytes).map_err(wrong)
    }

    /// Reads a file and hands its parts of `part` bytes to the writer.
    async fn write_parts(
        &self,
        writer: &mut WriteMultipart,
        item: &OutgoingFile,
        file: &File,
        part: u64,
    ) -> Result<(), CloudError> {
        let mut remaining = item.bytes;
        while remaining > 0 {
            let bytes = read_piece(file, item, remaining.min(part))?;
            remaining -= bytes.len() as u64;
            writer
                .wait_for_capacity(CONCURRENT_PARTS)
                .await
                .map_err(|error| self.object_error(&item.name, "write it", &error))?;
            writer.put(bytes.into());
        }
        check_at_end(file, item)
    }
}

/// The size of the parts of a file. All but the last have the same size, as some stores demand.
fn part_size(bytes: u64) -> u64 {
    PART_BYTES.max(bytes.div_ceil(MAX_PARTS))
}

/// The next `length` bytes of a file.
fn read_piece(mut file: &File, item: &OutgoingFile, length: u64) -> Result<Vec<u8>, CloudError> {
    let mut bytes = vec![0; usize::try_from(length).unwrap_or(usize::MAX)];
    file.read_exact(&mut bytes).map_err(CloudError::for_local_file(&item.path, "read"))?;
    Ok(bytes)
}

/// Checks that a file was read to its end: it is longer than its listed size if it grew meanwhile.
fn check_at_end(mut file: &File, item: &OutgoingFile) -> Result<(), CloudError> {
    match file.read(&mut [0]).map_err(CloudError::for_local_file(&item.path, "read"))? {
        0 => Ok(()),
        _ => Err(CloudError::Changed { at: item.path.display().to_string() }),
    }
}

/// Whether a file is the index or an unfinished file of a fetch into the folder. `is_top` is whether it lies in the folder itself.
fn is_fetch_file(name: &str, is_top: bool) -> bool {
    name.ends_with(UNFINISHED_SUFFIX) || (is_top && name.starts_with(FETCH_INDEX_FILE))
}

/// The plain files below a folder, in the order of their names.
fn list_files(local: &Path, name: &str) -> Result<Vec<OutgoingFile>, CloudError> {
    let mut items = Vec::new();
    let mut folders = vec![(local.to_owned(), name.to_owned())];
    while let Some((folder, prefix)) = folders.pop() {
        let wrong = || CloudError::for_local_file(&folder, "list");
        for inside in fs::read_dir(&folder).map_err(wrong())? {
            let inside = inside.map_err(wrong())?;
            let about = inside.file_type().map_err(wrong())?;
            let path = inside.path();
            let Some(last) = inside.file_name().to_str().map(str::to_owned) else {
                return Err(names::name_error(&path.to_string_lossy(), "is not Unicode"));
            };
            let name = format!("{prefix}/{last}");
            if about.is_dir() {
                names::check_name(&name)?;
                folders.push((path, name));
            } else if about.is_file() && !is_fetch_file(&last, folder == local) {
                names::check_name(&name)?;
                let bytes = inside.metadata().map_err(CloudError::for_local_file(&path, "read"))?.len();
                items.push(OutgoingFile { path, name, bytes });
            }
        }
    }
    items.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(items)
}

#[cfg(test)]
mod tests {
    use super::{MAX_PARTS, PART_BYTES, part_size};

    #[test]
    fn a_huge_file_has_no_more_parts_than_stores_take() {
        assert_eq!(part_size(PART_BYTES + 1), PART_BYTES);
        let huge = 4 << 40;
        assert!(huge_parts(huge) <= MAX_PARTS);
    }

    fn huge_parts(bytes: u64) -> u64 {
        bytes.div_ceil(part_size(bytes))
    }
}
