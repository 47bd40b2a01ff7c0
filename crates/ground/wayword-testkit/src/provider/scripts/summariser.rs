//! A scripted summariser: it turns a dialogue about a picture into one sentence, with occasional mistakes.

use super::{
    Script,
    prompt::{article, denies, enumerate, exchanges, room, things},
    rng,
};
use crate::provider::Heard;
use rand::Rng;

/// Names the objects that the answers affirmed. When it is careless, it keeps denied ones as well, or adds a piano.
#[derive(Debug, Clone, Copy)]
pub struct Summariser {
    /// Seed of its draws.
    pub seed: u64,
    /// How often it is careless, 0 to 1. It never is when the prompt gives the reason of an earlier refusal.
    pub carelessness: f64,
}

impl Script for Summariser {
    fn reply(&self, heard: &Heard) -> String {
        let prompt = heard.prompt();
        let told = exchanges(prompt);
        let named: Vec<String> =
            told.iter().filter(|(_, answer)| !denies(answer)).flat_map(|(_, answer)| things(answer)).collect();
        let room = room(&told);
        let is_denied =
            |name: &String| told.iter().any(|(question, answer)| denies(answer) && question.contains(name.as_str()));
        let careless = !prompt.contains("was refused") && rng(self.seed, prompt).random_bool(self.carelessness);
        let mut kept: Vec<String> = Vec::new();
        for name in named {
            if (careless || !is_denied(&name)) && Some(name.as_str()) != room && !kept.contains(&name) {
                kept.push(name);
            }
        }
        if careless && kept.iter().all(|name| !is_denied(name)) {
            kept.push("piano".to_owned());
        }
        let items: Vec<String> = kept.iter().map(|name| article(name)).collect();
        let place = room.map_or("A place".to_owned(), |room| format!("The picture shows a {room}"));
        if items.is_empty() { format!("{place}.") } else { format!("{place} with {}.", enumerate(&items)) }
    }
}
