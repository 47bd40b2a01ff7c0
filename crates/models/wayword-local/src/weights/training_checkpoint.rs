//! Reads a checkpoint as training leaves it (`.pth`): a zip archive with a pickle, which describes the tensors, and one
//! entry for the numbers of each storage. Only the weights are read, which are under the key `model`; the state of the
//! optimiser is left out.

use super::pickle::CheckpointPickle;
use crate::{LocalError, error::FETCH_AGAIN};
use candle_core::{DType, Device, Tensor};
use std::{
    collections::BTreeMap,
    fs::File,
    io::{self, BufReader, Read},
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};
use zip::{CompressionMethod, ZipArchive};

/// The key of the table with the weights.
const WEIGHTS_TABLE: &str = "model";

/// The prefix of the names of weights that were trained on several devices.
const PARALLEL_NAME_PREFIX: &str = "module.";

/// The longest pickle that is read, bytes; a longer one is refused. The numbers of tensors are not in it.
const MAX_PICKLE_BYTES: u64 = 32 << 20;

/// An open archive, and the locations of its weights.
pub(super) struct TrainingCheckpoint {
    path: PathBuf,
    archive: Mutex<ZipArchive<BufReader<File>>>,
    /// The name of the folder within the archive.
    root: String,
    tensors: BTreeMap<String, ArchivedTensor>,
    /// The length of the file, bytes.
    length: u64,
}

/// The location of a tensor: a part of the numbers of an entry of the archive.
struct ArchivedTensor {
    entry: String,
    dtype: DType,
    /// How many numbers the entry has, and how many of them come before the tensor.
    count: u64,
    offset: u64,
    shape: Vec<usize>,
    strides: Vec<usize>,
}

impl TrainingCheckpoint {
    pub(super) fn open(path: &Path) -> Result<Self, LocalError> {
        let io = |error| LocalError::from_io(path, "read", error);
        let damaged = |problem: String| LocalError::File {
            file: path.to_owned(),
            problem: format!("it is cut off or not a checkpoint of PyTorch: {problem}"),
            hint: FETCH_AGAIN,
        };
        let file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|error| damaged(error.to_string()))?;
        let is_pickle = |name: &&str| name.split_once('/').is_some_and(|(_, file)| file == "data.pkl");
        let names: Vec<String> = archive.file_names().filter_map(|name| Some(name.ok()?.into_owned())).collect();
        let pickle = names.iter().map(String::as_str).find(is_pickle);
        let root = pickle.and_then(|name| name.split_once('/')).map(|(root, _)| root.to_owned());
        let root = root.ok_or_else(|| damaged("it has no data.pkl".to_owned()))?;
        let bytes = with_entry(&mut archive, &format!("{root}/data.pkl"), |entry| {
            if entry.size > MAX_PICKLE_BYTES {
                return Err(format!("its pickle has {} bytes", entry.size));
            }
            let mut bytes = Vec::new();
            entry.read.read_to_end(&mut bytes).map_err(|error| error.to_string())?;
            Ok(bytes)
        });
        let pickle = CheckpointPickle::from_bytes(&bytes.map_err(damaged)?).map_err(damaged)?;
        let tensors = pickle.tensors_under(WEIGHTS_TABLE).map_err(damaged)?.map(|(name, place)| {
            let location = ArchivedTensor {
                entry: place.storage.key.to_string(),
                dtype: if place.storage.floats { DType::F32 } else { DType::I64 },
                count: place.storage.count,
                offset: place.offset,
                shape: place.shape.clone(),
                strides: place.strides.clone(),
            };
            (name.strip_prefix(PARALLEL_NAME_PREFIX).unwrap_or(&name).to_owned(), location)
        });
        let tensors = tensors.collect();
        Ok(Self { path: path.to_owned(), archive: Mutex::new(archive), root, tensors, length })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn tensor_names(&self) -> impl Iterator<Item = String> {
        self.tensors.keys().cloned()
    }

    pub(super) fn tensor_shape(&self, name: &str) -> Option<Vec<usize>> {
        Some(self.tensors.get(name)?.shape.clone())
    }

    /// Reads a tensor, and checks its shape.
    pub(super) fn read_tensor(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        let wrong = |problem: String| LocalError::bad_tensor(&self.path, name, problem);
        let location = self.tensors.get(name).ok_or_else(|| wrong("it is missing".to_owned()))?;
        if location.shape != shape {
            return Err(wrong(format!("its shape is {:?}, not {shape:?}", location.shape)));
        }
        let bytes =
            location.byte_range(self.length).and_then(|range| self.tensor_bytes(location, range)).map_err(wrong)?;
        Tensor::from_raw_buffer(&bytes, location.dtype, shape, &Device::Cpu).map_err(|error| wrong(error.to_string()))
    }

    /// The bytes of a tensor: `length` bytes of its entry from position `from` on.
    fn tensor_bytes(&self, location: &ArchivedTensor, (from, length): (u64, u64)) -> Result<Vec<u8>, String> {
        let mut archive = self.archive.lock().unwrap_or_else(PoisonError::into_inner);
        with_entry(&mut archive, &format!("{}/data/{}", self.root, location.entry), |entry| {
            let whole = location.count * location.dtype.size_in_bytes() as u64;
            if entry.size != whole {
                return Err(format!("its entry of the archive has {} bytes, not {whole}", entry.size));
            }
            let mut read = entry.read;
            let to_text = |error: io::Error| error.to_string();
            io::copy(&mut Read::take(&mut read, from), &mut io::sink()).map_err(to_text)?;
            // The length was checked against that of the file.
            let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
            Read::take(&mut read, length).read_to_end(&mut bytes).map_err(to_text)?;
            // Reading to the end of the entry makes the archive reader compare the checksum.
            let surplus =
                if from + length == whole { io::copy(&mut read, &mut io::sink()).map_err(to_text)? } else { 0 };
            if bytes.len() as u64 == length && surplus == 0 { Ok(bytes) } else { Err("it is cut off".to_owned()) }
        })
    }
}

impl ArchivedTensor {
    /// The position of the tensor's first byte in the entry, and the number of its bytes. `file` is the length of the
    /// file.
    fn byte_range(&self, file: u64) -> Result<(u64, u64), String> {
        let numbers = self.shape.iter().try_fold(1_u64, |product, &length| product.checked_mul(length as u64));
        let size = self.dtype.size_in_bytes() as u64;
        let end = numbers.and_then(|numbers| self.offset.checked_add(numbers)).filter(|end| *end <= self.count);
        let whole = self.count.checked_mul(size).filter(|whole| *whole <= file);
        let (Some(numbers), Some(_), Some(_)) = (numbers, end, whole) else {
            return Err(format!("it is larger than what the file of {file} bytes has of it"));
        };
        let mut step = 1_usize;
        for (&length, &stride) in self.shape.iter().zip(&self.strides).rev() {
            if length > 1 && stride != step {
                return Err(format!(
                    "its numbers do not lie in order: shape {:?}, strides {:?}",
                    self.shape, self.strides
                ));
            }
            step = step.saturating_mul(length.max(1));
        }
        Ok((self.offset * size, numbers * size))
    }
}

/// An entry of an archive.
struct ArchiveEntry<'a> {
    size: u64,
    read: &'a mut dyn Read,
}

/// Calls `then` with an entry of the archive. A compressed entry is refused: PyTorch compresses none, and one could
/// unpack to more bytes than the memory holds.
fn with_entry<T>(
    archive: &mut ZipArchive<BufReader<File>>,
    name: &str,
    then: impl FnOnce(ArchiveEntry<'_>) -> Result<T, String>,
) -> Result<T, String> {
    let mut found = archive.by_name(name).map_err(|error| format!("{name}: {error}"))?;
    if found.compression() != CompressionMethod::Stored || found.compressed_size() != found.size() {
        return Err(format!("{name} is compressed"));
    }
    then(ArchiveEntry { size: found.size(), read: &mut found })
}

#[cfg(test)]
mod tests;
