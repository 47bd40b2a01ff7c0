//! Which colour words people use for the same colour, so that a "beige" sofa is not a mistake for a "cream" one.

use crate::data;
use std::sync::LazyLock;

/// Colours that people use for one another, as lists: one list for each line of `languages/en/colours.txt`.
static COLOUR_FAMILIES: LazyLock<Vec<Vec<&'static str>>> = LazyLock::new(|| {
    data::content_lines(include_str!("../languages/en/colours.txt"))
        .map(|line| data::split_names(line).collect())
        .collect()
});

/// Whether two colours may describe one thing: they are equal up to a shade ("dark brown", "brown"), or near each
/// other (cream and beige).
#[must_use]
pub fn same_colour(a: &str, b: &str) -> bool {
    let (a, b) = (without_shade(a), without_shade(b));
    a == b || COLOUR_FAMILIES.iter().any(|family| family.contains(&a) && family.contains(&b))
}

/// "brown" of "dark brown".
fn without_shade(colour: &str) -> &str {
    ["dark ", "light ", "pale ", "bright ", "deep "]
        .iter()
        .find_map(|shade| colour.strip_prefix(shade))
        .unwrap_or(colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_colours_are_not_kept_apart_and_others_are() {
        for (a, b) in [
            ("cream", "beige"),
            ("turquoise", "teal"),
            ("grey", "silver"),
            ("dark brown", "brown"),
            ("gray", "grey"),
            ("cream", "white"),
            ("wooden", "brown"),
            ("wooden", "light brown"),
            ("oak", "wooden"),
        ] {
            assert!(same_colour(a, b) && same_colour(b, a), "{a} and {b}");
        }
        for (a, b) in [
            ("red", "blue"),
            ("white", "black"),
            ("green", "red"),
            ("white", "brown"),
            ("wooden", "white"),
            ("glass", "white"),
        ] {
            assert!(!same_colour(a, b), "{a} and {b}");
        }
    }
}
