//! A scripted author: it writes instructions from the parts of the walk in a prompt, with occasional mistakes.

use super::{ModelScript, rng_for_text};
use crate::provider::ScriptRequest;
use rand::{Rng, seq::IndexedRandom};

/// Writes a sentence for each part of the walk, with a landmark of it. When it is careless, it names a treadmill or piano
/// that no part names.
#[derive(Debug, Clone, Copy)]
pub struct ScriptedAuthor {
    /// Seed of its draws.
    pub seed: u64,
    /// How often it is careless, 0 to 1. It is half as careless when the prompt gives the reason of an earlier refusal.
    pub carelessness: f64,
}

/// A part of the walk, as the prompt tells it.
struct PromptPart<'a> {
    /// How the walk goes there, as "turn left (85 degrees), 3.0 metres"; empty where it is not known.
    way: &'a str,
    /// The things that it lists.
    things: Vec<&'a str>,
}

impl ModelScript for ScriptedAuthor {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        let parts = read_parts(prompt);
        let mut rng = rng_for_text(self.seed, prompt);
        let share = if prompt.contains("was refused because") { self.carelessness / 2.0 } else { self.carelessness };
        let careless = rng.random_bool(share);
        let target = prompt.split("on this object of the last frame: ").nth(1).and_then(|rest| rest.lines().next());
        let target =
            target.map(|target| target.split([',', ';', '(']).next().unwrap_or(target).trim_end_matches([' ', '.']));
        let coarse = prompt.contains("an activity part");
        let text =
            if coarse { coarse_text(&parts, target, careless) } else { fine_text(&parts, target, careless, &mut rng) };
        // If the prompt lists texts that this path already has, the new text uses other words.
        match prompt.matches("This way already has the instruction: ").count() {
            0 => text,
            1 => text.replace("Walk past", "Go past").replace("Go on until", "Walk on until"),
            _ => text.replace("Walk past", "Move past").replace("Go on until", "Head on until").replace("Stop", "Wait"),
        }
    }
}

/// The parts that a prompt lists.
fn read_parts(prompt: &str) -> Vec<PromptPart<'_>> {
    let mut parts: Vec<PromptPart<'_>> = Vec::new();
    let told = prompt.split("The style,").next().unwrap_or_default();
    for line in told.lines().skip(1) {
        let frames = line.strip_prefix("Frame").map(|rest| rest.trim_start_matches('s'));
        if frames.is_some_and(|rest| rest.trim_start().starts_with(|c: char| c.is_ascii_digit())) {
            parts.push(PromptPart { way: line.split_once(": ").map_or("", |(_, way)| way), things: Vec::new() });
        } else if let (Some((label, things)), Some(part)) = (line.split_once(": "), parts.last_mut()) {
            let is_sure = !["perhaps", "ways out", "described"].iter().any(|other| label.contains(other));
            part.things.extend(things.split("; ").map(bare_thing).filter(|_| is_sure));
        }
    }
    parts
}

/// A thing without what stands behind its name: "grey sofa (left)", "picture of a ship".
fn bare_thing(thing: &str) -> &str {
    let end = [" (", " of a ", " with "].iter().filter_map(|mark| thing.find(mark)).min().unwrap_or(thing.len());
    thing[..end].trim_end_matches('.')
}

/// The first thing of a part that a text can name.
fn first_landmark<'a>(part: &PromptPart<'a>) -> Option<&'a str> {
    part.things.iter().copied().find(|name| !name.starts_with("several") && !name.ends_with("floor"))
}

/// One sentence about the end of the path, as in REVERIE.
fn coarse_text(parts: &[PromptPart<'_>], target: Option<&str>, careless: bool) -> String {
    let object = target.or_else(|| parts.last().and_then(first_landmark)).unwrap_or("door");
    let object = if careless { "treadmill" } else { object };
    format!("Go on until you see the {object} and clean the {object}.")
}

/// A sentence for each part, as in R2R.
fn fine_text(parts: &[PromptPart<'_>], target: Option<&str>, careless: bool, rng: &mut impl Rng) -> String {
    let wrong = careless.then(|| rng.random_range(0..parts.len().max(1)));
    let absent = ["treadmill", "piano"].choose(rng).copied().unwrap_or("piano");
    let mut sentences = Vec::new();
    for (at, part) in parts.iter().enumerate().take(parts.len().max(1) - 1) {
        let turn = ["left", "right"].into_iter().find(|side| part.way.contains(&format!("turn {side}")));
        sentences.extend(turn.map(|side| format!("Turn {side}.")));
        if part.way.contains("turn around") {
            sentences.push("Turn around.".to_owned());
        }
        if wrong == Some(at) {
            sentences.push(format!("Walk past the {absent}."));
        } else if let Some(name) = first_landmark(part).filter(|_| turn.is_none() && at > 0) {
            sentences.push(format!("Walk past the {name}."));
        }
    }
    let end = target.or_else(|| parts.last().and_then(first_landmark));
    sentences.push("Go straight on.".to_owned());
    sentences.push(end.map_or("Stop there.".to_owned(), |name| format!("Stop at the {name}.")));
    sentences.join(" ")
}
