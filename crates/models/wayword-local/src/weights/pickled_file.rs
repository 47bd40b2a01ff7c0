//! Reads `pytorch_model.bin`, a checkpoint that PyTorch pickled. Some public checkpoints have no other form.
//!
//! candle reads the pickle as data, and executes no code in it.

use crate::{LocalError, error::FETCH_AGAIN};
use candle_core::{Tensor, pickle::PthTensors};
use std::path::{Path, PathBuf};

/// A pickled checkpoint.
pub(super) struct PickledFile {
    path: PathBuf,
    tensors: PthTensors,
    /// The length of the file, bytes.
    length: u64,
}

impl PickledFile {
    pub(super) fn open(path: &Path) -> Result<Self, LocalError> {
        let length = std::fs::metadata(path).map_err(|error| LocalError::from_io(path, "read", error))?.len();
        let tensors = PthTensors::new(path, None).map_err(|error| LocalError::File {
            file: path.to_owned(),
            problem: format!("it is cut off or not a PyTorch checkpoint: {}", first_line(&error)),
            hint: FETCH_AGAIN,
        })?;
        Ok(Self { path: path.to_owned(), tensors, length })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn tensor_names(&self) -> impl Iterator<Item = String> {
        let mut names: Vec<String> = self.tensors.tensor_infos().keys().cloned().collect();
        names.sort_unstable();
        names.into_iter()
    }

    pub(super) fn tensor_shape(&self, name: &str) -> Option<Vec<usize>> {
        Some(self.tensors.tensor_infos().get(name)?.layout.shape().dims().to_vec())
    }

    /// Reads a tensor, and checks its shape.
    pub(super) fn read_tensor(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        let wrong = |problem: String| LocalError::bad_tensor(&self.path, name, problem);
        let found = self.tensor_shape(name).ok_or_else(|| wrong("it is missing".to_owned()))?;
        if found != shape {
            return Err(wrong(format!("its shape is {found:?}, not {shape:?}")));
        }
        // PyTorch does not compress tensors, so a tensor cannot be larger than the file.
        let bytes = shape.iter().try_fold(1_u64, |product, &length| product.checked_mul(length as u64));
        if bytes.is_none_or(|bytes| bytes > self.length) {
            return Err(wrong(format!("it is larger than the file of {} bytes", self.length)));
        }
        let tensor = self.tensors.get(name).map_err(|error| wrong(first_line(&error)))?;
        tensor.ok_or_else(|| wrong("it is missing".to_owned()))
    }
}

/// The first line of an error, because candle's errors may contain a backtrace.
fn first_line(error: &candle_core::Error) -> String {
    error.to_string().lines().next().unwrap_or("it cannot be read").to_owned()
}
