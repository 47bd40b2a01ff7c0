//! Figures about instructions, trajectories and studies with people, each with an interval and with the anchors that give it a
//! meaning (as: what another person reaches, and what a text about another path reaches).
//!
//! Architecture invariant: this crate does not read files or run models, and uses only the graph of a platform; vectors come
//! from the caller. Distances are computed once and cached ([`Atlas`]), and equal input gives equal figures.

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
