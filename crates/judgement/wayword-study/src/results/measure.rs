//! The list of the figures that each mode of a study measures, with their names, units and meanings, and how each figure is read out
//! of an answer.

use super::given::Given;
use crate::Mode;
use serde::Serialize;
use wayword_metrics::Score;

/// A figure of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Measure {
    /// Its name in files.
    pub name: &'static str,
    /// Its name in tables, without the unit.
    pub label: &'static str,
    /// Whether it is a share or a mean.
    pub kind: MeasureKind,
    /// The unit in which it is shown. Where this is per cent, the values themselves lie between 0 and 1.
    pub unit: Unit,
    /// Its meaning, as a phrase for readers.
    pub meaning: &'static str,
    /// The lowest and the highest value that one answer can give; `None` where there is no bound.
    pub range: [Option<f64>; 2],
    #[serde(skip)]
    of: Of,
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
pub enum Unit {
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
enum Of {
    Walk(Walked),
    Seconds,
    Presses,
    Level(usize),
    AtLeast(usize, u8),
    AtMost(usize, u8),
    Gain,
    BothBad,
}

/// A metric of a walk.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Walked {
    Success,
    Spl,
    NavigationErrorM,
    Ndtw,
    Sdtw,
    OracleSuccess,
    LengthM,
}

impl Walked {
    fn of(self, score: &Score) -> Option<f64> {
        let yes = |is: bool| f64::from(u8::from(is));
        match self {
            Self::Success => Some(yes(score.distance.success)),
            Self::Spl => Some(score.distance.spl),
            Self::NavigationErrorM => score.navigation_error_m,
            Self::Ndtw => Some(score.ndtw),
            Self::Sdtw => Some(score.distance.sdtw),
            Self::OracleSuccess => Some(yes(score.distance.oracle_success)),
            Self::LengthM => Some(score.length_m),
        }
    }
}

impl Measure {
    /// All figures of a mode, in the order of the tables.
    #[must_use]
    pub fn of_mode(mode: Mode) -> &'static [Self] {
        match mode {
            Mode::Follow => &FOLLOW,
            Mode::Rate => &RATE,
            Mode::Pair => &PAIR,
        }
    }

    /// The value of this figure for one judgement; `None` if the judgement has none.
    pub(super) fn value(&self, given: &Given<'_>) -> Option<f64> {
        let level = |at: usize| given.levels.get(at).copied();
        let yes = |is: bool| f64::from(u8::from(is));
        match self.of {
            Of::Walk(figure) => given.walk.and_then(|score| figure.of(score)),
            Of::Seconds => given.seconds,
            Of::Presses => given.presses.map(f64::from),
            Of::Level(at) => level(at).map(f64::from),
            Of::AtLeast(at, least) => level(at).map(|level| yes(level >= least)),
            Of::AtMost(at, most) => level(at).map(|level| yes(level <= most)),
            Of::Gain => given.gain,
            Of::BothBad => given.both_bad.map(yes),
        }
    }

    /// The figures of a walk, in the order of the tables.
    pub(super) fn of_walks() -> impl Iterator<Item = &'static Self> {
        FOLLOW.iter().filter(|measure| matches!(measure.of, Of::Walk(_)))
    }

    /// The value of this figure for one walk; `None` if it is not a figure of walks.
    pub(super) fn of_walk(&self, score: &Score) -> Option<f64> {
        match self.of {
            Of::Walk(figure) => figure.of(score),
            _ => None,
        }
    }

    /// The name with the unit, as the heading of a plot or table.
    #[must_use]
    pub fn heading(&self) -> String {
        match self.unit {
            Unit::PerCent => format!("{}, %", self.label),
            Unit::Level => format!("{}, mean level 1 to 5", self.label),
            Unit::Metres => format!("{}, m", self.label),
            Unit::Seconds => format!("{}, s", self.label),
            Unit::Count => self.label.to_owned(),
        }
    }
}

/// The names of the figures that count levels as arXiv 2403.11487 does.
pub(super) const OF_THE_PAPER: [&str; 4] = ["similar_low", "accurate_high", "ghosts_any", "reachable_high"];

const fn measure(
    name: &'static str,
    label: &'static str,
    kind: MeasureKind,
    unit: Unit,
    meaning: &'static str,
    of: Of,
) -> Measure {
    let range = match unit {
        Unit::PerCent => [Some(0.0), Some(1.0)],
        Unit::Level => [Some(1.0), Some(5.0)],
        Unit::Metres | Unit::Seconds | Unit::Count => [Some(0.0), None],
    };
    Measure { name, label, kind, unit, meaning, range, of }
}

const fn share(name: &'static str, label: &'static str, meaning: &'static str, of: Of) -> Measure {
    measure(name, label, MeasureKind::Share, Unit::PerCent, meaning, of)
}

const fn mean(name: &'static str, label: &'static str, unit: Unit, meaning: &'static str, of: Of) -> Measure {
    measure(name, label, MeasureKind::Mean, unit, meaning, of)
}

const fn level(name: &'static str, label: &'static str, meaning: &'static str, at: usize) -> Measure {
    mean(name, label, Unit::Level, meaning, Of::Level(at))
}

const AGREES: &str = "share of level 4 or 5 (agree, strongly agree)";

const FOLLOW: [Measure; 15] = [
    share(
        "success",
        "SR",
        "success rate: stopped nearer than 3 m to the goal, along the graph",
        Of::Walk(Walked::Success),
    ),
    mean("spl", "SPL", Unit::PerCent, "success weighted by path length (Anderson et al. 2018)", Of::Walk(Walked::Spl)),
    mean(
        "navigation_error_m",
        "NE",
        Unit::Metres,
        "navigation error: from where the walk stopped to the goal, along the graph",
        Of::Walk(Walked::NavigationErrorM),
    ),
    mean("ndtw", "nDTW", Unit::PerCent, "normalised dynamic time warping", Of::Walk(Walked::Ndtw)),
    mean("sdtw", "SDTW", Unit::PerCent, "nDTW of a success, 0 of a failure", Of::Walk(Walked::Sdtw)),
    share(
        "oracle_success",
        "OSR",
        "came nearer than 3 m to the goal at any point of the walk",
        Of::Walk(Walked::OracleSuccess),
    ),
    mean("length_m", "TL", Unit::Metres, "length of the walk", Of::Walk(Walked::LengthM)),
    mean("seconds", "Time", Unit::Seconds, "from getting the text to stopping", Of::Seconds),
    mean("presses", "Presses", Unit::Count, "moves, and turns to look, as the page counted them", Of::Presses),
    level("easy", "Easy", "the text was easy to follow", 0),
    share("easy_high", "Easy: 4 or 5", AGREES, Of::AtLeast(0, 4)),
    level("confident", "Confident", "confident to have gone the way that the text describes", 1),
    share("confident_high", "Confident: 4 or 5", AGREES, Of::AtLeast(1, 4)),
    level("demanding", "Demanding", "following the text was mentally demanding; lower is better", 2),
    share("demanding_high", "Demanding: 4 or 5", AGREES, Of::AtLeast(2, 4)),
];

const RATE: [Measure; 9] = [
    level("similar", "Similar", "how similar the text is to one that the participant would write", 0),
    share(
        "similar_high",
        "Similar: 4 or 5",
        "share of level 4 or 5 (mostly similar, almost the same)",
        Of::AtLeast(0, 4),
    ),
    share(
        "similar_low",
        "Similar: 1 or 2",
        "share of level 1 or 2 (very different, minor overlaps); lower is better; the paper's first question",
        Of::AtMost(0, 2),
    ),
    level("accurate", "Accurate", "how accurately the text describes the walk", 1),
    share(
        "accurate_high",
        "Accurate: 4 or 5",
        "share of level 4 or 5, more than decent; the paper's second question",
        Of::AtLeast(1, 4),
    ),
    level(
        "ghosts",
        "Ghosts",
        "how many things the text names that were not seen, from 1 (none) to 5 (more than three); lower is better",
        2,
    ),
    share(
        "ghosts_any",
        "Ghosts: any",
        "share of level 2 or more, at least one ghost; lower is better; the paper's third question",
        Of::AtLeast(2, 2),
    ),
    level("reachable", "Reachable", "whether a robot could reach the end of the walk by the text", 3),
    share(
        "reachable_high",
        "Reachable: 4 or 5",
        "share of level 4 or 5 (probably, certainly); the paper's fourth question",
        Of::AtLeast(3, 4),
    ),
];

const PAIR: [Measure; 2] = [
    share(
        "gain",
        "Preferred",
        "over all comparisons in which the condition took part: 1 where its text was preferred, a half for a tie and for both bad, else 0",
        Of::Gain,
    ),
    share("both_bad", "Both bad", "comparisons in which neither text was good", Of::BothBad),
];
