//! Words that comments hardly ever use: with them a sentence has no subject that a reader could look for.

use super::{sources, workspace};
use std::fs;

/// Words, and how often each may be used in 10,000 words of comments.
const RARE_WORDS: [&str; 7] = ["says", "what is", "whose", "told", "said", "stands", "nobody"];
const MAX_PER_10_000: f64 = 2.5;

/// The words of all comments of the sources, in lower case, with one space between them.
fn comment_text() -> String {
    let mut text = String::new();
    for file in sources(&workspace().join("crates")) {
        if !file.components().any(|part| part.as_os_str() == "src") {
            continue;
        }
        for line in fs::read_to_string(&file).unwrap().lines() {
            if let Some(comment) = line.trim_start().strip_prefix("//") {
                let words = comment.split(|c: char| !c.is_alphanumeric() && c != '\'').filter(|word| !word.is_empty());
                for word in words {
                    text.push_str(&word.to_lowercase());
                    text.push(' ');
                }
                // Two comments are no sentence.
                text.push_str(". ");
            }
        }
    }
    text
}

#[test]
fn comments_use_ordinary_words() {
    let text = format!(" {}", comment_text());
    let words = text.split(' ').filter(|word| !word.is_empty() && *word != ".").count() as f64;
    for word in RARE_WORDS {
        let rate = 1e4 * text.matches(&format!(" {word} ")).count() as f64 / words;
        assert!(rate <= MAX_PER_10_000, "\"{word}\": {rate:.1} in 10,000 words of comments; see docs/CODE_WORDS.md");
    }
}
