//! Measurements that the documents quote, each a command: see `wayword-measure --help`.

mod budget;
mod calls;
mod corrupt;
mod corruptions;
mod eye;
#[cfg(test)]
mod made_up;
mod provider;
mod resources;
mod reuse;
mod sample;
mod skeleton;
mod stage;
mod storm;
mod sweep;

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
    /// Ghosts in the captions and instructions of a flawed eye, for each way of asking.
    Eye {
        /// The world.
        #[command(flatten)]
        world: stage::World,
        /// Views that are captioned.
        #[arg(long, default_value_t = 100)]
        views: usize,
        /// Paths that instructions are written for.
        #[arg(long, default_value_t = 40)]
        paths: usize,
        /// Share of what the eye names that is not there.
        #[arg(long, default_value_t = 0.15)]
        ghosts: f64,
    },
    /// Calls per second, our own processor time for each, and memory, against a provider that is slow or is not.
    Calls {
        /// How many.
        #[arg(long, default_value_t = 5000)]
        calls: usize,
        /// How long the provider takes for each, milliseconds.
        #[arg(long, default_value_t = 200)]
        latency_ms: u64,
        /// Requests at a time.
        #[arg(long, default_value_t = 32)]
        concurrency: usize,
    },
    /// Our own processor time for calls with pictures.
    Pictures {
        /// How many.
        #[arg(long, default_value_t = 500)]
        calls: usize,
    },
    /// What gets through to a rate-limited provider in a storm of faults.
    Storm {
        /// How many calls.
        #[arg(long, default_value_t = 3000)]
        calls: usize,
        /// Requests per second that the provider bears.
        #[arg(long, default_value_t = 50.0)]
        requests_per_second: f64,
        /// And at once, after a rest.
        #[arg(long, default_value_t = 10)]
        burst: u32,
        /// Share of requests that meet a fault.
        #[arg(long, default_value_t = 0.3)]
        share: f64,
        /// Seed of the faults.
        #[arg(long, default_value_t = 0)]
        seed: u64,
    },
    /// Serves the test kit's provider until standard input closes.
    Provider(provider::Flags),
    /// A run that a budget stops: what it has spent against the bound.
    Budget {
        /// The world.
        #[command(flatten)]
        world: stage::World,
        /// Paths that would be made.
        #[arg(long, default_value_t = 330)]
        paths: usize,
        /// The bound, US dollars, at 10 and 20 a million tokens in and out.
        #[arg(long, default_value_t = 2.0)]
        max_usd: f64,
    },
    /// Calls per instruction on paths of one building, against the paper's way.
    Reuse {
        /// The world.
        #[command(flatten)]
        world: stage::World,
        /// Paths that instructions are written for.
        #[arg(long, default_value_t = 200)]
        paths: usize,
    },
    /// What agents decide by, tried out on a train split.
    Sweep(sweep::Flags),
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
        What::Calls { calls, latency_ms, concurrency } => calls::measure(calls, latency_ms, concurrency, output),
        What::Pictures { calls } => calls::pictures(calls, output),
        What::Storm { calls, requests_per_second, burst, share, seed } => {
            storm::measure(calls, requests_per_second, burst, share, seed, output)
        }
        What::Provider(flags) => provider::serve(&flags, output),
        What::Budget { world, paths, max_usd } => budget::measure(&world, paths, max_usd, output),
        What::Eye { world, views, paths, ghosts } => eye::measure(&world, views, paths, ghosts, output),
        What::Reuse { world, paths } => reuse::measure(&world, paths, output),
        What::Sweep(flags) => sweep::measure(&flags, output),
        What::Sample { run, count, seed } => sample::show(&run, count, seed, output),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use wayword_testkit::documents;

    #[test]
    fn every_measurement_that_the_documents_quote_is_read_by_the_command_line() {
        let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").canonicalize().unwrap();
        let mut measured = 0;
        for command in documents::commands(&repository).unwrap() {
            if command.program == "wayword-measure" && !command.args.is_empty() {
                let words = ["wayword-measure"].into_iter().chain(command.args.iter().map(String::as_str));
                let read = Cli::try_parse_from(words).map_err(|error| error.to_string());
                assert!(read.is_ok(), "{}: {:?}: {read:?}", command.place, command.args);
                measured += 1;
            }
        }
        assert!(measured > 5, "{measured} measurements");
    }
}
