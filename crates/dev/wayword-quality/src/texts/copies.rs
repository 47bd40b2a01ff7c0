//! Counts the runs of words and the skeletons that texts have in common with training texts and with each other.

use super::{
    names::{find_names, split_words},
    row::{TextFigureRow, number_row, share_row},
};
use std::collections::{BTreeMap, HashSet};

/// The lengths of runs of words that are compared.
const RUN_LENGTHS_WORDS: [usize; 3] = [5, 8, 10];

/// The runs of words and the skeletons of the training texts.
pub(super) struct TrainingTexts {
    /// The runs of words of each length in [`RUN_LENGTHS_WORDS`].
    runs: Vec<HashSet<String>>,
    /// The texts with their names masked.
    skeletons: HashSet<String>,
}

impl TrainingTexts {
    pub(super) fn from_texts(texts: &[&str]) -> Self {
        let all = |length: usize| texts.iter().flat_map(|text| word_runs(&split_words(text), length)).collect();
        Self { runs: RUN_LENGTHS_WORDS.map(all).into(), skeletons: texts.iter().map(|text| mask_names(text)).collect() }
    }
}

fn word_runs(words: &[String], length: usize) -> Vec<String> {
    words.windows(length).map(|run| run.join(" ")).collect()
}

/// The skeleton of a text: its words with the names of objects and rooms masked.
fn mask_names(text: &str) -> String {
    let mut words = split_words(text);
    for name in find_names(&words).iter().rev() {
        words.splice(name.start..name.end, [if name.is_room { "ROOM" } else { "THING" }.to_owned()]);
    }
    words.join(" ")
}

/// The rows of the table about words in common. Without training texts, only those about these texts among themselves.
pub(super) fn copy_rows(texts: &[&str], train: Option<&TrainingTexts>) -> Vec<TextFigureRow> {
    let skeletons: Vec<String> = texts.iter().map(|text| mask_names(text)).collect();
    let mut counts: BTreeMap<&String, usize> = BTreeMap::new();
    skeletons.iter().for_each(|skeleton| *counts.entry(skeleton).or_default() += 1);
    let mut rows = vec![
        share_row(
            "skeleton in common with another of these texts",
            skeletons.iter().map(|skeleton| counts[skeleton] > 1),
        ),
        number_row("different skeletons", counts.len() as f64),
    ];
    if let Some(train) = train {
        rows.push(share_row(
            "skeleton in common with a training text",
            skeletons.iter().map(|skeleton| train.skeletons.contains(skeleton)),
        ));
        let copied = |text: &&str, at: usize| {
            word_runs(&split_words(text), RUN_LENGTHS_WORDS[at]).iter().any(|run| train.runs[at].contains(run))
        };
        let row = |at: usize| {
            let name = format!("{} words in a row in common with a training text", RUN_LENGTHS_WORDS[at]);
            share_row(&name, texts.iter().map(|text| copied(text, at)))
        };
        rows.extend((0..RUN_LENGTHS_WORDS.len()).map(row));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::row::TextFigureValue;
    use super::*;

    #[test]
    fn texts_that_differ_in_objects_and_rooms_share_a_skeleton() {
        let texts = ["Go to the kitchen and wipe the table.", "Go to the bedroom and wipe the mirror.", "Wait here."];
        let train = TrainingTexts::from_texts(&["go to the garage and wipe the car, please", "wait"]);
        let rows = copy_rows(&texts, Some(&train));
        let values: Vec<TextFigureValue> = rows.iter().map(|row| row.value).collect();
        let share = |count| TextFigureValue::Share { count, of: 3 };
        // "Go to the", "and wipe the": five words in a row need the same room.
        assert_eq!(values, [share(2), TextFigureValue::Number(2.0), share(0), share(0), share(0), share(0)]);
        let copied = TrainingTexts::from_texts(&["so, go to the kitchen and wipe"]);
        assert_eq!(super::copy_rows(&texts, Some(&copied))[3].value, share(1));
    }
}
