//! The measurements that the documents quote, one command each: see `wayword-measure --help`.
//!
//! Each measurement is a module of `wayword-quality` or `wayword-fit`; this crate is their command line.

use clap::{Parser, Subcommand};
use std::{path::PathBuf, process::ExitCode};
use wayword_fit::{fit_alignment, fit_evidence, fit_follower, fit_wording};
use wayword_quality::{
    arrivals, budget, checked_texts, claims, corrupt_people, corruption_findings, corruptions, coverage, critics,
    detector, doubts, eye, house_faults, house_views, pairs, people, reader_figures, refined, remembered, reuse,
    sample, skeleton, stage, steps, study_coverage, sweep, tell_apart, texts, walker,
};
use wayword_run::{error::CommandError, output::CommandOutput};

/// Measures the figures in Wayword's documents.
#[derive(Debug, Parser)]
struct MeasureCli {
    #[command(subcommand)]
    what: Measurement,
}

#[derive(Debug, Subcommand)]
enum Measurement {
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
    FitFollower(fit_follower::FitFollowerArgs),
    /// Count the constructions by which people's texts describe a way, for the style that is built in.
    FitWording(fit_wording::FitWordingArgs),
    /// Fit the weights of the alignment to stretches of walks that people gave to parts of texts.
    FitAlignment(fit_alignment::FitAlignmentArgs),
    /// Measure the alignment by such stretches, next to what word counts alone give.
    Align(fit_alignment::MeasureAlignmentArgs),
    /// Count the words and clauses of datasets' texts that the reader understands, and show those that it does not.
    Coverage(coverage::CoverageArgs),
    /// Correlate critics of texts (words, BLEU-4, ROUGE-L, CIDEr-D, agreement with pictures) with the success of agents that walked by
    /// them, or with the walks and ratings of people in a study.
    Critics(critics::CriticsArgs),
    /// Run `wayword compare` with the agent `tools` and a scripted model: it walks the shortest way, at random, or it breaks.
    Walker(Box<walker::ScriptedWalkerArgs>),
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
        world: stage::MeasuredWorldArgs,
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
    /// Measure how right the memory of a walk is that is made from captions alone: which sightings are of one thing, and the side on
    /// which one passes it. A scripted eye looks, and labels decide.
    Memory {
        /// Walks through generated houses.
        #[arg(long, default_value_t = 100)]
        paths: usize,
        /// Seed of the houses, the walks and the eye.
        #[arg(long, default_value_t = 0)]
        seed: u64,
    },
    /// Measure what judging a text and writing it again mends. A scripted author errs in every first text (a turn flipped, a landmark
    /// of another part, the end left out), and a follower walks by it and by the text that is kept.
    Refinement {
        /// Walks through generated houses.
        #[arg(long, default_value_t = 60)]
        paths: usize,
        /// `--repairs` of the run.
        #[arg(long, default_value_t = 3)]
        repairs: u32,
        /// `--refine` of the run.
        #[arg(long, default_value_t = 1)]
        refine: u32,
        /// Seed of the houses, the walks, the eye and the faults.
        #[arg(long, default_value_t = 0)]
        seed: u64,
    },
    /// Check true and false claims about paths by labels and by the captions of a flawed eye, and count those that the checks
    /// refuse and catch.
    Claims(claims::ClaimsArgs),
    /// Check right and seeded wrong landmarks by a detector that draws its finds and misses from labels, and count the objects
    /// that a flawed eye hallucinates in texts, with that detector and without.
    Detector(detector::DetectorArgs),
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
        world: stage::MeasuredWorldArgs,
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
        world: stage::MeasuredWorldArgs,
        /// Paths that instructions are written for.
        #[arg(long, default_value_t = 200)]
        paths: usize,
    },
    /// Take the walks of an export of steps again: whether their actions lead to their ends, and whether their pictures are those
    /// of their poses.
    Steps(steps::StepsArgs),
    /// Compare the findings of `wayword check` with spans of texts that people called right or wrong: HEAR's file.
    #[command(mut_arg("file", |file| file.help("File of labelled texts, in HEAR's format")))]
    #[command(mut_arg("show", |show| show.help("Show at most this many findings about words that people called right")))]
    #[command(after_long_help = "")]
    People(checked_texts::JudgingArgs),
    /// Score pairs of a film and a text that are made wrong in known ways, or fit the weights of that score.
    Pairs(pairs::PairsArgs),
    /// Make people's own texts wrong, without the words of the program's reader: a file of texts and its key.
    CorruptPeople(corrupt_people::CorruptPeopleArgs),
    /// Compare the findings of `wayword check` with the key of a corrupted file: corruptions found, and false alarms.
    #[command(mut_arg("file", |file| file.help("File of corrupted texts")))]
    #[command(mut_arg("show", |show| show.help("Show at most this many corruptions that were not found")))]
    #[command(after_long_help = "")]
    Found(corruption_findings::CorruptionFindingArgs),
    /// Measure how well the follower foresees who arrives by answers that guides gave: CVDN's dialogues.
    Arrivals(arrivals::ArrivalsArgs),
    /// Measure how far the follower can be believed: its calibration, wrong turns, other paths' texts, ambiguity.
    ReaderFigures(reader_figures::ReaderFiguresArgs),
    /// Count the words of people's texts that the follower would doubt, because a change would fit the walk better, by kind of change.
    Doubts(doubts::DoubtsArgs),
    /// Try out the settings of agents on a train split.
    Sweep(sweep::SweepArgs),
    /// Tell generated texts from people's with a plain classifier, cross-validated by building.
    TellApart(tell_apart::TellApartArgs),
    /// Compare texts about generated houses with their plans: the room at the end, the thing at the stop, the target.
    Houses(texts::houses::HouseTextsArgs),
    /// Plant faults into texts about generated houses, as the plans prove, and count how many the checks find.
    HouseFaults(house_faults::HouseFaultsArgs),
    /// Count the views on walks through generated houses of which half or more is bare wall, and measure the time that a view takes.
    HouseViews(house_views::HouseViewsArgs),
    /// Simulate studies with people, and count how often the intervals of their figures cover the truth.
    StudyCoverage(study_coverage::StudyCoverageArgs),
    /// Measure generated texts: bare turns, lengths, word types, openers, and what they share with other texts.
    Texts(texts::TextFiguresArgs),
}

fn main() -> ExitCode {
    let what = MeasureCli::parse().what;
    let is_json = match &what {
        Measurement::Arrivals(flags) => flags.json,
        Measurement::Critics(flags) => flags.json,
        Measurement::People(flags) => flags.json,
        Measurement::Found(flags) => flags.judging.json,
        Measurement::TellApart(flags) => flags.json,
        Measurement::Texts(flags) => flags.json,
        Measurement::Houses(flags) => flags.json,
        Measurement::HouseFaults(flags) => flags.json,
        Measurement::HouseViews(flags) => flags.json,
        Measurement::StudyCoverage(flags) => flags.json,
        Measurement::Align(flags) => flags.json,
        Measurement::Pairs(flags) => flags.json,
        _ => false,
    };
    let output = CommandOutput::new(is_json, false);
    match run_measurement(what, &output) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output.print_error(&error);
            (error.exit_code() as u8).into()
        }
    }
}

fn run_measurement(what: Measurement, output: &CommandOutput) -> Result<(), CommandError> {
    match what {
        Measurement::Corruptions { runs, count, seed, show } => {
            corruptions::measure_corruptions(&runs, count, seed, show, output)
        }
        Measurement::StudyCoverage(flags) => study_coverage::measure_study_coverage(&flags, output),
        Measurement::FitAlignment(flags) => fit_alignment::fit_alignment_weights(&flags, output),
        Measurement::Align(flags) => fit_alignment::measure_alignment(&flags, output),
        Measurement::FitFollower(flags) => fit_follower::fit_follower_weights(&flags, output),
        Measurement::Coverage(flags) => coverage::measure_coverage(&flags, output),
        Measurement::Walker(flags) => walker::measure_walker(*flags, output),
        Measurement::Critics(flags) => critics::show_correlations(&flags, output),
        Measurement::Variety { runs, show } => skeleton::measure_skeletons(&runs, show, output),
        Measurement::Budget { world, paths, max_usd } => budget::measure_budget(&world, paths, max_usd, output),
        Measurement::Eye { world, views, paths, hallucinated } => {
            eye::measure_eye(&world, views, paths, hallucinated, output)
        }
        Measurement::Memory { paths, seed } => {
            let figures = remembered::measure_memory(paths, seed, output)?;
            output.print_result(&figures, figures);
            Ok(())
        }
        Measurement::Refinement { paths, repairs, refine, seed } => {
            let figures = refined::measure_refinement(paths, (repairs, refine), seed)?;
            output.print_result(&figures, figures);
            Ok(())
        }
        Measurement::Claims(flags) => claims::measure_claims(&flags, output),
        Measurement::Detector(flags) => detector::measure_played_detector(&flags, output),
        Measurement::Reuse { world, paths } => reuse::measure_reuse(&world, paths, output),
        Measurement::FitWording(flags) => fit_wording::fit_wording(&flags, output),
        Measurement::FitEvidence { data, episodes, out } => {
            fit_evidence::fit_evidence_weights(&data, &episodes, out.as_deref(), output)
        }
        Measurement::Steps(flags) => steps::replay_steps(&flags, output),
        Measurement::Pairs(flags) => pairs::measure_pairs(&flags, output),
        Measurement::People(flags) => people::measure_people(flags, output),
        Measurement::CorruptPeople(flags) => corrupt_people::write_corruptions(&flags, output),
        Measurement::Found(flags) => corruption_findings::measure_corruption_findings(flags, output),
        Measurement::Arrivals(flags) => arrivals::measure_arrivals(&flags, output),
        Measurement::ReaderFigures(flags) => reader_figures::measure_reader_figures(&flags, output),
        Measurement::Doubts(flags) => doubts::measure_doubts(&flags, output),
        Measurement::Sweep(flags) => sweep::sweep_settings(&flags, output),
        Measurement::TellApart(flags) => tell_apart::measure_tell_apart(&flags, output),
        Measurement::Houses(flags) => texts::houses::measure_house_texts(&flags, output),
        Measurement::HouseFaults(flags) => house_faults::measure_house_faults(&flags, output),
        Measurement::HouseViews(flags) => house_views::measure_house_views(&flags, output),
        Measurement::Texts(flags) => texts::measure_texts(&flags, output),
        Measurement::Sample { run, count, seed } => sample::show_sample(&run, count, seed, output),
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
        for command in documents::documented_commands(&repository).unwrap() {
            if command.program == "wayword-measure" && !command.args.is_empty() {
                let words = ["wayword-measure"].into_iter().chain(command.args.iter().map(String::as_str));
                let read = MeasureCli::try_parse_from(words).map_err(|error| error.to_string());
                assert!(read.is_ok(), "{}: {:?}: {read:?}", command.place, command.args);
                measured += 1;
            }
        }
        assert!(measured > 5, "{measured} measurements");
    }
}
