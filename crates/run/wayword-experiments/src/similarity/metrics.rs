//! `wayword similarity --metrics`: BLEU, ROUGE-L, CIDEr-D and others of one set of texts against another.
//!
//! The report states its protocol, because such figures depend on tokens and references. It also gives two anchors to read them
//! by: the score of another person's text, and that of a text about another path.

use super::{
    CONFIDENCE_LEVEL, SimilaritySide, format_percent,
    java::{self, JavaScores},
    pictures::{self, PictureAgreementReport},
    write_sides,
};
use crate::{
    similarity::args::{MetricTokens, SimilarityArgs as Args, TextPairing},
    text_sets::{ItemTexts, TextSet},
};
use serde::Serialize;
use std::fmt;
use wayword_metrics::{
    ResamplingOptions,
    captions::{
        AnchoredCaptionFigures, CaptionFigures, CaptionItem, CaptionRowSets, CaptionVocabulary, NumberedText,
        TextDiversity, anchored_caption_figures, character_tokens, collapse_white_space, measure_diversity, ptb_tokens,
        split_tokens,
    },
};
use wayword_run::{count::count_phrase, error::CommandError, output::CommandOutput};

/// The metrics of a set of texts against reference texts.
#[derive(Serialize)]
pub(super) struct TextMetricsReport {
    protocol: MetricProtocol,
    a: SimilaritySide,
    b: SimilaritySide,
    /// Confidence level of the intervals.
    level: f64,
    #[serde(flatten)]
    figures: AnchoredCaptionFigures,
    /// METEOR and SPICE, if the user has these programs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    outside: Vec<JavaScores>,
    /// How well the texts agree with pictures, if a CLIP was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<PictureAgreementReport>,
    diversity: SideDiversity,
}

/// The conditions under which the figures were computed. Figures are comparable only under the same ones.
#[derive(Serialize)]
struct MetricProtocol {
    tokens: &'static str,
    /// Whether the references of a text are those of its item or of its path.
    references: &'static str,
    truncate_characters: Option<u32>,
    /// Items of A that B has, of which the first text is judged.
    judged: usize,
    /// The other texts of these items in A, which are not judged.
    not_judged: usize,
    /// Items of A that B lacks.
    only_in_a: usize,
}

/// How diverse the texts of each side are.
#[derive(Serialize)]
struct SideDiversity {
    a: TextDiversity,
    b: TextDiversity,
}

/// Turns strings into tokenised texts with a common vocabulary.
struct MetricTextReader<'a> {
    args: &'a Args,
    tokens: MetricTokens,
    vocabulary: CaptionVocabulary,
}

impl MetricTextReader<'_> {
    fn read_text(&mut self, text: &str) -> NumberedText {
        let text = collapse_white_space(text);
        let max_chars = self.args.truncate_characters.map_or(usize::MAX, |max_chars| max_chars as usize);
        let end = text.char_indices().nth(max_chars).map_or(text.len(), |(end, _)| end);
        let tokens = match self.tokens {
            MetricTokens::Ptb => ptb_tokens(&text[..end]),
            MetricTokens::Split => split_tokens(&text[..end]),
            MetricTokens::Characters => character_tokens(&text[..end]),
        };
        self.vocabulary.number_text(&tokens)
    }

    /// The tokenised texts of each item, with its id and its path.
    fn read_items<'i>(&mut self, items: &'i TextSet) -> Vec<(&'i str, &'i str, Vec<NumberedText>)> {
        let to_item = |(id, item): (&'i String, &'i ItemTexts)| {
            let texts = item.texts.iter().map(|text| self.read_text(text)).collect();
            (id.as_str(), item.path.as_str(), texts)
        };
        items.iter().map(to_item).collect()
    }
}

/// Computes the metrics of A's texts against B's.
pub(super) fn measure_texts(
    args: &Args,
    tokens: MetricTokens,
    (a, b): (&TextSet, &TextSet),
    output: &CommandOutput,
) -> Result<TextMetricsReport, CommandError> {
    // Pictures come first, so that a missing model or picture is reported before the metrics are computed.
    let drawing = ResamplingOptions { resamples: args.resamples as usize, level: CONFIDENCE_LEVEL, seed: args.seed };
    let pictures = pictures::measure_pictures(args, (a, b), &drawing, output)?;
    let mut reader = MetricTextReader { args, tokens, vocabulary: CaptionVocabulary::default() };
    let (judged, references) = (reader.read_items(a), reader.read_items(b));
    let in_b = |id: &str| references.binary_search_by_key(&id, |(other, ..)| other).ok().map(|at| &references[at]);
    let mut items: Vec<CaptionItem<'_>> = Vec::new();
    let mut not_judged = 0;
    for (id, _, texts) in &judged {
        let (Some((_, cluster, references)), Some(text)) = (in_b(id), texts.first()) else { continue };
        not_judged += texts.len() - 1;
        items.push(CaptionItem { id, cluster, text, references: references.iter().collect() });
    }
    // A set with more texts has fewer new words in each, so only the items of both sets are compared.
    let is_in_both = |id: &str| items.binary_search_by_key(&id, |item| item.id).is_ok();
    let diversity_of_side = |side: &[(&str, &str, Vec<NumberedText>)]| {
        let both = side.iter().filter(|(id, ..)| is_in_both(id));
        let all: Vec<(&str, &NumberedText)> =
            both.flat_map(|(_, path, texts)| texts.iter().map(move |text| (*path, text))).collect();
        measure_diversity(&all, args.seed)
    };
    let sets = CaptionRowSets::from_items(&items, args.seed);
    Ok(TextMetricsReport {
        protocol: MetricProtocol {
            tokens: tokens.name(),
            references: if args.by == TextPairing::Path { "path" } else { "item" },
            truncate_characters: args.truncate_characters,
            judged: items.len(),
            not_judged,
            only_in_a: judged.len() - items.len(),
        },
        a: SimilaritySide::from_items(&args.a, a),
        b: SimilaritySide::from_items(&args.b, b),
        level: CONFIDENCE_LEVEL,
        figures: anchored_caption_figures(&sets, &drawing),
        outside: java::run_java_scorers(args, &sets, &reader.vocabulary)?,
        pictures,
        diversity: SideDiversity { a: diversity_of_side(&judged), b: diversity_of_side(&references) },
    })
}

impl fmt::Display for TextMetricsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write_sides(f, [&self.a, &self.b])?;
        writeln!(f, "{}", self.protocol)?;
        let interval = format!("({:.0} % interval)", self.level * 100.0);
        writeln!(f, "\n{:<42} {:>22} {:>22} {:>22}", format!("times 100 {interval}"), "BLEU-4", "ROUGE-L", "CIDEr-D")?;
        let AnchoredCaptionFigures { all, rest, person, other_path, single } = &self.figures;
        write_metric_row(f, "A against all of B's texts", all.as_ref())?;
        write_metric_row(f, "A against all but the first", rest.as_ref())?;
        write_metric_row(f, "  another person's text against the same", person.as_ref())?;
        write_metric_row(f, "  another path's text against the same", other_path.as_ref())?;
        if *single > 0 {
            writeln!(f, "only in the first row, because B has one text for them: {}", count_phrase(*single, "item"))?;
        }
        if let Some(figures) = all {
            if figures.cider_d.is_none() {
                writeln!(f, "no CIDEr-D: how rare a word is cannot be told from one item")?;
            }
            if figures.rouge_l.interval().is_none() {
                writeln!(f, "no intervals: all texts are about one path")?;
            }
            let [one, two, three, _] = figures.bleu.map(|bleu| format_percent(&bleu));
            writeln!(f, "A against all of B's texts: BLEU-1 {one}, BLEU-2 {two}, BLEU-3 {three}")?;
        }
        for JavaScores { name, all, rest, person, other_path } in &self.outside {
            let [all, rest, person, other] = [all, rest, person, other_path]
                .map(|score| score.map_or_else(|| "-".to_owned(), |value| format!("{:.1}", value * 100.0)));
            writeln!(f, "{name}: A {all}; but the first {rest}, another person {person}, another path {other}")?;
        }
        if let Some(pictures) = &self.pictures {
            write!(f, "\n{pictures}")?;
        }
        writeln!(f, "\n{:<44} {:>8} {:>8}", "diversity", "A", "B")?;
        let [a, b] = [&self.diversity.a, &self.diversity.b].map(diversity_rows);
        let rows: Vec<String> = a
            .iter()
            .zip(&b)
            .map(|((name, a), (_, b))| format!("{name:<44} {:>8} {:>8}", format_share(*a), format_share(*b)))
            .collect();
        write!(f, "{}", rows.join("\n"))
    }
}

impl fmt::Display for MetricProtocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tokens, references, judged, not_judged, only_in_a, .. } = self;
        let cut = match self.truncate_characters {
            Some(most) => format!("cut off after {most} characters"),
            None => "not cut off".to_owned(),
        };
        write!(f, "protocol: {tokens} tokens; references by {references}; white space collapsed; texts {cut}; ")?;
        write!(f, "the first text of {}", count_phrase(*judged, "item"))?;
        if *not_judged > 0 {
            write!(f, " ({} not judged)", count_phrase(*not_judged, "other text"))?;
        }
        if *only_in_a > 0 {
            write!(f, "; only in A: {}", count_phrase(*only_in_a, "item"))?;
        }
        Ok(())
    }
}

/// The rows of the table of diversity: each figure with its name.
fn diversity_rows(diversity: &TextDiversity) -> [(&'static str, Option<f64>); 6] {
    let [one, two, three] = diversity.distinct;
    [
        ("self-BLEU-4 (less is more diverse)", diversity.self_bleu_4),
        ("distinct words", one),
        ("distinct pairs", two),
        ("distinct triples", three),
        ("type-token ratio in 50 words", diversity.mattr_50),
        ("homogenisation: ROUGE-L of two paths' texts", diversity.homogenisation),
    ]
}

fn format_share(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"))
}

fn write_metric_row(f: &mut fmt::Formatter<'_>, name: &str, figures: Option<&CaptionFigures>) -> fmt::Result {
    match figures {
        Some(CaptionFigures { bleu, rouge_l, cider_d }) => {
            let [bleu, rouge_l] = [&bleu[3], rouge_l].map(format_percent);
            let cider_d = cider_d.as_ref().map_or_else(|| "-".to_owned(), format_percent);
            writeln!(f, "{name:<42} {bleu:>22} {rouge_l:>22} {cider_d:>22}")
        }
        None => writeln!(f, "{name:<42} {:>22} nothing to measure", "-"),
    }
}
