//! A small regular-expression engine for the tokenizer: it matches many patterns at once and finds the longest match. All patterns
//! become one automaton (Glushkov's construction), so a text is scanned once for all of them.
//!
//! A pattern is made of characters and of
//!
//! - `(a|b)`: one of several; `a?`, `a*`, `a+`: at most one, any number, at least one;
//! - `[xyz]`, `[a-z]`, `[^xyz]`: a character of a set, or of none;
//! - `{name}`: a class of characters, see [`CharacterClass`];
//! - `\x`: the character itself.
//!
//! A small letter matches the capital one too. Parsing never fails: brackets that are still open are closed by the pattern's end.
//! (Each pattern of the table has an example, and a test checks that the pattern matches it.)

use std::{collections::BTreeMap, iter::Peekable, str::Chars};

/// A set of characters, one of which a pattern accepts at one position.
#[derive(Debug, Clone, PartialEq)]
enum CharacterClass {
    /// This character; a small letter also matches the capital.
    Same(char),
    /// The characters in the ranges (first and last) or, if `is_without`, those in none of them.
    Set { ranges: Vec<(char, char)>, is_without: bool },
    /// A letter of any script, with other characters that Unicode counts as alphabetic.
    Letter,
    /// A digit of any script.
    Digit,
    /// An apostrophe.
    Apostrophe,
    /// A single quote of any kind, also as an apostrophe.
    Quote,
    /// A letter, or a soft hyphen.
    SoftLetter,
    /// A small letter of ASCII.
    Small,
    /// A character beyond ASCII.
    High,
    /// This character and no other.
    Exactly(char),
}

/// Marks where a word may be broken at the end of a line; it is not a letter of the word.
pub(super) const SOFT_HYPHEN: char = '\u{ad}';

impl CharacterClass {
    /// The class of a name in curly brackets. Any other name is an apostrophe.
    fn from_name(name: &str) -> Self {
        match name {
            "letter" => Self::Letter,
            "digit" => Self::Digit,
            "quote" => Self::Quote,
            "soft" => Self::SoftLetter,
            "hyphen" => Self::Exactly(SOFT_HYPHEN),
            "small" => Self::Small,
            "high" => Self::High,
            "small n" => Self::Exactly('n'),
            "small o" => Self::Exactly('o'),
            "small x" => Self::Exactly('x'),
            _ => Self::Apostrophe,
        }
    }

    fn matches_char(&self, c: char) -> bool {
        match self {
            Self::Same(same) => matches_either_case(*same, c),
            Self::Set { ranges, is_without } => {
                let small = c.to_ascii_lowercase();
                ranges.iter().any(|(low, high)| (*low..=*high).contains(&c) || (*low..=*high).contains(&small))
                    != *is_without
            }
            Self::Letter => is_letter(c),
            Self::Digit => is_digit(c),
            Self::Quote => matches!(c, '\'' | '`' | '\u{2018}' | '\u{2019}' | '\u{91}' | '\u{92}'),
            Self::SoftLetter => is_letter(c) || c == SOFT_HYPHEN,
            Self::Small => c.is_ascii_lowercase(),
            Self::High => !c.is_ascii(),
            Self::Exactly(same) => c == *same,
            Self::Apostrophe => matches!(c, '\'' | '\u{2019}' | '\u{92}'),
        }
    }
}

fn matches_either_case(pattern: char, c: char) -> bool {
    pattern == c || pattern == c.to_ascii_lowercase()
}

fn is_letter(c: char) -> bool {
    c.is_alphabetic()
}

fn is_digit(c: char) -> bool {
    c.is_ascii_digit()
        || (!c.is_ascii() && !c.is_alphabetic() && c.is_numeric() && c.to_digit(36).is_none() && is_decimal(c))
}

/// Whether a character is a decimal digit of another script: Arabic, Persian, Devanagari, Thai or full width.
fn is_decimal(c: char) -> bool {
    matches!(c, '\u{660}'..='\u{669}' | '\u{6f0}'..='\u{6f9}' | '\u{966}'..='\u{96f}' | '\u{e50}'..='\u{e59}' | '\u{ff10}'..='\u{ff19}')
}

/// A parsed pattern, as a tree.
#[derive(Debug, Clone)]
enum PatternPart {
    /// One character of a class.
    One(CharacterClass),
    /// Parts one after the other.
    Row(Vec<PatternPart>),
    /// One of several parts: `(a|b)`.
    Either(Vec<PatternPart>),
    /// A repeated part: at least once if `is_needed` (`+`), and more than once if `is_many` (`*` and `+`).
    Repeat { part: Box<PatternPart>, is_needed: bool, is_many: bool },
}

/// Parses parts with `|` between them.
fn parse_alternatives(chars: &mut Peekable<Chars<'_>>) -> PatternPart {
    let mut ways = vec![parse_sequence(chars)];
    while chars.next_if_eq(&'|').is_some() {
        ways.push(parse_sequence(chars));
    }
    if ways.len() == 1 { ways.remove(0) } else { PatternPart::Either(ways) }
}

/// Parses parts one after the other, up to `|`, `)` or the end.
fn parse_sequence(chars: &mut Peekable<Chars<'_>>) -> PatternPart {
    let mut parts = Vec::new();
    while let Some(c) = chars.next_if(|c| !matches!(c, '|' | ')')) {
        let part = match c {
            '(' => {
                let inner = parse_alternatives(chars);
                chars.next_if_eq(&')');
                inner
            }
            '[' => PatternPart::One(parse_set(chars)),
            '{' => PatternPart::One(CharacterClass::from_name(
                &chars.by_ref().take_while(|c| *c != '}').collect::<String>(),
            )),
            '\\' => PatternPart::One(CharacterClass::Same(chars.next().unwrap_or('\\'))),
            c => PatternPart::One(CharacterClass::Same(c)),
        };
        parts.push(parse_repetition(part, chars));
    }
    PatternPart::Row(parts)
}

/// Parses the sign of a repetition after a part, if there is one.
fn parse_repetition(part: PatternPart, chars: &mut Peekable<Chars<'_>>) -> PatternPart {
    match chars.next_if(|c| matches!(c, '?' | '*' | '+')) {
        Some(sign) => PatternPart::Repeat { part: Box::new(part), is_needed: sign == '+', is_many: sign != '?' },
        None => part,
    }
}

/// Parses a set of characters after its `[`.
fn parse_set(chars: &mut Peekable<Chars<'_>>) -> CharacterClass {
    let is_without = chars.next_if_eq(&'^').is_some();
    let mut ranges = Vec::new();
    while let Some(c) = chars.next().filter(|c| *c != ']') {
        let escaped = |c: char, chars: &mut Peekable<Chars<'_>>| if c == '\\' { chars.next().unwrap_or(c) } else { c };
        let low = escaped(c, chars);
        let high = match chars.next_if_eq(&'-') {
            Some(_) => chars.next().map_or(low, |c| escaped(c, chars)),
            None => low,
        };
        ranges.push((low, high));
    }
    CharacterClass::Set { ranges, is_without }
}

/// A state of the automaton: one position of a pattern, which accepts a class of characters, with the positions that may follow.
#[derive(Debug)]
struct PatternPosition {
    class: CharacterClass,
    /// The numbers of the positions that may follow.
    next: Vec<usize>,
    /// The number of the pattern that is complete here.
    ends: Option<usize>,
}

/// Many patterns as one automaton.
#[derive(Debug, Default)]
pub(super) struct TokenShapes {
    places: Vec<PatternPosition>,
    /// The positions at which a match may begin, by its first character, for ASCII.
    starts: BTreeMap<char, Vec<usize>>,
    /// The positions at which a match may begin with a character beyond ASCII.
    other_starts: Vec<usize>,
}

/// The positions at which a part of a pattern may begin and end, and whether the part may be left out.
struct PartEnds {
    first: Vec<usize>,
    last: Vec<usize>,
    may_be_empty: bool,
}

impl TokenShapes {
    /// Builds the automaton of patterns. The patterns are numbered in their order.
    pub(super) fn new<'a>(patterns: impl IntoIterator<Item = &'a str>) -> Self {
        let mut shapes = Self::default();
        let mut starts = Vec::new();
        for (number, pattern) in patterns.into_iter().enumerate() {
            let ends = shapes.add_part(&parse_alternatives(&mut pattern.chars().peekable()));
            for at in ends.last {
                shapes.places[at].ends = Some(number);
            }
            starts.extend(ends.first);
        }
        for c in (0..128u8).map(char::from) {
            let matching = starts.iter().copied().filter(|at| shapes.places[*at].class.matches_char(c)).collect();
            shapes.starts.insert(c, matching);
        }
        shapes.other_starts = starts;
        shapes
    }

    /// Gives each character of a part a position (Glushkov's construction: the automaton has no empty transitions).
    fn add_part(&mut self, part: &PatternPart) -> PartEnds {
        match part {
            PatternPart::One(class) => {
                self.places.push(PatternPosition { class: class.clone(), next: Vec::new(), ends: None });
                let at = vec![self.places.len() - 1];
                PartEnds { first: at.clone(), last: at, may_be_empty: false }
            }
            PatternPart::Row(parts) => parts
                .iter()
                .fold(PartEnds { first: Vec::new(), last: Vec::new(), may_be_empty: true }, |before, part| {
                    self.append_part(before, part)
                }),
            PatternPart::Either(ways) => {
                let mut all = PartEnds { first: Vec::new(), last: Vec::new(), may_be_empty: false };
                for way in ways {
                    let ends = self.add_part(way);
                    all.first.extend(ends.first);
                    all.last.extend(ends.last);
                    all.may_be_empty |= ends.may_be_empty;
                }
                all
            }
            PatternPart::Repeat { part, is_needed, is_many } => {
                let mut ends = self.add_part(part);
                if *is_many {
                    self.join_positions(&ends.last, &ends.first);
                }
                ends.may_be_empty |= !is_needed;
                ends
            }
        }
    }

    /// Adds a part that follows the parts `before`.
    fn append_part(&mut self, mut before: PartEnds, part: &PatternPart) -> PartEnds {
        let after = self.add_part(part);
        self.join_positions(&before.last, &after.first);
        if before.may_be_empty {
            before.first.extend(&after.first);
        }
        let earlier_ends = if after.may_be_empty { before.last } else { Vec::new() };
        PartEnds {
            first: before.first,
            last: [after.last, earlier_ends].concat(),
            may_be_empty: before.may_be_empty && after.may_be_empty,
        }
    }

    /// Lets each position of `to` follow each of `from`.
    fn join_positions(&mut self, from: &[usize], to: &[usize]) {
        for at in from {
            let next = &mut self.places[*at].next;
            for to in to {
                if !next.contains(to) {
                    next.push(*to);
                }
            }
        }
    }

    /// The longest match at the start of a text, as the number of its pattern and its length in characters. `holds` gets both and
    /// may reject a match. Of several patterns with matches of equal length, the first is taken.
    pub(super) fn longest_match(
        &self,
        text: &[char],
        mut holds: impl FnMut(usize, usize) -> bool,
    ) -> Option<(usize, usize)> {
        let mut longest = None;
        // The positions that have accepted the last character, and those that accept the next.
        let mut active: Vec<usize> = Vec::new();
        let mut next: Vec<usize> = Vec::new();
        for (at, c) in text.iter().enumerate() {
            next.clear();
            let mut enter = |to: &[usize]| {
                for to in to {
                    if !next.contains(to) && self.places[*to].class.matches_char(*c) {
                        next.push(*to);
                    }
                }
            };
            if at == 0 {
                enter(self.starts.get(c).unwrap_or(&self.other_starts));
            } else {
                active.iter().for_each(|from| enter(&self.places[*from].next));
            }
            if next.is_empty() {
                break;
            }
            let ending = next.iter().filter_map(|at| self.places[*at].ends).filter(|shape| holds(*shape, at + 1)).min();
            longest = ending.map(|shape| (shape, at + 1)).or(longest);
            std::mem::swap(&mut active, &mut next);
        }
        longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn longest(patterns: &[&str], text: &str) -> Option<(usize, usize)> {
        TokenShapes::new(patterns.iter().copied()).longest_match(&text.chars().collect::<Vec<_>>(), |_, _| true)
    }

    #[test]
    fn the_longest_shape_wins_and_then_the_first() {
        assert_eq!(longest(&["a", "ab*", "abb"], "abbc"), Some((1, 3)));
        assert_eq!(longest(&["a", "ab*", "abb"], "ac"), Some((0, 1)));
        assert_eq!(longest(&["a"], "b"), None);
        assert_eq!(longest(&["a"], ""), None);
    }

    #[test]
    fn patterns_have_alternatives_sets_and_repetitions() {
        let pattern = ["(x|[a-c]+[^d])?e\\+"];
        assert_eq!(longest(&pattern, "e+"), Some((0, 2)));
        assert_eq!(longest(&pattern, "abcaze+."), Some((0, 7)));
        assert_eq!(longest(&pattern, "ade+"), None);
        assert_eq!(longest(&["{letter}{digit}{apostrophe}"], "é5’"), Some((0, 3)));
    }

    #[test]
    fn small_letters_stand_for_capitals_too() {
        assert_eq!(longest(&["ab"], "AB"), Some((0, 2)));
        assert_eq!(longest(&["AB"], "ab"), None);
        assert_eq!(longest(&["[a-c]"], "B"), Some((0, 1)));
    }

    #[test]
    fn open_brackets_end_with_the_pattern() {
        assert_eq!(longest(&["(a[b"], "ab"), Some((0, 2)));
        assert_eq!(longest(&["a\\"], "a\\"), Some((0, 2)));
    }

    #[test]
    fn a_shape_can_be_refused_by_its_text() {
        let shapes = TokenShapes::new(["a+"]);
        assert_eq!(shapes.longest_match(&['a'; 5], |_, length| length % 2 == 0), Some((0, 4)));
    }
}
