//! The tokenizer of `pycocoevalcap`: Stanford's PTB tokenizer (CoreNLP 3.4.1, `-preserveLines -lowerCase`), without the
//! punctuation marks that `pycocoevalcap` then drops.
//!
//! Like the original, it takes at each position the longest match among many patterns ([`shape_table`]). It was written by observing the
//! answers of the original, without its source. `docs/CRITICS.md` lists where the two are known to agree and to differ.

mod abbreviations;
mod shape;
mod shape_table;

use shape::{SOFT_HYPHEN, TokenShapes};
use shape_table::{SHAPE_ROWS, TokenExtent};
use std::sync::LazyLock;

/// The patterns of all rows of the table, as one automaton.
static TOKEN_SHAPES: LazyLock<TokenShapes> = LazyLock::new(|| TokenShapes::new(SHAPE_ROWS.iter().map(|row| row.shape)));

/// The reference writes a blank within a token as this no-break space.
const NO_BREAK_SPACE: char = '\u{a0}';

/// Splits a text into tokens. White space is collapsed first ([`super::collapse_white_space`]), because the reference reads texts
/// line by line.
#[must_use]
pub fn ptb_tokens(text: &str) -> Vec<String> {
    let text: Vec<char> = super::collapse_white_space(text).chars().collect();
    let mut tokens = Vec::new();
    let mut rest = &text[..];
    while let Some(next) = rest.first() {
        if *next == ' ' {
            rest = &rest[1..];
            continue;
        }
        let (taken, length) = first_token(rest);
        let (token, after) = rest.split_at(length);
        tokens.extend(write_token(taken, token).filter(|token| !DROPPED_TOKENS.contains(&token.as_str())));
        rest = after;
    }
    tokens
}

/// Finds the token at the beginning of a text: how much of the match becomes the token, and the token's length in characters.
fn first_token(text: &[char]) -> (TokenExtent, usize) {
    let longest = TOKEN_SHAPES.longest_match(text, |row, length| token_length(row, text, length) > 0);
    match longest.and_then(|(row, length)| Some((SHAPE_ROWS.get(row)?.taken, token_length(row, text, length)))) {
        Some((taken, length)) => (taken, length.clamp(1, text.len())),
        None => (TokenExtent::All, 1),
    }
}

/// The length of the token if the pattern of row `row` matches `length` characters; 0 if the rest of its condition does not hold.
fn token_length(row: usize, text: &[char], length: usize) -> usize {
    let (covered, after) = text.split_at(length);
    let next_is = |wanted: fn(char) -> bool| after.first().is_some_and(|c| wanted(*c));
    let ends = after.is_empty() || next_is(|c| c == ' ');
    let only_if = |holds: bool, length: usize| if holds { length } else { 0 };
    let through_stop = || covered.iter().position(|c| *c == '.').map_or(0, |at| at + 1);
    let word = || covered.iter().take_while(|c| **c != '.').collect::<String>();
    match SHAPE_ROWS.get(row).map_or(TokenExtent::All, |row| row.taken) {
        TokenExtent::All | TokenExtent::Address => length,
        TokenExtent::First(count) => count,
        TokenExtent::AllBut(count) => length.saturating_sub(count),
        TokenExtent::Abbreviation => only_if(abbreviations::is_abbreviation(&word()), through_stop()),
        TokenExtent::BeforeLetter => only_if(abbreviations::often_ends_sentence(&word()), through_stop()),
        TokenExtent::BeforeNumber => only_if(abbreviations::is_abbreviation_before_number(&word()), through_stop()),
        TokenExtent::BeforeSentence => only_if(ends, 1),
        TokenExtent::BeforeBlank => only_if(ends, length),
        TokenExtent::File => only_if(ends || next_is(|c| matches!(c, '!' | ',' | '.' | '?')), length),
        TokenExtent::NotBeforeLetter => only_if(!next_is(|c| c.is_ascii_alphabetic()), length),
        TokenExtent::NotInWord => only_if(!next_is(|c| c.is_ascii_alphanumeric()), length),
    }
}

/// Punctuation marks that are dropped. `pycocoevalcap` lists brackets too, but in capitals (`-LRB-`), so they never match its
/// lower-case tokens and stay.
const DROPPED_TOKENS: [&str; 14] = ["", "''", "'", "``", "`", ".", "?", "!", ",", ":", "-", "--", "...", ";"];

/// A token as the reference writes it; `None` if the reference drops it.
fn write_token(taken: TokenExtent, token: &[char]) -> Option<String> {
    if let [single] = token {
        return sign_replacement(*single)
            .map_or_else(|| Some(single.to_lowercase().collect()), |sign| sign.map(str::to_owned));
    }
    let text: String = token.iter().collect();
    if let Some(sign) = entity_sign(&text.to_ascii_lowercase()) {
        return Some(sign.to_owned());
    }
    if let Some(quotes) = token.iter().map(|c| quote_sign(*c)).collect::<Option<String>>() {
        return Some(quotes);
    }
    if is_run(token, '.') || token.len() < 5 && is_run(token, '-') || is_run(token, SOFT_HYPHEN) {
        return None;
    }
    if matches!(taken, TokenExtent::Address) {
        return Some(text.to_lowercase().replace(' ', "\u{a0}"));
    }
    Some(write_characters(taken, &text.replace("&amp;", "&").replace("&AMP;", "&")))
}

/// Whether a token is a run of one sign, possibly with blanks between.
fn is_run(token: &[char], sign: char) -> bool {
    token.iter().all(|c| *c == sign || *c == ' ')
}

/// Writes a token character by character: lower case, with round brackets and blanks as the reference writes them.
fn write_characters(taken: TokenExtent, token: &str) -> String {
    let is_ending = has_curly_apostrophe(token);
    let mut text = String::with_capacity(token.len());
    for c in token.chars() {
        match c {
            SOFT_HYPHEN if taken != TokenExtent::File => {}
            '(' => text.push_str("-lrb-"),
            ')' => text.push_str("-rrb-"),
            ' ' => text.push(NO_BREAK_SPACE),
            '’' | '\u{92}' if is_ending => text.push('\''),
            c => text.extend(c.to_lowercase()),
        }
    }
    text
}

/// Whether a token is one of the endings 's, 'm, 'd, 're, 've, 'll and n't with a curly apostrophe. Only there the apostrophe becomes
/// a straight one.
fn has_curly_apostrophe(token: &str) -> bool {
    ["’s", "’m", "’d", "’re", "’ve", "’ll", "n’t"]
        .iter()
        .any(|ending| ending.eq_ignore_ascii_case(&token.replace('\u{92}', "’")))
}

/// The sign for an HTML entity; empty if the reference writes the entity as an empty token.
fn entity_sign(text: &str) -> Option<&'static str> {
    Some(match text {
        "&amp;" => "&",
        "&lt;" => "<",
        "&gt;" => ">",
        "&quot;" | "&apos;" | "&mdash;" | "&ndash;" | "&nbsp;" => "",
        _ => return None,
    })
}

/// How a quotation mark is written in a token that consists only of quotation marks.
fn quote_sign(c: char) -> Option<&'static str> {
    Some(match c {
        '\'' | '’' | '›' | '\u{92}' => "'",
        '`' | '‘' | '‹' | '\u{91}' => "`",
        '«' | '“' | '\u{93}' => "``",
        '»' | '”' | '\u{94}' => "''",
        _ => return None,
    })
}

/// The replacement of a single sign: `Some(Some(..))` if it is written differently, `Some(None)` if it is dropped, `None` if it
/// stays.
fn sign_replacement(c: char) -> Option<Option<&'static str>> {
    Some(Some(match c {
        '(' => "-lrb-",
        ')' => "-rrb-",
        '[' => "-lsb-",
        ']' => "-rsb-",
        '{' => "-lcb-",
        '}' => "-rcb-",
        '½' => "1/2",
        '¼' => "1/4",
        '¾' => "3/4",
        '⅓' => "1/3",
        '⅔' => "2/3",
        '£' => "#",
        '¢' => "cents",
        '¤' | '€' | '\u{80}' => "$",
        '"' | '…' | SOFT_HYPHEN | '\u{2010}'..='\u{2015}' => return Some(None),
        c if quote_sign(c).is_some() => return Some(None),
        // The reference drops characters that it cannot read, with a warning.
        c if c.is_control() || c as u32 > 0xffff => return Some(None),
        _ => return None,
    }))
}

#[cfg(test)]
mod tests;
