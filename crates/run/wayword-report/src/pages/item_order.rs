//! Decides which items of a run the report shows, and in which order: those with the most suspicious texts first.

use super::suspicion::unwritten_score;
use serde::Deserialize;
use std::{cmp::Reverse, collections::BTreeMap, path::Path};
use wayword_run::{
    error::CommandError,
    run_folder::{ItemCalls, lines},
};

/// The field of a line that names its path.
#[derive(Deserialize)]
pub(super) struct PathLine {
    pub(super) path: PathIdField,
}

#[derive(Deserialize)]
pub(super) struct PathIdField {
    pub(super) id: String,
}

/// The line of a path, as far as all of them are read.
#[derive(Deserialize)]
struct ListedWalk {
    path: PathIdField,
    #[serde(default)]
    used: Option<ItemCalls>,
}

/// The highest score of each item's texts. Items that are missing here have no text.
#[derive(Default)]
pub(super) struct ItemScores(BTreeMap<String, u32>);

/// The places of the shown items in the report, by the number of their line in the file of paths.
pub(super) struct ItemOrder {
    places: BTreeMap<usize, usize>,
    left_bytes: usize,
    /// Items in the file.
    pub(super) items: usize,
    /// Items without any text.
    pub(super) unwritten: usize,
    /// US dollars for the answers of models that all items used.
    pub(super) usd: f64,
}

impl ItemScores {
    /// Notes the score of a text.
    pub(super) fn note_score(&mut self, item: String, score: u32) {
        let worst = self.0.entry(item).or_insert(score);
        *worst = (*worst).max(score);
    }
}

impl ItemOrder {
    /// The first `most` items of a file of paths, the worst before the others, as long as their lines fit into
    /// `most_bytes`.
    ///
    /// # Errors
    /// When the file cannot be read, or a line names no path.
    pub(super) fn from_walks(
        walks: &Path,
        most: usize,
        most_bytes: usize,
        scores: &ItemScores,
    ) -> Result<Self, CommandError> {
        let mut found: BTreeMap<Reverse<u32>, Vec<(usize, usize)>> = BTreeMap::new();
        let (mut number, mut unwritten, mut usd) = (0, 0, 0.0);
        lines::each_line(walks, |line| {
            let ListedWalk { path, used } = line.parse()?;
            let score = scores.0.get(&path.id).copied();
            unwritten += usize::from(score.is_none());
            usd += used.map_or(0.0, |used| used.usd);
            let same = found.entry(Reverse(score.unwrap_or_else(unwritten_score))).or_default();
            if same.len() < most {
                same.push((number, line.byte_count()));
            }
            number += 1;
            Ok(())
        })?;
        let mut left_bytes = most_bytes;
        let in_order = found.into_values().flatten().take(most);
        // Once one is left out, all after it are too, so that the report shows the first items and not the small ones.
        let fitting = in_order.map_while(|(number, bytes)| take_bytes(&mut left_bytes, bytes).then_some(number));
        let places = fitting.enumerate().map(|(place, number)| (number, place)).collect();
        Ok(Self { places, left_bytes, items: number, unwritten, usd })
    }

    /// The place of a line's item in the report; `None` if it is not shown.
    pub(super) fn place_of_line(&self, line: usize) -> Option<usize> {
        self.places.get(&line).copied()
    }

    /// How many bytes of instructions may still be read for these items.
    pub(super) fn left_bytes(&self) -> usize {
        self.left_bytes
    }
}

/// Subtracts `bytes` from `left_bytes` if so many are left. Returns whether it did.
pub(super) fn take_bytes(left_bytes: &mut usize, bytes: usize) -> bool {
    let left = left_bytes.checked_sub(bytes);
    *left_bytes = left.unwrap_or(*left_bytes);
    left.is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(most: usize, most_bytes: usize) -> Vec<(usize, usize)> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("walks.jsonl");
        let line = |id: &str| format!("{{\"path\":{{\"id\":\"{id}\"}}}}\n");
        std::fs::write(&file, ["a", "b", "c", "d"].map(line).concat()).unwrap();
        let mut scores = ItemScores::default();
        for (item, score) in [("a", 0), ("b", 4000), ("c", 0), ("d", 0), ("d", 6000), ("d", 4000)] {
            scores.note_score(item.to_owned(), score);
        }
        let order = ItemOrder::from_walks(&file, most, most_bytes, &scores).unwrap();
        assert_eq!((order.items, order.unwritten), (4, 0));
        (0..4)
            .filter_map(|line| Some((order.place_of_line(line)?, line)))
            .collect::<BTreeMap<_, _>>()
            .into_iter()
            .collect()
    }

    #[test]
    fn the_worst_come_first_and_the_others_as_they_were() {
        assert_eq!(shown(10, 1000), [(0, 3), (1, 1), (2, 0), (3, 2)]);
        assert_eq!(shown(2, 1000), [(0, 3), (1, 1)]);
        assert_eq!(shown(0, 1000), []);
        assert_eq!(shown(10, 60), [(0, 3), (1, 1), (2, 0)]);
    }
}
