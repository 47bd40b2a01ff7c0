//! Writes the closing task of an instruction ("... and dust the lamp").

use super::{
    WriteError, WritingBrief,
    object::{ObjectContent, TaskObject},
};
use rand_chacha::ChaCha8Rng;

/// What a task tells: the English verb with `{o}` for the object, and the object.
#[derive(Clone)]
pub(super) struct TaskContent {
    pub(super) verb: String,
    pub(super) object: ObjectContent,
}

/// A task in words.
#[derive(Clone)]
pub(super) struct TaskPhrase {
    pub(super) text: String,
    /// The name of its object.
    pub(super) name: String,
    pub(super) content: TaskContent,
}

/// Draws a task.
pub(super) fn draw_task(brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> Result<TaskPhrase, WriteError> {
    let object = TaskObject::for_brief(brief, rng)?;
    let wording = &brief.profile.wording;
    let (phrase, content) = object.object_phrase(&object.draw_distinction_in_view(wording, rng), wording, rng);
    let verb = wording.draw_verb(&object.name, 1.0, rng);
    let content = TaskContent { verb: verb.to_owned(), object: content };
    Ok(TaskPhrase { text: task_words(verb, &phrase), name: object.name, content })
}

/// The words of a task. `verb` has `{o}` in place of the object ("turn {o} on"). A particle follows a short object
/// only, of up to three words: "turn the lamp on", but "turn on the lamp by the door".
pub(super) fn task_words(verb: &str, object: &str) -> String {
    match verb.split_once(" {o} ") {
        Some((verb, particle)) if object.split(' ').count() > 3 => format!("{verb} {particle} {object}"),
        _ => verb.replace("{o}", object),
    }
}
