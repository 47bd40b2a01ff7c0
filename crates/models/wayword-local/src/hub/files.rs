//! The files of a model: which are needed, which are on this machine, and a hash that identifies them.

use super::ModelName;
use crate::{LocalError, weights};
use sha2::{Digest, Sha256};
use std::{
    fs::File,
    io::{self, Read, Seek, SeekFrom},
    path::{Path, PathBuf},
};

/// The weights in one file; the index of weights in several files; a pickled file of PyTorch; the tokenizer.
const WHOLE_WEIGHTS_FILE: &str = "model.safetensors";
const WEIGHTS_INDEX_FILE: &str = "model.safetensors.index.json";
const PICKLED_WEIGHTS_FILE: &str = "pytorch_model.bin";
const TOKENIZER_FILE: &str = "tokenizer.json";

/// Files that the models of this crate read if they exist.
const OPTIONAL_MODEL_FILES: [&str; 11] = [
    TOKENIZER_FILE,
    "tokenizer_config.json",
    "preprocessor_config.json",
    "processor_config.json",
    "generation_config.json",
    "sentence_bert_config.json",
    "1_Pooling/config.json",
    "modules.json",
    "config_sentence_transformers.json",
    "2_Dense/config.json",
    "2_Dense/model.safetensors",
];

/// Files that say what a sentence encoder does besides its BERT.
const SENTENCE_FILES: [&str; 7] = [
    "modules.json",
    "config_sentence_transformers.json",
    "sentence_bert_config.json",
    "tokenizer_config.json",
    "1_Pooling/config.json",
    "2_Dense/config.json",
    "2_Dense/model.safetensors",
];

/// Files up to this length, bytes, are hashed as a whole for a model's identity. Longer ones are sampled.
const MAX_WHOLLY_HASHED_BYTES: u64 = 1 << 20;
/// The number of samples of a longer file, evenly from its beginning to its end.
const SAMPLE_COUNT: u64 = 256;
/// Bytes of each sample.
const SAMPLE_BYTES: u64 = 4096;

/// Which files of a model are needed. A file that is part of the model's name is always needed.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NeededFiles {
    /// Whether the weights are needed.
    weights: bool,
    /// Files that the model must have.
    required: Vec<&'static str>,
    /// Files that are used if the model has them.
    optional: Vec<&'static str>,
}

/// Access to the files of a model, on disk or on the hub.
pub(super) trait ModelFiles {
    /// The folder that the files are in.
    fn folder_path(&self) -> PathBuf;

    /// The path of a file, if it is on this machine.
    fn local_path(&self, file: &str) -> Option<PathBuf>;

    /// The path of a file, which is fetched if necessary. `None` if the model lacks the file.
    fn get_file(&mut self, file: &str) -> Result<Option<PathBuf>, LocalError>;

    /// The error for a needed file that does not exist.
    fn missing_error(&self, file: &str, what: &'static str) -> LocalError;
}

/// The files of a model after they were found or fetched.
#[derive(Debug)]
pub(super) struct GatheredFiles {
    pub(super) folder: PathBuf,
    /// Required and optional files, by their names.
    pub(super) small: Vec<(String, PathBuf)>,
    /// The files with weights.
    pub(super) weights: Vec<PathBuf>,
}

impl NeededFiles {
    /// Adds the weights: `model.safetensors`, or its parts and their index, or `pytorch_model.bin`. For the name of a
    /// file, the weights are in that file.
    #[must_use]
    pub fn with_weights(mut self) -> Self {
        self.weights = true;
        self
    }

    /// Adds these files.
    #[must_use]
    pub fn with_required(mut self, files: &[&'static str]) -> Self {
        self.required.extend(files);
        self
    }

    /// Adds these files, if the model has them.
    #[must_use]
    pub fn with_optional(mut self, files: &[&'static str]) -> Self {
        self.optional.extend(files);
        self
    }

    /// The files that a model of any architecture needs.
    #[must_use]
    pub fn for_any_architecture(name: &ModelName) -> Self {
        if name.is_file() {
            return Self::default();
        }
        Self::default().with_weights().with_required(&["config.json"]).with_optional(&OPTIONAL_MODEL_FILES)
    }

    /// The files that a sentence encoder needs.
    #[must_use]
    pub fn for_sentence_encoder() -> Self {
        Self::default().with_weights().with_required(&["config.json", TOKENIZER_FILE]).with_optional(&SENTENCE_FILES)
    }

    /// The tokenizer alone, without the model's weights.
    #[must_use]
    pub fn for_tokenizer() -> Self {
        Self::default().with_required(&[TOKENIZER_FILE])
    }

    /// The flags for `wayword models fetch` that make it fetch these files and not many more. They come before the
    /// name.
    pub(super) fn fetch_flags(&self) -> &'static str {
        if *self == Self::for_tokenizer() { "--tokenizer " } else { "" }
    }

    /// Gets all files, and the file `named` in the model's name, if there is one. Small files come first, so that an
    /// error appears before gigabytes are fetched.
    pub(super) fn gather_files(
        &self,
        files: &mut dyn ModelFiles,
        named: Option<&str>,
    ) -> Result<GatheredFiles, LocalError> {
        let mut small = Vec::new();
        for file in &self.required {
            let path = files.get_file(file)?.ok_or_else(|| files.missing_error(file, "a file of the model"))?;
            small.push(((*file).to_owned(), path));
        }
        for file in &self.optional {
            small.extend(files.get_file(file)?.map(|path| ((*file).to_owned(), path)));
        }
        let weights = match named {
            Some(file) => vec![files.get_file(file)?.ok_or_else(|| files.missing_error(file, "the model"))?],
            None if self.weights => gather_weights(files)?,
            None => Vec::new(),
        };
        Ok(GatheredFiles { folder: files.folder_path(), small, weights })
    }
}

/// The files with the weights, in the first form that the model has.
fn gather_weights(files: &mut dyn ModelFiles) -> Result<Vec<PathBuf>, LocalError> {
    let forms = [WHOLE_WEIGHTS_FILE, WEIGHTS_INDEX_FILE, PICKLED_WEIGHTS_FILE];
    // If one form of the weights is on this machine, no other form is fetched.
    let local_form = forms.into_iter().find(|form| files.local_path(form).is_some());
    for form in local_form.map_or(forms.to_vec(), |form| vec![form]) {
        if let Some(path) = files.get_file(form)? {
            return if form == WEIGHTS_INDEX_FILE { weight_parts(files, &path) } else { Ok(vec![path]) };
        }
    }
    Err(files.missing_error(WHOLE_WEIGHTS_FILE, "the checkpoint"))
}

/// The files that an index of weights names.
fn weight_parts(files: &mut dyn ModelFiles, index: &Path) -> Result<Vec<PathBuf>, LocalError> {
    let names = weights::part_names(index)?;
    names
        .iter()
        .map(|name| files.get_file(name)?.ok_or_else(|| files.missing_error(name, "a part of the weights")))
        .collect()
}

impl GatheredFiles {
    /// A hash over the names, lengths and contents of the small files, and over lengths and samples of the weights. The
    /// samples include the beginning, where safetensors and GGUF files have their header, and the end, where a pickled
    /// file has its checksums.
    pub(super) fn hash_identity(&self) -> Result<String, LocalError> {
        let mut hasher = Sha256::new();
        let mut add = |name: &str, path: &Path| {
            hash_file(&mut hasher, name, path).map_err(|error| LocalError::from_io(path, "read", error))
        };
        for (name, path) in &self.small {
            add(name, path)?;
        }
        for path in &self.weights {
            add(&path.file_name().unwrap_or_default().to_string_lossy(), path)?;
        }
        Ok(format!("sha256:{:x}", hasher.finalize()))
    }
}

/// Adds name, length and content of a file to a hash; of a long file, samples of the content.
fn hash_file(hasher: &mut Sha256, name: &str, path: &Path) -> io::Result<()> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    // Lengths come before contents, so that two different sets of files never give the same bytes.
    hasher.update((name.len() as u64).to_le_bytes());
    hasher.update(name);
    hasher.update(length.to_le_bytes());
    if length <= MAX_WHOLLY_HASHED_BYTES {
        return io::copy(&mut file.take(MAX_WHOLLY_HASHED_BYTES), hasher).map(drop);
    }
    let last = length - SAMPLE_BYTES;
    for sample in 0..SAMPLE_COUNT {
        // From 0 for the first sample to `last` for the last one, at equal distances.
        let at = u128::from(last) * u128::from(sample) / u128::from(SAMPLE_COUNT - 1);
        file.seek(SeekFrom::Start(u64::try_from(at).unwrap_or(last)))?;
        io::copy(&mut file.by_ref().take(SAMPLE_BYTES), hasher)?;
    }
    Ok(())
}

/// The files of one folder on this machine, and the hint for a file that it lacks.
pub(super) struct DiskModelFiles<'a> {
    folder: PathBuf,
    hint: &'a dyn Fn(&str) -> String,
}

impl<'a> DiskModelFiles<'a> {
    pub(super) fn new(folder: PathBuf, hint: &'a dyn Fn(&str) -> String) -> Self {
        Self { folder, hint }
    }
}

impl DiskModelFiles<'static> {
    /// The user's own folder.
    pub(super) fn for_user_folder(folder: &Path) -> Self {
        let hint = &|file: &str| format!("put the model's {file} there, or check the path");
        Self { folder: folder.to_owned(), hint }
    }
}

impl ModelFiles for DiskModelFiles<'_> {
    fn folder_path(&self) -> PathBuf {
        self.folder.clone()
    }

    fn local_path(&self, file: &str) -> Option<PathBuf> {
        let path = self.folder.join(file);
        path.is_file().then_some(path)
    }

    fn get_file(&mut self, file: &str) -> Result<Option<PathBuf>, LocalError> {
        Ok(self.local_path(file))
    }

    fn missing_error(&self, file: &str, what: &'static str) -> LocalError {
        LocalError::Missing { file: self.folder.join(file), what, hint: (self.hint)(file) }
    }
}
