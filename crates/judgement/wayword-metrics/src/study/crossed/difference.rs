//! Differences between two conditions that may share persons and items.
//!
//! The variance of the difference is that of one sum of errors over both conditions, so the effects that a person or an item has
//! on both of them cancel. For shares, the interval combines those of the two shares (Zou and Donner 2008, "MOVER"), with the
//! correlation that this variance implies. For independent answers that is Newcombe's hybrid score interval (1998, method 10).

use super::{AnswerGroups, IntervalMethod, StudyFigure, error_contributions, quantile, symmetric_interval};
use crate::study::{ConfidenceInterval, StudyAnswer};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The difference between two shares or means: the first minus the second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FigureDifference {
    /// The difference.
    pub value: f64,
    /// Its interval, where one can be made.
    pub interval: Option<ConfidenceInterval>,
    /// Its standard error, where it is above 0 and both conditions have several persons and items.
    pub se: Option<f64>,
    /// How the interval was made.
    pub method: IntervalMethod,
    /// The correlation of the two figures, through persons and items that are in both conditions.
    pub correlation: f64,
    /// The first condition's figure.
    pub first: StudyFigure,
    /// The second condition's.
    pub second: StudyFigure,
}

/// The difference between the shares of two conditions. `None` where one of the two has no [`answer_share`](super::answer_share).
#[must_use]
pub fn share_difference<P: Ord, I: Ord>(
    first: &[StudyAnswer<P, I>],
    second: &[StudyAnswer<P, I>],
    level: f64,
) -> Option<FigureDifference> {
    let both = ConditionPair::from_answers(
        first,
        second,
        [super::answer_share(first, level)?, super::answer_share(second, level)?],
    );
    let interval = both.hybrid_interval();
    Some(both.into_difference(IntervalMethod::Wilson, IntervalMethod::Newcombe, interval))
}

/// The difference between the means of two conditions. `None` where one of the two has no [`answer_mean`](super::answer_mean).
#[must_use]
pub fn mean_difference<P: Ord, I: Ord>(
    first: &[StudyAnswer<P, I>],
    second: &[StudyAnswer<P, I>],
    level: f64,
) -> Option<FigureDifference> {
    let both = ConditionPair::from_answers(
        first,
        second,
        [super::answer_mean(first, level)?, super::answer_mean(second, level)?],
    );
    let interval = both.linear_interval(level);
    Some(both.into_difference(IntervalMethod::Student, IntervalMethod::Student, interval))
}

/// Two conditions together.
struct ConditionPair {
    figures: [StudyFigure; 2],
    /// The standard error of the difference, where it is above 0.
    se: Option<f64>,
    /// The correlation of the two figures.
    correlation: f64,
    /// Whether no person and no item is in both.
    is_apart: bool,
    /// The number of persons or of items that the error is estimated from, whichever is smaller.
    fewest: usize,
}

impl ConditionPair {
    fn from_answers<P: Ord, I: Ord>(
        first: &[StudyAnswer<P, I>],
        second: &[StudyAnswer<P, I>],
        figures: [StudyFigure; 2],
    ) -> Self {
        let groups = AnswerGroups::from_pairs(first.iter().chain(second).map(|answer| (&answer.person, &answer.item)));
        let mut all = error_contributions(first, figures[0].value);
        all.extend(error_contributions(second, figures[1].value).into_iter().map(|error| -error));
        let [(shares_persons, person_count), (shares_items, item_count)] = [
            find_shared(first, second, &figures, |answer| &answer.person, |figure| figure.persons),
            find_shared(first, second, &figures, |answer| &answer.item, |figure| figure.items),
        ];
        let is_apart = !shares_persons && !shares_items;
        let fewest = person_count.min(item_count);
        let squares = figures.each_ref().map(|figure| figure.se.map_or(0.0, |se| se * se));
        let independent_variance = squares[0] + squares[1];
        let variance = if is_apart { independent_variance } else { groups.variance_parts(&all, 2).variance() };
        let product = 2.0 * (squares[0] * squares[1]).sqrt();
        let correlation =
            if product > 0.0 { ((independent_variance - variance) / product).clamp(-1.0, 1.0) } else { 0.0 };
        // A condition of one person or one item is no sample, also where the other condition has several.
        let is_sample = figures.iter().all(|figure| figure.persons > 1 && figure.items > 1);
        Self { figures, se: Some(variance.sqrt()).filter(|se| is_sample && *se > 0.0), correlation, is_apart, fewest }
    }

    fn value(&self) -> f64 {
        self.figures[0].value - self.figures[1].value
    }

    /// Student's interval, as for a single mean.
    fn linear_interval(&self, level: f64) -> Option<ConfidenceInterval> {
        let half = self.se? * quantile::student_quantile(0.5 + level / 2.0, self.fewest - 1)?;
        Some(symmetric_interval(self.value(), half))
    }

    /// The hybrid interval: combines the distances of the two figures from the ends of their intervals like correlated errors.
    fn hybrid_interval(&self) -> Option<ConfidenceInterval> {
        let [first, second] = &self.figures;
        let (first_ends, second_ends) = (first.interval?, second.interval?);
        let together = |a: f64, b: f64| (a * a + b * b - 2.0 * self.correlation * a * b).max(0.0).sqrt();
        let low = self.value() - together(first.value - first_ends.low, second_ends.high - second.value);
        let high = self.value() + together(first_ends.high - first.value, second.value - second_ends.low);
        Some(ConfidenceInterval { low: low.max(-1.0), high: high.min(1.0) })
    }

    /// The difference. Its method is `together` if both figures have the method `each` and share no person or item, and clustered
    /// otherwise.
    fn into_difference(
        self,
        each: IntervalMethod,
        together: IntervalMethod,
        interval: Option<ConfidenceInterval>,
    ) -> FigureDifference {
        let is_simple = self.is_apart && self.figures.iter().all(|figure| figure.method == each);
        let method = if is_simple { together } else { IntervalMethod::Clustered };
        let value = self.value();
        let Self { figures: [first, second], se, correlation, .. } = self;
        let method = if interval.is_some() { method } else { IntervalMethod::None };
        FigureDifference { value, interval, se, method, correlation, first, second }
    }
}

/// Whether any person (or item) is in both conditions, and the number to use for the degrees of freedom: all distinct ones if some
/// are in both, and otherwise those of the condition with fewer, because its error is known least.
fn find_shared<'a, P, I, T: Ord + 'a>(
    first: &'a [StudyAnswer<P, I>],
    second: &'a [StudyAnswer<P, I>],
    figures: &[StudyFigure; 2],
    id: impl Fn(&'a StudyAnswer<P, I>) -> &'a T,
    count: impl Fn(&StudyFigure) -> usize,
) -> (bool, usize) {
    let all: BTreeSet<&T> = first.iter().chain(second).map(id).collect();
    let [first_count, second_count] = figures.each_ref().map(count);
    let is_shared = all.len() < first_count + second_count;
    (is_shared, if is_shared { all.len() } else { first_count.min(second_count) })
}
