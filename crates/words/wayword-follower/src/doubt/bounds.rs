//! The gains from which words are doubted.

use super::DoubtSource;
use wayword_core::DoubtGrade;

/// The gains from which words of one source are doubted, natural logs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubtBound {
    /// Words with a larger gain than this are uncertain.
    pub uncertain: f64,
    /// Words with a larger gain than this are likely wrong.
    pub likely: f64,
}

/// The bounds of all sources.
#[derive(Debug, Clone, PartialEq)]
pub struct DoubtBounds([DoubtBound; DoubtSource::ALL.len()]);

impl DoubtBounds {
    /// The grade of a doubt for a gain; `None` if the gain is too small for a doubt.
    #[must_use]
    pub fn grade_gain(&self, source: DoubtSource, gain: f64) -> Option<DoubtGrade> {
        let bound = self.for_source(source);
        if gain > bound.likely {
            Some(DoubtGrade::Likely)
        } else if gain > bound.uncertain {
            Some(DoubtGrade::Uncertain)
        } else {
            None
        }
    }

    /// Bounds that doubt all words with any gain.
    #[cfg(test)]
    pub(crate) fn all() -> Self {
        Self(DoubtSource::ALL.map(|_| DoubtBound { uncertain: 0.0, likely: 1.0 }))
    }

    /// The bounds of a source.
    #[must_use]
    pub fn for_source(&self, source: DoubtSource) -> DoubtBound {
        self.0[source as usize]
    }
}

impl Default for DoubtBounds {
    /// Bounds that give the shares of doubted words in people's texts of R2R's train split in docs/CHECKS.md, measured
    /// by `wayword-measure doubts`.
    fn default() -> Self {
        let bound = |source| {
            let (uncertain, likely) = match source {
                DoubtSource::Turn => (1.0, 2.0),
                DoubtSource::NoTurn => (2.0, 2.7),
                DoubtSource::Side => (1.4, 1.7),
                DoubtSource::Climb => (0.1, 0.2),
                DoubtSource::NoStep => (5.3, 5.7),
                DoubtSource::Way => (1.8, 2.2),
                DoubtSource::Place => (3.6, 4.2),
                DoubtSource::Unknown => (2.0, 2.2),
                DoubtSource::Swap => (2.4, 3.0),
            };
            DoubtBound { uncertain, likely }
        };
        Self(DoubtSource::ALL.map(bound))
    }
}
