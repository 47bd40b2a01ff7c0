//! Counts the runs of words and the skeletons that texts have in common with training texts and with each other.

use super::{
    names::{named, words},
    row::{Row, number, share},
};
use std::collections::{BTreeMap, HashSet};

/// The lengths of runs of words that are compared.
const RUNS: [usize; 3] = [5, 8, 10];

/// The runs of words and the skeletons of the training texts.
pub(super) struct Train {
    runs: Vec<HashSet<String>>,
    skeletons: HashSet<String>,
}

impl Train {
    pub(super) fn of(texts: &[&str]) -> Self {
        let all = |length: usize| texts.iter().flat_map(|text| runs(&words(text), length)).collect();
        Self { runs: RUNS.map(all).into(), skeletons: texts.iter().map(|text| skeleton(text)).collect() }
    }
}

fn runs(words: &[String], length: usize) -> Vec<String> {
    words.windows(length).map(|run| run.join(" ")).collect()
}

/// A text with its objects and rooms masked.
fn skeleton(text: &str) -> String {
    let mut words = words(text);
    for name in named(&words).iter().rev() {
        words.splice(name.start..name.end, [if name.is_room { "ROOM" } else { "THING" }.to_owned()]);
    }
    words.join(" ")
}

pub(super) fn rows(texts: &[&str], train: Option<&Train>) -> Vec<Row> {
    let skeletons: Vec<String> = texts.iter().map(|text| skeleton(text)).collect();
    let mut counts: BTreeMap<&String, usize> = BTreeMap::new();
    skeletons.iter().for_each(|skeleton| *counts.entry(skeleton).or_default() += 1);
    let mut rows = vec![
        share("skeleton in common with another of these texts", skeletons.iter().map(|one| counts[one] > 1)),
        number("different skeletons", counts.len() as f64),
    ];
    if let Some(train) = train {
        rows.push(share(
            "skeleton in common with a training text",
            skeletons.iter().map(|one| train.skeletons.contains(one)),
        ));
        let copied =
            |text: &&str, at: usize| runs(&words(text), RUNS[at]).iter().any(|run| train.runs[at].contains(run));
        let row = |at: usize| {
            let name = format!("{} words in a row in common with a training text", RUNS[at]);
            share(&name, texts.iter().map(|text| copied(text, at)))
        };
        rows.extend((0..RUNS.len()).map(row));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::super::row::Value;
    use super::*;

    #[test]
    fn texts_that_differ_in_objects_and_rooms_share_a_skeleton() {
        let texts = ["Go to the kitchen and wipe the table.", "Go to the bedroom and wipe the mirror.", "Wait here."];
        let train = Train::of(&["go to the garage and wipe the car, please", "wait"]);
        let rows = rows(&texts, Some(&train));
        let values: Vec<Value> = rows.iter().map(|row| row.value).collect();
        let share = |count| Value::Share { count, of: 3 };
        // "Go to the", "and wipe the": five words in a row need the same room.
        assert_eq!(values, [share(2), Value::Number(2.0), share(0), share(0), share(0), share(0)]);
        let copied = Train::of(&["so, go to the kitchen and wipe"]);
        assert_eq!(super::rows(&texts, Some(&copied))[3].value, share(1));
    }
}
