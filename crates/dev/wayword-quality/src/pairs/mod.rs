//! Measures the score of pairs of a film and a text, and fits its weights, on pairs that are made wrong in known ways.

mod figures;
mod films;
mod made_wrong;

use figures::{PairFigures, ScoredPair, figure_table};
use films::{EyeShares, checked_films, label_films, see_films};
use made_wrong::{MadePair, PairFault, make_pairs};
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_fit::logistic::{WeighedSample, fit_weights};
use wayword_follower::{
    alignment::PartedText,
    pair::{FilmedHop, FilmedWalk, JudgedPair, PairEye, PairMotion, PairWeights},
};
use wayword_language::reading::read_instruction;
use wayword_run::{error::CommandError, output::CommandOutput, written_files::write_file};

/// The flags of `pairs` and `fit-pairs`.
#[derive(Debug, clap::Args)]
pub struct PairsArgs {
    /// Run folders of generated houses, whose walks a scripted eye sees.
    #[arg(long, required_unless_present_any = ["episodes", "films"])]
    run: Vec<PathBuf>,
    /// Folders of `wayword check --by pictures` about right pairs: their films as they were seen there.
    #[arg(long, value_name = "DIR")]
    films: Vec<PathBuf>,
    /// The same films with `--motion pictures`, in the same order.
    #[arg(long, value_name = "DIR", requires = "films")]
    films_by_pictures: Vec<PathBuf>,
    /// In place of runs, people's texts: R2R. Labels see their walks.
    #[arg(long, requires = "data", conflicts_with = "run")]
    episodes: Option<PathBuf>,
    /// Folder of Matterport3D's data.
    #[arg(long, requires = "episodes")]
    data: Option<PathBuf>,
    /// How many pairs.
    #[arg(long, default_value_t = 2000)]
    count: usize,
    /// Share of the things in a picture that the eye names.
    #[arg(long, default_value_t = 0.8)]
    recall: f64,
    /// Share of the things that the eye names which are not there.
    #[arg(long, default_value_t = 0.05)]
    invented: f64,
    /// Draw the films, and estimate their turns from the pictures. Without it, the estimates are drawn by lot from the true turns.
    #[arg(long)]
    draw: bool,
    /// Seed of the eye and of the pairs.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Fit the weights to these pairs, and write them to this file.
    #[arg(long)]
    fit: Option<PathBuf>,
    /// Score with the weights of this file, and not with those of the program.
    #[arg(long, conflicts_with = "fit")]
    weights: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// Makes pairs, scores them and prints the figures for each source of motion; with `--fit`, fits the weights first.
///
/// # Errors
/// When a run cannot be read or the file cannot be written.
pub fn measure_pairs(flags: &PairsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let (films, eye) = match (&flags.episodes, &flags.data) {
        (Some(episodes), Some(data)) => (label_films(data, episodes, output)?, PairEye::Labels),
        _ => {
            let eye = EyeShares { recall: flags.recall, invented: flags.invented };
            let mut films = see_films(&flags.run, eye, flags.draw, flags.seed, output)?;
            films.extend(checked_films(&flags.films, &flags.films_by_pictures)?);
            (films, PairEye::Pictures)
        }
    };
    let pairs = make_pairs(&films, flags.count, flags.seed);
    let judged: BTreeMap<PairMotion, Vec<JudgedFault>> = [PairMotion::Poses, PairMotion::Pictures, PairMotion::Unknown]
        .into_iter()
        .map(|motion| (motion, pairs.par_iter().map(|pair| (pair.fault, judge_pair(pair, motion))).collect()))
        .collect();
    let weights = match (&flags.fit, &flags.weights) {
        (None, Some(file)) => read_weights(file)?,
        (Some(file), _) => {
            let weights = PairWeights {
                origin: flags.origin(),
                command: flags.command(),
                weights: judged.iter().map(|(motion, judged)| (*motion, fit_pair_weights(judged))).collect(),
            };
            write_file(file, serde_json::to_string(&weights).unwrap_or_default() + "\n")?;
            weights
        }
        (None, None) => PairWeights::for_eye(eye).clone(),
    };
    let figures: BTreeMap<PairMotion, PairFigures> =
        judged.iter().map(|(motion, judged)| (*motion, PairFigures::new(&score_all(judged, &weights)))).collect();
    output.print_result(&figures, figure_table(&figures));
    Ok(())
}

/// The fault of a pair, and how it was judged.
type JudgedFault = (PairFault, Option<JudgedPair>);

fn score_all(judged: &[JudgedFault], weights: &PairWeights) -> Vec<ScoredPair> {
    let score = |(fault, judged): &JudgedFault| ScoredPair {
        fault: *fault,
        chance: judged.as_ref().map_or(0.5, |judged| weights.chance_wrong(judged, 0.5)),
    };
    judged.iter().map(score).collect()
}

fn read_weights(file: &Path) -> Result<PairWeights, CommandError> {
    let text = std::fs::read_to_string(file).map_err(CommandError::io(file, "read"))?;
    PairWeights::parse(&text)
        .map_err(|error| CommandError::usage(format!("{}: {error}", file.display()), "give a file that --fit wrote"))
}

/// Judges a pair by what a source of motion tells of its film.
fn judge_pair(pair: &MadePair, motion: PairMotion) -> Option<JudgedPair> {
    let walk = match motion {
        PairMotion::Poses => &pair.by_poses,
        PairMotion::Pictures => &pair.by_pictures,
        PairMotion::Unknown => &FilmedWalk {
            hops: vec![FilmedHop::default(); pair.by_poses.hops.len()],
            places: pair.by_poses.places.clone(),
        },
    };
    let reading = read_instruction(&pair.text, &BTreeSet::new()).into_claims();
    JudgedPair::new(&PartedText::from_reading(&pair.text, &reading), walk)
}

/// Fits the weights: wrong and right pairs count alike.
fn fit_pair_weights(judged: &[JudgedFault]) -> BTreeMap<String, f64> {
    let wrong = judged.iter().filter(|(fault, _)| *fault != PairFault::None).count().max(1) as f64;
    let right = (judged.len() as f64 - wrong).max(1.0);
    let half = judged.len() as f64 / 2.0;
    let samples = judged.iter().filter_map(|(fault, judged)| {
        let is_wrong = *fault != PairFault::None;
        let weight = half / if is_wrong { wrong } else { right };
        Some(WeighedSample { features: judged.as_ref()?.features.clone(), wrong: is_wrong, weight })
    });
    let weights = fit_weights(&samples.collect::<Vec<_>>(), RIDGE);
    weights.into_iter().map(|(name, weight)| (name, (weight * 1000.0).round() / 1000.0)).collect()
}

/// The penalty of large weights.
const RIDGE: f64 = 4.0;

impl PairsArgs {
    fn origin(&self) -> String {
        match &self.episodes {
            Some(file) => format!("{} pairs made of the texts of {}, seen by labels", self.count, file_name(file)),
            None => format!(
                "{} pairs made of walks through generated houses, seen by eyes of recall {} that invent {}: along their paths{}",
                self.count,
                self.recall,
                self.invented,
                if self.films.is_empty() { "" } else { ", and in recordings of them" }
            ),
        }
    }

    fn command(&self) -> String {
        match &self.episodes {
            Some(file) => format!(
                "wayword-measure pairs --data DATA --episodes {} --count {} --fit FILE",
                file_name(file),
                self.count
            ),
            None => {
                let films = if self.films.is_empty() { "" } else { " --films CHECK --films-by-pictures CHECK" };
                format!("wayword-measure pairs --run RUN{films} --count {} --fit FILE", self.count)
            }
        }
    }
}

fn file_name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
