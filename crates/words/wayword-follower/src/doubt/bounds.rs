//! The gains from which words are doubted.

use super::Source;
use wayword_core::Grade;

/// The gains from which words of one source are doubted, natural logs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bound {
    /// From here on they are uncertain.
    pub uncertain: f64,
    /// From here on they are likely wrong.
    pub likely: f64,
}

/// The bounds of all sources.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds([Bound; Source::ALL.len()]);

impl Bounds {
    /// The grade of a doubt for a gain; `None` if the gain is too small for a doubt.
    #[must_use]
    pub fn grade(&self, source: Source, gain: f64) -> Option<Grade> {
        let bound = self.of(source);
        if gain > bound.likely {
            Some(Grade::Likely)
        } else if gain > bound.uncertain {
            Some(Grade::Uncertain)
        } else {
            None
        }
    }

    /// Bounds that doubt all words with any gain.
    #[cfg(test)]
    pub(crate) fn all() -> Self {
        Self(Source::ALL.map(|_| Bound { uncertain: 0.0, likely: 1.0 }))
    }

    /// The bounds of a source.
    #[must_use]
    pub fn of(&self, source: Source) -> Bound {
        self.0[source as usize]
    }
}

impl Default for Bounds {
    /// Bounds that give the shares of doubted words in people's texts of R2R's train split in docs/CHECKS.md, measured
    /// by `wayword-measure doubts`.
    fn default() -> Self {
        let bound = |source| {
            let (uncertain, likely) = match source {
                Source::Turn => (1.0, 2.0),
                Source::NoTurn => (2.0, 2.7),
                Source::Side => (1.4, 1.7),
                Source::Climb => (0.1, 0.2),
                Source::NoStep => (5.3, 5.7),
                Source::Way => (1.8, 2.2),
                Source::Place => (3.6, 4.2),
                Source::Unknown => (2.0, 2.2),
                Source::Swap => (2.4, 3.0),
            };
            Bound { uncertain, likely }
        };
        Self(Source::ALL.map(bound))
    }
}
