//! Which files of a model a program reads.

use super::ModelName;
use crate::{LocalError, weights};
use std::path::{Path, PathBuf};

const WHOLE: &str = "model.safetensors";
const INDEX: &str = "model.safetensors.index.json";
const PICKLED: &str = "pytorch_model.bin";

/// What any model here reads where it is there.
const READ_WHERE_THERE: [&str; 8] = [
    "tokenizer.json",
    "tokenizer_config.json",
    "preprocessor_config.json",
    "processor_config.json",
    "generation_config.json",
    "sentence_bert_config.json",
    "1_Pooling/config.json",
    "modules.json",
];

/// Which files of a model are needed. The file that a name names is always needed.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Needs {
    weights: bool,
    required: Vec<&'static str>,
    optional: Vec<&'static str>,
}

/// A way to a model's files.
pub(super) trait Files {
    /// The folder that they lie in.
    fn folder(&self) -> PathBuf;

    /// Where a file is, if it is on this machine.
    fn here(&self, file: &str) -> Option<PathBuf>;

    /// Where a file is, once it has been got; `None` where the model has no such file.
    fn get(&mut self, file: &str) -> Result<Option<PathBuf>, LocalError>;

    /// What to say where a file is needed and there is none.
    fn missing(&self, file: &str, what: &'static str) -> LocalError;
}

/// What was got.
#[derive(Debug)]
pub(super) struct Gathered {
    pub(super) folder: PathBuf,
    /// Required and optional files, by their names.
    pub(super) small: Vec<(String, PathBuf)>,
    /// The files with weights.
    pub(super) weights: Vec<PathBuf>,
}

impl Needs {
    /// The weights too: `model.safetensors`, or its parts and their index, or `pytorch_model.bin`. A name of one GGUF file has
    /// them in that file.
    #[must_use]
    pub fn weights(mut self) -> Self {
        self.weights = true;
        self
    }

    /// These files too.
    #[must_use]
    pub fn required(mut self, files: &[&'static str]) -> Self {
        self.required.extend(files);
        self
    }

    /// These files too, where the model has them.
    #[must_use]
    pub fn optional(mut self, files: &[&'static str]) -> Self {
        self.optional.extend(files);
        self
    }

    /// What a model of any kind needs.
    #[must_use]
    pub fn of_any(name: &ModelName) -> Self {
        if name.is_gguf() {
            return Self::default();
        }
        Self::default().weights().required(&["config.json"]).optional(&READ_WHERE_THERE)
    }

    /// Gets them all, small files first: what is wrong shows before gigabytes have come.
    pub(super) fn gather(&self, files: &mut dyn Files, named: Option<&str>) -> Result<Gathered, LocalError> {
        let mut small = Vec::new();
        for file in &self.required {
            let path = files.get(file)?.ok_or_else(|| files.missing(file, "a file of the model"))?;
            small.push(((*file).to_owned(), path));
        }
        for file in &self.optional {
            small.extend(files.get(file)?.map(|path| ((*file).to_owned(), path)));
        }
        let weights = match named {
            Some(file) => vec![files.get(file)?.ok_or_else(|| files.missing(file, "the model"))?],
            None if self.weights => weights_of(files)?,
            None => Vec::new(),
        };
        Ok(Gathered { folder: files.folder(), small, weights })
    }
}

fn weights_of(files: &mut dyn Files) -> Result<Vec<PathBuf>, LocalError> {
    let forms = [WHOLE, INDEX, PICKLED];
    // Whichever form is here already is not fetched in another.
    let here = forms.into_iter().find(|form| files.here(form).is_some());
    for form in here.map_or(forms.to_vec(), |form| vec![form]) {
        if let Some(path) = files.get(form)? {
            return if form == INDEX { parts(files, &path) } else { Ok(vec![path]) };
        }
    }
    Err(files.missing(WHOLE, "the checkpoint"))
}

fn parts(files: &mut dyn Files, index: &Path) -> Result<Vec<PathBuf>, LocalError> {
    let names = weights::part_names(index)?;
    names.iter().map(|name| files.get(name)?.ok_or_else(|| files.missing(name, "a part of the weights"))).collect()
}
