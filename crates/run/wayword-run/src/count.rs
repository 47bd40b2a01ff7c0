//! Numbers with their nouns.

/// A number with its noun: 1 item, 2 items, 0 different views, 3 calls of unknown price.
pub fn count_phrase(count: impl TryInto<u64>, of: &str) -> String {
    match count.try_into().unwrap_or(u64::MAX) {
        1 => format!("1 {of}"),
        count => match of.split_once(" of ") {
            Some((noun, rest)) => format!("{count} {} of {rest}", plural_noun(noun)),
            None => format!("{count} {}", plural_noun(of)),
        },
    }
}

/// The plural of a noun, or of words that end in one. It knows the rules that the program's own words need.
fn plural_noun(noun: &str) -> String {
    let ends = |ends: &[&str]| ends.iter().any(|end| noun.ends_with(end));
    match noun.strip_suffix('y') {
        Some(stem) if !ends(&["ay", "ey", "oy", "uy"]) => format!("{stem}ies"),
        _ if ends(&["s", "x", "ch", "sh"]) => format!("{noun}es"),
        _ => format!("{noun}s"),
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
        assert_eq!([plural_noun("box"), plural_noun("way"), plural_noun("branch")], ["boxes", "ways", "branches"]);
    }
}
