//! Where the files of a GLIP are. The checkpoint is one file, and the tokenizer comes from elsewhere.

use super::{GLIP_LICENCE, GLIP_TOKENIZER};
use crate::{
    LocalError,
    hub::{Hub, ModelName, Needs, Progress},
};
use std::path::{Path, PathBuf};

const TOKENIZER: &str = "tokenizer.json";

/// Where the files of a GLIP are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GlipFiles {
    /// The checkpoint, in the form of the original. Sizes other than GLIP-T's are read from `config.json` beside it.
    pub weights: PathBuf,
    /// The folder of BERT's `tokenizer.json`.
    pub tokenizer: PathBuf,
    /// Distinguishes checkpoints of the same name.
    pub identity: String,
}

impl GlipFiles {
    /// The files of a name like `hf/GLIPModel/GLIP:FILE.pth`, or `hf//FOLDER/FILE.pth`; what is missing is fetched. The
    /// tokenizer is the one beside the checkpoint, if there is one, or else [`GLIP_TOKENIZER`]. What the makers do not say
    /// of the licence is told once, to `progress`.
    ///
    /// # Errors
    /// When the name is not that of one file, or a file cannot be had or is not the one that it should be.
    pub fn find(hub: &Hub, name: &ModelName, progress: &dyn Progress) -> Result<Self, LocalError> {
        let wrong = |problem: &str| LocalError::Name { name: name.to_string(), problem: problem.to_owned() };
        if !name.is_trained() {
            return Err(wrong("GLIP is one file: hf/GLIPModel/GLIP:glip_tiny_model_o365_goldg_cc_sbu.pth"));
        }
        let found = hub.folder(name, &Needs::default(), progress)?;
        let weights = found.file.ok_or_else(|| wrong("it names no file"))?;
        let beside = weights.parent().unwrap_or(Path::new("."));
        let tokenizer = if beside.join(TOKENIZER).is_file() {
            beside.to_owned()
        } else {
            hub.folder(&ModelName::parse(GLIP_TOKENIZER)?, &Needs::default().required(&[TOKENIZER]), progress)?.path
        };
        progress.told(GLIP_LICENCE);
        Ok(Self { weights, tokenizer, identity: found.identity })
    }
}
