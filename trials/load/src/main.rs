//! Trials of load and parity, one command each: see `wayword-trials --help`.
//!
//! # Where things are
//! - `calls.rs`, `storm.rs`: calls under load, and with a provider that fails often.
//! - `parity/` (feature `full`): a detector beside PyTorch on the same random weights.

mod calls;
#[cfg(feature = "full")]
mod parity;
mod provider;
mod storm;

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use wayword_run::{error::CommandError, output::CommandOutput};

/// Tries what needs load, faults or another implementation.
#[derive(Debug, Parser)]
struct TrialsCli {
    #[command(subcommand)]
    what: Trial,
}

#[derive(Debug, Subcommand)]
enum Trial {
    /// Measure calls per second, this program's processor time per call, and memory, with a test provider.
    Calls {
        /// How many calls.
        #[arg(long, default_value_t = 5000)]
        calls: usize,
        /// How long the provider takes for each call, milliseconds.
        #[arg(long, default_value_t = 200)]
        latency_ms: u64,
        /// Requests at a time.
        #[arg(long, default_value_t = 32)]
        concurrency: usize,
    },
    /// Measure this program's processor time for calls with pictures.
    Pictures {
        /// How many calls.
        #[arg(long, default_value_t = 500)]
        calls: usize,
    },
    /// Measure how many calls succeed with a rate-limited provider that often fails.
    Storm {
        /// How many calls.
        #[arg(long, default_value_t = 3000)]
        calls: usize,
        /// Requests per second that the provider accepts.
        #[arg(long, default_value_t = 50.0)]
        requests_per_second: f64,
        /// Requests that it accepts at once after a pause.
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
    Provider(provider::ProviderArgs),
    /// Compare a detector in process with one in PyTorch, on random weights of the true size: numbers, times, memory.
    #[cfg(feature = "full")]
    Parity(parity::ParityArgs),
}

fn main() -> ExitCode {
    let output = CommandOutput::new(false, false);
    match run_trial(TrialsCli::parse().what, &output) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output.print_error(&error);
            (error.exit_code() as u8).into()
        }
    }
}

fn run_trial(what: Trial, output: &CommandOutput) -> Result<(), CommandError> {
    match what {
        Trial::Calls { calls, latency_ms, concurrency } => calls::measure_calls(calls, latency_ms, concurrency, output),
        Trial::Pictures { calls } => calls::measure_pictures(calls, output),
        Trial::Storm { calls, requests_per_second, burst, share, seed } => {
            storm::measure_storm(calls, requests_per_second, burst, share, seed, output)
        }
        Trial::Provider(flags) => provider::serve_provider(&flags, output),
        #[cfg(feature = "full")]
        Trial::Parity(flags) => parity::measure_parity(&flags, output),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use wayword_testkit::documents;

    #[test]
    fn every_trial_that_the_documents_quote_is_read_by_the_command_line() {
        let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
        let mut measured = 0;
        for command in documents::documented_commands(&repository).unwrap() {
            if command.program == "wayword-trials" && !command.args.is_empty() {
                let words = ["wayword-trials"].into_iter().chain(command.args.iter().map(String::as_str));
                let read = TrialsCli::try_parse_from(words).map_err(|error| error.to_string());
                assert!(read.is_ok(), "{}: {:?}: {read:?}", command.place, command.args);
                measured += 1;
            }
        }
        assert!(measured > 3, "{measured} trials");
    }
}
