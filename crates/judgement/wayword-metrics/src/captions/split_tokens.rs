//! The tokenizer of EnvDrop (`split_sentence`), with which LANA and SAS compute their scores: punctuation marks are tokens too.

/// Splits a text into words in lower case and the marks between them. A run of punctuation marks is split into single marks, unless
/// all are full stops.
#[must_use]
pub fn split_tokens(text: &str) -> Vec<String> {
    let text = super::collapse_white_space(text);
    let mut tokens = Vec::new();
    let mut rest = text.as_str();
    while let Some(first) = rest.chars().next() {
        let is_word = is_word_character(first);
        let end = rest.find(|c| is_word_character(c) != is_word).unwrap_or(rest.len());
        let (run, after) = rest.split_at(end);
        push_run(run.trim(), &mut tokens);
        rest = after;
    }
    tokens
}

fn is_word_character(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Adds the tokens of a run, which is a word or a run of other characters.
fn push_run(run: &str, tokens: &mut Vec<String>) {
    let is_marks = run.chars().all(|c| c.is_ascii_punctuation()) && run.chars().any(|c| c != '.');
    if is_marks {
        tokens.extend(run.chars().map(String::from));
    } else {
        // Marks with a blank among them stay together, and the scores then split them at the blank.
        tokens.extend(run.split(' ').filter(|part| !part.is_empty()).map(str::to_lowercase));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn punctuation_marks_are_tokens() {
        assert_eq!(split_tokens("Turn Left, stop?! Wait..."), ["turn", "left", ",", "stop", "?", "!", "wait", "..."]);
        assert_eq!(split_tokens("it's the left-hand door"), ["it", "'", "s", "the", "left", "-", "hand", "door"]);
        assert_eq!(split_tokens("__ a_b é½"), ["_", "_", "a_b", "é½"]);
    }

    #[test]
    fn marks_with_a_blank_among_them_are_split_there_alone() {
        assert_eq!(split_tokens("stop.) (Then"), ["stop", ".)", "(", "then"]);
    }

    #[test]
    fn split_gives_no_tokens_for_an_empty_text() {
        assert!(split_tokens(" \n ").is_empty());
    }
}
