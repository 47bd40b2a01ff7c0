//! A scripted summariser: it turns a dialogue about a picture into one sentence, with occasional mistakes.

use super::{
    ModelScript,
    prompt_reading::{is_denial, join_with_and, named_room, named_things, read_exchanges, with_article},
    rng_for_text,
};
use crate::provider::ScriptRequest;
use rand::Rng;

/// Names the objects that the answers affirmed. When it is careless, it keeps denied ones as well, or adds a piano.
#[derive(Debug, Clone, Copy)]
pub struct ScriptedSummariser {
    /// Seed of its draws.
    pub seed: u64,
    /// How often it is careless, 0 to 1. It never is when the prompt gives the reason of an earlier refusal.
    pub carelessness: f64,
}

impl ModelScript for ScriptedSummariser {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        let exchanges = read_exchanges(prompt);
        let named: Vec<String> = exchanges
            .iter()
            .filter(|(_, answer)| !is_denial(answer))
            .flat_map(|(_, answer)| named_things(answer))
            .collect();
        let room = named_room(&exchanges);
        let is_denied = |name: &String| {
            exchanges.iter().any(|(question, answer)| is_denial(answer) && question.contains(name.as_str()))
        };
        let careless =
            !prompt.contains("was refused") && rng_for_text(self.seed, prompt).random_bool(self.carelessness);
        let mut kept: Vec<String> = Vec::new();
        for name in named {
            if (careless || !is_denied(&name)) && Some(name.as_str()) != room && !kept.contains(&name) {
                kept.push(name);
            }
        }
        if careless && kept.iter().all(|name| !is_denied(name)) {
            kept.push("piano".to_owned());
        }
        let items: Vec<String> = kept.iter().map(|name| with_article(name)).collect();
        let place = room.map_or("A place".to_owned(), |room| format!("The picture shows a {room}"));
        if items.is_empty() { format!("{place}.") } else { format!("{place} with {}.", join_with_and(&items)) }
    }
}
