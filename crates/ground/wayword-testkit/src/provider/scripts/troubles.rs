//! An eye with the known troubles of BLIP-2 (ChatCaptioner #4 and #7; LAVIS #472, #713, #806).

use super::prompt::question;
use crate::provider::{Heard, Script};
use rand::Rng;
use std::sync::Arc;

/// Another script, but a share of its answers cannot be used: an equal part each is empty, the question, a loop of a few words, and
/// the same sentence whatever was asked. A question in other words is another draw, so that asking again may help.
#[derive(Clone)]
pub struct Troubled {
    script: Arc<dyn Script>,
    share: f64,
    seed: u64,
}

impl Troubled {
    /// Spoils a share (0 to 1) of a script's answers.
    #[must_use]
    pub fn new(script: impl Script + 'static, share: f64, seed: u64) -> Self {
        Self { script: Arc::new(script), share, seed }
    }
}

impl Script for Troubled {
    fn reply(&self, heard: &Heard) -> String {
        let pictures = heard.pictures.iter().map(|bytes| String::from_utf8_lossy(bytes));
        let pictures: String = pictures.collect();
        let mut draw = wayword_core::rng(self.seed, &["trouble", heard.prompt(), &pictures]);
        if draw.random::<f64>() >= self.share {
            return self.script.reply(heard);
        }
        match draw.random_range(0..4) {
            0 => String::new(),
            1 => question(heard.prompt()).to_owned(),
            2 => "a bed and ".repeat(20),
            _ => "A room with a window.".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provider::scripts::Fixed;
    use wayword_core::Role;

    #[test]
    fn a_share_of_answers_is_spoilt_in_all_four_ways() {
        let eye = Troubled::new(Fixed::new("A lamp."), 0.4, 1);
        let answers = (0..1000).map(|at| {
            let text = format!("Look.\nQuestion: What is at {at}?\nAnswer:");
            eye.reply(&Heard { messages: vec![(Role::User, text)], ..Heard::default() })
        });
        let answers: Vec<String> = answers.collect();
        let count = |is: &dyn Fn(&str) -> bool| answers.iter().filter(|answer| is(answer)).count();
        assert!((550..650).contains(&count(&|answer| answer == "A lamp.")));
        for spoilt in ["", "a bed and a bed and", "A room with", "What is at"] {
            let found = count(&|answer| if spoilt.is_empty() { answer.is_empty() } else { answer.starts_with(spoilt) });
            assert!((60..140).contains(&found), "{found} of {spoilt:?}");
        }
    }
}
