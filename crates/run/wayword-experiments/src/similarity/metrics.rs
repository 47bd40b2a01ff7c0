//! `wayword similarity --metrics`: BLEU, ROUGE-L, CIDEr-D and others of one set of texts against another.
//!
//! The report states its protocol, because such figures depend on tokens and references. It also gives two anchors to read them
//! by: the score of another person's text, and that of a text about another path.

use super::{
    Compared, LEVEL,
    java::{self, Outside},
    pictures::{self, ByPictures},
    sides,
};
use crate::{
    similarity::args::{By, Similarity as Args, Tokens},
    texts::{Items, Texts},
};
use serde::Serialize;
use std::fmt;
use wayword_metrics::{
    Drawing, Estimate,
    captions::{
        Anchored, Described, Diversity, Figures, Sets, Text, Vocabulary, anchored, collapsed, diversity, ptb, split,
    },
};
use wayword_run::{count::count, error::Error, output::Output};

/// The metrics of a set of texts against reference texts.
#[derive(Serialize)]
pub(super) struct Report {
    protocol: Protocol,
    a: Compared,
    b: Compared,
    /// Confidence level of the intervals.
    level: f64,
    #[serde(flatten)]
    figures: Anchored,
    /// METEOR and SPICE, if the user has these programs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    outside: Vec<Outside>,
    /// How well the texts agree with pictures, if a CLIP was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<ByPictures>,
    diversity: Sides,
}

/// The conditions under which the figures were computed. Figures are comparable only under the same ones.
#[derive(Serialize)]
struct Protocol {
    tokens: &'static str,
    /// Whether the references of a text are those of its item or of its path.
    references: &'static str,
    truncate_characters: Option<u32>,
    /// Items of A that B has, of which the first text is judged.
    judged: usize,
    /// The other texts of these items in A, which are not judged.
    not_judged: usize,
    only_in_a: usize,
}

/// How diverse the texts of each side are.
#[derive(Serialize)]
struct Sides {
    a: Diversity,
    b: Diversity,
}

/// Turns strings into tokenised texts with a common vocabulary.
struct Reader<'a> {
    args: &'a Args,
    vocabulary: Vocabulary,
}

impl Reader<'_> {
    fn text(&mut self, said: &str) -> Text {
        let said = collapsed(said);
        let most = self.args.truncate_characters.map_or(usize::MAX, |most| most as usize);
        let end = said.char_indices().nth(most).map_or(said.len(), |(end, _)| end);
        let tokens = match self.args.tokens {
            Tokens::Ptb => ptb(&said[..end]),
            Tokens::Split => split(&said[..end]),
        };
        self.vocabulary.text(&tokens)
    }

    /// The tokenised texts of each item, with its id and its path.
    fn items<'i>(&mut self, items: &'i Items) -> Vec<(&'i str, &'i str, Vec<Text>)> {
        let of_item = |(id, item): (&'i String, &'i Texts)| {
            let texts = item.texts.iter().map(|said| self.text(said)).collect();
            (id.as_str(), item.path.as_str(), texts)
        };
        items.iter().map(of_item).collect()
    }
}

/// Computes the metrics of A's texts against B's.
pub(super) fn of(args: &Args, (a, b): (&Items, &Items), output: &Output) -> Result<Report, Error> {
    // Pictures come first, so that a missing model or picture is reported before the metrics are computed.
    let drawing = Drawing { resamples: args.resamples as usize, level: LEVEL, seed: args.seed };
    let pictures = pictures::of(args, (a, b), &drawing, output)?;
    let mut reader = Reader { args, vocabulary: Vocabulary::default() };
    let (judged, references) = (reader.items(a), reader.items(b));
    let in_b = |id: &str| references.binary_search_by_key(&id, |(other, ..)| other).ok().map(|at| &references[at]);
    let mut items: Vec<Described<'_>> = Vec::new();
    let mut not_judged = 0;
    for (id, _, texts) in &judged {
        let (Some((_, cluster, references)), Some(text)) = (in_b(id), texts.first()) else { continue };
        not_judged += texts.len() - 1;
        items.push(Described { id, cluster, text, references: references.iter().collect() });
    }
    let told = |items: &[(&str, &str, Vec<Text>)]| {
        let all: Vec<(&str, &Text)> =
            items.iter().flat_map(|(_, path, texts)| texts.iter().map(move |text| (*path, text))).collect();
        diversity(&all, args.seed)
    };
    let sets = Sets::of(&items, args.seed);
    Ok(Report {
        protocol: Protocol {
            tokens: if args.tokens == Tokens::Ptb { "ptb" } else { "split" },
            references: if args.by == By::Path { "path" } else { "item" },
            truncate_characters: args.truncate_characters,
            judged: items.len(),
            not_judged,
            only_in_a: judged.len() - items.len(),
        },
        a: Compared::of(&args.a, a),
        b: Compared::of(&args.b, b),
        level: LEVEL,
        figures: anchored(&sets, &drawing),
        outside: java::of(args, &sets, &reader.vocabulary)?,
        pictures,
        diversity: Sides { a: told(&judged), b: told(&references) },
    })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        sides(f, [&self.a, &self.b])?;
        writeln!(f, "{}", self.protocol)?;
        let interval = format!("({:.0} % interval)", self.level * 100.0);
        writeln!(f, "\n{:<42} {:>22} {:>22} {:>22}", format!("times 100 {interval}"), "BLEU-4", "ROUGE-L", "CIDEr-D")?;
        let Anchored { all, rest, person, other_path, single } = &self.figures;
        row(f, "A against all of B's texts", all.as_ref())?;
        row(f, "A against all but the first", rest.as_ref())?;
        row(f, "  another person's text against the same", person.as_ref())?;
        row(f, "  another path's text against the same", other_path.as_ref())?;
        if *single > 0 {
            writeln!(f, "only in the first row, because B has one text for them: {}", count(*single, "item"))?;
        }
        if let Some(figures) = all {
            let [one, two, three, _] = figures.bleu.map(|bleu| percent(&bleu));
            writeln!(f, "A against all of B's texts: BLEU-1 {one}, BLEU-2 {two}, BLEU-3 {three}")?;
        }
        for Outside { name, all, rest, person, other_path } in &self.outside {
            let [all, rest, person, other] = [all, rest, person, other_path]
                .map(|of| of.map_or_else(|| "-".to_owned(), |value| format!("{:.1}", value * 100.0)));
            writeln!(f, "{name}: A {all}; but the first {rest}, another person {person}, another path {other}")?;
        }
        if let Some(pictures) = &self.pictures {
            write!(f, "\n{pictures}")?;
        }
        writeln!(f, "\n{:<44} {:>8} {:>8}", "diversity", "A", "B")?;
        let [a, b] = [&self.diversity.a, &self.diversity.b].map(of_diversity);
        let rows: Vec<String> = a
            .iter()
            .zip(&b)
            .map(|((name, a), (_, b))| format!("{name:<44} {:>8} {:>8}", share(*a), share(*b)))
            .collect();
        write!(f, "{}", rows.join("\n"))
    }
}

impl fmt::Display for Protocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tokens, references, judged, not_judged, only_in_a, .. } = self;
        let cut = match self.truncate_characters {
            Some(most) => format!("cut off after {most} characters"),
            None => "not cut off".to_owned(),
        };
        write!(f, "protocol: {tokens} tokens; references by {references}; white space collapsed; texts {cut}; ")?;
        write!(f, "the first text of {}", count(*judged, "item"))?;
        if *not_judged > 0 {
            write!(f, " ({} not judged)", count(*not_judged, "other text"))?;
        }
        if *only_in_a > 0 {
            write!(f, "; only in A: {}", count(*only_in_a, "item"))?;
        }
        Ok(())
    }
}

fn of_diversity(of: &Diversity) -> [(&'static str, Option<f64>); 6] {
    let [one, two, three] = of.distinct;
    [
        ("self-BLEU-4 (less is more diverse)", of.self_bleu_4),
        ("distinct words", one),
        ("distinct pairs", two),
        ("distinct triples", three),
        ("type-token ratio in 50 words", of.mattr_50),
        ("homogenisation: ROUGE-L of two paths' texts", of.homogenisation),
    ]
}

fn share(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"))
}

pub(super) fn percent(Estimate { mean, low, high, .. }: &Estimate) -> String {
    let [mean, low, high] = [mean, low, high].map(|value| format!("{:.1}", value * 100.0));
    format!("{mean} ({low} to {high})")
}

fn row(f: &mut fmt::Formatter<'_>, name: &str, figures: Option<&Figures>) -> fmt::Result {
    match figures {
        Some(Figures { bleu, rouge_l, cider_d }) => {
            let [bleu, rouge_l, cider_d] = [&bleu[3], rouge_l, cider_d].map(percent);
            writeln!(f, "{name:<42} {bleu:>22} {rouge_l:>22} {cider_d:>22}")
        }
        None => writeln!(f, "{name:<42} {:>22} nothing to measure", "-"),
    }
}
