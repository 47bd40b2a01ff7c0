//! The measurements that the documents quote, one command each: see `wayword-measure --help`.

use clap::{Parser, Subcommand};
use std::{path::PathBuf, process::ExitCode};
use wayword_fit::{fit_evidence, fit_follower};
use wayword_quality::{
    budget, claims, corrupt_people, corruptions, coverage, critics, detector, doubts, eye, found, house_views, judged,
    people, reader_figures, reuse, sample, skeleton, stage, steps, study_coverage, sweep, tell_apart, texts, walker,
};
use wayword_run::{error::Error, output::Output};

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
    /// them, or with the walks and ratings of people in a study.
    Critics(critics::Flags),
    /// Run `wayword compare` with the agent `tools` and a scripted model: it walks the shortest way, at random, or it breaks.
    Walker(Box<walker::Flags>),
    /// Show instructions of each style, picked by seed, next to people's texts.
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
    /// Check true and false claims about paths by labels and by the captions of a flawed eye, and count those that the checks
    /// refuse and catch.
    Claims(claims::Flags),
    /// Check right and seeded wrong landmarks by a detector that draws its finds and misses from labels, and count the objects
    /// that a flawed eye hallucinates in texts, with that detector and without.
    Detector(detector::Flags),
    /// Fit the weights for how much it counts against a claim that no label confirms it, on people's texts.
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
    /// Compare the findings of `wayword check` with spans of texts that people called right or wrong: HEAR's file.
    #[command(mut_arg("file", |file| file.help("File of labelled texts, in HEAR's format")))]
    #[command(mut_arg("show", |show| show.help("Show at most this many findings about words that people called right")))]
    #[command(after_long_help = "")]
    People(judged::Judging),
    /// Make people's own texts wrong, without the words of the program's reader: a file of texts and its key.
    CorruptPeople(corrupt_people::Flags),
    /// Compare the findings of `wayword check` with the key of a corrupted file: corruptions found, and false alarms.
    #[command(mut_arg("file", |file| file.help("File of corrupted texts")))]
    #[command(mut_arg("show", |show| show.help("Show at most this many corruptions that were not found")))]
    #[command(after_long_help = "")]
    Found(found::Flags),
    /// Measure how far the follower can be believed: its calibration, wrong turns, other paths' texts, ambiguity.
    ReaderFigures(reader_figures::Flags),
    /// Count the words of people's texts that the follower would doubt, because a change would fit the walk better, by kind of change.
    Doubts(doubts::Flags),
    /// Try out the settings of agents on a train split.
    Sweep(sweep::Flags),
    /// Tell generated texts from people's with a plain classifier, cross-validated by building.
    TellApart(tell_apart::Flags),
    /// Compare texts about generated houses with their plans: the room at the end, the thing at the stop, the target.
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
        What::Budget { world, paths, max_usd } => budget::measure(&world, paths, max_usd, output),
        What::Eye { world, views, paths, hallucinated } => eye::measure(&world, views, paths, hallucinated, output),
        What::Claims(flags) => claims::measure(&flags, output),
        What::Detector(flags) => detector::measure(&flags, output),
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
