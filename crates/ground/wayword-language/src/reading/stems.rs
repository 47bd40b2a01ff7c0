//! Finds the plain form of a verb: "walk" for "walks", "walked" and "walking".

/// Whether a word is a verb of a list, in any of its regular forms: "walk", "walks", "walked", "walking".
pub(super) fn is_form_of(word: &str, list: &[&str]) -> bool {
    verb_stems(word).any(|stem| list.contains(&stem.as_str()))
}

/// The candidates for the plain form of a word, if it is a verb. Some of them are no words.
fn verb_stems(word: &str) -> impl Iterator<Item = String> {
    let without = |end: &str| word.strip_suffix(end).filter(|stem| stem.len() > 1);
    let y = without("ies").or(without("ied")).map(|stem| format!("{stem}y"));
    let bare = ["s", "es", "ed", "ing", "d"].map(|end| without(end).map(str::to_owned));
    let with_e = without("ing").map(|stem| format!("{stem}e"));
    // "Stopping", "stopped".
    let single = |stem: &str| {
        let mut ends = stem.bytes().rev();
        let is_double = ends.next() == ends.next() && stem.is_ascii();
        is_double.then(|| stem[..stem.len() - 1].to_owned())
    };
    let single = [without("ing"), without("ed")].map(|stem| stem.and_then(single));
    [Some(word.to_owned()), y, with_e].into_iter().chain(bare).chain(single).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_forms_of_a_verb_are_found() {
        for word in ["stop", "stops", "stopped", "stopping", "make", "making", "makes", "carries", "carried", "passes"]
        {
            assert!(is_form_of(word, &["stop", "make", "carry", "pass"]), "{word}");
        }
        for word in ["stopper", "passage", "s", "ing", "", "étopped"] {
            assert!(!is_form_of(word, &["stop", "pass"]), "{word}");
        }
    }
}
