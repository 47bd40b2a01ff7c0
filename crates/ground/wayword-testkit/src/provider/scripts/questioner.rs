//! A scripted questioner: it asks about a picture that it cannot see, from the dialogue so far.

use super::{
    ModelScript,
    prompt_reading::{named_things, read_exchanges, with_article},
    rng_for_text,
};
use crate::provider::ScriptRequest;
use rand::Rng;

/// Asks for the kind of room, then whether each named object is really there, then about the left, the right and the floor.
#[derive(Debug, Clone, Copy)]
pub struct ScriptedQuestioner {
    /// Seed of its draws.
    pub seed: u64,
    /// How often it wraps the question in other words, as real models do.
    pub chatter: f64,
}

impl ModelScript for ScriptedQuestioner {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        let question = next_question(prompt);
        let mut rng = rng_for_text(self.seed, prompt);
        if !rng.random_bool(self.chatter) {
            return question;
        }
        match rng.random_range(0..3) {
            0 => format!("Sure! Question: {question}"),
            1 => format!("{question}\nAnswer: Yes, there is one next to the elephant."),
            _ => format!("\"{question}\""),
        }
    }
}

/// The first question of the list that the dialogue does not have yet.
fn next_question(prompt: &str) -> String {
    let exchanges = read_exchanges(prompt);
    let is_new = |question: &String| !exchanges.iter().any(|(before, _)| before == question);
    let named = exchanges.first().map_or_else(Vec::new, |(_, answer)| named_things(answer));
    let doubts = named.iter().enumerate().map(|(at, name)| match at % 3 {
        0 => format!("Is there really {}?", with_article(name)),
        1 => format!("Is the {name} you mentioned really there?"),
        _ => format!("Do you see {} in the picture?", with_article(name)),
    });
    let first = ["What kind of room is this?".to_owned()].into_iter();
    let last = ["What is on the left?", "What is on the right?", "What is the floor made of?"].map(str::to_owned);
    first.chain(doubts).chain(last).find(is_new).unwrap_or_else(|| "What else can you see?".to_owned())
}
