//! Suggests a name for a mistyped one.

/// Least similarity of a suggestion, from 0 to 1: the same as in clap's own suggestions.
const MIN_SIMILARITY: f64 = 0.7;

/// The name most similar to a word, if any is similar enough.
pub(crate) fn most_similar<'n>(word: &str, names: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let word = word.to_lowercase();
    let rated = names.into_iter().map(|name| (strsim::jaro(&word, &name.to_lowercase()), name));
    rated.filter(|(alike, _)| *alike > MIN_SIMILARITY).max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, name)| name)
}

/// The suggestion as "; did you mean \"r2r\"?", or an empty text if no name is similar.
pub(crate) fn did_you_mean<'n>(word: &str, names: impl IntoIterator<Item = &'n str>) -> String {
    most_similar(word, names).map_or_else(String::new, |name| format!("; did you mean {name:?}?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_found_and_none_where_all_are_far() {
        assert_eq!(most_similar("revery", ["r2r", "reverie"]), Some("reverie"));
        assert_eq!(most_similar("R2R", ["r2r", "reverie"]), Some("r2r"));
        assert_eq!(most_similar("poem", ["r2r", "reverie"]), None);
        assert_eq!(did_you_mean("hause", ["house"]), "; did you mean \"house\"?");
        assert_eq!(did_you_mean("moon", ["r2r"]), "");
        assert_eq!(most_similar("17drp5sb8fy", ["1LXtFkjw3qL", "17DRP5sb8fy"]), Some("17DRP5sb8fy"));
    }
}
