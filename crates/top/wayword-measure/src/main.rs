//! Measurements that the documents quote, each a command: see `wayword-measure --help`.

mod corrupt;
mod corruptions;
mod sample;
mod skeleton;

use clap::{Parser, Subcommand};
use std::{path::PathBuf, process::ExitCode};
use wayword::{error::Error, output::Output};

/// Measures what the documents of Wayword state.
#[derive(Debug, Parser)]
struct Cli {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Corrupt good instructions of runs, and count how many the checks catch.
    Corruptions {
        /// Run folders.
        #[arg(required = true)]
        runs: Vec<PathBuf>,
        /// How many corruptions.
        #[arg(long, default_value_t = 1000)]
        count: usize,
        /// Seed of the choice.
        #[arg(long, default_value_t = 0)]
        seed: u64,
        /// Show so many that were missed.
        #[arg(long, default_value_t = 10)]
        show: usize,
    },
    /// The most frequent sentence skeletons of each style: landmarks, rooms and turns masked.
    Variety {
        /// Run folders.
        #[arg(required = true)]
        runs: Vec<PathBuf>,
        /// Show so many per style.
        #[arg(long, default_value_t = 3)]
        show: usize,
    },
    /// Instructions of each style, picked by seed, beside what people wrote.
    Sample {
        /// Run folder.
        run: PathBuf,
        /// How many of each style.
        #[arg(long, default_value_t = 10)]
        count: usize,
        /// Seed of the choice.
        #[arg(long, default_value_t = 0)]
        seed: u64,
    },
}

fn main() -> ExitCode {
    let output = Output::new(false, false);
    match run(Cli::parse().what, &output) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output.error(&error);
            error.exit_code().into()
        }
    }
}

fn run(what: What, output: &Output) -> Result<(), Error> {
    match what {
        What::Corruptions { runs, count, seed, show } => corruptions::measure(&runs, count, seed, show, output),
        What::Variety { runs, show } => skeleton::measure(&runs, show, output),
        What::Sample { run, count, seed } => sample::show(&run, count, seed, output),
    }
}
