//! Writes the closing task of an instruction ("... and dust the lamp").

use super::{WriteError, WritingBrief, object::TaskObject};
use rand_chacha::ChaCha8Rng;

/// Draws a task; returns its words and the name of its object.
pub(super) fn draw_task(brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> Result<(String, String), WriteError> {
    let object = TaskObject::for_brief(brief, rng)?;
    let wording = &brief.profile.wording;
    let phrase = object.object_phrase(&object.draw_distinction_in_view(wording, rng), wording, rng);
    Ok((task_phrase(wording.draw_verb(&object.name, 1.0, rng), &phrase), object.name))
}

/// The words of a task. `verb` has `{o}` in place of the object ("turn {o} on"). A particle follows a short object
/// only, of up to three words: "turn the lamp on", but "turn on the lamp by the door".
pub(super) fn task_phrase(verb: &str, object: &str) -> String {
    match verb.split_once(" {o} ") {
        Some((verb, particle)) if object.split(' ').count() > 3 => format!("{verb} {particle} {object}"),
        _ => verb.replace("{o}", object),
    }
}
