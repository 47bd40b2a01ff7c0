//! Pairs of texts: one passes, and the same one with a word changed fails.

use crate::{flat, verdict};
use wayword_core::Verdict;

#[test]
fn one_changed_word_makes_a_right_text_wrong() {
    for (text, word, other) in [
        ("Walk past the sofa and turn right into the bedroom.", "right", "left"),
        ("Walk past the sofa and turn right into the bedroom.", "sofa", "piano"),
        ("Walk past the sofa and turn right into the bedroom.", "bedroom", "kitchen"),
        ("Walk past the plant. Walk past the lamp.", "plant", "dresser"),
        ("Walk past the plant on your left.", "left", "right"),
        ("Walk past the sofa on your right.", "right", "left"),
        ("Go down the hallway and stop by the bed.", "bed", "plant"),
        ("Go down the hallway and stop in the bedroom.", "bedroom", "hallway"),
        ("Walk past the lamp to the bedroom on the first floor.", "first", "second"),
    ] {
        assert_eq!(verdict(text, &flat()), Verdict::Pass, "{text}");
        let changed = text.replacen(word, other, 1);
        assert_eq!(verdict(&changed, &flat()), Verdict::Fail, "{changed}");
    }
}

#[test]
fn an_unknown_frame_turns_failures_into_unverified() {
    let mut path = flat();
    path.frames[1].things.clear();
    path.frames[1].rooms.clear();
    path.frames[1].knows_things = false;
    for text in ["Walk past the piano.", "Walk through the kitchen."] {
        assert_eq!(verdict(text, &flat()), Verdict::Fail, "{text}");
        assert_eq!(verdict(text, &path), Verdict::Unverified, "{text}");
    }
    assert_eq!(verdict("Turn left.", &path), Verdict::Fail, "the moves are known");
}
