//! Scripts for the roles of a run: they see, ask, summarise, write and walk like a careless model. Their mistakes are drawn from a
//! seed, so every run repeats them.

mod author;
mod eye;
mod prompt;
mod questioner;
mod summariser;
mod troubles;
mod walker;

use super::{Heard, Script};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

pub use author::Author;
pub use eye::FlawedEye;
pub use questioner::Questioner;
pub use summariser::Summariser;
pub use troubles::Troubled;
pub use walker::{Gait, MISCHIEF, Route, Walker};

/// All roles behind one model name. A request to write goes to the author, with pictures or without; another request with
/// a picture goes to the eye, and any other to the role that its prompt is for.
#[derive(Debug, Clone)]
pub struct Cast {
    /// Answers about pictures.
    pub eye: FlawedEye,
    /// Asks questions about a picture.
    pub questioner: Questioner,
    /// Summarises a dialogue.
    pub summariser: Summariser,
    /// Writes instructions.
    pub author: Author,
}

impl Cast {
    /// A cast with text roles that make mistakes with this probability.
    #[must_use]
    pub fn new(eye: FlawedEye, seed: u64, carelessness: f64) -> Self {
        Self {
            eye,
            questioner: Questioner { seed, chatter: carelessness },
            summariser: Summariser { seed, carelessness },
            author: Author { seed, carelessness },
        }
    }
}

impl Script for Cast {
    fn reply(&self, heard: &Heard) -> String {
        let prompt = heard.prompt();
        if prompt.contains("Frame 0:") {
            self.author.reply(heard)
        } else if !heard.pictures.is_empty() {
            self.eye.reply(heard)
        } else if prompt.contains("Ask one new question") {
            self.questioner.reply(heard)
        } else if prompt.contains("Sum up") {
            self.summariser.reply(heard)
        } else if prompt.contains("Describe the place in one sentence") {
            prompt::condensed(prompt)
        } else {
            "ready".to_owned()
        }
    }
}

impl<F: Fn(&Heard) -> String + Send + Sync> Script for F {
    fn reply(&self, heard: &Heard) -> String {
        self(heard)
    }
}

/// A random generator that is seeded by a text, so that equal prompts get equal draws.
fn rng(seed: u64, about: &str) -> ChaCha8Rng {
    let mut hash = Sha256::new();
    hash.update(seed.to_le_bytes());
    hash.update(about);
    ChaCha8Rng::from_seed(hash.finalize().into())
}
