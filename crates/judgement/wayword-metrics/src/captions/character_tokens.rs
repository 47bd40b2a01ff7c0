//! Tokens of languages that write no blanks between words: each character is one, as captions in Chinese are usually scored.

use super::split_tokens;

/// Splits a text into its Chinese and Japanese characters, and the rest into words and marks as [`split_tokens`] does. Blanks between
/// characters count for nothing.
#[must_use]
pub fn character_tokens(text: &str) -> Vec<String> {
    let mut apart = String::with_capacity(2 * text.len());
    for c in text.chars() {
        match stands_alone(c) {
            true => apart.extend([' ', c, ' ']),
            false => apart.push(c),
        }
    }
    apart.split_whitespace().flat_map(split_tokens).collect()
}

/// Whether a character is a word or a mark of Chinese or Japanese.
#[must_use]
pub fn stands_alone(c: char) -> bool {
    matches!(c, '\u{3000}'..='\u{30FF}' | '\u{3400}'..='\u{4DBF}' | '\u{4E00}'..='\u{9FFF}' | '\u{FF00}'..='\u{FF65}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_chinese_character_is_a_token() {
        assert_eq!(character_tokens("左转，走到 TV 前。"), ["左", "转", "，", "走", "到", "tv", "前", "。"]);
        assert_eq!(character_tokens("Turn left, stop."), ["turn", "left", ",", "stop", "."]);
        assert!(character_tokens(" \n ").is_empty());
    }
}
