//! Counts how many words, clauses and whole texts of datasets the reader understands.

use clap::Args;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
};
use wayword_language::{
    languages::ReadableText,
    reading::{TextReading, read_instruction},
};
use wayword_run::{error::CommandError, output::CommandOutput};

/// The flags of `coverage`.
#[derive(Debug, Args)]
pub struct CoverageArgs {
    /// Dataset files, of any format.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Only the texts of these scans.
    #[arg(long, value_delimiter = ',', conflicts_with = "except")]
    scans: Vec<String>,
    /// All texts but those of these scans.
    #[arg(long, value_delimiter = ',')]
    except: Vec<String>,
    /// How many of the words that are not understood to show, the most frequent first.
    #[arg(long, default_value_t = 40)]
    show: usize,
}

/// Prints for each file how many words and clauses the reader understands, and those that it does not.
///
/// # Errors
/// When a file cannot be read.
pub fn measure_coverage(flags: &CoverageArgs, output: &CommandOutput) -> Result<(), CommandError> {
    for file in &flags.files {
        let mut counts = UnderstandingCounts::default();
        for episode in wayword_formats::read_any_format(file)? {
            let scan = episode.scene.as_str();
            let is_in = |scans: &[String]| scans.iter().any(|name| name == scan);
            if (flags.scans.is_empty() || is_in(&flags.scans)) && !is_in(&flags.except) {
                episode.instructions.iter().for_each(|text| counts.add_text(text));
            }
        }
        output.print_result(&(), format!("{}\n{}", file.display(), counts.report_lines(flags.show).join("\n")));
    }
    Ok(())
}

/// Counts over texts. The reader gets no names from evidence, so it has only its lexicon.
#[derive(Debug, Default)]
struct UnderstandingCounts {
    texts: usize,
    /// Texts of which every clause is understood.
    whole_texts: usize,
    /// Words without marks and stop words.
    words: usize,
    understood_words: usize,
    clauses: usize,
    understood_clauses: usize,
    /// How often each word that is not understood occurs, in lower case.
    unknown: BTreeMap<String, usize>,
}

impl UnderstandingCounts {
    fn add_text(&mut self, text: &str) {
        let readable = ReadableText::new(text, None);
        let TextReading { words, clauses, .. } = read_instruction(readable.english(), &BTreeSet::new());
        let words = readable.source_words(&words);
        let counted = || words.iter().filter(|word| word.is_counted);
        let unknown = counted().filter(|word| !word.is_understood());
        let spelling = |span: [usize; 2]| text.get(span[0]..span[1]).unwrap_or_default().to_lowercase();
        unknown.for_each(|word| *self.unknown.entry(spelling(word.span)).or_default() += 1);
        let worded = || clauses.iter().filter(|clause| clause.span[0] < clause.span[1]);
        self.texts += 1;
        self.words += counted().count();
        self.understood_words += counted().filter(|word| word.is_understood()).count();
        self.clauses += worded().count();
        self.understood_clauses += worded().filter(|clause| clause.understood).count();
        self.whole_texts += usize::from(worded().all(|clause| clause.understood));
    }

    fn report_lines(&self, show: usize) -> Vec<String> {
        let share = |name: &str, part: usize, all: usize| {
            format!("{name:<52} {part:>7} of {all:>7}  {:>5.1} %", 100.0 * part as f64 / all.max(1) as f64)
        };
        let mut unknown: Vec<(&String, &usize)> = self.unknown.iter().collect();
        unknown.sort_by_key(|(word, count)| (std::cmp::Reverse(**count), *word));
        let unknown: Vec<String> = unknown.iter().take(show).map(|(word, count)| format!("{word} {count}")).collect();
        vec![
            share("words understood (without marks and stop words)", self.understood_words, self.words),
            share("clauses understood", self.understood_clauses, self.clauses),
            share("texts of which every clause is understood", self.whole_texts, self.texts),
            format!("not understood: {}", unknown.join(", ")),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_clauses_are_counted_over_texts() {
        let mut counts = UnderstandingCounts::default();
        counts.add_text("Walk past the sofa. Stop at the zorble.");
        counts.add_text("Grab the zorble!");
        let lines = counts.report_lines(1).join("\n");
        assert!(lines.contains("4 of       6   66.7 %") && lines.contains("not understood: zorble 2"), "{lines}");
        assert!(lines.contains("1 of       3   33.3 %") && lines.contains("0 of       2    0.0 %"), "{lines}");
    }
}
