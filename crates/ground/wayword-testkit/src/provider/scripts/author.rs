//! A scripted author: it writes instructions from the captions and moves in a prompt, with occasional mistakes.

use super::{ModelScript, prompt_reading::named_things, rng_for_text};
use crate::provider::ScriptRequest;
use rand::{Rng, seq::IndexedRandom};

/// Writes a sentence for each move, with a landmark of the frame. When it is careless, it names a treadmill or piano
/// that no caption names.
#[derive(Debug, Clone, Copy)]
pub struct ScriptedAuthor {
    /// Seed of its draws.
    pub seed: u64,
    /// How often it is careless, 0 to 1. It is half as careless when the prompt gives the reason of an earlier refusal.
    pub carelessness: f64,
}

/// A frame of the prompt: its caption, and the move that follows.
struct PromptFrame<'a> {
    caption: &'a str,
    /// The words of the move to the next frame, as "turns left"; `None` for the last frame.
    then: Option<&'a str>,
}

impl ModelScript for ScriptedAuthor {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        let frames = read_frames(prompt);
        let mut rng = rng_for_text(self.seed, prompt);
        let share = if prompt.contains("was refused because") { self.carelessness / 2.0 } else { self.carelessness };
        let careless = rng.random_bool(share);
        let target = prompt.split("on this object of the last frame: ").nth(1).and_then(|rest| rest.lines().next());
        let target = target.map(|target| target.split(" (").next().unwrap_or(target).trim_end_matches('.'));
        let coarse = prompt.contains("an activity part");
        let text = if coarse {
            coarse_text(&frames, target, careless)
        } else {
            fine_text(&frames, target, careless, &mut rng)
        };
        // If the prompt lists texts that this path already has, the new text uses other words.
        match prompt.matches("This way already has the instruction: ").count() {
            0 => text,
            1 => text.replace("Walk past", "Go past").replace("Go on until", "Walk on until"),
            _ => text.replace("Walk past", "Move past").replace("Go on until", "Head on until").replace("Stop", "Wait"),
        }
    }
}

/// The frames that a prompt lists.
fn read_frames(prompt: &str) -> Vec<PromptFrame<'_>> {
    let mut frames: Vec<PromptFrame<'_>> = Vec::new();
    for line in prompt.lines() {
        if let Some((_, caption)) = line.strip_prefix("Frame ").and_then(|rest| rest.split_once(": ")) {
            frames.push(PromptFrame { caption, then: None });
        } else if let (Some(then), Some(last)) = (line.trim().strip_prefix("Then: "), frames.last_mut()) {
            last.then = Some(then);
        }
    }
    frames
}

/// The first thing that a caption names and that is not a room.
fn first_landmark(caption: &str) -> Option<String> {
    named_things(caption).into_iter().find(|name| !name.ends_with("room") && !name.ends_with("way") && name != "place")
}

/// One sentence about the end of the path, as in REVERIE.
fn coarse_text(frames: &[PromptFrame<'_>], target: Option<&str>, careless: bool) -> String {
    let last = frames.last().and_then(|frame| first_landmark(frame.caption));
    let object = target.map(str::to_owned).or(last).unwrap_or_else(|| "door".to_owned());
    let object = if careless { "treadmill".to_owned() } else { object };
    format!("Go on until you see the {object} and clean the {object}.")
}

/// A sentence for each move, as in R2R.
fn fine_text(frames: &[PromptFrame<'_>], target: Option<&str>, careless: bool, rng: &mut impl Rng) -> String {
    let wrong = careless.then(|| rng.random_range(0..frames.len().max(1)));
    let absent = ["treadmill", "piano"].choose(rng).copied().unwrap_or("piano");
    let mut sentences = Vec::new();
    for (at, frame) in frames.iter().enumerate() {
        let Some(then) = frame.then else { continue };
        let turn = if then.starts_with("turns left") {
            Some("left")
        } else if then.starts_with("turns right") {
            Some("right")
        } else {
            None
        };
        if let Some(side) = turn {
            sentences.push(format!("Turn {side}."));
        } else if then.starts_with("turns around") {
            sentences.push("Turn around.".to_owned());
        }
        if wrong == Some(at) {
            sentences.push(format!("Walk past the {absent}."));
        } else if let Some(name) = first_landmark(frame.caption).filter(|_| turn.is_none() && at > 0) {
            sentences.push(format!("Walk past the {name}."));
        }
    }
    let end = target.map(str::to_owned).or_else(|| frames.last().and_then(|frame| first_landmark(frame.caption)));
    sentences.push("Go straight on.".to_owned());
    sentences.push(end.map_or("Stop there.".to_owned(), |name| format!("Stop at the {name}.")));
    sentences.join(" ")
}
