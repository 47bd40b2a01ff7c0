//! Doubts: words of a text that a reader should not rely on, with alternatives for them.
//!
//! A doubt is a hint for readers and no verdict: the doubted words may be right.

use serde::{Deserialize, Serialize};
use std::cmp::Reverse;

/// How much words are doubted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoubtGrade {
    /// No evidence supports them.
    Uncertain,
    /// They are likely wrong.
    Likely,
}

impl DoubtGrade {
    /// Both, the stronger one first.
    pub const ALL: [Self; 2] = [Self::Likely, Self::Uncertain];

    /// Its name, in files and on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Uncertain => "uncertain",
            Self::Likely => "likely",
        }
    }

    /// The grade in words for readers.
    #[must_use]
    pub fn reader_label(self) -> &'static str {
        match self {
            Self::Uncertain => "uncertain",
            Self::Likely => "likely wrong",
        }
    }
}

/// Why words are doubted, the strongest cause first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoubtCause {
    /// A check found them wrong.
    Wrong,
    /// Other words would fit the path better.
    Change,
    /// They may mean several places or objects.
    Ambiguous,
    /// No evidence decides whether they are right.
    Unverified,
}

impl DoubtCause {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Wrong, Self::Change, Self::Ambiguous, Self::Unverified];

    /// Its name, in files and on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Wrong => "wrong",
            Self::Change => "change",
            Self::Ambiguous => "ambiguous",
            Self::Unverified => "unverified",
        }
    }
}

/// Words that may replace doubted ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DoubtAlternative {
    /// The words; `None` where the doubted words are better left out.
    pub words: Option<String>,
    /// How much better the text fits the path with them, natural logs; `None` where they are offered for another reason.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
}

/// Words that a reader should doubt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextDoubt {
    /// Their byte range in the text.
    pub span: [usize; 2],
    /// How much they are doubted.
    pub grade: DoubtGrade,
    /// Why, by its kind.
    pub cause: DoubtCause,
    /// Why, in a sentence.
    pub reason: String,
    /// Replacements, the best first; at most [`MAX_ALTERNATIVES`].
    pub alternatives: Vec<DoubtAlternative>,
}

/// Most alternatives of a doubt; the best are kept.
pub const MAX_ALTERNATIVES: usize = 3;
/// Most doubts of a text; the strongest are kept.
pub const MAX_DOUBTS: usize = 40;
/// The longest words of an alternative, bytes. An alternative with longer words is dropped.
const MAX_ALTERNATIVE_BYTES: usize = 200;

impl TextDoubt {
    /// The gain of its best alternative, natural logs; 0 where that is not known.
    #[must_use]
    pub fn best_gain(&self) -> f64 {
        self.alternatives.iter().filter_map(|alternative| alternative.gain).fold(0.0, f64::max)
    }

    /// Takes over the alternatives of a weaker doubt that lies within this one. They are extended to the words of this
    /// one.
    pub fn take_over(&mut self, text: &str, weaker: &Self) {
        let [from, to] = self.span;
        let around = (text.get(from..weaker.span[0]), text.get(weaker.span[1]..to));
        let (Some(before), Some(after)) = around else { return };
        for DoubtAlternative { words, gain } in &weaker.alternatives {
            let words = match words {
                Some(words) => Some(format!("{before}{words}{after}")),
                None if before.is_empty() && after.is_empty() => None,
                // Words that are left out within others leave too many blanks, or a capital, behind.
                None => continue,
            };
            self.alternatives.push(DoubtAlternative { words, gain: *gain });
        }
    }
}

/// The doubts of a text, in its order and without overlaps. Of two that overlap, the stronger one stays and takes over
/// the alternatives of the other. Doubts that lie outside the text, or begin or end within a character, are left out.
#[must_use]
pub fn separate_doubts(text: &str, doubts: Vec<TextDoubt>) -> Vec<TextDoubt> {
    let trimmed = doubts.into_iter().filter_map(|doubt| trim_doubt(text, doubt));
    let mut doubts: Vec<TextDoubt> = trimmed.collect();
    doubts.sort_by(|a, b| {
        let key = |doubt: &TextDoubt| (Reverse(doubt.grade), doubt.cause);
        key(a).cmp(&key(b)).then(b.best_gain().total_cmp(&a.best_gain())).then(a.span.cmp(&b.span))
    });
    let mut kept: Vec<TextDoubt> = Vec::new();
    for doubt in doubts {
        if let Some(stronger) = kept.iter_mut().find(|other| spans_overlap(other.span, doubt.span)) {
            stronger.take_over(text, &doubt);
        } else if kept.len() < MAX_DOUBTS {
            kept.push(doubt);
        }
    }
    kept.iter_mut().for_each(|doubt| tidy_alternatives(text, doubt));
    kept.sort_by_key(|doubt| doubt.span);
    kept
}

/// Cuts a text where doubts begin and end: each run of words, with the doubt about it. All runs together are the text. Doubts
/// that are out of order, overlap or do not lie in the text are left out, so they may come from a file.
pub fn split_at_doubts<'a, D>(
    text: &'a str,
    doubts: &'a [D],
    span: impl Fn(&D) -> [usize; 2],
) -> Vec<(&'a str, Option<&'a D>)> {
    let mut parts = Vec::new();
    // The byte up to which the text is cut.
    let mut cut_to = 0;
    for doubt in doubts {
        let [from, to] = span(doubt);
        let (Some(before), Some(words)) = (text.get(cut_to..from), text.get(from..to)) else { continue };
        if words.is_empty() {
            continue;
        }
        parts.extend((!before.is_empty()).then_some((before, None)));
        parts.push((words, Some(doubt)));
        cut_to = to;
    }
    let rest = &text[cut_to..];
    parts.extend((!rest.is_empty()).then_some((rest, None)));
    parts
}

/// Whether two byte ranges share a byte.
#[must_use]
pub fn spans_overlap(a: [usize; 2], b: [usize; 2]) -> bool {
    a[0] < b[1] && b[0] < a[1]
}

/// A doubt without the blanks and marks around its words; `None` where no word is left.
fn trim_doubt(text: &str, doubt: TextDoubt) -> Option<TextDoubt> {
    let words = text.get(doubt.span[0]..doubt.span[1])?;
    let is_around = |c: char| c.is_whitespace() || matches!(c, '.' | ',' | ';' | ':' | '!' | '?');
    let after_start = words.trim_start_matches(is_around);
    let from = doubt.span[1] - after_start.len();
    let to = from + after_start.trim_end_matches(is_around).len();
    (from < to).then_some(TextDoubt { span: [from, to], ..doubt })
}

/// Sorts the alternatives of a doubt: first those with an unknown gain, then by gain, the best first. Drops
/// duplicates, alternatives that repeat the doubted words, and all beyond [`MAX_ALTERNATIVES`].
fn tidy_alternatives(text: &str, doubt: &mut TextDoubt) {
    let doubted_words = text[doubt.span[0]..doubt.span[1]].to_lowercase();
    let mut seen: Vec<Option<String>> = vec![Some(doubted_words)];
    let gain = |alternative: &DoubtAlternative| alternative.gain.unwrap_or(f64::INFINITY);
    doubt.alternatives.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    doubt.alternatives.retain(|DoubtAlternative { words, .. }| {
        let key = words.as_ref().map(|words| words.to_lowercase());
        let is_fit =
            words.as_ref().is_none_or(|words| !words.trim().is_empty() && words.len() <= MAX_ALTERNATIVE_BYTES);
        let is_new = is_fit && !seen.contains(&key);
        seen.push(key);
        is_new
    });
    doubt.alternatives.truncate(MAX_ALTERNATIVES);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seeded_rng;
    use rand::Rng;

    fn doubt(span: [usize; 2], grade: DoubtGrade, words: &[(Option<&str>, f64)]) -> TextDoubt {
        let alternative = |(words, gain): &(Option<&str>, f64)| DoubtAlternative {
            words: words.map(str::to_owned),
            gain: Some(*gain),
        };
        let alternatives = words.iter().map(alternative).collect();
        TextDoubt { span, grade, cause: DoubtCause::Change, reason: "r".into(), alternatives }
    }

    fn told(doubts: &[TextDoubt]) -> Vec<([usize; 2], Vec<Option<&str>>)> {
        doubts
            .iter()
            .map(|doubt| (doubt.span, doubt.alternatives.iter().map(|one| one.words.as_deref()).collect()))
            .collect()
    }

    const TEXT: &str = "Walk on. Turn left.";

    #[test]
    fn doubts_of_the_same_words_are_one_with_the_best_alternative_first() {
        let turn = [9, 18];
        let doubts = vec![
            doubt(turn, DoubtGrade::Uncertain, &[(Some("Turn right"), 1.0), (Some("turn LEFT"), 9.0)]),
            doubt(turn, DoubtGrade::Likely, &[(None, 3.0)]),
        ];
        let apart = separate_doubts(TEXT, doubts);
        assert_eq!(told(&apart), [(turn, vec![None, Some("Turn right")])]);
        assert_eq!(apart[0].grade, DoubtGrade::Likely);
    }

    #[test]
    fn separate_doubts_gives_the_stronger_doubt_the_alternatives_of_the_weaker() {
        let doubts = vec![
            doubt([0, 19], DoubtGrade::Likely, &[(None, 5.0)]),
            doubt([14, 18], DoubtGrade::Uncertain, &[(Some("right"), 1.0), (None, 2.0)]),
        ];
        assert_eq!(told(&separate_doubts(TEXT, doubts)), [([0, 18], vec![None, Some("Walk on. Turn right")])]);
    }

    #[test]
    fn marks_and_blanks_around_words_are_not_doubted() {
        let doubts = vec![doubt([7, 19], DoubtGrade::Uncertain, &[]), doubt([7, 9], DoubtGrade::Uncertain, &[])];
        assert_eq!(told(&separate_doubts(TEXT, doubts)), [([9, 18], vec![])]);
    }

    #[test]
    fn separate_doubts_sorts_and_separates_any_spans() {
        let texts = ["", "a", "Go on.", "Türe – 門 hinter 🪑", "\u{202e}e\u{301}x . , and so on , left ."];
        let mut random = seeded_rng(7, &["doubts"]);
        for text in texts.iter().cycle().take(3000) {
            let doubts: Vec<TextDoubt> = (0..8)
                .map(|at| {
                    let mut place = || random.random_range(0..=text.len() + 2);
                    let span = [place(), place()];
                    let grade = DoubtGrade::ALL[at % 2];
                    doubt(span, grade, &[(Some("x"), 1.0), (None, 2.0), (Some("y"), 3.0), (Some("ß"), f64::NAN)])
                })
                .collect();
            let raw: String = split_at_doubts(text, &doubts, |doubt| doubt.span).iter().map(|part| part.0).collect();
            assert_eq!(raw, *text, "doubts of a file may be anything");
            let apart = separate_doubts(text, doubts);
            for doubt in &apart {
                assert!(!text[doubt.span[0]..doubt.span[1]].trim().is_empty());
                assert!(doubt.alternatives.len() <= MAX_ALTERNATIVES);
            }
            assert!(apart.windows(2).all(|pair| pair[0].span[1] <= pair[1].span[0]));
            let parts = split_at_doubts(text, &apart, |doubt| doubt.span);
            assert_eq!(parts.iter().map(|part| part.0).collect::<String>(), *text);
            assert_eq!(parts.iter().filter(|part| part.1.is_some()).count(), apart.len());
        }
    }
}
