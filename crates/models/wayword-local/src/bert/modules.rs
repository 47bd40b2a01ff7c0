//! Reads what a saved sentence encoder does to a text and to its vector, besides its BERT: a prompt before the text, the pooling of
//! the tokens' vectors, and further layers. sentence-transformers lists these as modules in `modules.json` (4.1 to 6.2).
//!
//! What cannot be done here is refused by its name, because a vector without it would look like a right one.

use crate::{LocalError, ModelDevice, WeightPrecision, json, ops::LinearLayer, weights::CheckpointWeights};
use candle_core::{DType, Result as TensorResult, Tensor};
use serde::Deserialize;
use std::path::{Component, Path};

const MODULES_FILE: &str = "modules.json";
const SETTINGS_FILE: &str = "config_sentence_transformers.json";
const TRANSFORMER_FILE: &str = "sentence_bert_config.json";
/// The folder of the pooling, where no file lists the modules.
const USUAL_POOLING_FOLDER: &str = "1_Pooling";
const OTHER_ENCODER_HINT: &str = "choose another sentence encoder, such as sentence-transformers/all-MiniLM-L6-v2, or serve this one and export its vectors";
/// The most modules of an encoder. More are refused.
const MAX_MODULES: usize = 16;

/// What is done to texts before the encoder, and to the states behind it.
pub(super) struct SentenceModules {
    /// Stands before each text.
    prompt: String,
    lowers_case: bool,
    /// The vectors of several poolings stand side by side.
    pub(super) poolings: Vec<SentencePooling>,
    layers: Vec<VectorLayer>,
}

/// How a sentence's vector is made from the vectors of its tokens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SentencePooling {
    /// The mean of the vectors of all tokens.
    Mean,
    /// The vector of the first token.
    First,
    /// The vector of the last token.
    Last,
}

/// A step from one vector of a sentence to the next.
enum VectorLayer {
    /// A linear layer, perhaps with a hyperbolic tangent behind it.
    Dense { linear: LinearLayer, has_tanh: bool },
    /// Divides a vector by its length.
    UnitLength,
}

/// An entry of `modules.json`.
#[derive(Debug, Deserialize)]
struct ModuleEntry {
    path: String,
    #[serde(rename = "type")]
    kind: String,
}

/// `1_Pooling/config.json` in its forms until and since version 5.4.
#[derive(Debug, Deserialize)]
struct PoolingConfig {
    pooling_mode: Option<PoolingNames>,
    #[serde(default)]
    pooling_mode_cls_token: bool,
    #[serde(default)]
    pooling_mode_max_tokens: bool,
    #[serde(default)]
    pooling_mode_mean_tokens: bool,
    #[serde(default)]
    pooling_mode_mean_sqrt_len_tokens: bool,
    #[serde(default)]
    pooling_mode_weightedmean_tokens: bool,
    #[serde(default)]
    pooling_mode_lasttoken: bool,
    include_prompt: Option<bool>,
}

/// One name, or several.
#[derive(Debug, Clone, Deserialize)]
#[serde(untagged)]
enum PoolingNames {
    One(String),
    Several(Vec<String>),
}

/// `2_Dense/config.json`.
#[derive(Debug, Deserialize)]
struct DenseConfig {
    in_features: usize,
    out_features: usize,
    bias: Option<bool>,
    activation_function: Option<String>,
    module_input_name: Option<String>,
    module_output_name: Option<String>,
    use_residual: Option<bool>,
}

/// `config_sentence_transformers.json`.
#[derive(Debug, Default, Deserialize)]
struct EncoderSettings {
    model_type: Option<String>,
    #[serde(default)]
    prompts: serde_json::Map<String, serde_json::Value>,
    default_prompt_name: Option<String>,
    similarity_fn_name: Option<String>,
    truncate_dim: Option<usize>,
}

/// `sentence_bert_config.json`.
#[derive(Debug, Default, Deserialize)]
struct TransformerConfig {
    do_lower_case: Option<bool>,
    transformer_task: Option<String>,
    module_output_name: Option<String>,
    #[serde(default)]
    query_expansion: serde_json::Value,
}

impl SentenceModules {
    /// Reads the modules of an encoder with states of this size.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the encoder needs something that is not done here.
    pub(super) fn from_folder(
        folder: &Path,
        size: usize,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<Self, LocalError> {
        let listed: Option<Vec<ModuleEntry>> = json::read_if_there(folder, MODULES_FILE)?;
        let mut modules = Self { prompt: String::new(), lowers_case: false, poolings: Vec::new(), layers: Vec::new() };
        let mut width = size;
        let mut includes_prompt = true;
        if let Some(listed) = &listed {
            check_order(folder, listed)?;
            for module in listed.iter().skip(1) {
                let place = folder.join(&module.path);
                match module.name() {
                    "Pooling" => {
                        let config: PoolingConfig = json::read_required(&place, "config.json", "the pooling")?;
                        modules.poolings = config.poolings(&place.join("config.json"))?;
                        includes_prompt = config.include_prompt != Some(false);
                        width = size * modules.poolings.len();
                    }
                    "Dense" => {
                        let (layer, outputs) = read_dense(&place, width, device, precision)?;
                        modules.layers.push(layer);
                        width = outputs;
                    }
                    "Normalize" => modules.layers.push(VectorLayer::UnitLength),
                    // It does nothing after training.
                    _ => {}
                }
            }
        } else {
            let place = folder.join(USUAL_POOLING_FOLDER);
            let config: Option<PoolingConfig> = json::read_if_there(&place, "config.json")?;
            includes_prompt = config.as_ref().is_none_or(|config| config.include_prompt != Some(false));
            modules.poolings = match config {
                Some(config) => config.poolings(&place.join("config.json"))?,
                None => vec![SentencePooling::Mean],
            };
        }
        modules.lowers_case = read_transformer(folder)?;
        modules.prompt = read_prompt(folder, includes_prompt, &modules.layers)?;
        Ok(modules)
    }

    /// A text as the encoder takes it.
    pub(super) fn prepare_text(&self, text: &str) -> String {
        let text = format!("{}{text}", self.prompt);
        if self.lowers_case { text.to_lowercase() } else { text }
    }

    /// The vectors [texts, outputs] of pooled ones [texts, inputs].
    pub(super) fn apply_layers(&self, pooled: Tensor) -> TensorResult<Tensor> {
        self.layers.iter().try_fold(pooled, |vectors, layer| match layer {
            VectorLayer::Dense { linear, has_tanh: true } => hyperbolic_tangents(&linear.apply_to(&vectors)?),
            VectorLayer::Dense { linear, has_tanh: false } => linear.apply_to(&vectors),
            VectorLayer::UnitLength => unit_length(&vectors),
        })
    }
}

/// The hyperbolic tangent of each number, the same on every machine.
fn hyperbolic_tangents(vectors: &Tensor) -> TensorResult<Tensor> {
    let numbers: Vec<f32> = vectors.to_dtype(DType::F32)?.flatten_all()?.to_vec1()?;
    let numbers = numbers.into_iter().map(libm::tanhf).collect();
    Tensor::from_vec(numbers, vectors.dims(), vectors.device())
}

/// Vectors [texts, size] divided by their lengths.
pub(super) fn unit_length(vectors: &Tensor) -> TensorResult<Tensor> {
    // The minimum keeps a vector of zeros from a division by 0.
    let length = vectors.sqr()?.sum_keepdim(1)?.sqrt()?;
    vectors.broadcast_div(&length.maximum(1e-12)?)
}

impl ModuleEntry {
    /// The module's own name: the last part of its type.
    fn name(&self) -> &str {
        self.kind.rsplit('.').next().unwrap_or_default()
    }
}

/// Checks that the modules are a transformer, a pooling, and layers that can be computed here.
fn check_order(folder: &Path, listed: &[ModuleEntry]) -> Result<(), LocalError> {
    let wrong = |problem: String| unserved(&folder.join(MODULES_FILE), problem);
    if listed.len() > MAX_MODULES {
        return Err(wrong(format!("lists {} modules, but at most {MAX_MODULES} are read", listed.len())));
    }
    for (at, module) in listed.iter().enumerate() {
        let is_own = module.kind.starts_with("sentence_transformers.");
        let is_known = match module.name() {
            "Transformer" => at == 0,
            "Pooling" => at == 1,
            "Dense" | "Normalize" | "Dropout" => at > 1,
            _ => false,
        };
        if !is_own || !is_known {
            return Err(wrong(format!("module {at} is {}, which is not computed here", module.kind)));
        }
        if !Path::new(&module.path).components().all(|part| matches!(part, Component::Normal(_))) {
            return Err(wrong(format!("the path {:?} of module {at} leads out of the folder", module.path)));
        }
        if at == 0 && !module.path.is_empty() {
            return Err(wrong(format!("the transformer is in {:?}, and not in the folder itself", module.path)));
        }
    }
    if listed.len() < 2 {
        return Err(wrong("lists no pooling, so there is no vector of a sentence".to_owned()));
    }
    Ok(())
}

impl PoolingConfig {
    /// The poolings. Without any name it is the mean, as in sentence-transformers.
    fn poolings(&self, file: &Path) -> Result<Vec<SentencePooling>, LocalError> {
        let old = [
            ("cls", self.pooling_mode_cls_token),
            ("max", self.pooling_mode_max_tokens),
            ("mean", self.pooling_mode_mean_tokens),
            ("mean_sqrt_len_tokens", self.pooling_mode_mean_sqrt_len_tokens),
            ("weightedmean", self.pooling_mode_weightedmean_tokens),
            ("lasttoken", self.pooling_mode_lasttoken),
        ];
        let mut names: Vec<&str> = match &self.pooling_mode {
            Some(PoolingNames::One(name)) => vec![name],
            Some(PoolingNames::Several(names)) => names.iter().map(String::as_str).collect(),
            None => old.iter().filter(|(_, is_on)| *is_on).map(|(name, _)| *name).collect(),
        };
        if names.is_empty() {
            names.push("mean");
        }
        if names.len() > old.len() {
            return Err(unserved(file, format!("pooling_mode has {} names", names.len())));
        }
        let pooling = |name: &&str| match *name {
            "mean" => Ok(SentencePooling::Mean),
            "cls" => Ok(SentencePooling::First),
            "lasttoken" => Ok(SentencePooling::Last),
            other => Err(unserved(file, format!("pooling_mode is {other:?}, which is not computed here"))),
        };
        names.iter().map(pooling).collect()
    }
}

/// Reads a linear layer for vectors of a width. Also returns the width of its results.
fn read_dense(
    place: &Path,
    width: usize,
    device: &ModelDevice,
    precision: WeightPrecision,
) -> Result<(VectorLayer, usize), LocalError> {
    let config: DenseConfig = json::read_required(place, "config.json", "the configuration of a layer")?;
    let file = place.join("config.json");
    let wrong = |problem: String| unserved(&file, problem);
    let sizes = [("in_features", config.in_features), ("out_features", config.out_features)];
    if let Some(problem) = json::size_problem(&sizes) {
        return Err(wrong(problem));
    }
    if config.in_features != width {
        return Err(wrong(format!(
            "in_features is {}, but the vectors before it have {width} numbers",
            config.in_features
        )));
    }
    for (key, name) in
        [("module_input_name", &config.module_input_name), ("module_output_name", &config.module_output_name)]
    {
        if let Some(name) = name.as_deref().filter(|name| *name != "sentence_embedding") {
            return Err(wrong(format!("{key} is {name:?}, which is not computed here")));
        }
    }
    if config.use_residual == Some(true) {
        return Err(wrong("use_residual is true, which is not computed here".to_owned()));
    }
    let has_tanh = match config.activation_function.as_deref().and_then(|name| name.rsplit('.').next()) {
        // The library's default.
        None | Some("Tanh") => true,
        Some("Identity") => false,
        Some(other) => return Err(wrong(format!("activation_function is {other}, which is not computed here"))),
    };
    let weights = CheckpointWeights::open(place, device, precision)?;
    let scope = weights.scope_under("");
    let has_bias = config.bias.unwrap_or(true);
    if scope.has_tensor("linear.bias") != has_bias {
        let found = if has_bias { "there is none" } else { "there is one" };
        return Err(wrong(format!("bias is {has_bias}, but in the weights {found}")));
    }
    let linear = scope.read_linear("linear", config.in_features, config.out_features)?;
    Ok((VectorLayer::Dense { linear, has_tanh }, config.out_features))
}

/// Whether the transformer's configuration lowers the case of texts, after a check of what else it says.
fn read_transformer(folder: &Path) -> Result<bool, LocalError> {
    let config: TransformerConfig = json::read_if_there(folder, TRANSFORMER_FILE)?.unwrap_or_default();
    let wrong = |key: &str, value: &str| {
        unserved(&folder.join(TRANSFORMER_FILE), format!("{key} is {value:?}, which is not computed here"))
    };
    match (config.transformer_task.as_deref(), config.module_output_name.as_deref()) {
        (Some(task), _) if task != "feature-extraction" => return Err(wrong("transformer_task", task)),
        (_, Some(output)) if output != "token_embeddings" => return Err(wrong("module_output_name", output)),
        _ => {}
    }
    if !config.query_expansion.is_null() {
        return Err(wrong("query_expansion", "on"));
    }
    Ok(config.do_lower_case == Some(true))
}

/// The prompt that stands before every text, after a check of the encoder's other settings.
fn read_prompt(folder: &Path, includes_prompt: bool, layers: &[VectorLayer]) -> Result<String, LocalError> {
    let settings: EncoderSettings = json::read_if_there(folder, SETTINGS_FILE)?.unwrap_or_default();
    let wrong = |problem: String| unserved(&folder.join(SETTINGS_FILE), problem);
    if let Some(kind) = settings.model_type.as_deref().filter(|kind| *kind != "SentenceTransformer") {
        return Err(wrong(format!("model_type is {kind}, which does not give one vector for a text")));
    }
    if let Some(length) = settings.truncate_dim {
        return Err(wrong(format!("truncate_dim is {length}: vectors that are cut are not computed here")));
    }
    // For vectors of length 1 the dot product is the cosine.
    let has_units = matches!(layers.last(), Some(VectorLayer::UnitLength));
    let similarity = settings.similarity_fn_name.as_deref().unwrap_or("cosine");
    if similarity != "cosine" && !(similarity == "dot" && has_units) {
        return Err(wrong(format!("similarity_fn_name is {similarity:?}, but texts are compared by the cosine here")));
    }
    let Some(name) = &settings.default_prompt_name else { return Ok(String::new()) };
    let prompt = settings.prompts.get(name).and_then(serde_json::Value::as_str);
    let prompt =
        prompt.ok_or_else(|| wrong(format!("default_prompt_name is {name:?}, but `prompts` has no such text")))?;
    if !includes_prompt && !prompt.is_empty() {
        let problem = format!(
            "default_prompt_name is {name:?}, but the pooling leaves the prompt out (include_prompt is false), which is not \
             computed here"
        );
        return Err(wrong(problem));
    }
    Ok(prompt.to_owned())
}

/// The error for something that an encoder needs and that is not done here.
fn unserved(file: &Path, problem: String) -> LocalError {
    LocalError::File { file: file.to_owned(), problem, hint: OTHER_ENCODER_HINT }
}
