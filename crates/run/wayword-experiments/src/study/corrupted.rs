//! Makes the texts of the control condition `corrupted`: an instruction with its sides turned and its landmarks exchanged.

use wayword_navigation::swap::{InstructionSwap, swap_text};

/// The text with left for right and up for down, and with each thing and room for another that it does not name. `None` where it names
/// neither, because it would stay as good as it is. Random choices depend only on the seed and the item.
pub(super) fn corrupt_text(text: &str, seed: u64, item: &str) -> Option<String> {
    let turned = swap_text(InstructionSwap::Directions, text, seed, item);
    let exchanged = swap_text(InstructionSwap::Landmarks, turned.as_deref().unwrap_or(text), seed, item);
    exchanged.or(turned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_and_landmarks_are_both_wrong_afterwards() {
        let text = "Turn left at the sofa, and stop in the kitchen.";
        let corrupted = corrupt_text(text, 1, "item").unwrap();
        assert!(corrupted.starts_with("Turn right at the ") && !corrupted.contains("sofa"), "{corrupted}");
        assert!(!corrupted.contains("kitchen"), "{corrupted}");
        assert_eq!(corrupt_text(text, 1, "item").unwrap(), corrupted, "it keeps to the seed");
    }

    #[test]
    fn one_kind_is_enough_and_a_text_without_either_has_no_corruption() {
        assert_eq!(corrupt_text("Turn left. Wait.", 1, "item").as_deref(), Some("Turn right. Wait."));
        assert!(corrupt_text("Stop at the sofa.", 1, "item").is_some_and(|text| text.starts_with("Stop at the ")));
        assert_eq!(corrupt_text("Walk on, then wait.", 1, "item"), None);
    }
}
