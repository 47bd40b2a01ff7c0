//! Computes the figure of each critic for each text.

use super::{OutcomeText, PeopleTexts};
use wayword_experiments::by_pictures::PictureCritic as ByPictures;
use wayword_language::text::word_count;
use wayword_metrics::captions::{
    CaptionRow, CaptionVocabulary, NumberedText, collapse_white_space, ptb_tokens, score_rows,
};
use wayword_run::{error::CommandError, interrupt, output::CommandOutput};

/// A critic with a figure for each text; `None` for a text that it cannot judge.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CriticFigures {
    /// The critic's name in the table.
    pub(super) name: &'static str,
    /// One figure for each text, in the order of the texts.
    pub(super) figures: Vec<Option<f64>>,
}

/// The length of the texts in words. A critic that correlates with success no better than the length is of little use.
pub(super) fn word_counts(texts: &[OutcomeText]) -> CriticFigures {
    CriticFigures { name: "words", figures: texts.iter().map(|text| Some(word_count(&text.text) as f64)).collect() }
}

/// BLEU-4, ROUGE-L and CIDEr-D of each text, with other people's texts about its item or path as references.
pub(super) fn score_by_people(texts: &[OutcomeText], people: &PeopleTexts) -> [CriticFigures; 3] {
    let mut vocabulary = CaptionVocabulary::default();
    let mut number_text = |words: &str| vocabulary.number_text(&ptb_tokens(&collapse_white_space(words)));
    let tokens: Vec<(NumberedText, Vec<NumberedText>)> = texts
        .iter()
        .map(|text| (number_text(&text.text), people.others_about(text).map(&mut number_text).collect()))
        .collect();
    let judged: Vec<usize> = (0..tokens.len()).filter(|at| !tokens[*at].1.is_empty()).collect();
    let row = |at: &usize| CaptionRow { text: &tokens[*at].0, references: tokens[*at].1.iter().collect() };
    let rows: Vec<CaptionRow<'_>> = judged.iter().map(row).collect();
    let mut found =
        ["BLEU-4", "ROUGE-L", "CIDEr-D"].map(|name| CriticFigures { name, figures: vec![None; texts.len()] });
    for (at, score) in judged.iter().zip(score_rows(&rows)) {
        for (critic, figure) in found.iter_mut().zip([score.counts.bleu_scores()[3], score.rouge_l, score.cider_d]) {
            critic.figures[*at] = Some(figure);
        }
    }
    found
}

/// How well each text agrees with the pictures of its path.
///
/// # Errors
/// When no text has pictures, or the model or the pictures cannot be read.
pub(super) fn score_by_pictures(
    texts: &[OutcomeText],
    critic: &ByPictures,
    output: &CommandOutput,
) -> Result<[CriticFigures; 2], CommandError> {
    let mut found =
        ["CLIP, sentences", "CLIP, whole"].map(|name| CriticFigures { name, figures: Vec::with_capacity(texts.len()) });
    let bar = output.progress_bar(texts.len(), "texts");
    for text in texts {
        interrupt::check_interrupt()?;
        let pictures = critic.frames.views_for_item(text.item.as_deref().unwrap_or_default(), &text.path)?;
        let agreed = critic.score_texts(&pictures, &[&text.text])?.into_iter().next().flatten();
        let [parts, whole] = &mut found;
        parts.figures.push(agreed.map(|agreed| agreed.parts));
        whole.figures.push(agreed.map(|agreed| agreed.whole));
        bar.inc(1);
    }
    bar.finish_and_clear();
    if found[0].figures.iter().all(Option::is_none) {
        return Err(CommandError::usage(
            "--clip: there is no picture of any path that the texts are about",
            "give a run of the same items or paths, or a platform that has pictures (`wayword platforms`)",
        ));
    }
    Ok(found)
}
