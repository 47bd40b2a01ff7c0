//! Numbers with their nouns, for messages: "1 item", "2 items".

use wayword_language::lexicon::to_plural;

/// A number with its noun, which is given in the singular: 1 item, 2 items, 0 different views, 3 calls of unknown
/// price.
pub fn count_phrase(count: impl TryInto<u64>, noun: &str) -> String {
    match count.try_into().unwrap_or(u64::MAX) {
        1 => format!("1 {noun}"),
        count => match noun.split_once(" of ") {
            Some((head, rest)) => format!("{count} {} of {rest}", to_plural(head)),
            None => format!("{count} {}", to_plural(noun)),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_is_in_the_singular() {
        assert_eq!(count_phrase(1_usize, "item"), "1 item");
        assert_eq!(count_phrase(0_usize, "item"), "0 items");
        assert_eq!(count_phrase(2_u64, "trajectory"), "2 trajectories");
        assert_eq!(count_phrase(1_u64, "trajectory"), "1 trajectory");
        assert_eq!(count_phrase(3_usize, "call of unknown price"), "3 calls of unknown price");
        assert_eq!(
            [count_phrase(1_usize, "different view"), count_phrase(2_usize, "different view")],
            ["1 different view", "2 different views"]
        );
    }
}
