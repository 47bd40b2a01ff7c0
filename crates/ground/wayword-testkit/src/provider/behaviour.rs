//! The settings of a scripted provider: its models, latency, faults, rate limit and key.

use super::{FaultSchedule, ProviderRequestRate};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
    time::Duration,
};
use wayword_core::MessageRole;

/// How a provider behaves. It has no `Debug`, because it holds a key.
#[derive(Clone, Default)]
pub struct ProviderBehaviour {
    /// The script of each model, by name. Any other name is answered with 404.
    pub scripts: BTreeMap<String, Arc<dyn ModelScript>>,
    /// The models that accept no pictures. Ollama's `/api/show` lists no `vision` for them.
    pub blind: BTreeSet<String>,
    /// The time from a request to its answer or fault. A request with a wrong key or above the rate is refused at once.
    pub latency: Duration,
    /// Which faults occur, and how often.
    pub faults: FaultSchedule,
    /// The rate limit; `None` for no limit.
    pub rate: Option<ProviderRequestRate>,
    /// The only key that is accepted, in the dialect's header for it; `None` where no key is needed.
    pub key: Option<String>,
    /// Seed of the faults.
    pub seed: u64,
}

impl ProviderBehaviour {
    /// One model, without faults, limits, delay or key.
    #[must_use]
    pub fn for_model(model: &str, script: impl ModelScript + 'static) -> Self {
        Self::default().and_model(model, script)
    }

    /// The same with one more model.
    #[must_use]
    pub fn and_model(mut self, model: &str, script: impl ModelScript + 'static) -> Self {
        self.scripts.insert(model.to_owned(), Arc::new(script));
        self
    }
}

/// A substitute for a model: turns a request into the text of a reply.
pub trait ModelScript: Send + Sync {
    /// The model's reply. It should depend on the request alone, so that runs can be repeated.
    fn reply(&self, request: &ScriptRequest) -> String;
}

/// A request to a model, the same in every dialect.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ScriptRequest {
    /// The model's name, without its provider's.
    pub model: String,
    /// The messages with their roles, in order.
    pub messages: Vec<(MessageRole, String)>,
    /// The bytes of all pictures, in order.
    pub pictures: Vec<Vec<u8>>,
    /// The temperature of the sampling. 0 gives the likeliest words.
    pub temperature: Option<f64>,
    /// The most tokens of the reply. When this provider cuts replies, it counts a word as a token.
    pub max_tokens: Option<u64>,
    /// Seed of the sampling.
    pub seed: Option<u64>,
}

impl ScriptRequest {
    /// The last message that is not the model's own.
    #[must_use]
    pub fn prompt(&self) -> &str {
        let last = self.messages.iter().rev().find(|(role, _)| *role != MessageRole::Assistant);
        last.map_or("", |(_, text)| text)
    }
}
