//! Splits instructions by rules, offline, with the same language reader that the checks use.

use super::{
    InstructionSplitter, MAX_PHRASES, SplitInstruction, instruction_pieces::InstructionPieces, readable_part,
    shorten_phrase,
};
use wayword_core::ModelError;

/// Splits instructions by rules.
///
/// A key phrase is a clause that names a thing or a room, or a part of a clause that goes through one place on to another. Clauses
/// that only turn are left out, because no picture shows a turn. The activity is the closing task, else the last piece with a
/// place, else the whole text. If the text is only a task that names its room, the room is the key phrase. If the walk has one
/// place, that place is both key phrase and activity. All parts are runs of the text's own words.
#[derive(Debug, Clone, Copy, Default)]
pub struct RuleSplitter;

impl InstructionSplitter for RuleSplitter {
    fn name(&self) -> &'static str {
        "rules"
    }

    fn split_instructions(&self, instructions: &[&str]) -> Vec<Result<SplitInstruction, ModelError>> {
        instructions.iter().map(|text| split_by_rules(text)).collect()
    }
}

fn split_by_rules(text: &str) -> Result<SplitInstruction, ModelError> {
    let text = readable_part(text, RuleSplitter.name())?;
    let pieces = InstructionPieces::from_text(text);
    let task = pieces.task_clause();
    let mut phrases = pieces.leading_pieces(task);
    let activity = match task {
        Some(task) => {
            if phrases.is_empty() {
                phrases.extend(pieces.longest_unread(task).or_else(|| pieces.room_of_task(task)));
            }
            pieces.text_from(task)
        }
        None if phrases.len() > 1 => phrases.pop().unwrap_or(text),
        None => phrases.first().copied().unwrap_or(text),
    };
    let phrases = phrases.into_iter().take(MAX_PHRASES).map(shorten_phrase).collect();
    Ok(SplitInstruction { phrases, activity: shorten_phrase(activity) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn told(text: &str) -> (Vec<String>, String) {
        let directions = RuleSplitter.split_instructions(&[text]).remove(0).unwrap();
        (directions.phrases, directions.activity)
    }

    #[track_caller]
    fn is(text: &str, phrases: &[&str], activity: &str) {
        let phrases = phrases.iter().map(|phrase| (*phrase).to_owned()).collect();
        assert_eq!(told(text), (phrases, activity.to_owned()), "{text}");
    }

    #[test]
    fn walk_and_task_are_separated() {
        is("Go to the bathroom on level 2 and wipe the sink", &["Go to the bathroom on level 2"], "wipe the sink");
        is(
            "Walk through the lounge, then go up the stairs to the office and switch off the lamp next to the globe.",
            &["Walk through the lounge", "go up the stairs", "to the office"],
            "switch off the lamp next to the globe",
        );
        is(
            "Go to the pantry, empty the bin and bring me the kettle",
            &["Go to the pantry"],
            "empty the bin and bring me the kettle",
        );
        is(
            "In the bathroom on the second level, clean the mirror",
            &["In the bathroom on the second level"],
            "clean the mirror",
        );
    }

    #[test]
    fn a_task_alone_gives_its_room_as_phrase() {
        is(
            "Bring me the pillow from the bedroom with the blue bed",
            &["the bedroom with the blue bed"],
            "Bring me the pillow from the bedroom with the blue bed",
        );
        is(
            "clean the mirror in the bathroom on the second level",
            &["the bathroom on the second level"],
            "clean the mirror in the bathroom on the second level",
        );
        is(
            "Check in the kitchen if the window is shut",
            &["the kitchen"],
            "Check in the kitchen if the window is shut",
        );
        is(
            "Go to the kitchen and wipe the counter in the kitchen",
            &["Go to the kitchen"],
            "wipe the counter in the kitchen",
        );
        is("Dust the lamp", &[], "Dust the lamp");
    }

    #[test]
    fn a_walk_without_a_task_ends_at_its_last_place() {
        is("Walk past the couch, turn left and stop at the sink.", &["Walk past the couch"], "stop at the sink");
        is(
            "Leave the bedroom. Turn right. Go down the hall all the way to the piano. Wait there.",
            &["Leave the bedroom", "Go down the hall"],
            "all the way to the piano",
        );
        is("Walk to the kitchen and stop.", &["Walk to the kitchen"], "Walk to the kitchen");
        is("Turn left, then walk straight on.", &[], "Turn left, then walk straight on.");
    }

    #[test]
    fn climbing_is_joined_to_the_place_behind_it() {
        is(
            "Go upstairs, turn left and enter the bedroom. Wait by the bed.",
            &["Go upstairs, turn left and enter the bedroom"],
            "Wait by the bed",
        );
    }

    #[test]
    fn descriptions_of_a_place_make_no_clause() {
        is(
            "Go to the lounge with a red sofa and stripey chairs and is next to the foyer and dust the globe that is by the door and is on a shelf",
            &["Go to the lounge with a red sofa and stripey chairs and is next to the foyer"],
            "dust the globe that is by the door and is on a shelf",
        );
        is(
            "Go to the bedroom with a sign \"Home Sweet Home\" above the bed and clean the window",
            &["Go to the bedroom with a sign \"Home Sweet Home\" above the bed"],
            "clean the window",
        );
    }

    #[test]
    fn a_clause_is_cut_where_the_walk_goes_on() {
        is(
            "Go out of the bathroom into the hall and past the piano, take two steps and wait by the door.",
            &["Go out of the bathroom", "into the hall", "past the piano"],
            "wait by the door",
        );
        is(
            "Walk past the sofa and the table to the left of the door. Stop at the bed",
            &["Walk past the sofa and the table to the left of the door"],
            "Stop at the bed",
        );
    }

    #[test]
    fn unknown_words_are_kept() {
        is(
            "Go to the dinnning room on level 2 and move the chair",
            &["Go to the dinnning room on level 2"],
            "move the chair",
        );
        is("Got to the pantry near the door and empty the bin", &["Got to the pantry near the door"], "empty the bin");
    }

    #[test]
    fn denied_moves_make_no_phrase() {
        is(
            "Don't enter the kitchen. Go past the sofa and stop at the door.",
            &["Go past the sofa"],
            "stop at the door",
        );
    }

    #[test]
    fn a_text_without_words_is_refused() {
        for text in ["", "  ", "?!,"] {
            assert!(RuleSplitter.split_instructions(&[text]).remove(0).is_err());
        }
    }

    #[test]
    fn hostile_texts_stay_small() {
        for text in ["x".repeat(20_000), "é,".repeat(10_000), "go to the bed and wipe the sink, ".repeat(10_000)] {
            let (phrases, activity) = told(&text);
            assert!(
                phrases.len() <= MAX_PHRASES
                    && activity.len() <= super::super::MAX_PHRASE_BYTES
                    && !activity.is_empty()
            );
        }
    }

    proptest! {
        #[test]
        fn no_word_is_invented(text in "((go to|clean|turn left|in|and|then|the|bed|kitchen|up|stairs|into|past|level 2|not|ß|[,.?’é(]) ?){1,30}|\\PC{0,80}") {
            let Ok(directions) = RuleSplitter.split_instructions(&[&text]).remove(0) else { return Ok(()) };
            prop_assert!(!directions.activity.is_empty());
            for phrase in directions.phrases.iter().chain([&directions.activity]) {
                prop_assert!(!phrase.is_empty() && text.contains(phrase.as_str()), "{phrase:?} in {text:?}");
            }
        }
    }
}
