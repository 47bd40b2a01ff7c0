//! Tokens as `pycocoevalcap` has them: those of Stanford's PTB tokenizer, version 3.4.1, in small letters, without
//! punctuation marks.

mod abbreviations;
mod shape;
mod table;

use shape::{SOFT_HYPHEN, Shapes};
use std::sync::LazyLock;
use table::{ROWS, Taken};

static SHAPES: LazyLock<Shapes> = LazyLock::new(|| Shapes::new(ROWS.iter().map(|row| row.shape)));

/// Takes a text apart. White space is collapsed first, because the reference reads texts by lines.
#[must_use]
pub fn ptb(text: &str) -> Vec<String> {
    let text: Vec<char> = super::collapsed(text).chars().collect();
    let mut tokens = Vec::new();
    let mut rest = &text[..];
    while let Some(first) = rest.first() {
        if *first == ' ' {
            rest = &rest[1..];
            continue;
        }
        let length = length(rest).clamp(1, rest.len());
        tokens.extend(written(&rest[..length]));
        rest = &rest[length..];
    }
    tokens
}

/// How long the token is that a text begins with.
fn length(text: &[char]) -> usize {
    let found = SHAPES.longest(text, |row, length| taken(row, text, length) > 0);
    found.map_or(1, |(row, length)| taken(row, text, length))
}

/// How much of what a shape covers is a token; 0 where it is none.
fn taken(row: usize, text: &[char], length: usize) -> usize {
    let (text, after) = text.split_at(length);
    let word = |text: &[char]| text.iter().take_while(|c| **c != '.').filter(|c| **c != SOFT_HYPHEN).collect::<String>();
    let stop = || text.iter().position(|c| *c == '.').map_or(0, |at| at + 1);
    match ROWS.get(row).map_or(Taken::All, |row| row.taken) {
        Taken::All => text.len(),
        Taken::First(count) => count,
        Taken::AllBut(count) => text.len().saturating_sub(count),
        Taken::Abbreviation => if abbreviations::is_one(&word(text)) { stop() } else { 0 },
        Taken::BeforeBlank => if after.first().is_none_or(|c| *c == ' ') { length } else { 0 },
        Taken::NotInWord => if after.first().is_none_or(|c| !c.is_ascii_alphanumeric()) { length } else { 0 },
        Taken::BeforeLetter => if abbreviations::often_ends(&word(text)) { stop() } else { 0 },
        Taken::BeforeSentence => usize::from(after.first().is_none_or(|c| *c == ' ')),
        Taken::BeforeStop => if after.first().is_none_or(|c| matches!(c, ' ' | '!' | ',' | '.' | '?')) { length } else { 0 },
        Taken::NotBeforeLetter => if after.first().is_none_or(|c| !c.is_ascii_alphabetic()) { length } else { 0 },
        Taken::BeforeNumber => if abbreviations::is_one_before_a_number(&word(text)) { stop() } else { 0 },
    }
}

/// Punctuation marks that are left out.
const LEFT_OUT: [&str; 13] = ["''", "'", "``", "`", ".", "?", "!", ",", ":", "-", "--", "...", ";"];

/// A token as it is written, if it is kept.
fn written(token: &[char]) -> Option<String> {
    let entity: String = token.iter().collect();
    if let Some((_, c)) = [("&amp;", "&"), ("&lt;", "<"), ("&gt;", ">")].iter().find(|(e, _)| e.eq_ignore_ascii_case(&entity)) { return Some((*c).to_owned()); }
    if ["&quot;", "&apos;", "&mdash;", "&ndash;", "&nbsp;"].iter().any(|e| e.eq_ignore_ascii_case(&entity)) { return None; }
    if let Some(quotes) = token.iter().map(|c| quote(*c)).collect::<Option<String>>() && token.len() > 1 {
        return (!LEFT_OUT.contains(&quotes.as_str())).then_some(quotes);
    }
    let mut text = String::with_capacity(token.len());
    if let [one] = token && let Some(other) = sign(*one) {
        text.push_str(other);
    } else if token.iter().all(|c| matches!(c, '.' | ' ')) && token.len() > 1 || token.len() > 2 && token.iter().all(|c| *c == '-') && token.len() < 5 {
        return None;
    } else {
        for c in token {
            match c {
                &SOFT_HYPHEN if token[0] != '#' && !token.contains(&'@') && !token.contains(&'/') => {}
                '(' => text.push_str("-lrb-"),
                ')' => text.push_str("-rrb-"),
                ' ' => text.push('\u{a0}'),
                '\u{2019}' | '\u{2018}' => text.push('\''),
                c => text.extend(c.to_lowercase()),
            }
        }
    }
    (!text.is_empty() && !LEFT_OUT.contains(&text.as_str())).then_some(text)
}

/// Quotation marks as they are written in a row.
fn quote(c: char) -> Option<&'static str> {
    Some(match c {
        '\'' | '’' => "'",
        '`' | '‘' => "`",
        '«' | '“' => "``",
        '»' | '”' => "''",
        _ => return None,
    })
}

/// Signs that are written otherwise.
fn sign(c: char) -> Option<&'static str> {
    Some(match c {
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
        '¤' | '€' => "$",
        '"' | '«' | '»' | '\u{2018}'..='\u{201f}' | '‹' | '›' | '…' | '–' | '—' | '‒' | '―' | SOFT_HYPHEN => "'",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {}
