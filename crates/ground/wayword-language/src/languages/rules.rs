//! The rules of a pack: patterns of classes, and the English that they become.

use super::chunks::{Chunk, ChunkSense, GlossWord};
use crate::data;
use std::collections::HashMap;

/// The rules of one stage. At each place the first that fits is taken.
#[derive(Debug)]
pub(super) struct RuleStage(Vec<GlossRule>);

/// Chunks of these classes become one chunk of that class.
#[derive(Debug)]
struct GlossRule {
    class: &'static str,
    pattern: Vec<PatternPart>,
    english: Vec<EnglishPart>,
}

/// A number of chunks of one of some classes.
#[derive(Debug)]
struct PatternPart {
    classes: Vec<&'static str>,
    least: usize,
    most: usize,
}

#[derive(Debug)]
enum EnglishPart {
    /// A word of its own.
    Word(&'static str),
    /// The words of a part of the pattern, by its index.
    Part(usize),
}

/// The classes of each group that a file names.
type ClassGroups = HashMap<&'static str, Vec<&'static str>>;

/// Most chunks of a repeated part.
const MAX_REPEATS: usize = 8;

/// The stages of a file, or the first line that is no rule.
pub(super) fn parse_stages(file: &'static str) -> Result<Vec<RuleStage>, &'static str> {
    let mut stages = vec![RuleStage(Vec::new())];
    let mut groups = ClassGroups::new();
    for line in data::content_lines(file) {
        if data::list_name(line).is_some() {
            stages.push(RuleStage(Vec::new()));
        } else if let Some((name, classes)) = line.split_once(" = ") {
            groups.insert(name, classes.split('|').collect());
        } else {
            let rule = GlossRule::parse(line, &groups).ok_or(line)?;
            stages.last_mut().ok_or(line)?.0.push(rule);
        }
    }
    Ok(stages)
}

impl RuleStage {
    /// Goes over the chunks once.
    pub(super) fn apply(&self, chunks: &[Chunk]) -> Vec<Chunk> {
        let mut done = Vec::with_capacity(chunks.len());
        let mut rest = chunks;
        while let Some(first) = rest.first() {
            let fitting = self.0.iter().find_map(|rule| Some((rule, rule.match_start(rest)?)));
            let (chunk, taken) = match fitting {
                Some((rule, counts)) => (rule.make_chunk(rest, &counts), counts.iter().sum()),
                None => (first.clone(), 1),
            };
            done.push(chunk);
            rest = &rest[taken..];
        }
        done
    }
}

impl GlossRule {
    /// Reads "class: pattern -> English".
    fn parse(line: &'static str, groups: &ClassGroups) -> Option<Self> {
        let (class, rest) = line.split_once(':')?;
        let (pattern, english) = rest.split_once("->")?;
        let pattern: Vec<PatternPart> =
            pattern.split_whitespace().map(|part| PatternPart::parse(part, groups)).collect();
        let english = english.split_whitespace().map(|word| match word.strip_prefix('$') {
            Some(number) => {
                let index = number.parse::<usize>().ok()?.checked_sub(1)?;
                (index < pattern.len()).then_some(EnglishPart::Part(index))
            }
            None => Some(EnglishPart::Word(word)),
        });
        let english = english.collect::<Option<_>>()?;
        Some(Self { class, pattern, english })
    }

    /// How many chunks each part of the pattern takes, where it fits at the beginning of `chunks`.
    fn match_start(&self, chunks: &[Chunk]) -> Option<Vec<usize>> {
        let mut counts = Vec::with_capacity(self.pattern.len());
        let fits = count_parts(&self.pattern, chunks, &mut counts);
        (fits && counts.iter().any(|count| *count > 0)).then_some(counts)
    }

    fn make_chunk(&self, chunks: &[Chunk], counts: &[usize]) -> Chunk {
        let mut from = 0;
        let parts = self.pattern.iter().zip(counts).map(|(part, count)| {
            let taken = &chunks[from..from + count];
            from += count;
            taken.iter().filter_map(|chunk| chunk.sense(&part.classes)).flat_map(|sense| sense.words.clone()).collect()
        });
        let parts: Vec<Vec<GlossWord>> = parts.collect();
        let mut sources = self.sources_of_own_words(&parts).into_iter();
        let words = self.english.iter().flat_map(|part| match part {
            EnglishPart::Word(word) => {
                vec![GlossWord { word: (*word).to_owned(), source: sources.next().flatten() }]
            }
            EnglishPart::Part(index) => parts[*index].clone(),
        });
        Chunk { senses: vec![ChunkSense { class: self.class, words: words.collect() }] }
    }

    /// For each of its own English words, the words of the text that it replaces: those of a part that the English does not repeat. The first
    /// run of own words replaces the first such part, and so on; the last run all that are left.
    fn sources_of_own_words(&self, parts: &[Vec<GlossWord>]) -> Vec<Option<[usize; 2]>> {
        let is_repeated =
            |index: usize| self.english.iter().any(|part| matches!(part, EnglishPart::Part(own) if *own == index));
        let hull = |spans: &mut dyn Iterator<Item = [usize; 2]>| spans.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let replaced = parts.iter().enumerate().filter(|(index, _)| !is_repeated(*index));
        let replaced: Vec<[usize; 2]> =
            replaced.filter_map(|(_, words)| hull(&mut words.iter().filter_map(|word| word.source))).collect();
        let own_runs = self.english.split(|part| matches!(part, EnglishPart::Part(_))).filter(|run| !run.is_empty());
        let own_runs: Vec<usize> = own_runs.map(<[EnglishPart]>::len).collect();
        let last = own_runs.len().saturating_sub(1);
        let source = |run: usize| match replaced.get(run.min(replaced.len().saturating_sub(1))..) {
            Some(left) if run == last => hull(&mut left.iter().copied()),
            left => left.and_then(|left| left.first()).copied(),
        };
        own_runs.iter().enumerate().flat_map(|(run, words)| std::iter::repeat_n(source(run), *words)).collect()
    }
}

impl PatternPart {
    fn parse(part: &'static str, groups: &ClassGroups) -> Self {
        let (name, least, most) = match part.char_indices().next_back() {
            Some((end, '?')) => (&part[..end], 0, 1),
            Some((end, '*')) => (&part[..end], 0, MAX_REPEATS),
            Some((end, '+')) => (&part[..end], 1, MAX_REPEATS),
            _ => (part, 1, 1),
        };
        let members = |class| groups.get(class).cloned().unwrap_or_else(|| vec![class]);
        Self { classes: name.split('|').flat_map(members).collect(), least, most }
    }
}

/// Finds out how many chunks each part takes: as many as it can so that the rest fits as well.
fn count_parts(pattern: &[PatternPart], chunks: &[Chunk], counts: &mut Vec<usize>) -> bool {
    let Some((part, rest)) = pattern.split_first() else { return true };
    let most = chunks.iter().take(part.most).take_while(|chunk| chunk.sense(&part.classes).is_some()).count();
    (part.least..=most).rev().any(|count| {
        counts.push(count);
        let fits = count_parts(rest, &chunks[count..], counts);
        if !fits {
            counts.pop();
        }
        fits
    })
}
