//! Word lists that steer the reading of an instruction.

crate::data::lists! {
    "languages/en/reading.txt";
    words: WALKING, TURNING, DOING, SPINNING, BEFORE_ABOUT, GOING, CLIMBING, BEFORE_CLIMB, FEW, ONWARD, STOREYS, CARRIERS, FLOORINGS, LEAVING, BEFORE_SIDE, BEFORE_SIDE_OF_TURN, AFTER_SIDE, AFTER_ADVERB_RIGHT, HAVE_SIDES, DETERMINERS, COUNTING, BREAKERS, ABSTRACT, BESIDE, ARRIVING, ADJECTIVES, COLOURS, ADVERBS, FUNCTION, AFTER_NOUN, STOCK, STOPPING, AFTER_STOP, PARTS, UNITS;
    phrases:;
}

/// The number of a storey, from an ordinal or a numeral.
pub(super) fn floor_number(word: &str) -> Option<u32> {
    const STOREY_NUMBERS: [[&str; 2]; 12] = [
        ["one", "first"],
        ["two", "second"],
        ["three", "third"],
        ["four", "fourth"],
        ["five", "fifth"],
        ["six", "sixth"],
        ["seven", "seventh"],
        ["eight", "eighth"],
        ["nine", "ninth"],
        ["ten", "tenth"],
        ["eleven", "eleventh"],
        ["twelve", "twelfth"],
    ];
    if matches!(word, "ground" | "bottom") {
        return Some(1);
    }
    let digits = ["st", "nd", "rd", "th"].iter().find_map(|end| word.strip_suffix(end)).unwrap_or(word);
    let in_words = || STOREY_NUMBERS.iter().zip(1..).find(|(words, _)| words.contains(&word)).map(|(_, number)| number);
    digits.parse().ok().filter(|number| (1..1000).contains(number)).or_else(in_words)
}

/// Whether a word is a number or an ordinal, as in the name of a storey.
#[must_use]
pub fn ordinal_or_number(word: &str) -> bool {
    floor_number(word).is_some()
}
