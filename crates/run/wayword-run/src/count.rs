//! Numbers with their nouns.

/// A number with its noun: 1 item, 2 items, 0 different views, 3 calls of unknown price.
pub fn count(count: impl TryInto<u64>, of: &str) -> String {
    match count.try_into().unwrap_or(u64::MAX) {
        1 => format!("1 {of}"),
        count => match of.split_once(" of ") {
            Some((noun, rest)) => format!("{count} {} of {rest}", plural(noun)),
            None => format!("{count} {}", plural(of)),
        },
    }
}

/// The plural of a noun, or of words that end in one. It knows the rules that the program's own words need.
fn plural(noun: &str) -> String {
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
        assert_eq!(count(1_usize, "item"), "1 item");
        assert_eq!(count(0_usize, "item"), "0 items");
        assert_eq!(count(2_u64, "trajectory"), "2 trajectories");
        assert_eq!(count(1_u64, "trajectory"), "1 trajectory");
        assert_eq!(count(3_usize, "call of unknown price"), "3 calls of unknown price");
        assert_eq!(
            [count(1_usize, "different view"), count(2_usize, "different view")],
            ["1 different view", "2 different views"]
        );
        assert_eq!([plural("box"), plural("way"), plural("branch")], ["boxes", "ways", "branches"]);
    }
}
