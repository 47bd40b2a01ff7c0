//! Swap tests: makes instructions wrong in one respect, such as left for right. If an agent does as well by the wrong texts, it does
//! not use that information.

mod casing;
mod landmarks;
mod other_path;
mod sentences;
mod sides;

use serde::{Deserialize, Serialize};
use std::fmt;
use wayword_language::languages::ReadableText;

pub use other_path::{SwapCandidate, other_path};

/// A way to make instructions wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InstructionSwap {
    /// Left for right, up for down, and the other way round.
    Directions,
    /// Each thing and room for another that the text does not name.
    Landmarks,
    /// Sentences in another order; the clauses, where there is one sentence.
    Sentences,
    /// The instruction of another path of the same building, with another goal.
    OtherPath,
}

impl InstructionSwap {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Directions, Self::Landmarks, Self::Sentences, Self::OtherPath];

    /// Its name: `directions`, `landmarks`, `sentences`, `other-path`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Directions => "directions",
            Self::Landmarks => "landmarks",
            Self::Sentences => "sentences",
            Self::OtherPath => "other-path",
        }
    }
}

impl fmt::Display for InstructionSwap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Longest text that is swapped, bytes; texts by people have up to about 2,500.
const MAX_SWAPPED_BYTES: usize = 8_000;

/// Makes a text wrong in one way. `None` if the text would stay the same, or is too long to be an instruction. Also `None` for
/// [`InstructionSwap::OtherPath`]: the caller takes that text from the item that [`other_path`] chooses. A text that is read through English
/// words becomes those words, and they are changed.
///
/// Random choices depend only on the seed and the item's id.
#[must_use]
pub fn swap_text(swap: InstructionSwap, text: &str, seed: u64, item: &str) -> Option<String> {
    let readable = ReadableText::new(text, None);
    let text = readable.english();
    if text.len() > MAX_SWAPPED_BYTES {
        return None;
    }
    match swap {
        InstructionSwap::Directions => sides::swap_directions(text),
        InstructionSwap::Landmarks => landmarks::swap_landmarks(text, seed, item),
        InstructionSwap::Sentences => sentences::swap_sentences(text, seed, item),
        InstructionSwap::OtherPath => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chinese_text_is_changed_in_english_words() {
        let swapped = swap_text(InstructionSwap::Directions, "走到沙发旁边，左转上楼梯。", 0, "a").unwrap();
        assert_eq!(swapped, "walk to the sofa, turn right, go downstairs.");
    }

    #[test]
    fn names_are_those_in_files() {
        for swap in InstructionSwap::ALL {
            assert_eq!(serde_json::to_value(swap).unwrap(), swap.name());
        }
    }

    #[test]
    fn each_swap_changes_its_subject_and_leaves_long_texts() {
        let text = "Turn left at the sofa. Wait.";
        assert_eq!(
            swap_text(InstructionSwap::Directions, text, 1, "item").as_deref(),
            Some("Turn right at the sofa. Wait.")
        );
        assert!(swap_text(InstructionSwap::Landmarks, text, 1, "item").unwrap().starts_with("Turn left at the "));
        assert_eq!(
            swap_text(InstructionSwap::Sentences, text, 1, "item").as_deref(),
            Some("Wait. Turn left at the sofa.")
        );
        assert_eq!(swap_text(InstructionSwap::OtherPath, text, 1, "item"), None);
        for swap in InstructionSwap::ALL {
            assert_eq!(swap_text(swap, &text.repeat(300), 1, "item"), None);
        }
    }
}
