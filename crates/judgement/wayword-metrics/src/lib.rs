//! Figures about instructions and trajectories, each with its interval and the figures to compare it with.
//!
//! Architecture invariant: nothing here reads a file, runs a model or knows a platform beyond the graph that the
//! platform gives; vectors come from the caller. Distances are computed once and kept ([`Atlas`]), and the same input
//! gives the same figures.

mod bootstrap;
pub mod captions;
mod correlation;
mod mcnemar;
pub mod pictures;
mod similarity;
mod study;
mod trajectory;
mod words;

pub use bootstrap::{Estimate, clustered_interval, clustered_interval_of, percentile_interval};
pub use correlation::{kendall_tau_b, pearson, spearman};
pub use mcnemar::McNemar;
pub use similarity::{Drawing, Said, Similarity, similarity};
pub use study::{
    Agreement, Answer, BradleyTerry, Comparison, Detectable, Difference, Figure, Interval, Method, NoStrength, Plan,
    Preference, Scale, Strength, Term, agreement, bradley_terry, detectable, mean, mean_difference, mean_share, share,
    share_difference, wilson,
};
pub use trajectory::{
    Atlas, Course, Demand, Distances, Grounding, Invalid, Metric, Outcome, Rule, Score, Trajectory, problems, score,
};
pub use words::Words;
