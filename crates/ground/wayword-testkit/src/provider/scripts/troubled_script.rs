//! Spoils the answers of a script in the ways that BLIP-2 is known for (ChatCaptioner #4 and #7; LAVIS #472, #713, #806).

use super::{ModelScript, rng_for_text};
use crate::provider::ScriptRequest;
use rand::Rng;
use std::sync::Arc;

/// Wraps a script and makes a share of its answers useless. Each of these is, equally often, empty, the question itself, a loop
/// of a few words, or one fixed sentence. Equal requests get equal answers. A question in other words is drawn anew, so asking
/// again may help.
#[derive(Clone)]
pub struct TroubledScript {
    script: Arc<dyn ModelScript>,
    /// The share of useless answers, 0 to 1.
    share: f64,
    seed: u64,
}

impl TroubledScript {
    /// Spoils a share (0 to 1) of a script's answers.
    #[must_use]
    pub fn new(script: impl ModelScript + 'static, share: f64, seed: u64) -> Self {
        Self { script: Arc::new(script), share: share.clamp(0.0, 1.0), seed }
    }
}

impl ModelScript for TroubledScript {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        let pictures: String = request.pictures.iter().map(|bytes| String::from_utf8_lossy(bytes)).collect();
        let mut rng = rng_for_text(self.seed, &format!("trouble {prompt} {pictures}"));
        if !rng.random_bool(self.share) {
            return self.script.reply(request);
        }
        match rng.random_range(0..4) {
            0 => String::new(),
            1 => prompt.rsplit("Question:").next().unwrap_or(prompt).replace("Answer:", "").trim().to_owned(),
            2 => "a bed and ".repeat(20),
            _ => "A room with a window.".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::MessageRole;

    #[test]
    fn a_share_of_answers_is_spoilt_in_all_four_ways() {
        let troubled = TroubledScript::new(|_: &ScriptRequest| "A lamp.".to_owned(), 0.4, 1);
        let answer = |at: usize| {
            let text = format!("Look.\nQuestion: What is at {at}?\nAnswer:");
            troubled.reply(&ScriptRequest { messages: vec![(MessageRole::User, text)], ..ScriptRequest::default() })
        };
        let answers: Vec<String> = (0..1000).map(answer).collect();
        assert_eq!(answers, (0..1000).map(answer).collect::<Vec<_>>());
        let count = |is: &dyn Fn(&str) -> bool| answers.iter().filter(|answer| is(answer)).count();
        assert!((550..650).contains(&count(&|answer| answer == "A lamp.")));
        let ways: [&dyn Fn(&str) -> bool; 4] = [
            &|answer| answer.is_empty(),
            &|answer| answer.starts_with("What is at") && answer.ends_with('?'),
            &|answer| answer.starts_with("a bed and a bed and"),
            &|answer| answer == "A room with a window.",
        ];
        for is in ways {
            assert!((60..140).contains(&count(is)), "{}", count(is));
        }
    }
}
