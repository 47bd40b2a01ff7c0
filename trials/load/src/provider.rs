//! The test kit's provider as a process of its own, so that a measurement does not count the provider's time and
//! memory.

use serde::{Deserialize, Serialize};
use std::{
    io::{BufRead, BufReader, Read},
    process::{Child, Command, Stdio},
    time::Duration,
};
use wayword_run::{error::CommandError, output::CommandOutput};
use wayword_testkit::provider::{
    FaultSchedule, PictureGallery, ProviderBehaviour, ProviderDialect, ProviderRequestRate, RetryAfter,
    ScriptedProvider,
    scripts::{FlawedEye, ScriptedCast},
};

/// How the provider behaves.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct ProviderArgs {
    /// Time from a request to its answer, milliseconds.
    #[arg(long, default_value_t = 0)]
    latency_ms: u64,
    /// Share of requests that meet a fault from which a client can recover.
    #[arg(long, default_value_t = 0.0)]
    storm: f64,
    /// Requests per second that the provider accepts; 0 for any number.
    #[arg(long, default_value_t = 0.0)]
    requests_per_second: f64,
    /// Requests that it accepts at once after a pause.
    #[arg(long, default_value_t = 10)]
    burst: u32,
    /// Seed of the faults.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// The report of a provider, one line of JSON.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ProviderReport {
    /// The address of its API.
    pub(super) base_url: String,
    /// Requests that were let in.
    pub(super) admitted: u64,
    /// Requests that were answered.
    pub(super) answered: u64,
    /// Faults that the provider made.
    pub(super) faults: u64,
    /// Requests above the rate.
    pub(super) rate_limited: u64,
}

/// Serves until standard input closes. Prints a report with its address at the beginning, and one with its counts at the end.
pub(super) fn serve_provider(flags: &ProviderArgs, output: &CommandOutput) -> Result<(), CommandError> {
    // The eye hallucinates 15 % of the objects that it names, and the text roles make mistakes with a probability of 20 %.
    let cast = ScriptedCast::new(FlawedEye::new(PictureGallery::default(), flags.seed, 0.15), flags.seed, 0.2);
    let rate = (flags.requests_per_second > 0.0).then_some(ProviderRequestRate {
        requests_per_s: flags.requests_per_second,
        burst: flags.burst,
        retry_after: RetryAfter::Seconds,
    });
    let behaviour = ProviderBehaviour {
        latency: Duration::from_millis(flags.latency_ms),
        faults: FaultSchedule::storm(flags.storm),
        rate,
        seed: flags.seed,
        ..ProviderBehaviour::for_model("words", cast.clone()).and_model("eye", cast)
    };
    let provider = ScriptedProvider::start(behaviour).map_err(|source| CommandError::Io {
        path: "127.0.0.1".into(),
        doing: "serve on",
        source,
    })?;
    let print_report = || {
        let log = provider.log();
        let report = ProviderReport {
            base_url: provider.base_url(ProviderDialect::OpenAi),
            admitted: log.admitted,
            answered: log.answered,
            faults: log.faults_committed(),
            rate_limited: log.rate_limited,
        };
        output.print_result(&report, serde_json::to_string(&report).unwrap_or_default());
    };
    print_report();
    let _ = std::io::stdin().read_to_end(&mut Vec::new());
    print_report();
    Ok(())
}

/// A provider in a process of its own.
pub(super) struct ProviderProcess {
    child: Child,
    lines: std::io::Lines<BufReader<std::process::ChildStdout>>,
    pub(super) base_url: String,
}

impl ProviderProcess {
    /// Starts a provider with these flags, and waits until it listens.
    pub(super) fn start(flags: &[String]) -> Result<Self, CommandError> {
        let failed = |source| CommandError::Io { path: "wayword-trials".into(), doing: "start", source };
        let own = std::env::current_exe().map_err(failed)?;
        let mut child = Command::new(own)
            .arg("provider")
            .args(flags)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let stdout = child.stdout.take().ok_or_else(|| failed(std::io::ErrorKind::BrokenPipe.into()))?;
        let mut process = Self { child, lines: BufReader::new(stdout).lines(), base_url: String::new() };
        process.base_url = process.read_report()?.base_url;
        Ok(process)
    }

    /// The next report of the process.
    fn read_report(&mut self) -> Result<ProviderReport, CommandError> {
        let line = self.lines.next().and_then(Result::ok).unwrap_or_default();
        serde_json::from_str(&line)
            .map_err(|error| CommandError::usage(format!("the provider said {line:?}: {error}"), "try again"))
    }

    /// Stops the process, and returns its last report.
    pub(super) fn stop_and_report(mut self) -> Result<ProviderReport, CommandError> {
        drop(self.child.stdin.take());
        let report = self.read_report();
        let _ = self.child.wait();
        report
    }
}
