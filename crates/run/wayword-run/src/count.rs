//! Numbers with their nouns.

use wayword_language::lexicon::to_plural;

/// A number with its noun: 1 item, 2 items, 0 different views, 3 calls of unknown price.
pub fn count_phrase(count: impl TryInto<u64>, of: &str) -> String {
    match count.try_into().unwrap_or(u64::MAX) {
        1 => format!("1 {of}"),
        count => match of.split_once(" of ") {
            Some((noun, rest)) => format!("{count} {} of {rest}", to_plural(noun)),
            None => format!("{count} {}", to_plural(of)),
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
