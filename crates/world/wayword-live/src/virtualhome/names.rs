//! Words from VirtualHome's names of classes, which run them together.

/// What the first words of names are. What follows has to be a word as well: three letters at least.
const FIRST: [&str; 26] = [
    "bathroom", "bedroom", "ceiling", "clothes", "coffee", "closet", "cutting", "desk", "dining", "dish", "door",
    "floor", "garage", "garbage", "kitchen", "laundry", "light", "living", "picture", "power", "remote", "table",
    "toilet", "tv", "wall", "washing",
];
/// Names that begin with one of these words and are one word.
const WHOLE: [&str; 8] = ["closets", "doorway", "floors", "kitchens", "lights", "tables", "tablet", "tablets"];

/// `coffeetable` as "coffee table", `wallpictureframe` as "wall picture frame".
pub(super) fn words(class_name: &str) -> String {
    let (name, mut words) = (class_name.to_lowercase(), Vec::new());
    let mut rest = name.as_str();
    while !WHOLE.contains(&rest) {
        let cut = FIRST.iter().find_map(|first| rest.strip_prefix(first).filter(|rest| rest.chars().count() >= 3));
        let Some(after) = cut else { break };
        words.push(rest[..rest.len() - after.len()].to_owned());
        rest = after;
    }
    words.push(rest.to_owned());
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn names_come_apart_where_words_meet() {
        let expected = [
            ("coffeetable", "coffee table"),
            ("wallpictureframe", "wall picture frame"),
            ("livingroom", "living room"),
            ("Bathroomcabinet", "bathroom cabinet"),
            ("tvstand", "tv stand"),
            ("tv", "tv"),
            ("bookshelf", "bookshelf"),
            ("tablet", "tablet"),
            ("closet", "closet"),
            ("doorjamb", "door jamb"),
            ("table\u{e9}\u{e9}\u{e9}", "table \u{e9}\u{e9}\u{e9}"),
        ];
        for (name, apart) in expected {
            assert_eq!(words(name), apart);
        }
    }
}
