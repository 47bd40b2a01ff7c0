//! The measurements that the documents quote, one command each: see `wayword-measure --help`.

mod budget;
mod calls;
mod claims;
mod corrupt;
mod corrupt_people;
mod corruptions;
mod coverage;
mod critics;
mod detector;
mod doubts;
mod eye;
mod fit_evidence;
mod fit_follower;
mod found;
mod house_views;
mod judged;
mod key;
#[cfg(test)]
mod made_up;
#[cfg(feature = "full")]
mod parity;
mod people;
mod provider;
mod reader_figures;
mod resources;
mod reuse;
mod sample;
mod share;
mod skeleton;
mod stage;
mod steps;
mod storm;
mod study_coverage;
mod sweep;
mod tell_apart;
mod texts;
mod walker;

use clap::{Parser, Subcommand};
use std::{path::PathBuf, process::ExitCode};
use wayword::{error::Error, output::Output};

/// Measures the figures in Wayword's documents.
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
        /// How many missed corruptions to show.
        #[arg(long, default_value_t = 10)]
        show: usize,
    },
    /// Count the most frequent sentence skeletons of each style: sentences with landmarks, rooms and turns masked.
    Variety {
        /// Run folders.
        #[arg(required = true)]
        runs: Vec<PathBuf>,
        /// How many to show per style.
        #[arg(long, default_value_t = 3)]
        show: usize,
    },
    /// Fit the weights of the follower to people's texts, and print how it does on the buildings that were left out.
    FitFollower(fit_follower::Flags),
    /// Count the words and clauses of datasets' texts that the reader understands, and show those that it does not.
    Coverage(coverage::Flags),
    /// Correlate critics of texts (words, BLEU-4, ROUGE-L, CIDEr-D, agreement with pictures) with the success of agents that walked by
    /// them, or with what people in a study did and said.
    Critics(critics::Flags),
    /// Run `wayword compare` with the agent `tools`, whose model is a script: it walks the shortest way, at random, or it breaks.
    Walker(Box<walker::Flags>),
    /// Show instructions of each style, picked by seed, beside what people wrote.
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
    /// Count hallucinated objects in captions and instructions when the model that sees is flawed, for each way of
    /// asking.
    Eye {
        /// The platform.
        #[command(flatten)]
        world: stage::World,
        /// Views that are captioned.
        #[arg(long, default_value_t = 100)]
        views: usize,
        /// Paths that instructions are written for.
        #[arg(long, default_value_t = 40)]
        paths: usize,
        /// Share of the objects named by that model that are not there.
        #[arg(long, default_value_t = 0.15)]
        hallucinated: f64,
    },
    /// Hold true and false claims about paths against labels and against the captions of a flawed eye, and count what the
    /// checks refuse and what they catch.
    Claims(claims::Flags),
    /// Hold right and seeded wrong landmarks against a detector whose finds and misses are drawn by labels, and count the objects
    /// that a flawed eye hallucinates in texts, with that detector and without.
    Detector(detector::Flags),
    /// Compare a detector in process with one in PyTorch, on random weights of the true size: numbers, times, memory.
    #[cfg(feature = "full")]
    Parity(parity::Flags),
    /// Fit the weights that say how much the silence of labels says about a claim, on people's texts.
    FitEvidence {
        /// Folder of Matterport3D's and REVERIE's data.
        #[arg(long)]
        data: PathBuf,
        /// File of people's texts. Its last ten buildings by name are left out, and how the weights do there is shown.
        #[arg(long)]
        episodes: PathBuf,
        /// Write the weights to this file.
        #[arg(long)]
        out: Option<PathBuf>,
    },
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
    Provider(provider::Flags),
    /// Compare what a run spends with the budget that stops it.
    Budget {
        /// The platform.
        #[command(flatten)]
        world: stage::World,
        /// Paths of the run without a budget.
        #[arg(long, default_value_t = 330)]
        paths: usize,
        /// The budget, US dollars, at prices of 10 and 20 per million tokens in and out.
        #[arg(long, default_value_t = 2.0)]
        max_usd: f64,
    },
    /// Compare the calls per instruction on paths of one building with those of the paper's method.
    Reuse {
        /// The platform.
        #[command(flatten)]
        world: stage::World,
        /// Paths that instructions are written for.
        #[arg(long, default_value_t = 200)]
        paths: usize,
    },
    /// Take the walks of an export of steps again: whether their actions lead to their ends, and whether their pictures are those
    /// of their poses.
    Steps(steps::Flags),
    /// Hold the findings of `wayword check` against spans of texts that people called right or wrong: HEAR's file.
    #[command(mut_arg("file", |file| file.help("File of labelled texts, in HEAR's format")))]
    #[command(mut_arg("show", |show| show.help("Show at most this many findings about words that people called right")))]
    #[command(after_long_help = "")]
    People(judged::Judging),
    /// Make people's own texts wrong, without the words of the program's reader: a file of texts and its key.
    CorruptPeople(corrupt_people::Flags),
    /// Hold the findings of `wayword check` against the key of such a file: corruptions found, and false alarms.
    #[command(mut_arg("file", |file| file.help("File of corrupted texts")))]
    #[command(mut_arg("show", |show| show.help("Show at most this many corruptions that were not found")))]
    #[command(after_long_help = "")]
    Found(found::Flags),
    /// Measure how far the follower can be believed: its calibration, wrong turns, other paths' texts, ambiguity.
    ReaderFigures(reader_figures::Flags),
    /// Count the words of people's texts that a change would fit better, by what is changed: the doubts that readers see.
    Doubts(doubts::Flags),
    /// Try out the settings of agents on a train split.
    Sweep(sweep::Flags),
    /// Tell generated texts from people's with a plain classifier, cross-validated by building.
    TellApart(tell_apart::Flags),
    /// Hold texts about generated houses against their plans: the room at the end, what stands there, the target.
    Houses(texts::houses::Flags),
    /// Count the views on walks through generated houses of which half or more is bare wall, and measure the time that a view takes.
    HouseViews(house_views::Flags),
    /// Simulate studies with people, and count how often the intervals of their figures cover the truth.
    StudyCoverage(study_coverage::Flags),
    /// Measure generated texts: bare turns, lengths, word types, openers, and what they share with other texts.
    Texts(texts::Flags),
}

fn main() -> ExitCode {
    let what = Cli::parse().what;
    let is_json = match &what {
        What::Critics(flags) => flags.json,
        What::People(flags) => flags.json,
        What::Found(flags) => flags.judging.json,
        What::TellApart(flags) => flags.json,
        What::Texts(flags) => flags.json,
        What::Houses(flags) => flags.json,
        What::HouseViews(flags) => flags.json,
        What::StudyCoverage(flags) => flags.json,
        _ => false,
    };
    let output = Output::new(is_json, false);
    match run(what, &output) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output.error(&error);
            (error.exit_code() as u8).into()
        }
    }
}

fn run(what: What, output: &Output) -> Result<(), Error> {
    match what {
        What::Corruptions { runs, count, seed, show } => corruptions::measure(&runs, count, seed, show, output),
        What::StudyCoverage(flags) => study_coverage::measure(&flags, output),
        What::FitFollower(flags) => fit_follower::measure(&flags, output),
        What::Coverage(flags) => coverage::measure(&flags, output),
        What::Walker(flags) => walker::measure(*flags, output),
        What::Critics(flags) => critics::show(&flags, output),
        What::Variety { runs, show } => skeleton::measure(&runs, show, output),
        What::Calls { calls, latency_ms, concurrency } => calls::measure(calls, latency_ms, concurrency, output),
        What::Pictures { calls } => calls::pictures(calls, output),
        What::Storm { calls, requests_per_second, burst, share, seed } => {
            storm::measure(calls, requests_per_second, burst, share, seed, output)
        }
        What::Provider(flags) => provider::serve(&flags, output),
        What::Budget { world, paths, max_usd } => budget::measure(&world, paths, max_usd, output),
        What::Eye { world, views, paths, hallucinated } => eye::measure(&world, views, paths, hallucinated, output),
        What::Claims(flags) => claims::measure(&flags, output),
        What::Detector(flags) => detector::measure(&flags, output),
        #[cfg(feature = "full")]
        What::Parity(flags) => parity::measure(&flags, output),
        What::Reuse { world, paths } => reuse::measure(&world, paths, output),
        What::FitEvidence { data, episodes, out } => fit_evidence::measure(&data, &episodes, out.as_deref(), output),
        What::Steps(flags) => steps::measure(&flags, output),
        What::People(flags) => people::measure(flags, output),
        What::CorruptPeople(flags) => corrupt_people::write(&flags, output),
        What::Found(flags) => found::measure(flags, output),
        What::ReaderFigures(flags) => reader_figures::measure(&flags, output),
        What::Doubts(flags) => doubts::measure(&flags, output),
        What::Sweep(flags) => sweep::measure(&flags, output),
        What::TellApart(flags) => tell_apart::measure(&flags, output),
        What::Houses(flags) => texts::houses::measure(&flags, output),
        What::HouseViews(flags) => house_views::measure(&flags, output),
        What::Texts(flags) => texts::measure(&flags, output),
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
