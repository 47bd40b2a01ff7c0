//! Finds in-process models by their names (`hf/ORG/NAME`), and loads each of them once.

use crate::{
    LocalError, ModelDevice, WeightPrecision,
    blip::{BlipCaptioner, BlipVqa},
    blip2::Blip2Model,
    call_ledger::LocalModel,
    detectors::{DetectorCheckpoint, LocalDetector},
    hub::{DownloadProgress, ModelFolder, ModelHub, ModelName, NeededFiles},
    json,
    memory::{self, MemoryBudget},
    picture_models::{Blip2Eye, BlipEye, PictureModel},
};
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    path::Path,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_ledger::LedgerRun;

/// Gives access to in-process models by their names.
pub struct LocalModels {
    hub: ModelHub,
    device: ModelDevice,
    precision: Option<WeightPrecision>,
    progress: Box<dyn DownloadProgress + Send + Sync>,
    run: LedgerRun,
    loaded: Mutex<LoadedModels>,
}

/// The models that are loaded so far, and the memory that they take.
#[derive(Default)]
struct LoadedModels {
    models: BTreeMap<String, Arc<LocalModel>>,
    detectors: BTreeMap<String, Arc<LocalDetector>>,
    budget: MemoryBudget,
}

/// The settings for loading models.
#[derive(Debug, Clone)]
pub struct LoadingOptions {
    /// The device on which the models compute.
    pub device: ModelDevice,
    /// The precision of their weights. The default is 32 bits, and 16 bits for BLIP-2.
    pub precision: Option<WeightPrecision>,
    /// The most memory for all models together, bytes. The default is the free memory of the machine.
    pub memory_bytes: Option<u64>,
}

/// The architecture and the task of a checkpoint. BLIP has one checkpoint for answers and another for descriptions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EyeArchitecture {
    /// The BLIP that answers questions about a picture.
    BlipAnswers,
    /// The BLIP that describes a picture.
    BlipDescribes,
    /// BLIP-2, which does both.
    Blip2,
}

/// The fields of `config.json` that identify the architecture.
#[derive(Deserialize)]
struct ArchitectureConfig {
    model_type: Option<String>,
    architectures: Option<Vec<String>>,
}

impl LocalModels {
    /// Models from a hub. `run` is the part of the ledger that keeps their answers.
    #[must_use]
    pub fn new(
        hub: ModelHub,
        loading: LoadingOptions,
        progress: Box<dyn DownloadProgress + Send + Sync>,
        run: LedgerRun,
    ) -> Self {
        let LoadingOptions { device, precision, memory_bytes } = loading;
        let loaded = LoadedModels { budget: MemoryBudget::new(memory_bytes), ..LoadedModels::default() };
        Self { hub, device, precision, progress, run, loaded: Mutex::new(loaded) }
    }

    /// Checks that a name has the form of an in-process model for pictures. Reads no file.
    ///
    /// # Errors
    /// When it has another form.
    pub fn check_name(name: &str) -> Result<(), LocalError> {
        parse_parts(name).map(drop)
    }

    /// Checks that a model's files are on this machine and of the right kind, and fetches missing ones. Does
    /// not load the model.
    ///
    /// # Errors
    /// When the files cannot be fetched, or the model does not take pictures.
    pub fn ensure_model_files(&self, name: &str) -> Result<(), LocalError> {
        for part in &parse_parts(name)? {
            let folder = self.hub.model_folder(part, &NeededFiles::for_any_architecture(part), &*self.progress)?;
            EyeArchitecture::from_folder(&folder.path)?;
        }
        Ok(())
    }

    /// A model by its name: `hf/ORG/NAME`, or two BLIP models as `hf/ORG/ANSWERS+ORG/DESCRIBES`. The first call fetches
    /// it, if it is not on this machine, and loads it.
    ///
    /// # Errors
    /// When the model cannot be fetched, is damaged, or does not take pictures.
    pub fn get_model(&self, name: &str) -> Result<Arc<LocalModel>, LocalError> {
        let mut loaded = self.loaded.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(model) = loaded.models.get(name) {
            return Ok(Arc::clone(model));
        }
        let (eye, origin) = self.load_eye(name, &mut loaded.budget)?;
        let model = Arc::new(LocalModel::new(name, origin, eye, self.run.clone()));
        loaded.models.insert(name.to_owned(), Arc::clone(&model));
        Ok(model)
    }

    /// Checks that a name has the form of an in-process detector. Reads no file.
    ///
    /// # Errors
    /// When it has another form.
    pub fn check_detector_name(name: &str) -> Result<(), LocalError> {
        detector_name(name).map(drop)
    }

    /// Checks that a detector's files are on this machine and of a kind that detects, and fetches missing ones. Does
    /// not load the detector.
    ///
    /// # Errors
    /// When the files cannot be fetched, or the model does not detect.
    pub fn ensure_detector_files(&self, name: &str) -> Result<(), LocalError> {
        let part = detector_name(name)?;
        DetectorCheckpoint::find_files(&self.hub, &part, &*self.progress).map(drop)
    }

    /// A detector by its name, `hf/ORG/NAME`. The first call fetches it, if it is not on this machine, and loads it.
    ///
    /// # Errors
    /// When the model cannot be fetched, is damaged, does not fit into the memory, or does not detect.
    pub fn get_detector(&self, name: &str) -> Result<Arc<LocalDetector>, LocalError> {
        let mut loaded = self.loaded.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(detector) = loaded.detectors.get(name) {
            return Ok(Arc::clone(detector));
        }
        let part = detector_name(name)?;
        let checkpoint = DetectorCheckpoint::find_files(&self.hub, &part, &*self.progress)?;
        let precision = self.precision.unwrap_or_default();
        loaded.budget.reserve_weights(name, checkpoint.memory_bytes(precision)?)?;
        let ready = checkpoint.load(name, &self.device, precision)?;
        let origin = format_origin(&[checkpoint.identity()], precision);
        let detector = Arc::new(LocalDetector::new(name, origin, ready, self.run.clone()));
        loaded.detectors.insert(name.to_owned(), Arc::clone(&detector));
        Ok(detector)
    }

    /// Loads the model or the two models of a name. Returns them with the text that identifies their weights.
    fn load_eye(&self, name: &str, budget: &mut MemoryBudget) -> Result<(Arc<dyn PictureModel>, String), LocalError> {
        let parts = parse_parts(name)?;
        let find_folder = |part| self.hub.model_folder(part, &NeededFiles::for_any_architecture(part), &*self.progress);
        let folders: Vec<ModelFolder> = parts.iter().map(find_folder).collect::<Result<_, _>>()?;
        let architectures = folders.iter().map(|folder| EyeArchitecture::from_folder(&folder.path));
        let architectures: Vec<EyeArchitecture> = architectures.collect::<Result<_, _>>()?;
        let default_precision =
            if architectures.contains(&EyeArchitecture::Blip2) { WeightPrecision::Bf16 } else { WeightPrecision::F32 };
        let precision = self.precision.unwrap_or(default_precision);
        for folder in &folders {
            budget.reserve_weights(name, memory::checkpoint_bytes(&folder.path, precision)?)?;
        }
        let paths: Vec<&Path> = folders.iter().map(|folder| folder.path.as_path()).collect();
        let identities: Vec<&str> = folders.iter().map(|folder| folder.identity.as_str()).collect();
        Ok((self.build_eye(name, &paths, &architectures, precision)?, format_origin(&identities, precision)))
    }

    /// Loads checkpoints of known architectures. Two BLIPs may be in either order.
    fn build_eye(
        &self,
        name: &str,
        paths: &[&Path],
        architectures: &[EyeArchitecture],
        precision: WeightPrecision,
    ) -> Result<Arc<dyn PictureModel>, LocalError> {
        use EyeArchitecture::{Blip2 as Both, BlipAnswers as Answers, BlipDescribes as Describes};
        let answers = |path: &Path| BlipVqa::load(name, path, &self.device, precision).map(Some);
        let describes = |path: &Path| BlipCaptioner::load(name, path, &self.device, precision).map(Some);
        let (answers, describes) = match (architectures, paths) {
            ([Both], [path]) => {
                let model = Blip2Model::load(name, path, &self.device, precision)?;
                return Ok(Arc::new(Blip2Eye { name: name.to_owned(), model }));
            }
            ([Answers], [path]) => (answers(path)?, None),
            ([Describes], [path]) => (None, describes(path)?),
            ([Answers, Describes], [first, second]) => (answers(first)?, describes(second)?),
            ([Describes, Answers], [first, second]) => (answers(second)?, describes(first)?),
            _ => {
                return Err(name_error(name, "a name of two parts needs one BLIP that answers and one that describes"));
            }
        };
        Ok(Arc::new(BlipEye { name: name.to_owned(), answers, describes }))
    }
}

impl EyeArchitecture {
    /// Reads the architecture from the `config.json` of a folder.
    fn from_folder(folder: &Path) -> Result<Self, LocalError> {
        let config: ArchitectureConfig = json::read_required(folder, "config.json", "the configuration")?;
        let architectures = config.architectures.unwrap_or_default();
        let has = |name: &str| architectures.iter().any(|architecture| architecture == name);
        match config.model_type.as_deref() {
            Some("blip") if has("BlipForQuestionAnswering") => Ok(Self::BlipAnswers),
            Some("blip") if has("BlipForConditionalGeneration") => Ok(Self::BlipDescribes),
            Some("blip-2") => Ok(Self::Blip2),
            other => Err(LocalError::File {
                file: folder.join("config.json"),
                problem: format!(
                    "model_type {}, architectures {:?}: such a model can neither see nor write texts in process",
                    other.unwrap_or("(none)"),
                    architectures
                ),
                hint: "choose BLIP or BLIP-2 to see, and a model of a server for the text roles, such as ollama/qwen3",
            }),
        }
    }
}

/// The one or two models of a name: `hf/ORG/NAME`, or two BLIPs as `hf/ORG/ANSWERS+ORG/DESCRIBES`.
fn parse_parts(name: &str) -> Result<Vec<ModelName>, LocalError> {
    let rest = name.strip_prefix("hf/").ok_or_else(|| name_error(name, "it does not begin with hf/"))?;
    let parts = rest.split('+').map(|part| ModelName::parse(&format!("hf/{part}")));
    let parts: Vec<ModelName> = parts.collect::<Result<_, _>>()?;
    if parts.iter().any(ModelName::is_gguf) {
        return Err(name_error(name, "a GGUF file cannot be used in process"));
    }
    if parts.iter().any(ModelName::is_file) {
        return Err(name_error(name, "a .pth file holds a detector, which neither sees nor writes"));
    }
    if parts.len() > 2 {
        return Err(name_error(name, "a name has at most two parts: one BLIP that answers and one that describes"));
    }
    Ok(parts)
}

/// The model that a detector's name refers to.
fn detector_name(name: &str) -> Result<ModelName, LocalError> {
    let rest = name.strip_prefix("hf/").ok_or_else(|| name_error(name, "it does not begin with hf/"))?;
    if rest.contains('+') {
        return Err(name_error(name, "a detector is one model"));
    }
    let part = ModelName::parse(name)?;
    if part.is_gguf() {
        return Err(name_error(name, "a GGUF file cannot be used in process"));
    }
    Ok(part)
}

fn name_error(name: &str, problem: &str) -> LocalError {
    LocalError::Name { name: name.to_owned(), problem: problem.to_owned() }
}

/// A text that identifies what determines a model's answers: its weights and their precision.
fn format_origin(identities: &[&str], precision: WeightPrecision) -> String {
    format!("in process: {} ({})", identities.join("+"), format!("{precision:?}").to_lowercase())
}
