//! The page of an annotated dataset: film strip, parts and texts of each episode, and what was not kept, with the reasons.

use super::{
    CuratedFrame, CuratedMark, CuratedPair, CuratedPart, CuratedPicture, MOST_SEEN, PAIRS_PER_PAGE, PageLink,
    remove_later_pages, state_word,
};
use crate::pages::{load_templates, replace_page, template_error};
use minijinja::context;
use serde::Serialize;
use std::path::PathBuf;
use wayword_run::{
    annotate::{AnnotatedFrame, AnnotationReport, EpisodeAnnotation, read_annotations},
    error::CommandError,
};

/// A page of episodes, as the template has it.
#[derive(Serialize)]
struct AnnotationPage<'a> {
    dataset: &'a str,
    page: usize,
    pages: &'a [PageLink],
    summary: String,
    pairs: Vec<CuratedPair<'a>>,
}

/// Writes the pages of an annotated dataset into the folder of its records; returns the first.
///
/// # Errors
/// When the annotations cannot be read, or a page cannot be written.
pub fn write_annotation_pages(report: &AnnotationReport) -> Result<PathBuf, CommandError> {
    let annotations = read_annotations(&report.kept)?;
    let names: Vec<String> = annotations.iter().map(|known| format!("episode {}", known.episode)).collect();
    let templates = load_templates().map_err(template_error)?;
    let pages = annotations.len().div_ceil(PAIRS_PER_PAGE).max(1);
    for page in 1..=pages {
        let links = PageLink::all(annotations.len(), page);
        let first = (page - 1) * PAIRS_PER_PAGE;
        let shown = annotations.iter().zip(&names).enumerate().skip(first).take(PAIRS_PER_PAGE);
        let view = AnnotationPage {
            dataset: &report.dataset,
            page,
            pages: &links,
            summary: report.to_string(),
            pairs: shown.map(|(at, (known, name))| episode_view(at + 1, known, name)).collect(),
        };
        let view = context! { page => view, has_files => true };
        let drawn = templates.get_template("annotations.html").and_then(|template| template.render(view));
        let file = report.kept.join(PageLink::file(page));
        replace_page(&file, |take| take(&drawn.map_err(template_error)?))?;
    }
    remove_later_pages(&report.kept, pages)?;
    Ok(report.kept.join(PageLink::file(1)))
}

fn episode_view<'a>(number: usize, known: &'a EpisodeAnnotation, name: &'a str) -> CuratedPair<'a> {
    let ends = known.parts.iter().skip(1).map(|part| part.from);
    let ends = ends.chain([known.frames.last().map_or(0, |frame| frame.frame)]);
    let parts = known.parts.iter().zip(ends).enumerate().map(|(at, (part, end))| CuratedPart {
        number: Some(at + 1),
        words: &part.text,
        state: state_word(part.state),
        frames: Some([part.from, end.max(part.from)]),
        reasons: Vec::new(),
    });
    let texts = known.texts.iter().map(|text| format!("kept, about the whole: {}", text.text));
    let dropped = known.dropped.iter().map(|dropped| match dropped.text.as_str() {
        "" => format!("no text: {}", dropped.why),
        text => format!("not kept: {text} ({})", dropped.why),
    });
    let asked =
        known.questions.iter().map(|asked| format!("frame {}: {} {}", asked.frame, asked.question, asked.answer));
    CuratedPair {
        anchor: format!("episode-{number}"),
        number,
        id: name,
        mark: CuratedMark { class: "good", words: format!("{} parts", known.parts.len()) },
        about: "Task",
        scene: known.tasks.first().map_or("", String::as_str),
        source: match known.motion.as_str() {
            "poses" => "poses known",
            "pictures" => "motion estimated from the pictures",
            _ => "motion unknown",
        },
        parts: parts.flat_map(|part| [part, CuratedPart::between(" ")]).collect(),
        frames: known.frames.iter().filter(|frame| frame.picture.is_some()).map(frame_view).collect(),
        notes: texts.chain(dropped).chain(asked).collect(),
        notes_title: "Texts about the whole, what was not kept, and questions",
    }
}

fn frame_view(frame: &AnnotatedFrame) -> CuratedFrame<'_> {
    CuratedFrame {
        number: frame.frame,
        picture: frame.picture.as_ref().map(CuratedPicture::new),
        seen: &frame.seen[..frame.seen.len().min(MOST_SEEN)],
        room: frame.room.as_deref(),
        then: None,
        sign: None,
    }
}
