//! Places in a view: "on the left", "in the centre of the room", but not "to the left of the sofa".

use wayword_core::Where;
use wayword_language::answers::{BEFORE_SIDE, PREPOSITIONS, SIDE_PARTS, WHOLES};

/// A phrase that says where in the view something is: its words, from and to, and the third.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Phrase {
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) place: Where,
}

/// The place that a phrase beginning at a word tells, and where it ends. `Some((None, _))` for a place in relation to
/// something else.
fn phrase_at(words: &[&str], from: usize) -> Option<(Option<Where>, usize)> {
    let word = |at: usize| words.get(at).copied().unwrap_or("");
    match (word(from), word(from + 1), word(from + 2)) {
        ("straight" | "directly" | "right", "ahead", _) => return Some((Some(Where::Middle), from + 2)),
        ("ahead", ..) => return Some((Some(Where::Middle), from + 1)),
        ("in", "front", "of") if matches!(word(from + 3), "you" | "us" | "me") => {
            return Some((Some(Where::Middle), from + 4));
        }
        _ => {}
    }
    if !PREPOSITIONS.contains(&word(from)) {
        return None;
    }
    let mut at = from + 1;
    while at < from + 4 && BEFORE_SIDE.contains(&word(at)) {
        at += 1;
    }
    let place = match word(at) {
        "left" | "lefthand" => Where::Left,
        "right" | "righthand" => Where::Right,
        "middle" | "centre" | "center" | "background" | "distance" => Where::Middle,
        _ => return None,
    };
    if at == from + 1 {
        return None;
    }
    at += 1;
    while SIDE_PARTS.contains(&word(at)) {
        at += 1;
    }
    if word(at) != "of" {
        return Some((Some(place), at));
    }
    let whole = if matches!(word(at + 1), "the" | "this" | "your" | "my") { at + 2 } else { at + 1 };
    let room = wayword_language::lexicon::is_room(word(whole)) || word(whole + 1) == "room";
    let of_view = WHOLES.contains(&word(whole)) || room;
    Some(if of_view { (Some(place), whole + 1) } else { (None, at + 1) })
}

/// The phrases of a run of words that place something in the view.
pub(super) fn phrases(words: &[&str]) -> Vec<Phrase> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let next = phrase_at(words, at);
        if let Some((Some(place), to)) = next {
            found.push(Phrase { from: at, to, place });
        }
        at = next.map_or(at + 1, |(_, to)| to);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use Where::{Left, Middle, Right};

    fn places(text: &str) -> Vec<Where> {
        phrases(&text.split(' ').collect::<Vec<_>>()).into_iter().map(|phrase| phrase.place).collect()
    }

    #[test]
    fn places_in_the_view_are_found() {
        for (text, wanted) in [
            ("a bed on the left", vec![Left]),
            ("on the left side of the room there is a bed", vec![Left]),
            ("a bed to the right and a lamp in the centre", vec![Right, Middle]),
            ("in the center of the image", vec![Middle]),
            ("a door straight ahead", vec![Middle]),
            ("a kitchen in the background", vec![Middle]),
            ("in the far left corner", vec![Left]),
            ("on your right", vec![Right]),
            ("against the right wall", vec![Right]),
            ("on the left side of the kitchen", vec![Left]),
            ("a chair in front of you", vec![Middle]),
        ] {
            assert_eq!(places(text), wanted, "{text}");
        }
    }

    #[test]
    fn places_in_relation_to_things_are_not_places_in_the_view() {
        for text in [
            "to the left of the sofa",
            "on the right side of the bed",
            "in the middle of the table",
            "to its left",
            "in front of the sofa",
            "right next to the bed",
            "what is left",
            "",
        ] {
            assert_eq!(places(text), [], "{text}");
        }
    }
}
