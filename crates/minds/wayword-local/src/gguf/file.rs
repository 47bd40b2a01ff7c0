//! A GGUF file: its metadata by name and kind, and its tensors, each held against the shape that is expected.

use super::header::{Header, Value};
use crate::LocalError;
use candle_core::{
    Device, Shape, Tensor,
    quantized::{QTensor, gguf_file::TensorInfo},
};
use std::{
    fs::File,
    io::BufReader,
    path::{Path, PathBuf},
};

/// An open GGUF file.
pub(super) struct GgufFile {
    path: PathBuf,
    file: File,
    header: Header,
}

impl GgufFile {
    /// Reads the head of a file.
    ///
    /// # Errors
    /// When it is missing, cut off, or none.
    pub(super) fn open(path: &Path) -> Result<Self, LocalError> {
        let file = File::open(path).map_err(|error| LocalError::io(path, "open", error))?;
        let length = file.metadata().map_err(|error| LocalError::io(path, "read", error))?.len();
        let header = Header::read(BufReader::new(&file), length).map_err(|problem| wrong(path, problem))?;
        Ok(Self { path: path.to_owned(), file, header })
    }

    /// An error about this file.
    pub(super) fn wrong(&self, problem: impl Into<String>) -> LocalError {
        wrong(&self.path, problem)
    }

    /// What stands under a name, as `kind` reads it; `None` where nothing does.
    fn get<'a, T>(
        &'a self,
        key: &str,
        what: &str,
        kind: impl Fn(&'a Value) -> Option<T>,
    ) -> Result<Option<T>, LocalError> {
        let Some(value) = self.header.metadata.get(key) else { return Ok(None) };
        kind(value).map(Some).ok_or_else(|| self.wrong(format!("{key}: it is no {what}")))
    }

    /// A text.
    pub(super) fn text(&self, key: &str) -> Result<Option<&str>, LocalError> {
        self.get(key, "text", |value| if let Value::Text(text) = value { Some(&text[..]) } else { None })
    }

    /// A whole number from `least` to `most`.
    pub(super) fn whole(&self, key: &str, least: usize, most: usize) -> Result<Option<usize>, LocalError> {
        let what = format!("whole number from {least} to {most}");
        let within = |whole: &i128| usize::try_from(*whole).ok().filter(|whole| (least..=most).contains(whole));
        self.get(key, &what, |value| if let Value::Whole(whole) = value { within(whole) } else { None })
    }

    /// The same, where it has to be there.
    pub(super) fn size(&self, key: &str, most: usize) -> Result<usize, LocalError> {
        self.whole(key, 1, most)?.ok_or_else(|| self.wrong(format!("{key} is missing")))
    }

    /// A number above 0.
    pub(super) fn real(&self, key: &str) -> Result<Option<f64>, LocalError> {
        let real = |value: &Value| match value {
            Value::Real(real) => Some(*real),
            Value::Whole(whole) => Some(*whole as f64),
            _ => None,
        };
        self.get(key, "number above 0", |value| real(value).filter(|real| real.is_finite() && *real > 0.0))
    }

    /// Yes or no.
    pub(super) fn flag(&self, key: &str) -> Result<Option<bool>, LocalError> {
        self.get(key, "flag", |value| if let Value::Flag(flag) = value { Some(*flag) } else { None })
    }

    /// A list of texts.
    pub(super) fn texts(&self, key: &str) -> Result<Option<&[String]>, LocalError> {
        self.get(key, "list of texts", |value| if let Value::Texts(texts) = value { Some(&texts[..]) } else { None })
    }

    /// A list of numbers.
    pub(super) fn numbers(&self, key: &str) -> Result<Option<&[f64]>, LocalError> {
        self.get(key, "list of numbers", |value| if let Value::Numbers(all) = value { Some(&all[..]) } else { None })
    }

    /// The shape of a tensor, where it is there.
    pub(super) fn shape(&self, name: &str) -> Option<&[usize]> {
        self.header.tensors.get(name).map(|place| &place.shape[..])
    }

    /// A tensor of a shape, in the numbers that the file has.
    pub(super) fn tensor(&self, name: &str, shape: &[usize], device: &Device) -> Result<QTensor, LocalError> {
        let wrong = |problem: String| LocalError::tensor(&self.path, name, problem);
        let place = self.header.tensors.get(name).ok_or_else(|| wrong("it is missing".to_owned()))?;
        if place.shape != shape {
            return Err(wrong(format!("it has the shape {:?}, not {shape:?}", place.shape)));
        }
        let info = TensorInfo { ggml_dtype: place.dtype, shape: Shape::from(shape), offset: place.from };
        info.read(&mut &self.file, 0, device).map_err(|error| wrong(error.to_string()))
    }

    /// A tensor of a shape in 32 bits.
    pub(super) fn wide(&self, name: &str, shape: &[usize], device: &Device) -> Result<Tensor, LocalError> {
        let tensor = self.tensor(name, shape, device)?;
        tensor.dequantize(device).map_err(|error| LocalError::tensor(&self.path, name, error.to_string()))
    }
}

fn wrong(file: &Path, problem: impl Into<String>) -> LocalError {
    LocalError::File {
        file: file.to_owned(),
        problem: problem.into(),
        hint: "fetch it again, or name a GGUF file of Qwen2.5, Qwen3 or Llama",
    }
}
