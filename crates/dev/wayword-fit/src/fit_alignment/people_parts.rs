//! Reads the parts of R2R's texts with the stretches that people gave them: the files of Fine-Grained R2R (Hong et al. 2020).

use serde::Deserialize;
use std::path::Path;
use wayword_core::{SceneId, ViewpointId};
use wayword_language::text::split_tokens;
use wayword_run::error::CommandError;

/// A text that people aligned with its walk.
#[derive(Debug)]
pub struct PeopleAlignedText {
    /// Its building.
    pub scene: SceneId,
    /// The viewpoints of its walk.
    pub walk: Vec<ViewpointId>,
    /// The heading at its start, radians.
    pub heading_rad: f64,
    /// Its words.
    pub words: String,
    /// The byte range of each part.
    pub spans: Vec<[usize; 2]>,
    /// The places of the walk where each part begins and ends, from 0.
    pub stretches: Vec<[usize; 2]>,
}

/// An item of a file.
#[derive(Debug, Deserialize)]
struct FineGrainedItem {
    scan: String,
    path: Vec<String>,
    heading: f64,
    instructions: Vec<String>,
    /// For each text, its parts as lists of lower-case tokens, written as a literal of Python.
    new_instructions: String,
    /// For each text and part, the first and the last place in `path`, counted from 1.
    chunk_view: Vec<Vec<[usize; 2]>>,
}

/// Reads a file. Texts of which the parts and the stretches do not fit together are skipped.
///
/// # Errors
/// When the file cannot be read, or is no such file.
pub fn read_aligned_texts(file: &Path) -> Result<Vec<PeopleAlignedText>, CommandError> {
    let bytes = std::fs::read(file).map_err(CommandError::io(file, "read"))?;
    let items: Vec<FineGrainedItem> = serde_json::from_slice(&bytes).map_err(|error| {
        let problem = format!("{}: it is no file of Fine-Grained R2R: {error}", file.display());
        CommandError::usage(problem, "give FGR2R_val_seen.json or another file of that dataset")
    })?;
    Ok(items.iter().flat_map(FineGrainedItem::aligned_texts).collect())
}

impl FineGrainedItem {
    fn aligned_texts(&self) -> Vec<PeopleAlignedText> {
        let parts = read_token_lists(&self.new_instructions);
        let texts = self.instructions.iter().zip(&parts).zip(&self.chunk_view);
        texts.filter_map(|((words, parts), views)| self.aligned_text(words, parts, views)).collect()
    }

    fn aligned_text(&self, words: &str, parts: &[Vec<String>], views: &[[usize; 2]]) -> Option<PeopleAlignedText> {
        let stretches: Vec<[usize; 2]> =
            views.iter().map(|[from, to]| Some([from.checked_sub(1)?, to.checked_sub(1)?])).collect::<Option<_>>()?;
        let follows = |pair: &[[usize; 2]]| pair[0][1] == pair[1][0];
        let is_whole = stretches.first()?[0] == 0 && stretches.last()?[1] + 1 == self.path.len();
        let is_right = is_whole
            && parts.len() == stretches.len()
            && stretches.iter().all(|[from, to]| from <= to)
            && stretches.windows(2).all(follows);
        if !is_right {
            return None;
        }
        Some(PeopleAlignedText {
            scene: SceneId::new(&self.scan).ok()?,
            walk: self.path.iter().map(|id| ViewpointId::new(id).ok()).collect::<Option<_>>()?,
            heading_rad: self.heading,
            words: words.to_owned(),
            spans: part_spans(words, parts),
            stretches,
        })
    }
}

/// The lists in a literal of Python: a list of texts, of parts, of tokens.
fn read_token_lists(literal: &str) -> Vec<Vec<Vec<String>>> {
    let mut texts: Vec<Vec<Vec<String>>> = Vec::new();
    let mut depth = 0;
    let mut characters = literal.chars();
    while let Some(character) = characters.next() {
        match character {
            '[' => {
                depth += 1;
                match (depth, texts.last_mut()) {
                    (2, _) => texts.push(Vec::new()),
                    (3, Some(parts)) => parts.push(Vec::new()),
                    _ => {}
                }
            }
            ']' => depth -= 1,
            '\'' | '"' => {
                let mut token = String::new();
                while let Some(next) = characters.next().filter(|next| *next != character) {
                    token.extend(if next == '\\' { characters.next() } else { Some(next) });
                }
                if let Some(part) = texts.last_mut().and_then(|parts| parts.last_mut()) {
                    part.push(token);
                }
            }
            _ => {}
        }
    }
    texts
}

/// The byte range of each part: its tokens, which are base forms without punctuation, are matched with the words of the text in order.
fn part_spans(words: &str, parts: &[Vec<String>]) -> Vec<[usize; 2]> {
    let tokens: Vec<_> = split_tokens(words).into_iter().filter(|token| token.is_word()).collect();
    let text_words: Vec<&str> = tokens.iter().map(|token| token.word.as_str()).collect();
    let part_words: Vec<&str> = parts.iter().flatten().map(String::as_str).collect();
    let matched = match_words(&part_words, &text_words);
    let mut next = 0;
    let starts: Vec<usize> = parts
        .iter()
        .map(|part| {
            let first = matched[next..].iter().find_map(|at| *at);
            next += part.len();
            first.map_or(words.len(), |at| tokens[at].span[0])
        })
        .collect();
    let ends = starts.iter().skip(1).copied().chain([words.len()]);
    let range = |(from, to): (usize, usize)| {
        let part = words.get(from..to).unwrap_or_default();
        [from, from + part.trim_end().len()]
    };
    starts.iter().copied().zip(ends).map(range).collect()
}

/// For each part word, the text word that it stands for, so that the order holds and the beginnings of words agree best.
fn match_words(part_words: &[&str], text_words: &[&str]) -> Vec<Option<usize>> {
    let (rows, columns) = (part_words.len(), text_words.len());
    let agreement = |row: usize, column: usize| {
        let same = part_words[row].chars().zip(text_words[column].chars()).take_while(|(a, b)| a == b).count();
        2 * same.min(4) + usize::from(part_words[row] == text_words[column])
    };
    let mut best = vec![vec![0; columns + 1]; rows + 1];
    for row in (0..rows).rev() {
        for column in (0..columns).rev() {
            let both = best[row + 1][column + 1] + agreement(row, column);
            best[row][column] = both.max(best[row + 1][column]).max(best[row][column + 1]);
        }
    }
    let mut matched = vec![None; rows];
    let (mut row, mut column) = (0, 0);
    while row < rows && column < columns {
        if agreement(row, column) > 0 && best[row][column] == best[row + 1][column + 1] + agreement(row, column) {
            matched[row] = Some(column);
            (row, column) = (row + 1, column + 1);
        } else if best[row][column] == best[row + 1][column] {
            row += 1;
        } else {
            column += 1;
        }
    }
    matched
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_token_lists_reads_either_kind_of_quotes() {
        let texts = read_token_lists(r#"[[['leave', 'the', "cook's"], ['turn', 'it\'s']], [['go']]]"#);
        assert_eq!(texts, [vec![vec!["leave", "the", "cook's"], vec!["turn", "it's"]], vec![vec!["go"]]]);
    }

    #[test]
    fn part_spans_follow_base_forms_and_skip_punctuation() {
        let words = "Leaving the attic, turns left. Stop there.";
        let parts = [vec!["leave", "the", "attic"], vec!["turn", "left"], vec!["stop", "there"]];
        let parts: Vec<Vec<String>> =
            parts.iter().map(|part| part.iter().map(|&word| word.to_owned()).collect()).collect();
        let spans = part_spans(words, &parts);
        let texts: Vec<&str> = spans.iter().map(|[from, to]| &words[*from..*to]).collect();
        assert_eq!(texts, ["Leaving the attic,", "turns left.", "Stop there."]);
    }
}
