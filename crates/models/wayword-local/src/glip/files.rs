//! Finds the files of a GLIP. The checkpoint is one file, and the tokenizer comes from another repository.

use super::{GLIP_LICENCE, GLIP_TOKENIZER};
use crate::{
    LocalError,
    hub::{DownloadProgress, ModelHub, ModelName, NeededFiles},
};
use std::path::{Path, PathBuf};

const TOKENIZER_FILE: &str = "tokenizer.json";

/// The paths of a GLIP's files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GlipFiles {
    /// The checkpoint, in the form of the original. A `config.json` in the same folder gives sizes other than GLIP-T's.
    pub weights: PathBuf,
    /// The folder of BERT's `tokenizer.json`.
    pub tokenizer: PathBuf,
    /// Distinguishes checkpoints of the same name.
    pub identity: String,
}

impl GlipFiles {
    /// Finds the files for a name like `hf/GLIPModel/GLIP:FILE.pth`, or `hf//FOLDER/FILE.pth`, and fetches missing
    /// ones. The tokenizer is the one in the checkpoint's folder, or else [`GLIP_TOKENIZER`]. `progress` gets the note
    /// on the licence, [`GLIP_LICENCE`].
    ///
    /// # Errors
    /// When the name is not that of one file, or a file cannot be had or is not the one that it should be.
    pub fn find_files(hub: &ModelHub, name: &ModelName, progress: &dyn DownloadProgress) -> Result<Self, LocalError> {
        let wrong = |problem: &str| LocalError::Name { name: name.to_string(), problem: problem.to_owned() };
        if !name.is_trained() {
            return Err(wrong("GLIP is one file: hf/GLIPModel/GLIP:glip_tiny_model_o365_goldg_cc_sbu.pth"));
        }
        let checkpoint = hub.model_folder(name, &NeededFiles::default(), progress)?;
        let weights = checkpoint.file.ok_or_else(|| wrong("it names no file"))?;
        let folder = weights.parent().unwrap_or(Path::new("."));
        let tokenizer = if folder.join(TOKENIZER_FILE).is_file() {
            folder.to_owned()
        } else {
            hub.model_folder(
                &ModelName::parse(GLIP_TOKENIZER)?,
                &NeededFiles::default().with_required(&[TOKENIZER_FILE]),
                progress,
            )?
            .path
        };
        progress.show_note(GLIP_LICENCE);
        Ok(Self { weights, tokenizer, identity: checkpoint.identity })
    }
}
