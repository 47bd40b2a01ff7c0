//! Wilson's interval of a share of independent answers. Unlike the textbook interval it stays within 0 and 1 and is right for few
//! answers and for shares near 0 or 1.

use super::{ConfidenceInterval, is_level, quantile};

/// Wilson's score interval of a share (Wilson 1927; without a correction for continuity).
///
/// Counts may be fractions, because the number of answers can be an effective number. `None` if there are no answers, more
/// successes than answers, or the level is not between 0 and 1.
#[must_use]
pub fn wilson_interval(successes: f64, answers: f64, level: f64) -> Option<ConfidenceInterval> {
    let is_count = answers > 0.0 && answers.is_finite() && (0.0..=answers).contains(&successes);
    (is_count && is_level(level)).then(|| {
        let z = quantile::normal_quantile(0.5 + level / 2.0);
        let share = successes / answers;
        let shrink = 1.0 + z * z / answers;
        let centre = (share + z * z / (2.0 * answers)) / shrink;
        let spread = (share * (1.0 - share) / answers + z * z / (4.0 * answers * answers)).sqrt();
        let half = z * spread / shrink;
        // For shares of 0 and 1 the end is exactly 0 or 1; rounding would give a slightly different number.
        let low = if successes == 0.0 { 0.0 } else { (centre - half).max(0.0) };
        let high = if successes == answers { 1.0 } else { (centre + half).min(1.0) };
        ConfidenceInterval { low, high }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The study of the paper: shares of 30 people, in percent, with their intervals.
    #[test]
    fn the_papers_shares_have_these_intervals() {
        let published =
            [(25, "83.3 [66.4, 92.7]"), (22, "73.3 [55.6, 85.8]"), (13, "43.3 [27.4, 60.8]"), (5, "16.7 [7.3, 33.6]")];
        for (successes, expected) in published {
            let successes = f64::from(successes);
            let ConfidenceInterval { low, high } = wilson_interval(successes, 30.0, 0.95).unwrap();
            let [share, low, high] = [successes / 30.0, low, high].map(|share| 100.0 * share);
            assert_eq!(format!("{share:.1} [{low:.1}, {high:.1}]"), expected);
        }
    }

    #[test]
    fn wilson_is_none_for_impossible_counts() {
        for (successes, answers, level) in
            [(0.0, 0.0, 0.95), (3.0, 2.0, 0.95), (-1.0, 2.0, 0.95), (1.0, 2.0, 1.0), (f64::NAN, 2.0, 0.5)]
        {
            assert_eq!(wilson_interval(successes, answers, level), None);
        }
    }

    proptest! {
        #[test]
        fn the_interval_holds_the_share_and_stays_within_0_and_1(answers in 1..500u32, part in 0.0..=1.0f64, level in 0.01..0.999f64) {
            let successes = (f64::from(answers) * part).floor();
            let found = wilson_interval(successes, f64::from(answers), level).unwrap();
            let share = successes / f64::from(answers);
            prop_assert!(0.0 <= found.low && found.low <= share && share <= found.high && found.high <= 1.0, "{:?}", found);
        }

        #[test]
        fn failures_mirror_successes(answers in 1..500u32, part in 0.0..=1.0f64) {
            let (answers, successes) = (f64::from(answers), (f64::from(answers) * part).floor());
            let (of, other) = (wilson_interval(successes, answers, 0.95).unwrap(), wilson_interval(answers - successes, answers, 0.95).unwrap());
            prop_assert!((of.low + other.high - 1.0).abs() < 1e-12 && (of.high + other.low - 1.0).abs() < 1e-12);
        }
    }
}
