//! What every model that answers has in common.

use crate::{GgufModel, LocalError, Spoken};
use wayword_core::{Request, Sampling};

/// Answers requests.
pub(crate) trait Engine: Send + Sync {
    /// How it wants to be spoken to.
    fn kind(&self) -> Kind;

    /// The reply to a request.
    fn reply(&self, request: &Request) -> Result<Spoken, LocalError>;
}

impl Engine for GgufModel {
    fn kind(&self) -> Kind {
        Kind::Talks
    }

    fn reply(&self, request: &Request) -> Result<Spoken, LocalError> {
        // The same request again is to be answered anew, and the same seed would answer the same.
        let seed = request.sampling.seed.wrapping_add(request.replicate.into());
        self.reply(&request.messages, &Sampling { seed, ..request.sampling.clone() }, &mut |_| ())
    }
}

/// How a model wants to be spoken to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// In messages, as one that follows instructions. It does not see.
    Talks,
    /// With a picture and a bare question; with a picture and no words it describes.
    SeesQuestions,
    /// With a picture and a text to go on with.
    SeesTexts,
}
