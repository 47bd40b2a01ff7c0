//! Computes the figures of all conditions under one rule of which participants count. The report has two versions: all participants,
//! and only those who finished and passed the attention checks.

use super::{
    LEVEL,
    given::{Answered, Given, Whose},
    measure::{Measure, MeasureKind},
    pairs::Pairs,
};
use crate::{Data, Kind, Mode, wording::Scale};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use wayword_metrics::{
    Agreement, Answer, Difference, Figure, Interval, agreement, mean, mean_difference, share, share_difference,
};

/// The figures under one rule of which participants count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Version {
    /// A short name: `everybody` or `finished`.
    pub name: &'static str,
    /// Which answers count, in words.
    pub rule: &'static str,
    /// How many participants gave an answer that counts.
    pub persons: usize,
    /// How many answers count.
    pub answers: usize,
    /// One for each condition, in the order of the plan.
    pub rows: Vec<Row>,
    /// Each condition minus the first one. Empty where texts are compared; [`Version::pairs`] then has the comparisons.
    pub differences: Vec<Less>,
    /// How well participants who judged the same item agree.
    pub agreement: Vec<Agreed>,
    /// The results of the comparisons, where texts are compared.
    pub pairs: Option<Pairs>,
}

/// The figures of a condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Its name.
    pub condition: String,
    /// Where its texts come from.
    pub kind: Kind,
    /// Whether it is a control: people's texts, or those of another path.
    pub is_control: bool,
    /// How many answers it has.
    pub answers: usize,
    /// How many people gave them.
    pub persons: usize,
    /// How many routes they are about.
    pub items: usize,
    /// The figures, by name. A figure without any value is left out.
    pub figures: BTreeMap<&'static str, Figure>,
    /// How often each level was chosen, by the name of the question.
    pub levels: BTreeMap<&'static str, [usize; 5]>,
}

/// A condition minus the first one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Less {
    /// The condition.
    pub condition: String,
    /// The first one.
    pub minus: String,
    /// The differences, by the name of the figure.
    pub figures: BTreeMap<&'static str, Difference>,
}

/// How well participants who judged the same item agree on one question.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreed {
    /// The name of the question.
    pub name: &'static str,
    /// Krippendorff's alpha; `None` if no item has two answers, or all answers are the same.
    pub alpha: Option<Agreement>,
}

/// The name under which a choice between texts is listed among questions.
pub(super) const CHOICE: &str = "choice";

impl Version {
    pub(super) fn new(data: &Data, answered: &[Answered<'_>], whose: Whose, most_failed: usize) -> Self {
        let taken: Vec<&Answered<'_>> =
            answered.iter().filter(|one| whose.takes(one.participant, most_failed)).collect();
        let given: Vec<Given<'_>> = taken.iter().flat_map(|one| one.given(data)).collect();
        let measures = Measure::of_mode(data.plan.mode);
        let scales = super::scales(data.plan.mode);
        let rows = (0..data.plan.conditions.len()).map(|at| row(data, &given, at, measures, scales)).collect();
        let is_pair = data.plan.mode == Mode::Pair;
        let others = if is_pair { 0..0 } else { 1..data.plan.conditions.len() };
        let (name, rule) = match whose {
            Whose::Everybody => (
                "everybody",
                "All answers, also of those who did not finish or failed attention checks; none of those who were screened out.",
            ),
            Whose::Finished => ("finished", "Only answers of those who finished and passed the attention checks."),
        };
        Self {
            name,
            rule,
            persons: taken.iter().map(|one| one.person).collect::<BTreeSet<_>>().len(),
            answers: taken.len(),
            rows,
            differences: others.map(|at| less(data, &given, at, measures)).collect(),
            agreement: agreed(data, &taken, scales),
            pairs: is_pair.then(|| Pairs::new(data, &taken)),
        }
    }
}

fn row(data: &Data, given: &[Given<'_>], at: usize, measures: &[Measure], scales: &'static [Scale]) -> Row {
    let condition = &data.plan.conditions[at];
    let own: Vec<&Given<'_>> = given.iter().filter(|one| one.condition == at).collect();
    let figure = |measure: &Measure| {
        let values = values(&own, measure);
        let figure = match measure.kind {
            MeasureKind::Share => share(&values, LEVEL),
            MeasureKind::Mean => mean(&values, LEVEL),
        };
        figure.map(|figure| (measure.name, within(figure, measure)))
    };
    let levels = |(number, scale): (usize, &Scale)| {
        let mut counts = [0; 5];
        for level in own.iter().filter_map(|one| one.levels.get(number)) {
            if let Some(count) = usize::from(*level).checked_sub(1).and_then(|at| counts.get_mut(at)) {
                *count += 1;
            }
        }
        (scale.name, counts)
    };
    Row {
        condition: condition.name.clone(),
        kind: condition.kind,
        is_control: condition.kind != Kind::Run,
        answers: own.len(),
        persons: own.iter().map(|one| one.person).collect::<BTreeSet<_>>().len(),
        items: own.iter().map(|one| one.route).collect::<BTreeSet<_>>().len(),
        figures: measures.iter().filter_map(figure).collect(),
        levels: scales.iter().enumerate().map(levels).collect(),
    }
}

fn less(data: &Data, given: &[Given<'_>], at: usize, measures: &[Measure]) -> Less {
    let of = |at: usize| given.iter().filter(move |one| one.condition == at).collect::<Vec<_>>();
    let (this, first) = (of(at), of(0));
    let difference = |measure: &Measure| {
        let (this, first) = (values(&this, measure), values(&first, measure));
        let difference = match measure.kind {
            MeasureKind::Share => share_difference(&this, &first, LEVEL),
            MeasureKind::Mean => mean_difference(&this, &first, LEVEL),
        };
        difference.map(|difference| (measure.name, apart(difference, measure)))
    };
    let name = |at: usize| data.plan.conditions[at].name.clone();
    Less { condition: name(at), minus: name(0), figures: measures.iter().filter_map(difference).collect() }
}

/// The values of a figure. Conditions share routes, so the route is the item for the statistics.
fn values(given: &[&Given<'_>], measure: &Measure) -> Vec<Answer<usize, u32>> {
    let answer =
        |one: &&Given<'_>| measure.value(one).map(|value| Answer { person: one.person, item: one.route, value });
    given.iter().filter_map(answer).collect()
}

/// Clips the interval of a figure to the range of its values.
fn within(mut figure: Figure, measure: &Measure) -> Figure {
    let [low, high] = measure.range;
    figure.interval = figure.interval.map(|interval| cut(&interval, low, high));
    figure
}

/// Clips the interval of a difference to the range that differences of two values can have.
fn apart(mut difference: Difference, measure: &Measure) -> Difference {
    if let [Some(low), Some(high)] = measure.range {
        difference.interval = difference.interval.map(|interval| cut(&interval, Some(low - high), Some(high - low)));
    }
    difference.first = within(difference.first, measure);
    difference.second = within(difference.second, measure);
    difference
}

fn cut(interval: &Interval, low: Option<f64>, high: Option<f64>) -> Interval {
    let (low, high) = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
    Interval { low: interval.low.clamp(low, high), high: interval.high.clamp(low, high) }
}

/// Agreement of those who judged the same item: by levels, or by the choice between its texts.
fn agreed(data: &Data, taken: &[&Answered<'_>], scales: &'static [Scale]) -> Vec<Agreed> {
    let alpha = |values: &[Answer<usize, u32>], scale| agreement(values, scale, LEVEL);
    if data.plan.mode == Mode::Pair {
        let values: Vec<Answer<usize, u32>> = taken.iter().filter_map(|one| choice(one)).collect();
        return vec![Agreed { name: CHOICE, alpha: alpha(&values, wayword_metrics::Scale::Nominal) }];
    }
    let of = |(number, scale): (usize, &'static Scale)| {
        let value = |one: &&Answered<'_>| {
            let value = f64::from(*one.levels().get(number)?);
            Some(Answer { person: one.person, item: one.item.id, value })
        };
        let values: Vec<Answer<usize, u32>> = taken.iter().filter_map(value).collect();
        Agreed { name: scale.name, alpha: alpha(&values, wayword_metrics::Scale::Ordinal) }
    };
    scales.iter().enumerate().map(of).collect()
}

/// A choice as a number that does not depend on the sides: the item's first text, its second, a tie, both bad.
fn choice(one: &Answered<'_>) -> Option<Answer<usize, u32>> {
    let value = match one.answer {
        crate::Answer::Pair { choice: crate::Choice::Tie } => 2.0,
        crate::Answer::Pair { choice: crate::Choice::Bad } => 3.0,
        _ => one.preferred()? as f64,
    };
    Some(Answer { person: one.person, item: one.item.id, value })
}
