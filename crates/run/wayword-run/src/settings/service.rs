//! How models are reached, and how much may be spent. No value changes an answer, so a run may be continued with other values.

use super::group::group;
use crate::error::CommandError;
use clap::Args;
use serde::Deserialize;
use std::{collections::BTreeMap, fmt::Display, path::PathBuf};

group! {
    /// Limits and files of the calls to models: flags, and the table `[service]` of a settings file.
    #[derive(Debug, Clone, Default, PartialEq, Args, Deserialize)]
    #[serde(deny_unknown_fields, default)]
    pub struct Service {
        /// Stop before the costs exceed this, in US dollars. The limit is for the whole run, however often it is continued. Models
        /// without a known price are refused.
        #[arg(long, value_name = "USD")]
        pub max_usd: Option<f64>,
        /// Stop before more requests than this are sent. The limit is for the whole run, however often it is continued.
        #[arg(long, value_name = "N")]
        pub max_calls: Option<u64>,
        /// Number of requests at the same time, per provider. [default: raised step by step while the provider keeps up, at most 64]
        #[arg(long, value_name = "N")]
        pub concurrency: Option<usize>,
        /// Send at most this many requests per minute to a provider.
        #[arg(long, value_name = "N")]
        pub requests_per_minute: Option<f64>,
        /// Send at most this many tokens per minute to a provider.
        #[arg(long, value_name = "N")]
        pub tokens_per_minute: Option<f64>,
        /// Abandon a request after this many seconds. [default: 120]
        #[arg(long, value_name = "S")]
        pub timeout_s: Option<f64>,
        /// Environment variable that holds the key of the provider. For several providers use the settings file.
        #[arg(long, value_name = "NAME")]
        pub key_env: Option<String>,
        /// Device for models that run inside this program: cpu, cuda, cuda:1 or metal (the last three need a build with that feature). [default: cpu]
        #[arg(long, value_name = "DEVICE")]
        pub device: Option<String>,
        /// Limit of the memory that all models inside this program take, in GiB. [default: the free memory of the machine]
        #[arg(long, value_name = "GIB")]
        pub memory_gib: Option<f64>,
        /// SHA-256 that a checkpoint file (.pth) has to have, where its makers published none that is known here. Without it,
        /// that of the first use is kept, and later ones must equal it.
        #[arg(long, value_name = "SHA256")]
        pub trust: Option<String>,
        /// File with your own prices, TOML (see docs/MODELS.md).
        #[arg(long, value_name = "FILE")]
        pub prices: Option<PathBuf>,
        /// File of the ledger, which keeps every answer. [default: wayword/ledger.db in the data folder of your system; on Linux ~/.local/share]
        #[arg(long, value_name = "FILE")]
        pub ledger: Option<PathBuf>,
        /// Also save every answer of the run in this file, for --replay.
        #[arg(long, value_name = "FILE")]
        pub record: Option<PathBuf>,
        /// Take every answer from a file that --record wrote. No provider is called.
        #[arg(long, value_name = "FILE", conflicts_with_all = ["record", "ledger"])]
        pub replay: Option<PathBuf>,
    }
}

/// The user's own providers, and changes to the built-in ones: tables `[providers.NAME]` of a settings file.
pub type ProviderTables = BTreeMap<String, toml::Table>;

/// Where calls are kept.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum CallKeeping {
    /// In the ledger of this machine, which all runs share.
    #[default]
    Machine,
    /// In a recording in each chunk, for workers that share only a folder. The list has the recordings that a shard has so far;
    /// their cost counts towards its budget.
    Chunks(Vec<PathBuf>),
    /// In a database that all workers share. The duration is how long a worker's sign of life counts.
    #[cfg(feature = "queue")]
    Database(wayword_database::PostgresDatabase, std::time::Duration),
}

impl Service {
    /// The values of flags, completed by those of a file.
    #[must_use]
    pub fn or_file(self, mut file: Self) -> Self {
        // A replay excludes a recording and a ledger. A flag wins over the file, which could name the same recording.
        if self.replay.is_some() {
            file = Self { record: None, ledger: None, ..file };
        }
        if self.record.is_some() || self.ledger.is_some() {
            file.replay = None;
        }
        self.over(file)
    }

    /// Refuses values out of range and settings that exclude each other.
    ///
    /// # Errors
    /// When a number is out of range, or two settings exclude each other.
    pub fn into_checked(self) -> Result<Self, CommandError> {
        let refuse = |flag: &str, value: &dyn Display, hint: &str| {
            Err(CommandError::usage(format!("{flag} {value} is out of range"), hint))
        };
        if let Some(usd) = self.max_usd.filter(|usd| !usd.is_finite() || *usd < 0.0) {
            return refuse("--max-usd", &usd, "give US dollars, as in --max-usd 2.50");
        }
        if let Some(at_a_time) = self.concurrency.filter(|at_a_time| !(1..=MAX_CONCURRENCY).contains(at_a_time)) {
            return refuse("--concurrency", &at_a_time, "give a number from 1 to 512");
        }
        if let Some(timeout_s) = self.timeout_s.filter(|timeout_s| !(0.1..=3600.0).contains(timeout_s)) {
            return refuse("--timeout-s", &timeout_s, "give seconds, from 0.1 to 3600");
        }
        if let Some(gib) = self.memory_gib.filter(|gib| !(gib.is_finite() && *gib > 0.0)) {
            return refuse("--memory-gib", &gib, "give a number above 0, as in --memory-gib 8");
        }
        let rates =
            [("--requests-per-minute", self.requests_per_minute), ("--tokens-per-minute", self.tokens_per_minute)];
        for (flag, rate) in rates {
            if let Some(rate) = rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
                return refuse(flag, &rate, "give a number above 0, or leave the flag out for no limit");
            }
        }
        if self.replay.is_some() && (self.record.is_some() || self.ledger.is_some()) {
            return Err(CommandError::usage(
                "--replay cannot be combined with --record or --ledger",
                "a replay makes no new answers that could be kept: leave the other flags out",
            ));
        }
        Ok(self)
    }
}

/// Largest `--concurrency`, requests at the same time. A larger number is refused.
const MAX_CONCURRENCY: usize = 512;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_their_range_are_refused() {
        let refused = |text: &str| toml::from_str::<Service>(text).unwrap().into_checked().is_err();
        for bad in [
            "max_usd = -1.0",
            "max_usd = nan",
            "concurrency = 0",
            "timeout_s = 0.0",
            "requests_per_minute = 0.0",
            "memory_gib = 0",
        ] {
            assert!(refused(bad), "{bad}");
            let told = toml::from_str::<Service>(bad).unwrap().into_checked().unwrap_err().to_string();
            assert!(told.contains(&bad.split(' ').next().unwrap_or_default().replace('_', "-")), "{told}");
        }
        assert!(!refused("max_usd = 0.0\nmax_calls = 0\nconcurrency = 32"));
    }

    #[test]
    fn a_replay_never_writes_the_recording_of_a_settings_file() {
        let read = |text: &str| toml::from_str::<Service>(text).unwrap();
        let replayed = read("replay = 'calls.jsonl'").or_file(read("record = 'calls.jsonl'\nledger = 'calls.db'"));
        assert_eq!(replayed, read("replay = 'calls.jsonl'"));
        let recorded = read("record = 'new.jsonl'").or_file(read("replay = 'calls.jsonl'\nmax_calls = 3"));
        assert_eq!(recorded, read("record = 'new.jsonl'\nmax_calls = 3"));
        assert!(read("replay = 'calls.jsonl'\nrecord = 'calls.jsonl'").into_checked().is_err());
    }
}
