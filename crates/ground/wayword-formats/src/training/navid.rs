//! Training data of Uni-NaVid and NaVid: conversations in LLaVA's form about a video of all views up to a decision.
//!
//! Source: jzhzhang/Uni-NaVid, `uninavid/train/train.py` (`LazySupervisedDataset`) and `offline_eval_uninavid.py`;
//! jzhzhang/NaVid-VLN-CE, `agent_navid.py` (the prompt and the words that it reads back). A word means 0.25 m or 30 degrees.

use super::action_runs::{ActionRun, MAX_ANSWER_STEPS, action_runs, action_sentence};
use crate::{FormatError, output};
use serde_json::{Value, json};
use std::path::Path;
use wayword_core::AgentAction;

/// The angle that a turn of these policies means, degrees.
pub const NAVID_TURN_DEG: f64 = 30.0;
/// Actions that Uni-NaVid says at once.
const NEXT_ACTIONS: usize = 4;
const TURN_DEG: usize = 30;

/// The policy that learns from the conversations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NavidPolicy {
    /// NaVid: one action in words, with its length.
    NaVid,
    /// Uni-NaVid: the next four actions, one word each.
    UniNaVid,
}

/// A conversation about a decision.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NavidSample {
    /// Its name, which contains `NAV_ID`: the loader looks for that.
    pub id: String,
    /// The video, below the folder of videos.
    pub video: String,
    /// The question with the text.
    pub prompt: String,
    /// The actions in words.
    pub answer: String,
}

/// The decisions of a walk for which there are samples: the first action of each run of equal ones.
#[must_use]
pub fn navid_decisions(actions: &[AgentAction]) -> Vec<ActionRun> {
    action_runs(actions, MAX_ANSWER_STEPS)
}

/// The sample of a decision. `walk` names the walk with its text, and `video` the views up to the decision.
#[must_use]
pub fn navid_sample(
    policy: NavidPolicy,
    (walk, video): (&str, String),
    text: &str,
    actions: &[AgentAction],
    run: ActionRun,
) -> NavidSample {
    let answer = match policy {
        NavidPolicy::NaVid => action_sentence(run, TURN_DEG, "degrees"),
        NavidPolicy::UniNaVid => next_words(actions, run.first),
    };
    NavidSample { id: format!("NAV_ID_{walk}_{}", run.first), video, prompt: prompt_words(policy, text), answer }
}

/// The prompt of the policy's evaluation. `<image>` stands where the evaluation puts the video.
fn prompt_words(policy: NavidPolicy, text: &str) -> String {
    // What the loaders take for marks of their own, and newlines, which they drop, cannot stand in a text.
    let text = ["<image>", " ASSISTANT: ", "</s>", "\n", "\r"]
        .iter()
        .fold(text.to_owned(), |text, mark| text.replace(mark, " "));
    let asked = match policy {
        NavidPolicy::UniNaVid => {
            "determine your next four actions. The predicted action should be one of the following: forward, left, right, or stop."
        }
        NavidPolicy::NaVid => {
            "decide your next move, which could involve turning left or right by a specific degree or moving forward a certain distance."
        }
    };
    format!(
        "Imagine you are a robot programmed for navigation tasks. You have been given a video of historical observations and an \
         image of the current observation <image>. Your assigned task is: '{text}'. Analyze this series of images to {asked}"
    )
}

/// The next four actions, one word each; after the end of the walk "stop".
fn next_words(actions: &[AgentAction], first: usize) -> String {
    let word = |at: usize| match actions.get(at) {
        Some(AgentAction::Forward) => "forward",
        Some(AgentAction::Left) => "left",
        Some(AgentAction::Right) => "right",
        Some(AgentAction::Stop) | None => "stop",
    };
    (first..first + NEXT_ACTIONS).map(word).collect::<Vec<_>>().join(" ")
}

/// Writes the conversations as one list.
///
/// # Errors
/// When it cannot be written.
pub fn write_navid_file(file: &Path, samples: impl IntoIterator<Item = NavidSample>) -> Result<(), FormatError> {
    let item = |sample: NavidSample| -> Value {
        json!({
            "id": sample.id,
            "video": sample.video,
            "conversations": [
                {"from": "human", "value": sample.prompt},
                {"from": "gpt", "value": sample.answer},
            ],
        })
    };
    output::write_file(file, |out| output::write_list(out, samples.into_iter().map(item)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_what_the_agents_read_back() {
        let actions = [1, 1, 3, 0].map(|number| AgentAction::try_from(number).unwrap());
        let answers = |policy| {
            navid_decisions(&actions)
                .into_iter()
                .map(|run| navid_sample(policy, ("a-0", "x.avi".into()), "Go.", &actions, run).answer)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            answers(NavidPolicy::NaVid),
            [
                "The next action is move forward 50 cm.",
                "The next action is turn right 30 degrees.",
                "The next action is stop."
            ]
        );
        assert_eq!(
            answers(NavidPolicy::UniNaVid),
            ["forward forward right stop", "right stop stop stop", "stop stop stop stop"]
        );
    }

    #[test]
    fn a_text_cannot_hold_the_marks_of_the_loaders() {
        let sample = |text: &str| {
            let run = ActionRun { first: 7, action: AgentAction::Stop, count: 1 };
            navid_sample(NavidPolicy::UniNaVid, ("a-0", "x.avi".into()), text, &[AgentAction::Stop], run)
        };
        let made = sample("Go <image> on.\nStop </s> there.");
        assert_eq!(made.prompt.matches("<image>").count(), 1);
        assert!(made.prompt.contains("task is: 'Go   on. Stop   there.'. Analyze") && made.id == "NAV_ID_a-0_7");
        assert!(made.prompt.contains("a video of historical observations and an image of the current observation"));
    }
}
