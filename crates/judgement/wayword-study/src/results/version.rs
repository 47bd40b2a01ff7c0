//! Computes the figures of all conditions under one rule of which participants count. The report has two versions: all participants,
//! and only those who finished and passed the attention checks.

use super::{
    CONFIDENCE_LEVEL,
    exclusions::counts_answer,
    judgements::{AnsweredItem, ParticipantFilter, TextJudgement},
    measure::{MeasureKind, StudyMeasure},
    pairs::PairResults,
};
use crate::{ConditionKind, StudyData, StudyTask, wording::RatingScale};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use wayword_metrics::{
    ConfidenceInterval, FigureDifference, RaterAgreement, StudyAnswer, StudyFigure, answer_mean, answer_share,
    krippendorff_alpha, mean_difference, share_difference,
};

/// The figures under one rule of which participants count.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResultVersion {
    /// A short name: `everybody`, `finished` or `kept`.
    pub name: &'static str,
    /// Its heading.
    #[serde(skip)]
    pub(super) title: &'static str,
    /// Which answers count, in words.
    pub rule: &'static str,
    /// How many participants gave an answer that counts.
    pub persons: usize,
    /// How many answers count.
    pub answers: usize,
    /// One for each condition, in the order of the plan.
    pub rows: Vec<ConditionRow>,
    /// Each condition minus the first one. Empty where texts are compared; [`ResultVersion::pairs`] then has the comparisons.
    pub differences: Vec<ConditionDifference>,
    /// How well participants who judged the same item agree.
    pub agreement: Vec<QuestionAgreement>,
    /// The results of the comparisons, where texts are compared.
    pub pairs: Option<PairResults>,
}

/// The figures of a condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionRow {
    /// Its name.
    pub condition: String,
    /// Where its texts come from.
    pub kind: ConditionKind,
    /// Whether it is a control: people's texts, or those of another path.
    pub is_control: bool,
    /// How many answers it has.
    pub answers: usize,
    /// How many people gave them.
    pub persons: usize,
    /// How many routes they are about.
    pub items: usize,
    /// The figures, by name. A figure without any value is left out.
    pub figures: BTreeMap<&'static str, StudyFigure>,
    /// How often each level was chosen, by the name of the question.
    pub levels: BTreeMap<&'static str, [usize; 5]>,
}

/// A condition minus the first one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConditionDifference {
    /// The condition.
    pub condition: String,
    /// The first condition, which is subtracted.
    pub minus: String,
    /// The differences, by the name of the figure.
    pub figures: BTreeMap<&'static str, FigureDifference>,
}

/// How well participants who judged the same item agree on one question.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct QuestionAgreement {
    /// The name of the question.
    pub name: &'static str,
    /// Krippendorff's alpha; `None` if no item has two answers, or all answers are the same.
    pub alpha: Option<RaterAgreement>,
}

/// The name under which a choice between texts is listed among questions.
pub(super) const CHOICE_QUESTION_NAME: &str = "choice";

impl ResultVersion {
    pub(super) fn new(
        data: &StudyData,
        answered: &[AnsweredItem<'_>],
        filter: ParticipantFilter,
        most_failed: usize,
    ) -> Self {
        let counted: Vec<&AnsweredItem<'_>> =
            answered.iter().filter(|one| counts_answer(filter, one, data, most_failed)).collect();
        let judgements: Vec<TextJudgement<'_>> = counted.iter().flat_map(|one| one.text_judgements(data)).collect();
        let measures = StudyMeasure::for_mode(data.plan.mode);
        let scales = super::scales_for_mode(data.plan.mode);
        let rows =
            (0..data.plan.conditions.len()).map(|at| condition_row(data, &judgements, at, measures, scales)).collect();
        let is_pair = data.plan.mode == StudyTask::Pair;
        let others = if is_pair { 0..0 } else { 1..data.plan.conditions.len() };
        let (name, title, rule) = match filter {
            ParticipantFilter::Everybody => (
                "everybody",
                "All answers",
                "All answers, also of those who did not finish or failed attention checks; none of those who were screened out.",
            ),
            ParticipantFilter::Finished => (
                "finished",
                "Finished and passed",
                "Only answers of those who finished and passed the attention checks.",
            ),
            ParticipantFilter::Kept => (
                "kept",
                "Finished, passed, and no rule broken",
                "Only answers of those who finished and passed the attention checks, without the answers that an exclusion rule leaves out.",
            ),
        };
        Self {
            name,
            title,
            rule,
            persons: counted.iter().map(|one| one.person).collect::<BTreeSet<_>>().len(),
            answers: counted.len(),
            rows,
            differences: others.map(|at| condition_difference(data, &judgements, at, measures)).collect(),
            agreement: question_agreements(data, &counted, scales),
            pairs: is_pair.then(|| PairResults::new(data, &counted)),
        }
    }
}

/// The figures of the condition with index `at` in the plan.
fn condition_row(
    data: &StudyData,
    given: &[TextJudgement<'_>],
    at: usize,
    measures: &[StudyMeasure],
    scales: &'static [RatingScale],
) -> ConditionRow {
    let condition = &data.plan.conditions[at];
    let own: Vec<&TextJudgement<'_>> = given.iter().filter(|one| one.condition == at).collect();
    let figure = |measure: &StudyMeasure| {
        let values = measure_values(&own, measure);
        let figure = match measure.kind {
            MeasureKind::Share => answer_share(&values, CONFIDENCE_LEVEL),
            MeasureKind::Mean => answer_mean(&values, CONFIDENCE_LEVEL),
        };
        figure.map(|figure| (measure.name, clip_figure(figure, measure)))
    };
    let levels = |(number, scale): (usize, &RatingScale)| {
        let mut counts = [0; 5];
        for level in own.iter().filter_map(|one| one.levels.get(number)) {
            if let Some(count) = usize::from(*level).checked_sub(1).and_then(|at| counts.get_mut(at)) {
                *count += 1;
            }
        }
        (scale.name, counts)
    };
    ConditionRow {
        condition: condition.name.clone(),
        kind: condition.kind,
        is_control: condition.kind != ConditionKind::Run,
        answers: own.len(),
        persons: own.iter().map(|one| one.person).collect::<BTreeSet<_>>().len(),
        items: own.iter().map(|one| one.route).collect::<BTreeSet<_>>().len(),
        figures: measures.iter().filter_map(figure).collect(),
        levels: scales.iter().enumerate().map(levels).collect(),
    }
}

/// The figures of the condition with index `at`, minus those of the first one.
fn condition_difference(
    data: &StudyData,
    given: &[TextJudgement<'_>],
    at: usize,
    measures: &[StudyMeasure],
) -> ConditionDifference {
    let judgements_of = |at: usize| given.iter().filter(move |one| one.condition == at).collect::<Vec<_>>();
    let (this, first) = (judgements_of(at), judgements_of(0));
    let difference = |measure: &StudyMeasure| {
        let (this, first) = (measure_values(&this, measure), measure_values(&first, measure));
        let difference = match measure.kind {
            MeasureKind::Share => share_difference(&this, &first, CONFIDENCE_LEVEL),
            MeasureKind::Mean => mean_difference(&this, &first, CONFIDENCE_LEVEL),
        };
        difference.map(|difference| (measure.name, clip_difference(difference, measure)))
    };
    let name = |at: usize| data.plan.conditions[at].name.clone();
    ConditionDifference {
        condition: name(at),
        minus: name(0),
        figures: measures.iter().filter_map(difference).collect(),
    }
}

/// The values of a figure. Conditions share routes, so the route is the item for the statistics.
fn measure_values(given: &[&TextJudgement<'_>], measure: &StudyMeasure) -> Vec<StudyAnswer<usize, u32>> {
    let answer = |one: &&TextJudgement<'_>| {
        measure.judgement_value(one).map(|value| StudyAnswer { person: one.person, item: one.route, value })
    };
    given.iter().filter_map(answer).collect()
}

/// Clips the interval of a figure to the range of its values.
fn clip_figure(mut figure: StudyFigure, measure: &StudyMeasure) -> StudyFigure {
    let [low, high] = measure.range;
    figure.interval = figure.interval.map(|interval| clip_interval(&interval, low, high));
    figure
}

/// Clips the interval of a difference to the range that differences of two values can have.
fn clip_difference(mut difference: FigureDifference, measure: &StudyMeasure) -> FigureDifference {
    if let [Some(low), Some(high)] = measure.range {
        difference.interval =
            difference.interval.map(|interval| clip_interval(&interval, Some(low - high), Some(high - low)));
    }
    difference.first = clip_figure(difference.first, measure);
    difference.second = clip_figure(difference.second, measure);
    difference
}

fn clip_interval(interval: &ConfidenceInterval, low: Option<f64>, high: Option<f64>) -> ConfidenceInterval {
    let (low, high) = (low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY));
    ConfidenceInterval { low: interval.low.clamp(low, high), high: interval.high.clamp(low, high) }
}

/// Agreement of those who judged the same item: by levels, or by the choice between its texts.
fn question_agreements(
    data: &StudyData,
    taken: &[&AnsweredItem<'_>],
    scales: &'static [RatingScale],
) -> Vec<QuestionAgreement> {
    let alpha = |values: &[StudyAnswer<usize, u32>], scale| krippendorff_alpha(values, scale, CONFIDENCE_LEVEL);
    if data.plan.mode == StudyTask::Pair {
        let values: Vec<StudyAnswer<usize, u32>> = taken.iter().filter_map(|one| choice_as_number(one)).collect();
        return vec![QuestionAgreement {
            name: CHOICE_QUESTION_NAME,
            alpha: alpha(&values, wayword_metrics::AnswerScale::Nominal),
        }];
    }
    let agreement_on = |(number, scale): (usize, &'static RatingScale)| {
        let value = |one: &&AnsweredItem<'_>| {
            let value = f64::from(*one.chosen_levels().get(number)?);
            Some(StudyAnswer { person: one.person, item: one.item.id, value })
        };
        let values: Vec<StudyAnswer<usize, u32>> = taken.iter().filter_map(value).collect();
        QuestionAgreement { name: scale.name, alpha: alpha(&values, wayword_metrics::AnswerScale::Ordinal) }
    };
    scales.iter().enumerate().map(agreement_on).collect()
}

/// A choice as a number that does not depend on the sides: the item's first text, its second, a tie, both bad.
fn choice_as_number(one: &AnsweredItem<'_>) -> Option<StudyAnswer<usize, u32>> {
    let value = match one.answer {
        crate::ParticipantAnswer::Pair { choice: crate::PairChoice::Tie } => 2.0,
        crate::ParticipantAnswer::Pair { choice: crate::PairChoice::Bad } => 3.0,
        _ => one.preferred_text()? as f64,
    };
    Some(StudyAnswer { person: one.person, item: one.item.id, value })
}
