//! Reads the weights of a checkpoint, tensor by tensor, from safetensors files or from pickled files of PyTorch.
//!
//! A file is never mapped into memory. Each tensor is converted for the computation as soon as it is read, so that at
//! most one tensor is in memory twice.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod pickle;
mod pickled_file;
mod safetensor;
mod scope;
mod training_checkpoint;

pub(crate) use scope::WeightScope;

use crate::{LocalError, ModelDevice, WeightPrecision, error::FETCH_AGAIN};
use candle_core::{DType, Tensor};
use pickled_file::PickledFile;
use safetensor::SafeFile;
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use training_checkpoint::TrainingCheckpoint;

/// The longest index of a checkpoint in several files that is read, bytes. A longer one is refused.
const MAX_INDEX_BYTES: u64 = 64 << 20;

/// A checkpoint's tensors by their names.
pub(crate) struct CheckpointWeights {
    /// The file that an error names if a tensor is missing.
    path: PathBuf,
    files: Vec<WeightFile>,
    /// The file of each tensor, as an index into `files`.
    file_of_tensor: BTreeMap<String, usize>,
    device: candle_core::Device,
    dtype: DType,
}

/// A file of tensors.
enum WeightFile {
    /// `.safetensors`.
    Safe(SafeFile),
    /// `pytorch_model.bin`.
    Pickled(PickledFile),
    /// `.pth`.
    Trained(TrainingCheckpoint),
}

/// `model.safetensors.index.json`.
#[derive(Deserialize)]
struct WeightsIndex {
    /// The file of each tensor, by its name.
    weight_map: BTreeMap<String, String>,
}

impl CheckpointWeights {
    /// Opens a model's folder: `model.safetensors`, or its parts by `model.safetensors.index.json`, or
    /// `pytorch_model.bin`.
    ///
    /// # Errors
    /// When none of these files exists, or one is damaged.
    pub(crate) fn open(folder: &Path, device: &ModelDevice, precision: WeightPrecision) -> Result<Self, LocalError> {
        let whole = folder.join("model.safetensors");
        let index = folder.join("model.safetensors.index.json");
        let pickled = folder.join("pytorch_model.bin");
        let (path, files) = if whole.exists() {
            let file = WeightFile::Safe(SafeFile::open(&whole)?);
            (whole, vec![file])
        } else if index.exists() {
            let files = open_parts(folder, &index)?;
            (index, files)
        } else if pickled.exists() {
            let file = WeightFile::Pickled(PickledFile::open(&pickled)?);
            (pickled, vec![file])
        } else {
            let hint =
                "put the checkpoint's model.safetensors there, or fetch it: wayword models fetch NAME".to_owned();
            return Err(LocalError::Missing { file: whole, what: "the checkpoint", hint });
        };
        Ok(Self::new(path, files, device, precision))
    }

    /// Opens one file: `.safetensors`, or a checkpoint as training leaves it. Only the weights of the latter are read.
    ///
    /// # Errors
    /// When it is missing or damaged.
    pub(crate) fn open_file(path: &Path, device: &ModelDevice, precision: WeightPrecision) -> Result<Self, LocalError> {
        let is_safe = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("safetensors"));
        let file = if is_safe {
            SafeFile::open(path).map(WeightFile::Safe)
        } else {
            TrainingCheckpoint::open(path).map(WeightFile::Trained)
        };
        Ok(Self::new(path.to_owned(), vec![file?], device, precision))
    }

    fn new(path: PathBuf, files: Vec<WeightFile>, device: &ModelDevice, precision: WeightPrecision) -> Self {
        let mut at = BTreeMap::new();
        for (number, file) in files.iter().enumerate() {
            at.extend(file.tensor_names().map(|name| (name, number)));
        }
        Self { path, files, file_of_tensor: at, device: device.0.clone(), dtype: precision.candle_dtype() }
    }

    /// The tensors with names that begin with `prefix`, or all tensors for "".
    pub(crate) fn scope_under(&self, prefix: &str) -> WeightScope<'_> {
        WeightScope::new(self, prefix)
    }

    /// The size of all tensors at the weights' precision, bytes.
    pub(crate) fn size_bytes(&self) -> u64 {
        let elements = |name: &String| {
            let shape = self.tensor_shape(name).unwrap_or_default();
            shape.iter().fold(1_u64, |product, &length| product.saturating_mul(length as u64))
        };
        let all = self.file_of_tensor.keys().fold(0_u64, |sum, name| sum.saturating_add(elements(name)));
        all.saturating_mul(self.dtype.size_in_bytes() as u64)
    }

    fn has_tensor(&self, name: &str) -> bool {
        self.file_of_tensor.contains_key(name)
    }

    /// Reads a tensor, checks its shape, and converts it to the weights' precision and device.
    fn read_tensor(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        let lacks = || LocalError::bad_tensor(&self.path, name, "it is missing");
        let file = self.file_of_tensor.get(name).and_then(|&at| self.files.get(at)).ok_or_else(lacks)?;
        let tensor = match file {
            WeightFile::Safe(file) => file.read_tensor(name, shape)?,
            WeightFile::Pickled(file) => file.read_tensor(name, shape)?,
            WeightFile::Trained(file) => file.read_tensor(name, shape)?,
        };
        let wrong = |error: candle_core::Error| LocalError::bad_tensor(file.path(), name, error.to_string());
        tensor.to_dtype(self.dtype).and_then(|tensor| tensor.to_device(&self.device)).map_err(wrong)
    }

    /// The shape of a tensor, if it exists.
    fn tensor_shape(&self, name: &str) -> Option<Vec<usize>> {
        match self.files.get(*self.file_of_tensor.get(name)?)? {
            WeightFile::Safe(file) => file.tensor_shape(name),
            WeightFile::Pickled(file) => file.tensor_shape(name),
            WeightFile::Trained(file) => file.tensor_shape(name),
        }
    }
}

impl WeightFile {
    fn path(&self) -> &Path {
        match self {
            Self::Safe(file) => file.path(),
            Self::Pickled(file) => file.path(),
            Self::Trained(file) => file.path(),
        }
    }

    fn tensor_names(&self) -> Box<dyn Iterator<Item = String> + '_> {
        match self {
            Self::Safe(file) => Box::new(file.tensor_names()),
            Self::Pickled(file) => Box::new(file.tensor_names()),
            Self::Trained(file) => Box::new(file.tensor_names()),
        }
    }
}

/// The files that an index names, each opened once.
fn open_parts(folder: &Path, index: &Path) -> Result<Vec<WeightFile>, LocalError> {
    let open = |name: &String| SafeFile::open(&folder.join(name)).map(WeightFile::Safe);
    part_names(index)?.iter().map(open).collect()
}

/// The names of the files that an index names, each once.
///
/// # Errors
/// When the index is damaged, or names something that is not a file in the same folder.
pub(crate) fn part_names(index: &Path) -> Result<BTreeSet<String>, LocalError> {
    let damaged = |problem: String| LocalError::File { file: index.to_owned(), problem, hint: FETCH_AGAIN };
    let length = std::fs::metadata(index).map_err(|error| LocalError::from_io(index, "read", error))?.len();
    if length > MAX_INDEX_BYTES {
        return Err(damaged(format!("it is too long for an index: {length} bytes")));
    }
    let text = std::fs::read_to_string(index).map_err(|error| LocalError::from_io(index, "read", error))?;
    let parsed: WeightsIndex = serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))?;
    let names: BTreeSet<String> = parsed.weight_map.into_values().collect();
    // The names are untrusted, and must not lead out of the folder.
    let is_file = |name: &str| {
        Path::new(name).file_name().is_some_and(|file| file == name) && !name.chars().any(char::is_control)
    };
    match names.iter().find(|name| !is_file(name)) {
        Some(name) => Err(damaged(format!("{name:?} is not the name of a file"))),
        None => Ok(names),
    }
}

#[cfg(test)]
mod tests;
