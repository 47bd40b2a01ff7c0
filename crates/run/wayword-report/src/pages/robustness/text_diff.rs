//! Compares two texts word by word, and marks the words that differ. Words of the longest common subsequence are equal.

use serde::Serialize;

/// Consecutive words that are in both texts, or only in one.
#[derive(Debug, PartialEq, Eq, Serialize)]
pub(super) struct ComparedWords {
    words: String,
    differs: bool,
}

/// The words of both texts, grouped into equal and differing ones, by their longest common subsequence.
pub(super) fn compare_words(before: &str, after: &str) -> (Vec<ComparedWords>, Vec<ComparedWords>) {
    let (a, b): (Vec<&str>, Vec<&str>) = (before.split_whitespace().collect(), after.split_whitespace().collect());
    // `longest[at][to]` is the length of the longest common subsequence of `a[at..]` and `b[to..]`.
    let mut longest = vec![vec![0_usize; b.len() + 1]; a.len() + 1];
    for at in (0..a.len()).rev() {
        for to in (0..b.len()).rev() {
            longest[at][to] = match a[at] == b[to] {
                true => longest[at + 1][to + 1] + 1,
                false => longest[at + 1][to].max(longest[at][to + 1]),
            };
        }
    }
    let (mut in_a, mut in_b) = (vec![false; a.len()], vec![false; b.len()]);
    let (mut at, mut to) = (0, 0);
    while at < a.len() && to < b.len() {
        if a[at] == b[to] {
            (in_a[at], in_b[to]) = (true, true);
            (at, to) = (at + 1, to + 1);
        } else if longest[at + 1][to] >= longest[at][to + 1] {
            at += 1;
        } else {
            to += 1;
        }
    }
    (group_words(&a, &in_a), group_words(&b, &in_b))
}

fn group_words(words: &[&str], is_common: &[bool]) -> Vec<ComparedWords> {
    let mut groups: Vec<ComparedWords> = Vec::new();
    for (word, is_common) in words.iter().zip(is_common) {
        match groups.last_mut().filter(|group| group.differs != *is_common) {
            Some(group) => {
                group.words.push(' ');
                group.words.push_str(word);
            }
            None => groups.push(ComparedWords { words: (*word).to_owned(), differs: !is_common }),
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_marks_differing_words_in_both_texts() {
        let (before, after) = compare_words("Turn left at the sofa and stop.", "Turn right at the sofa and stop.");
        let words = |words: &str, differs| ComparedWords { words: words.to_owned(), differs };
        assert_eq!(before, [words("Turn", false), words("left", true), words("at the sofa and stop.", false)]);
        assert_eq!(after[1], words("right", true));
        assert_eq!(compare_words("a b", "a b").0, [words("a b", false)]);
        assert_eq!(compare_words("", "a"), (vec![], vec![words("a", true)]));
    }
}
