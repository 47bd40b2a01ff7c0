//! How well texts agree with pictures, with the same two anchors as the other metrics: another person's text, and another path's.

use super::format_percent;
use crate::{
    by_pictures::PictureCritic,
    similarity::args::SimilarityArgs as Args,
    text_sets::{self, TextSet},
};
use serde::Serialize;
use std::fmt;
use wayword_metrics::{
    ResamplingOptions,
    captions::draw_other_paths,
    picture_scores::{
        AnchoredPictureFigures, CLIP_PROMPT_PREFIX, PictureFigures, PictureScores, PicturedItem,
        anchored_picture_figures,
    },
};
use wayword_run::{count::count_phrase, error::CommandError, interrupt, output::CommandOutput};

/// How well the texts of a set agree with pictures.
#[derive(Debug, Serialize)]
pub(super) struct PictureAgreementReport {
    /// The name of the CLIP model.
    clip: String,
    /// The words that were put before each text.
    prefix: &'static str,
    #[serde(flatten)]
    figures: AnchoredPictureFigures,
    /// Common items without a picture. No figure includes them.
    without_pictures: usize,
    /// Items for which B has only the text that is judged, so that there is no other person's.
    without_person: usize,
}

/// An item that both sides have.
struct CommonItem<'a> {
    id: &'a str,
    path: &'a str,
    /// A's first text.
    text: &'a str,
    /// B's first text. For other items it serves as the text of another path.
    first: &'a str,
    /// B's first text that differs from A's.
    person: Option<&'a str>,
}

/// Scores A's texts by the pictures of a run or platform; `None` if no CLIP is named.
///
/// # Errors
/// When the model or the pictures cannot be read, or no item has pictures.
pub(super) fn measure_pictures(
    args: &Args,
    (a, b): (&TextSet, &TextSet),
    drawing: &ResamplingOptions,
    output: &CommandOutput,
) -> Result<Option<PictureAgreementReport>, CommandError> {
    let runs: Vec<_> = [&args.a, &args.b].into_iter().filter_map(|name| text_sets::text_set_run(name)).collect();
    let Some(critic) = PictureCritic::open(&args.pictured, &runs, &text_sets::text_set_file(&args.a), output)? else {
        return Ok(None);
    };
    let mut common: Vec<CommonItem<'_>> = Vec::new();
    for (id, item_a) in a {
        let Some(item_b) = b.get(id) else { continue };
        let (Some(text), Some(first)) = (item_a.texts.first(), item_b.texts.first()) else { continue };
        let person = item_b.texts.iter().find(|other| *other != text).map(String::as_str);
        common.push(CommonItem { id, path: &item_a.path, text, first, person });
    }
    let names: Vec<(&str, &str)> = common.iter().map(|item| (item.id, item.path)).collect();
    let others = draw_other_paths(&names, drawing.seed);
    let bar = output.progress_bar(common.len(), "items");
    let mut pictured = Vec::new();
    for (at, item) in common.iter().enumerate() {
        interrupt::check_interrupt()?;
        let pictures = critic.frames.views_for_item(item.id, item.path)?;
        let other = others.as_ref().map(|others| common[others[at]].first);
        let texts: Vec<&str> = [Some(item.text), item.person, other].into_iter().flatten().collect();
        let mut scores = critic.score_texts(&pictures, &texts)?.into_iter();
        // The scores come in the order of the texts. A text that there is not has no score.
        let mut next =
            |has_text: bool| -> Option<PictureScores> { if has_text { scores.next().flatten() } else { None } };
        let (text, person, other_path) = (next(true), next(item.person.is_some()), next(other.is_some()));
        pictured.extend(text.map(|text| PicturedItem { cluster: item.path, text, person, other_path }));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if pictured.is_empty() {
        let problem = format!("--clip: there is no picture of any of {}", count_phrase(common.len(), "item"));
        return Err(CommandError::usage(
            problem,
            "give the run of these paths with --pictures RUN, or a platform that has pictures with --platform (`wayword platforms`)",
        ));
    }
    Ok(Some(PictureAgreementReport {
        clip: critic.name().to_owned(),
        prefix: CLIP_PROMPT_PREFIX,
        figures: anchored_picture_figures(&pictured, drawing),
        without_pictures: common.len() - pictured.len(),
        without_person: pictured.iter().filter(|item| item.person.is_none()).count(),
    }))
}

impl fmt::Display for PictureAgreementReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let heading = format!("with pictures, by {}", self.clip);
        writeln!(f, "{heading}\n{:<42} {:>22} {:>22}", "2.5 times the cosine, times 100", "sentences", "whole text")?;
        let AnchoredPictureFigures { text, person, other_path } = &self.figures;
        write_picture_row(f, "A", text.as_ref())?;
        write_picture_row(f, "  another person's text", person.as_ref())?;
        write_picture_row(f, "  another path's text", other_path.as_ref())?;
        if self.without_person > 0 {
            let left = count_phrase(self.without_person, "item");
            writeln!(f, "not in the second row, because B has no other text for them: {left}")?;
        }
        if self.without_pictures > 0 {
            writeln!(f, "in no row, because there is no picture: {}", count_phrase(self.without_pictures, "item"))?;
        }
        writeln!(f, "CLIP hardly tells left from right, and does not know what comes first")
    }
}

fn write_picture_row(f: &mut fmt::Formatter<'_>, name: &str, figures: Option<&PictureFigures>) -> fmt::Result {
    match figures {
        Some(PictureFigures { parts, whole }) => {
            writeln!(f, "{name:<42} {:>22} {:>22}", format_percent(parts), format_percent(whole))
        }
        None => writeln!(f, "{name:<42} {:>22} nothing to measure", "-"),
    }
}
