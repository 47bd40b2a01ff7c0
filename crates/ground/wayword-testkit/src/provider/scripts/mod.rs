//! Scripts for the roles of a run: they see, ask, summarise, write and walk like a careless model. Their mistakes are drawn from a
//! seed, so every run repeats them.

mod author;
mod flawed_eye;
mod prompt_reading;
mod questioner;
mod summariser;
mod troubled_script;
mod walker;

use super::{ModelScript, ScriptRequest};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

pub use author::ScriptedAuthor;
pub use flawed_eye::FlawedEye;
pub use questioner::ScriptedQuestioner;
pub use summariser::ScriptedSummariser;
pub use troubled_script::TroubledScript;
pub use walker::{BROKEN_REPLIES, ScriptedRoute, ScriptedWalker, WalkerGait};

/// All roles behind one model name. A request to write goes to the author, with pictures or without; another request with
/// a picture goes to the eye, and any other to the role that its prompt is for.
#[derive(Debug, Clone)]
pub struct ScriptedCast {
    /// Answers about pictures.
    pub eye: FlawedEye,
    /// Asks questions about a picture.
    pub questioner: ScriptedQuestioner,
    /// Summarises a dialogue.
    pub summariser: ScriptedSummariser,
    /// Writes instructions.
    pub author: ScriptedAuthor,
}

impl ScriptedCast {
    /// A cast with text roles that make mistakes with this probability.
    #[must_use]
    pub fn new(eye: FlawedEye, seed: u64, carelessness: f64) -> Self {
        Self {
            eye,
            questioner: ScriptedQuestioner { seed, chatter: carelessness },
            summariser: ScriptedSummariser { seed, carelessness },
            author: ScriptedAuthor { seed, carelessness },
        }
    }
}

impl ModelScript for ScriptedCast {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        if prompt.contains("Write one instruction in this style") {
            self.author.reply(request)
        } else if !request.pictures.is_empty() {
            self.eye.reply(request)
        } else if prompt.contains("Ask one new question") {
            self.questioner.reply(request)
        } else if prompt.contains("Sum up") {
            self.summariser.reply(request)
        } else if prompt.contains("Describe the place in one sentence") {
            prompt_reading::condense_panorama(prompt)
        } else {
            "ready".to_owned()
        }
    }
}

impl<F: Fn(&ScriptRequest) -> String + Send + Sync> ModelScript for F {
    fn reply(&self, request: &ScriptRequest) -> String {
        self(request)
    }
}

/// A random generator that is seeded by a text, so that equal prompts get equal draws.
fn rng_for_text(seed: u64, about: &str) -> ChaCha8Rng {
    let mut hash = Sha256::new();
    hash.update(seed.to_le_bytes());
    hash.update(about);
    ChaCha8Rng::from_seed(hash.finalize().into())
}
