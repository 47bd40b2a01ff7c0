//! Turns annotators' names of objects into everyday words: `bathroom##sink` becomes "bathroom sink".

/// Spelling mistakes of the annotators, each with the intended word. Only mistakes that leave no doubt are listed.
const SPELLING_MISTAKES: &[(&str, &str)] = &[
    ("baracade", "barricade"),
    ("bathtab", "bathtub"),
    ("beside", "bedside"),
    ("bothroom", "bathroom"),
    ("cailing", "ceiling"),
    ("celling", "ceiling"),
    ("chairir", "chair"),
    ("chandellier", "chandelier"),
    ("closte", "closet"),
    ("curatain", "curtain"),
    ("displensor", "dispenser"),
    ("doorgrame", "doorframe"),
    ("dushbin", "dustbin"),
    ("excercise", "exercise"),
    ("exericse", "exercise"),
    ("extinctioms", "extinguisher"),
    ("fireextinctioms", "fire extinguisher"),
    ("firealarm", "fire alarm"),
    ("horizonal", "horizontal"),
    ("kitchencounter", "kitchen counter"),
    ("laundrybag", "laundry bag"),
    ("lightswitch", "light switch"),
    ("llight", "light"),
    ("nob", "knob"),
    ("paining", "painting"),
    ("paintintg", "painting"),
    ("scultpure", "sculpture"),
    ("sidetable", "side table"),
    ("sofachair", "sofa chair"),
    ("soffet", "soffit"),
    ("tarrace", "terrace"),
    ("trashcan", "trash can"),
    ("unkown", "unknown"),
    ("utencils", "utensils"),
    ("vaccum", "vacuum"),
    ("wainscotting", "wainscoting"),
    ("whine", "wine"),
    ("windowframe", "window frame"),
];

/// Words for parts of the building, and for objects that the annotators could not name. A task cannot be about these.
const WORDS_WITHOUT_TASK: &[&str] = &[
    "arch",
    "archway",
    "baseboard",
    "beam",
    "ceiling",
    "clutter",
    "column",
    "doorframe",
    "doorway",
    "duct",
    "edge",
    "floor",
    "frame",
    "ground",
    "hole",
    "item",
    "items",
    "junk",
    "ledge",
    "misc",
    "miscellaneous",
    "molding",
    "object",
    "objects",
    "partition",
    "pillar",
    "pipe",
    "pipes",
    "post",
    "reflection",
    "roof",
    "room",
    "skirting",
    "soffit",
    "space",
    "stuff",
    "trim",
    "unknown",
    "void",
    "wainscoting",
    "wall",
];

/// Longest name, in characters; the rest is cut off.
const MAX_NAME_CHARS: usize = 60;

/// Turns an annotator's name into words as people would write them: `bathroom##sink` becomes "bathroom sink". `#` becomes
/// a space. Stray marks are removed, as are remarks that the object is really elsewhere ("/ other room"), and spelling
/// mistakes are corrected. `None` if no letter is left.
///
/// Of two names joined by a slash with spaces around it, the first is used; without spaces ("stand/table"), the second.
#[must_use]
pub fn plain_name(raw: &str) -> Option<String> {
    let spaced: String =
        raw.chars().take(4 * MAX_NAME_CHARS).map(|c| if c == '#' || c == '_' { ' ' } else { c }).collect();
    let lower = choose_slash_name(&spaced).to_lowercase();
    let kept: String = lower.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '\'')).collect();
    let bare = kept.split_whitespace().map(|word| word.trim_matches(['-', '\'']));
    let words: Vec<&str> = bare.filter(|word| !word.is_empty()).map(correct_spelling).collect();
    let mut words: &[&str] = &words;
    while let [rest @ .., "etc"] = words {
        words = rest;
    }
    if let [rest @ .., "other", "room"] = words
        && !rest.is_empty()
    {
        words = rest;
    }
    let name: String = words.join(" ").chars().take(MAX_NAME_CHARS).collect();
    name.chars().any(char::is_alphabetic).then(|| name.trim().to_owned())
}

/// Chooses between two names that are joined by a slash or a backslash.
fn choose_slash_name(name: &str) -> &str {
    let Some((first, second)) = name.split_once(['/', '\\']) else {
        return name;
    };
    let is_remark = first.ends_with(' ') || second.starts_with(' ') || second.starts_with("other");
    if is_remark && !first.trim().is_empty() { first } else { second }
}

/// The intended word for one of the listed spelling mistakes; any other word as it is.
fn correct_spelling(word: &str) -> &str {
    SPELLING_MISTAKES.iter().find(|(slip, _)| *slip == word).map_or(word, |(_, meant)| meant)
}

/// Whether the object of this plain name is a furnishing, about which a person can be given a task, and not a part of the
/// building.
#[must_use]
pub fn is_furnishing(name: &str) -> bool {
    !name.split(' ').any(|word| WORDS_WITHOUT_TASK.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn odd_names_become_plain() {
        for (raw, expected) in [
            ("bath#cabinet", "bath cabinet"),
            ("bathroom##sink", "bathroom sink"),
            ("ceiling#/otherroom", "ceiling"),
            ("cabinet#\\other#room", "cabinet"),
            ("door/other#room", "door"),
            ("wall#\\other#oom", "wall"),
            ("c;lothes#hangers", "clothes hangers"),
            ("stand/table", "table"),
            ("hot#water/cold#water#knob", "cold water knob"),
            ("art#/#clutter", "art"),
            ("t.v", "tv"),
            ("towels#(rolled)", "towels rolled"),
            ("toaster?", "toaster"),
            ("shower#caddy#for#soap#etc.", "shower caddy for soap"),
            ("wall#other#room", "wall"),
            ("kitchen#countertop#object'", "kitchen countertop object"),
            ("a-frame#sign", "a-frame sign"),
            ("lightswitch", "light switch"),
            ("lamp#'#shade", "lamp shade"),
        ] {
            assert_eq!(plain_name(raw).as_deref(), Some(expected), "{raw}");
        }
        assert_eq!(plain_name("##"), None);
        assert_eq!(plain_name("/"), None);
    }

    #[test]
    fn parts_of_the_building_are_no_furnishings() {
        assert!(is_furnishing("coffee table"));
        assert!(!is_furnishing("shower wall"));
        assert!(!is_furnishing("unknown object"));
    }

    proptest! {
        #[test]
        fn plain_name_leaves_no_odd_characters(raw in "\\PC{0,300}") {
            if let Some(name) = plain_name(&raw) {
                prop_assert!(!name.contains(['#', '/', '\\', ';', '\n']) && !name.contains("  "));
                prop_assert!(name.chars().count() <= MAX_NAME_CHARS);
                prop_assert_eq!(name.trim(), &name);
            }
        }
    }
}
