//! Reads the `config.json` of CLIP, and of OWLv2, which has the same towers. Missing values get the defaults of
//! transformers.

use crate::{LocalError, json as files, ops::Activation};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value, json};
use std::path::Path;

/// `config.json`, with missing values filled in.
#[derive(Debug)]
pub(crate) struct ClipConfig {
    pub(crate) text: TextConfig,
    pub(crate) vision: VisionConfig,
    /// The length of a vector of a picture or a text.
    pub(crate) projection_dim: usize,
}

/// The settings of the text tower.
#[derive(Debug, Deserialize)]
pub(crate) struct TextConfig {
    #[serde(flatten)]
    pub(crate) layers: LayersConfig,
    pub(crate) vocab_size: usize,
    pub(crate) max_position_embeddings: usize,
    /// The token that ends a text. `None` if the token with the highest id ends it.
    pub(crate) eos_token_id: Option<u32>,
}

/// The settings of the vision tower.
#[derive(Debug, Deserialize)]
pub(crate) struct VisionConfig {
    #[serde(flatten)]
    pub(crate) layers: LayersConfig,
    pub(crate) image_size: usize,
    pub(crate) patch_size: usize,
}

/// The settings that both towers have.
#[derive(Debug, Deserialize)]
pub(crate) struct LayersConfig {
    pub(crate) hidden_size: usize,
    pub(crate) intermediate_size: usize,
    pub(crate) num_hidden_layers: usize,
    pub(crate) num_attention_heads: usize,
    pub(crate) hidden_act: Activation,
    pub(crate) layer_norm_eps: f64,
}

/// A family of checkpoints with these towers. The families differ in their defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TowerFamily {
    /// CLIP.
    Clip,
    /// OWLv2.
    Owl,
}

/// `config.json` as it is in the file, before defaults are filled in.
#[derive(Deserialize)]
struct ClipConfigFile {
    model_type: Option<String>,
    projection_dim: Option<usize>,
    text_config: Option<Map<String, Value>>,
    vision_config: Option<Map<String, Value>>,
    /// In old files. If present, it replaces `text_config` as a whole: values that it lacks are transformers' defaults.
    text_config_dict: Option<Map<String, Value>>,
    /// The same for `vision_config`.
    vision_config_dict: Option<Map<String, Value>>,
}

/// The longest edge of a picture that a configuration may ask for, pixels. A longer one is refused.
const MAX_EDGE_PX: usize = 2048;

impl ClipConfig {
    pub(crate) fn from_folder(folder: &Path, family: TowerFamily) -> Result<Self, LocalError> {
        let written: ClipConfigFile = files::read_required(folder, "config.json", "the configuration")?;
        written.fill_defaults(family).map_err(|problem| LocalError::File {
            file: folder.join("config.json"),
            problem,
            hint: family.error_hint(),
        })
    }
}

impl TowerFamily {
    /// The `model_type` of the family's checkpoints.
    fn model_type(self) -> &'static str {
        match self {
            Self::Clip => "clip",
            Self::Owl => "owlv2",
        }
    }

    fn error_hint(self) -> &'static str {
        match self {
            Self::Clip => {
                "choose a CLIP model, such as hf/openai/clip-vit-base-patch32; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`"
            }
            Self::Owl => {
                "choose an OWLv2 model, such as hf/google/owlv2-base-patch16-ensemble; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`"
            }
        }
    }

    /// The text tower's configuration, with the given values over the defaults.
    fn text_config(self, given: Option<Map<String, Value>>) -> Result<TextConfig, String> {
        let mut given = given.unwrap_or_default();
        let (positions, end) = match self {
            Self::Clip => (77, Some(49407)),
            Self::Owl => {
                // transformers does not read this field, and some files have a list there.
                given.remove("eos_token_id");
                (16, None)
            }
        };
        let defaults = json!({
            "vocab_size": 49408, "hidden_size": 512, "intermediate_size": 2048, "num_hidden_layers": 12,
            "num_attention_heads": 8, "max_position_embeddings": positions, "hidden_act": "quick_gelu",
            "layer_norm_eps": 1e-5, "eos_token_id": end,
        });
        overlay_defaults("text_config", given, defaults)
    }

    /// The vision tower's configuration, with the given values over the defaults.
    fn vision_config(self, given: Option<Map<String, Value>>) -> Result<VisionConfig, String> {
        let (edge, patch) = match self {
            Self::Clip => (224, 32),
            Self::Owl => (768, 16),
        };
        let defaults = json!({
            "hidden_size": 768, "intermediate_size": 3072, "num_hidden_layers": 12, "num_attention_heads": 12,
            "image_size": edge, "patch_size": patch, "hidden_act": "quick_gelu", "layer_norm_eps": 1e-5,
        });
        overlay_defaults("vision_config", given.unwrap_or_default(), defaults)
    }
}

impl ClipConfigFile {
    /// Fills in missing values, and checks the sizes.
    fn fill_defaults(self, family: TowerFamily) -> Result<ClipConfig, String> {
        let expected = family.model_type();
        if let Some(kind) = self.model_type.filter(|kind| kind != expected) {
            return Err(format!("model_type: {kind} is not {expected}"));
        }
        let text = family.text_config(self.text_config_dict.or(self.text_config))?;
        let vision = family.vision_config(self.vision_config_dict.or(self.vision_config))?;
        text.layers.check_sizes("text_config")?;
        vision.layers.check_sizes("vision_config")?;
        let (edge, patch) = (vision.image_size, vision.patch_size);
        if edge == 0 || edge > MAX_EDGE_PX || patch == 0 || !edge.is_multiple_of(patch) {
            return Err(format!("vision_config: pictures of {edge} pixels cannot be cut into patches of {patch}"));
        }
        if text.max_position_embeddings == 0 {
            return Err("text_config.max_position_embeddings: it must be at least 1".to_owned());
        }
        Ok(ClipConfig { text, vision, projection_dim: self.projection_dim.unwrap_or(512) })
    }
}

impl LayersConfig {
    fn check_sizes(&self, part: &str) -> Result<(), String> {
        let (size, heads) = (self.hidden_size, self.num_attention_heads);
        if size == 0 || heads == 0 || !size.is_multiple_of(heads) {
            return Err(format!("{part}.num_attention_heads: {heads} does not divide hidden_size {size}"));
        }
        if self.num_hidden_layers == 0 {
            return Err(format!("{part}.num_hidden_layers: it must be at least 1"));
        }
        Ok(())
    }
}

/// Replaces defaults by the given values, and reads the result. `part` is the name for errors.
fn overlay_defaults<T: DeserializeOwned>(part: &str, given: Map<String, Value>, defaults: Value) -> Result<T, String> {
    let Value::Object(mut all) = defaults else { return Err(format!("{part}: there are no defaults")) };
    all.extend(given.into_iter().filter(|(_, value)| !value.is_null()));
    serde_path_to_error::deserialize(Value::Object(all)).map_err(|error| format!("{part}: {error}"))
}
