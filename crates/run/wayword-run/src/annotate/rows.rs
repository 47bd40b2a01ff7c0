//! An annotated episode as rows of LeRobot's columns of language.

use super::records::EpisodeAnnotation;
use wayword_formats::training::{columns::LanguageRow, lerobot_language::EpisodeLanguage};

/// The rows of an episode: at the start of each part what is done and what is left to do, other words for the whole at the beginning, and
/// each question with its answer on its frame.
pub(super) fn language_rows(annotation: &EpisodeAnnotation, camera: &str) -> EpisodeLanguage {
    let row = |role, style, content: String, camera: Option<String>| LanguageRow {
        role,
        content,
        style,
        time_s: 0.0,
        camera,
    };
    let mut persistent = Vec::new();
    let parts = &annotation.parts;
    for (at, part) in parts.iter().enumerate() {
        let left = parts[at..].iter().enumerate().map(|(number, part)| format!("{}. {}", number + 1, part.text));
        persistent.push((part.from, row("assistant", "plan", left.collect::<Vec<_>>().join("\n"), None)));
        persistent.push((part.from, row("assistant", "subtask", part.text.clone(), None)));
    }
    let mut wordings: Vec<&str> = Vec::new();
    for text in annotation.tasks.iter().chain(annotation.texts.iter().map(|text| &text.text)) {
        if !wordings.contains(&text.as_str()) {
            wordings.push(text);
        }
    }
    persistent.extend(wordings.into_iter().map(|text| (0, row("user", "task_aug", text.to_owned(), None))));
    let mut events = Vec::new();
    for asked in &annotation.questions {
        let camera = || Some(camera.to_owned());
        events.push((asked.frame, row("assistant", "vqa", asked.answer.to_string(), camera())));
        events.push((asked.frame, row("user", "vqa", asked.question.clone(), camera())));
    }
    EpisodeLanguage { persistent, events }
}
