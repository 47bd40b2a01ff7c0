//! The list of the figures that each mode of a study measures, with their names, units and meanings, and how each figure is read out
//! of an answer.

use super::judgements::TextJudgement;
use crate::{StudyTask, wording::RatingScale};
use serde::Serialize;
use wayword_metrics::TrajectoryScore;

/// A figure of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StudyMeasure {
    /// Its name in files.
    pub name: &'static str,
    /// Its name in tables, without the unit.
    pub label: &'static str,
    /// Whether it is a share or a mean.
    pub kind: MeasureKind,
    /// The unit in which it is shown. Where this is per cent, the values themselves lie between 0 and 1.
    pub unit: MeasureUnit,
    /// Its meaning, as a phrase for readers.
    pub meaning: &'static str,
    /// The lowest and the highest value that one answer can give; `None` where there is no bound.
    pub range: [Option<f64>; 2],
    /// The part of an answer from which its value is read.
    #[serde(skip)]
    source: MeasureSource,
}

/// How answers become a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasureKind {
    /// The share of the answers that fulfil a condition.
    Share,
    /// The mean over the answers.
    Mean,
}

/// The unit in which a figure is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MeasureUnit {
    /// Shown times a hundred.
    PerCent,
    /// Levels from 1 to 5.
    Level,
    /// Metres.
    Metres,
    /// Seconds.
    Seconds,
    /// A count.
    Count,
}

/// Which part of an answer the value is read from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum MeasureSource {
    /// A metric of the walk.
    Walk(WalkFigure),
    /// The time to the answer.
    Seconds,
    /// How often a button was pressed.
    Presses,
    /// The level that was given to the question with this index.
    Level(usize),
    /// Whether the level of the question with this index is at least the second number.
    AtLeast(usize, u8),
    /// Whether the level of the question with this index is at most the second number.
    AtMost(usize, u8),
    /// How far the text was preferred to the other: 1, a half or 0.
    Gain,
    /// Whether both texts of a comparison were bad.
    BothBad,
}

/// A metric of a walk. The measures below explain each.
#[derive(Debug, Clone, Copy, PartialEq)]
enum WalkFigure {
    Success,
    Spl,
    NavigationErrorM,
    Ndtw,
    Sdtw,
    OracleSuccess,
    LengthM,
}

impl WalkFigure {
    fn score_value(self, score: &TrajectoryScore) -> Option<f64> {
        let one_or_zero = |is: bool| f64::from(u8::from(is));
        match self {
            Self::Success => Some(one_or_zero(score.distance.success)),
            Self::Spl => Some(score.distance.spl),
            Self::NavigationErrorM => score.navigation_error_m,
            Self::Ndtw => Some(score.ndtw),
            Self::Sdtw => Some(score.distance.sdtw),
            Self::OracleSuccess => Some(one_or_zero(score.distance.oracle_success)),
            Self::LengthM => Some(score.length_m),
        }
    }
}

impl StudyMeasure {
    /// All figures of a study in which participants have this task, in the order of the tables.
    #[must_use]
    pub fn for_mode(task: StudyTask) -> &'static [Self] {
        match task {
            StudyTask::Follow => &FOLLOW_MEASURES,
            StudyTask::Rate => &RATE_MEASURES,
            StudyTask::Pair => &PAIR_MEASURES,
        }
    }

    /// The value of this figure for one judgement; `None` if the judgement has none.
    pub(super) fn judgement_value(&self, judgement: &TextJudgement<'_>) -> Option<f64> {
        let level = |at: usize| judgement.levels.get(at).copied();
        let one_or_zero = |is: bool| f64::from(u8::from(is));
        match self.source {
            MeasureSource::Walk(figure) => judgement.walk.and_then(|score| figure.score_value(score)),
            MeasureSource::Seconds => judgement.seconds,
            MeasureSource::Presses => judgement.presses.map(f64::from),
            MeasureSource::Level(at) => level(at).map(f64::from),
            MeasureSource::AtLeast(at, least) => level(at).map(|level| one_or_zero(level >= least)),
            MeasureSource::AtMost(at, most) => level(at).map(|level| one_or_zero(level <= most)),
            MeasureSource::Gain => judgement.gain,
            MeasureSource::BothBad => judgement.both_bad.map(one_or_zero),
        }
    }

    /// The figures of a walk, in the order of the tables.
    pub(super) fn walk_measures() -> impl Iterator<Item = &'static Self> {
        FOLLOW_MEASURES.iter().filter(|measure| matches!(measure.source, MeasureSource::Walk(_)))
    }

    /// The value of this figure for one walk; `None` if it is not a figure of walks.
    pub(super) fn walk_value(&self, score: &TrajectoryScore) -> Option<f64> {
        match self.source {
            MeasureSource::Walk(figure) => figure.score_value(score),
            _ => None,
        }
    }

    /// The value of this figure for the answers `a`, as an expression in R. `scales` are the questions of the mode.
    pub(super) fn r_expression(&self, scales: &[RatingScale]) -> String {
        let level = |at: usize| scales.get(at).map_or("", |scale| scale.name);
        match self.source {
            MeasureSource::Walk(_) => format!("a${}", self.name),
            MeasureSource::Seconds => "a$seconds".to_owned(),
            MeasureSource::Presses => "a$presses".to_owned(),
            MeasureSource::Level(at) => format!("a${}", level(at)),
            MeasureSource::AtLeast(at, least) => format!("a${} >= {least}", level(at)),
            MeasureSource::AtMost(at, most) => format!("a${} <= {most}", level(at)),
            MeasureSource::Gain => "a$gain".to_owned(),
            MeasureSource::BothBad => "a$choice == \"bad\"".to_owned(),
        }
    }

    /// The name with the unit, as the heading of a plot or table.
    #[must_use]
    pub fn heading_with_unit(&self) -> String {
        match self.unit {
            MeasureUnit::PerCent => format!("{}, %", self.label),
            MeasureUnit::Level => format!("{}, mean level 1 to 5", self.label),
            MeasureUnit::Metres => format!("{}, m", self.label),
            MeasureUnit::Seconds => format!("{}, s", self.label),
            MeasureUnit::Count => self.label.to_owned(),
        }
    }
}

/// The names of the figures that count levels as arXiv 2403.11487 does. The meanings below call it "the paper".
pub(super) const PAPER_MEASURE_NAMES: [&str; 4] = ["similar_low", "accurate_high", "ghosts_any", "reachable_high"];

/// A measure with the range that its unit implies.
const fn new_measure(
    name: &'static str,
    label: &'static str,
    kind: MeasureKind,
    unit: MeasureUnit,
    meaning: &'static str,
    source: MeasureSource,
) -> StudyMeasure {
    let range = match unit {
        MeasureUnit::PerCent => [Some(0.0), Some(1.0)],
        MeasureUnit::Level => [Some(1.0), Some(5.0)],
        MeasureUnit::Metres | MeasureUnit::Seconds | MeasureUnit::Count => [Some(0.0), None],
    };
    StudyMeasure { name, label, kind, unit, meaning, range, source }
}

const fn share_measure(
    name: &'static str,
    label: &'static str,
    meaning: &'static str,
    source: MeasureSource,
) -> StudyMeasure {
    new_measure(name, label, MeasureKind::Share, MeasureUnit::PerCent, meaning, source)
}

const fn mean_measure(
    name: &'static str,
    label: &'static str,
    unit: MeasureUnit,
    meaning: &'static str,
    source: MeasureSource,
) -> StudyMeasure {
    new_measure(name, label, MeasureKind::Mean, unit, meaning, source)
}

/// The mean level of the question with index `at`.
const fn level_measure(name: &'static str, label: &'static str, meaning: &'static str, at: usize) -> StudyMeasure {
    mean_measure(name, label, MeasureUnit::Level, meaning, MeasureSource::Level(at))
}

/// The meaning of each share of agreement with a statement.
const AGREEMENT_SHARE_MEANING: &str = "share of level 4 or 5 (agree, strongly agree)";

const FOLLOW_MEASURES: [StudyMeasure; 15] = [
    share_measure(
        "success",
        "SR",
        "success rate: stopped nearer than 3 m to the goal, along the graph",
        MeasureSource::Walk(WalkFigure::Success),
    ),
    mean_measure(
        "spl",
        "SPL",
        MeasureUnit::PerCent,
        "success weighted by path length (Anderson et al. 2018)",
        MeasureSource::Walk(WalkFigure::Spl),
    ),
    mean_measure(
        "navigation_error_m",
        "NE",
        MeasureUnit::Metres,
        "navigation error: from where the walk stopped to the goal, along the graph",
        MeasureSource::Walk(WalkFigure::NavigationErrorM),
    ),
    mean_measure(
        "ndtw",
        "nDTW",
        MeasureUnit::PerCent,
        "normalised dynamic time warping",
        MeasureSource::Walk(WalkFigure::Ndtw),
    ),
    mean_measure(
        "sdtw",
        "SDTW",
        MeasureUnit::PerCent,
        "nDTW of a success, 0 of a failure",
        MeasureSource::Walk(WalkFigure::Sdtw),
    ),
    share_measure(
        "oracle_success",
        "OSR",
        "came nearer than 3 m to the goal at any point of the walk",
        MeasureSource::Walk(WalkFigure::OracleSuccess),
    ),
    mean_measure("length_m", "TL", MeasureUnit::Metres, "length of the walk", MeasureSource::Walk(WalkFigure::LengthM)),
    mean_measure("seconds", "Time", MeasureUnit::Seconds, "from getting the text to stopping", MeasureSource::Seconds),
    mean_measure(
        "presses",
        "Presses",
        MeasureUnit::Count,
        "moves, and turns to look, as the page counted them",
        MeasureSource::Presses,
    ),
    level_measure("easy", "Easy", "the text was easy to follow", 0),
    share_measure("easy_high", "Easy: 4 or 5", AGREEMENT_SHARE_MEANING, MeasureSource::AtLeast(0, 4)),
    level_measure("confident", "Confident", "confident to have gone the way that the text describes", 1),
    share_measure("confident_high", "Confident: 4 or 5", AGREEMENT_SHARE_MEANING, MeasureSource::AtLeast(1, 4)),
    level_measure("demanding", "Demanding", "following the text was mentally demanding; lower is better", 2),
    share_measure("demanding_high", "Demanding: 4 or 5", AGREEMENT_SHARE_MEANING, MeasureSource::AtLeast(2, 4)),
];

const RATE_MEASURES: [StudyMeasure; 9] = [
    level_measure("similar", "Similar", "how similar the text is to one that the participant would write", 0),
    share_measure(
        "similar_high",
        "Similar: 4 or 5",
        "share of level 4 or 5 (mostly similar, almost the same)",
        MeasureSource::AtLeast(0, 4),
    ),
    share_measure(
        "similar_low",
        "Similar: 1 or 2",
        "share of level 1 or 2 (very different, minor overlaps); lower is better; the paper's first question",
        MeasureSource::AtMost(0, 2),
    ),
    level_measure("accurate", "Accurate", "how accurately the text describes the walk", 1),
    share_measure(
        "accurate_high",
        "Accurate: 4 or 5",
        "share of level 4 or 5, more than decent; the paper's second question",
        MeasureSource::AtLeast(1, 4),
    ),
    level_measure(
        "ghosts",
        "Ghosts",
        "how many things the text names that were not seen, from 1 (none) to 5 (more than three); lower is better",
        2,
    ),
    share_measure(
        "ghosts_any",
        "Ghosts: any",
        "share of level 2 or more, at least one ghost; lower is better; the paper's third question",
        MeasureSource::AtLeast(2, 2),
    ),
    level_measure("reachable", "Reachable", "whether a robot could reach the end of the walk by the text", 3),
    share_measure(
        "reachable_high",
        "Reachable: 4 or 5",
        "share of level 4 or 5 (probably, certainly); the paper's fourth question",
        MeasureSource::AtLeast(3, 4),
    ),
];

const PAIR_MEASURES: [StudyMeasure; 2] = [
    share_measure(
        "gain",
        "Preferred",
        "over all comparisons in which the condition took part: 1 where its text was preferred, a half for a tie and for both bad, else 0",
        MeasureSource::Gain,
    ),
    share_measure("both_bad", "Both bad", "comparisons in which neither text was good", MeasureSource::BothBad),
];
