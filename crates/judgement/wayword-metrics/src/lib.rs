//! Figures about instructions, trajectories and studies with people, each with an interval and with the anchors that give it a
//! meaning (as: what another person reaches, and what a text about another path reaches).
//!
//! Architecture invariant: this crate does not read files or run models, and uses only the graph and the ground of a platform; vectors come
//! from the caller. Distances are computed once and cached ([`DistanceAtlas`]), and equal input gives equal figures.
//!
//! # Where things are
//! - `trajectory/mod.rs`: the rules of success; `fidelity.rs`, `score.rs`: the other figures of trajectories; `walk_survey.rs`: how well a
//!   graph stands for the ground.
//! - [`captions`]: BLEU, ROUGE-L, CIDEr-D, their tokenizers, diversity. [`picture_scores`]: agreement with pictures.
//! - `similarity`: vectors of texts, with both anchors. `bootstrap`: intervals clustered by path.
//! - `latex`: the escapes of LaTeX tables.
//! - `study/crossed/`: shares, means and differences over persons and items; `bradley_terry/` preferences, `agreement.rs`, `power.rs`.
//! - `fixtures/make_*.py` make the figures of other programs that the tests compare with.

mod bootstrap;
pub mod captions;
mod correlation;
mod hashed_words;
mod latex;
mod mcnemar;
pub mod picture_scores;
mod similarity;
mod study;
mod trajectory;

pub use bootstrap::{
    MeanEstimate, ResamplingOptions, clustered_interval, clustered_interval_from_draws, percentile_interval,
    resampled_intervals,
};
pub use correlation::{kendall_tau_b, pearson_correlation, spearman_correlation};
pub use hashed_words::HashedWordEncoder;
pub use latex::escape_latex;
pub use mcnemar::McNemar;
pub use similarity::{ItemVectors, SetSimilarity, compare_sets};
pub use study::{
    AnswerScale, BradleyTerry, ConfidenceInterval, FigureDifference, FittedTerm, IntervalMethod, NoStrength,
    PairPreference, PlannedAnswer, PlannedTest, PowerPlan, RaterAgreement, SimulatedPower, StudyAnswer, StudyFigure,
    SystemComparison, SystemStrength, answer_mean, answer_share, bradley_terry, krippendorff_alpha, mean_difference,
    search_for_power, share_difference, wilson_interval,
};
pub use trajectory::{
    AgentTrajectory, DistanceAtlas, EpisodeDemand, EpisodeScorer, GraphRoute, SceneDistances, SuccessOutcome,
    TargetGrounding, TrajectoryError, TrajectoryMetric, TrajectoryScore, TrajectorySuccessRule, WalkSurvey,
    find_problems, score_trajectory, survey_walks,
};
