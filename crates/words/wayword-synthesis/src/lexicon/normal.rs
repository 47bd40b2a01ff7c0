//! One spelling for the many of a name.

/// A name in one spelling: lower case, words separated by one space, each in the singular, without punctuation.
#[must_use]
pub fn normal(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric() && c != '\'').filter(|word| !word.is_empty());
    words.map(normal_word).collect::<Vec<_>>().join(" ")
}

/// One word in lower case and in the singular.
///
/// Wrong for some words, but wrong in the same way for a text and for a label, which is all that comparing needs.
#[must_use]
pub fn normal_word(word: &str) -> String {
    let word = word.to_lowercase();
    let keeps_its_s = ["ss", "us", "is"].iter().any(|end| word.ends_with(end)) || word.len() < 4;
    if keeps_its_s {
        return word;
    }
    for (end, instead) in
        [("shelves", "shelf"), ("knives", "knife"), ("leaves", "leaf"), ("scarves", "scarf"), ("loaves", "loaf")]
    {
        if let Some(stem) = word.strip_suffix(end) {
            return format!("{stem}{instead}");
        }
    }
    if let Some(stem) = word.strip_suffix("ies") {
        return format!("{stem}y");
    }
    for end in ["ches", "shes", "xes", "sses", "zes"] {
        if word.ends_with(end) {
            return word[..word.len() - 2].to_owned();
        }
    }
    word.strip_suffix('s').map_or(word.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plurals_and_spellings_come_together() {
        assert_eq!(normal("Book-Shelves"), "book shelf");
        assert_eq!(normal("couches"), normal("couch"));
        assert_eq!(normal("glass"), "glass");
        assert_eq!(normal("  dining#chairs "), "dining chair");
    }
}
