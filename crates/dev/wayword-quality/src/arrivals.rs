//! Measures whether the follower foresees which people arrive: it reads the answers that guides gave in CVDN's dialogues, as the
//! task of Navigation from Dialog History (Thomason et al. 2019) cuts them.
//!
//! The follower's probability that a walk by the answer ends in the goal region is held against whether the person who got the answer
//! ended there. The same probability without the answer's words, and how far the guide's next hops lead, are the baselines: near goals
//! are reached more often, whatever the answer.

use crate::share::area_under_curve;
use clap::Args;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_core::{Heading, SceneId, ViewpointId};
use wayword_experiments::compare::args::AskedPrior;
use wayword_fit::fit_follower::texts::{FollowerScene, read_scenes};
use wayword_follower::{FeatureWeights, Guide, GuideTrial, WalkFit, WalkTree, walk_shares};
use wayword_metrics::{ResamplingOptions, resampled_intervals};
use wayword_run::{error::CommandError, output::CommandOutput};

/// Resamples of the interval.
const RESAMPLE_COUNT: usize = 2_000;

/// The flags of `arrivals`.
#[derive(Debug, Args)]
pub struct ArrivalsArgs {
    /// File of answers: `scan`, `answer`, `came_by`, `planner_path`, `end_panos` and `arrived` of each.
    file: PathBuf,
    /// Folder of Matterport3D's and REVERIE's data.
    #[arg(long)]
    data: PathBuf,
    /// Seed of the interval.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
}

/// An answer to a question on the way.
#[derive(Debug, Deserialize)]
struct GuideAnswer {
    scan: SceneId,
    answer: String,
    /// The last viewpoints before the question, the place of the question last.
    came_by: Vec<ViewpointId>,
    /// The guide's next hops from there.
    planner_path: Vec<ViewpointId>,
    /// The goal region.
    end_panos: Vec<ViewpointId>,
    /// Whether the person ended in the goal region: 0 or 1.
    arrived: u8,
}

/// An answer with the follower's probabilities.
struct ForeseenArrival {
    /// The index of its dialogue: answers on the way to one goal region.
    dialogue: usize,
    has_arrived: bool,
    /// By the answer, by no words, and by how near the end of the guide's next hops is, metres times -1.
    scores: [f64; 3],
}

/// The figures of a file. Each area is that under the curve of hits over false alarms, from 0 to 1.
#[derive(Debug, Serialize)]
struct ArrivalFigures {
    answers: usize,
    /// Answers that were left out, because a viewpoint is not in the data.
    left_out: usize,
    arrived: usize,
    auc: f64,
    auc_words_hidden: f64,
    auc_planned_length: f64,
    gain: f64,
    /// The 95 % interval of the gain, by a bootstrap that draws whole dialogues.
    gain_low: f64,
    gain_high: f64,
}

/// Prints how well the follower foresees who arrives, with the answers' words and without.
///
/// # Errors
/// When the data or the file cannot be read.
pub fn measure_arrivals(flags: &ArrivalsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let answers = read_answers(&flags.file)?;
    let names: BTreeSet<&SceneId> = answers.iter().map(|answer| &answer.scan).collect();
    let scenes = read_scenes(&flags.data, &names)?;
    let mut dialogues: BTreeMap<(&SceneId, &[ViewpointId]), usize> = BTreeMap::new();
    let mut numbered = Vec::with_capacity(answers.len());
    for answer in &answers {
        let next = dialogues.len();
        numbered.push((answer, *dialogues.entry((&answer.scan, &answer.end_panos)).or_insert(next)));
    }
    let foresee = |(answer, dialogue): &(&GuideAnswer, usize)| {
        let scene = scenes.iter().find(|scene| scene.name == answer.scan)?;
        let scores = answer.scores(scene)?;
        Some(ForeseenArrival { dialogue: *dialogue, has_arrived: answer.arrived > 0, scores })
    };
    let foreseen: Vec<ForeseenArrival> = numbered.par_iter().filter_map(foresee).collect();
    let figures = ArrivalFigures::measure(&foreseen, answers.len() - foreseen.len(), dialogues.len(), flags.seed);
    output.print_result(&figures, figures.to_lines());
    Ok(())
}

fn read_answers(file: &Path) -> Result<Vec<GuideAnswer>, CommandError> {
    let bytes = std::fs::read(file).map_err(CommandError::io(file, "read"))?;
    serde_json::from_slice(&bytes).map_err(|error| {
        let problem = format!("{}: it is no file of answers: {error}", file.display());
        CommandError::usage(
            problem,
            "give a list of objects with scan, answer, came_by, planner_path, end_panos and arrived",
        )
    })
}

impl GuideAnswer {
    /// The scores of [`ForeseenArrival`]; `None` if a viewpoint is not in the scene.
    fn scores(&self, scene: &FollowerScene) -> Option<[f64; 3]> {
        let numbers = |ids: &[ViewpointId]| ids.iter().map(|id| scene.viewpoint_number(id)).collect::<Option<Vec<_>>>();
        let (came_by, planned) = (numbers(&self.came_by)?, numbers(&self.planner_path)?);
        let ends: BTreeSet<usize> = numbers(&self.end_panos)?.into_iter().collect();
        let arrival = came_by.windows(2).next_back();
        let heading = arrival.and_then(|hop| Heading::towards(scene.position(hop[0]), scene.position(hop[1])));
        let heading_rad = heading.map_or(0.0, |heading| heading.rad());
        // The walks that `reader-map` considers by default.
        let AskedPrior(prior) = AskedPrior::default();
        let tree = WalkTree::from_prior(&scene.building, *planned.first()?, heading_rad, prior);
        let arrives = |words: &str| {
            let guide = Guide::read_text(words);
            let fit = WalkFit::new(&GuideTrial::new(&guide, &scene.building), &tree, FeatureWeights::fitted());
            let shares = walk_shares(&fit, &tree);
            let ending = (1..tree.len()).filter(|walk| ends.contains(&tree.end_viewpoint(*walk)));
            ending.map(|walk| shares[walk]).sum::<f64>()
        };
        let planned_m: f64 = planned.windows(2).map(|hop| scene.building.distance_m(hop[0], hop[1])).sum();
        Some([arrives(&self.answer), arrives(""), -planned_m])
    }
}

impl ArrivalFigures {
    fn measure(foreseen: &[ForeseenArrival], left_out: usize, dialogues: usize, seed: u64) -> Self {
        let mut by_dialogue = vec![Vec::new(); dialogues];
        for (at, arrival) in foreseen.iter().enumerate() {
            by_dialogue[arrival.dialogue].push(at);
        }
        let area = |drawn: &[usize], score: usize| {
            let cases = drawn.iter().map(|at| (foreseen[*at].has_arrived, foreseen[*at].scores[score]));
            area_under_curve(cases.collect())
        };
        let all: Vec<usize> = (0..foreseen.len()).collect();
        let [auc, auc_words_hidden, auc_planned_length] = [0, 1, 2].map(|score| area(&all, score));
        let drawing = ResamplingOptions { resamples: RESAMPLE_COUNT, level: 0.95, seed };
        let [(gain_low, gain_high)] = resampled_intervals(dialogues, &drawing, |draws| {
            let drawn: Vec<usize> = draws.iter().flat_map(|dialogue| &by_dialogue[*dialogue]).copied().collect();
            [area(&drawn, 0) - area(&drawn, 1)]
        });
        Self {
            answers: foreseen.len(),
            left_out,
            arrived: foreseen.iter().filter(|arrival| arrival.has_arrived).count(),
            auc,
            auc_words_hidden,
            auc_planned_length,
            gain: auc - auc_words_hidden,
            gain_low,
            gain_high,
        }
    }

    fn to_lines(&self) -> String {
        format!(
            "{} answers ({} left out: a viewpoint is not in the data); {} people arrived\n\
             AUC of \"the person arrives\": {:.3}; with the words hidden {:.3}; by the planned length alone {:.3}\n\
             gain by the words {:.3} [{:.3}, {:.3}]",
            self.answers,
            self.left_out,
            self.arrived,
            self.auc,
            self.auc_words_hidden,
            self.auc_planned_length,
            self.gain,
            self.gain_low,
            self.gain_high
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrival(dialogue: usize, has_arrived: bool, scores: [f64; 3]) -> ForeseenArrival {
        ForeseenArrival { dialogue, has_arrived, scores }
    }

    #[test]
    fn measure_finds_the_gain_of_words_that_tell_who_arrives() {
        let foreseen: Vec<ForeseenArrival> = (0..40)
            .map(|at| {
                let has_arrived = at % 2 == 0;
                arrival(at / 4, has_arrived, [f64::from(u8::from(has_arrived)), 0.5, -(at as f64)])
            })
            .collect();
        let figures = ArrivalFigures::measure(&foreseen, 3, 10, 0);
        assert_eq!((figures.answers, figures.left_out, figures.arrived), (40, 3, 20));
        assert_eq!((figures.auc, figures.auc_words_hidden, figures.gain), (1.0, 0.5, 0.5));
        assert!(figures.gain_low > 0.4 && figures.gain_high <= 0.5, "{figures:?}");
        assert!((figures.auc_planned_length - 0.525).abs() < 1e-9, "{figures:?}");
    }

    #[test]
    fn measure_of_nothing_has_no_gain() {
        let figures = ArrivalFigures::measure(&[], 2, 0, 0);
        assert_eq!((figures.answers, figures.left_out, figures.gain), (0, 2, 0.0));
    }

    #[test]
    fn read_answers_says_what_a_file_must_have() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("answers.json");
        std::fs::write(&file, r#"[{"scan": "s", "answer": "go on"}]"#).unwrap();
        let error = read_answers(&file).unwrap_err().to_string();
        assert!(error.contains("answers.json") && error.contains("came_by"), "{error}");
    }
}
