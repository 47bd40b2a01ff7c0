//! Simulates studies with known truth, and counts how often the 95 % intervals of their figures cover it. An interval is honest if that is
//! close to 95 %.

mod assignment;
mod choices;
mod coverage_table;
mod figure;
mod logits;
mod ratings;
mod walks;

use crate::share::aligned_table;
use clap::Args;
use wayword_run::{error::CommandError, output::CommandOutput};

/// The share that an interval should cover.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// The flags of `study-coverage`.
#[derive(Debug, Args)]
#[command(after_help = "\
A column is a number of people, how many of 60 items each answers, and how much people and items differ on the logit scale:
none, middle (standard deviation 0.75 each), large (1.5). Two conditions have half of the answers each, and half of what
people and items do to one of them they do to both. The truth is that of all people and items. A cell is the percentage of 95 % intervals that
cover it; in brackets the percentage of studies that give an interval, where that is not all.")]
pub struct StudyCoverageArgs {
    /// Simulated studies of each figure in each column.
    #[arg(long, default_value_t = 2000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    studies: u64,
    /// Seed of the studies.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Simulates studies, and prints how often the intervals of their figures cover the truth.
///
/// # Errors
/// Never. The result has the type that all measurements return.
pub fn measure_study_coverage(flags: &StudyCoverageArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let cells = coverage_table::simulate_all(flags.studies, flags.seed);
    output.print_result(&cells, aligned_table(&coverage_table::coverage_rows(&cells)));
    Ok(())
}
