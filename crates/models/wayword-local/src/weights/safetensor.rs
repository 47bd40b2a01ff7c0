//! Reads one safetensors file: a JSON header with names, types, shapes and offsets, then the bytes of the tensors.

use crate::{LocalError, error::FETCH_AGAIN};
use candle_core::{DType, Device, Tensor};
use safetensors::{
    Dtype,
    tensor::{Metadata, TensorInfo},
};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

/// The longest header, bytes. This is the limit of the format.
const MAX_HEADER_BYTES: u64 = 100_000_000;

/// An open file with its header.
pub(super) struct SafeFile {
    path: PathBuf,
    file: Mutex<File>,
    header: Metadata,
    /// The position in the file at which the header ends and the tensors begin, bytes.
    begin: u64,
}

impl SafeFile {
    /// Opens a file and reads its header, which must agree with the file's length.
    pub(super) fn open(path: &Path) -> Result<Self, LocalError> {
        let io = |error| LocalError::from_io(path, "read", error);
        let damaged = |problem: String| LocalError::File {
            file: path.to_owned(),
            problem: format!("it is cut off or not a safetensors file: {problem}"),
            hint: FETCH_AGAIN,
        };
        let mut file = File::open(path).map_err(io)?;
        let length = file.metadata().map_err(io)?.len();
        let mut size = [0; 8];
        file.read_exact(&mut size).map_err(|_| damaged(format!("it has only {length} bytes and no header")))?;
        let size = u64::from_le_bytes(size);
        if size > MAX_HEADER_BYTES || size > length - 8 {
            return Err(damaged(format!("its header would have {size} bytes, but the file has {length}")));
        }
        let mut header = Vec::new();
        file.by_ref().take(size).read_to_end(&mut header).map_err(io)?;
        let header: Metadata =
            serde_json::from_slice(&header).map_err(|error| damaged(format!("its header: {error}")))?;
        let (begin, needed) = (8 + size, header.data_len() as u64);
        if begin.checked_add(needed) != Some(length) {
            return Err(damaged(format!("its tensors need {needed} bytes, but the file has {}", length - begin)));
        }
        Ok(Self { path: path.to_owned(), file: Mutex::new(file), header, begin })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn tensor_names(&self) -> impl Iterator<Item = String> {
        self.header.offset_keys().into_iter()
    }

    pub(super) fn tensor_shape(&self, name: &str) -> Option<Vec<usize>> {
        Some(self.header.info(name)?.shape.clone())
    }

    /// Reads a tensor, and checks its shape.
    pub(super) fn read_tensor(&self, name: &str, shape: &[usize]) -> Result<Tensor, LocalError> {
        let wrong = |problem: String| LocalError::bad_tensor(&self.path, name, problem);
        let info = self.header.info(name).ok_or_else(|| wrong("it is missing".to_owned()))?;
        if info.shape != shape {
            return Err(wrong(format!("its shape is {:?}, not {shape:?}", info.shape)));
        }
        let dtype =
            candle_dtype(info).ok_or_else(|| wrong(format!("numbers of type {:?} are not supported", info.dtype)))?;
        let bytes = self.tensor_bytes(info)?;
        Tensor::from_raw_buffer(&bytes, dtype, shape, &Device::Cpu).map_err(|error| wrong(error.to_string()))
    }

    fn tensor_bytes(&self, info: &TensorInfo) -> Result<Vec<u8>, LocalError> {
        let (from, to) = info.data_offsets;
        let io = |error| LocalError::Io { file: self.path.clone(), doing: "read", source: Arc::new(error) };
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.begin + from as u64)).map_err(io)?;
        // The header was checked against the file's length, so this is not longer than the file.
        let mut bytes = vec![0; to - from];
        file.read_exact(&mut bytes).map_err(io)?;
        Ok(bytes)
    }
}

fn candle_dtype(info: &TensorInfo) -> Option<DType> {
    Some(match info.dtype {
        Dtype::F64 => DType::F64,
        Dtype::F32 => DType::F32,
        Dtype::BF16 => DType::BF16,
        Dtype::F16 => DType::F16,
        Dtype::I64 => DType::I64,
        _ => return None,
    })
}
