//! Fits the weights of the follower to people's texts of known walks, and prints how they do on buildings that were left
//! out.

mod gains;
pub mod texts;
mod walker;

use clap::Args;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use texts::{FollowerScene, WalkedText, read_texts};
use wayword_core::{SceneId, seeded_rng};
use wayword_follower::{
    FeatureWeights, Guide, GuideTrial, WalkFit, WalkPrior, WalkTree, best_walk,
    change::flip_turns,
    learn::{FitPlan, FitSlope, WeightLearner},
    online::{OnwardLearner, OnwardSlope, OnwardWeights},
};
use wayword_run::{error::CommandError, output::CommandOutput, people::left_out, written_files::write_file};

/// The weight of the contrast between a text and the same text with one turn flipped.
const CONTRAST_WEIGHT: f64 = 1.0;
/// How many texts one thread adds up at a time.
const TEXTS_PER_CHUNK: usize = 8;

/// The flags of `fit-follower`.
#[derive(Debug, Args)]
pub struct FitFollowerArgs {
    /// Folder of Matterport3D's and REVERIE's data.
    #[arg(long)]
    data: PathBuf,
    /// File with texts, as R2R_train.json. It can be given several times. The last ten buildings by name are left out.
    #[arg(long, required = true)]
    episodes: Vec<PathBuf>,
    /// Seed of the order of texts.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Rounds over all texts, for the follower that knows the map.
    #[arg(long, default_value_t = 7)]
    rounds: usize,
    /// Rounds over all texts, for the follower that walks.
    #[arg(long, default_value_t = 4)]
    walker_rounds: usize,
    /// Fit on at most this many texts.
    #[arg(long)]
    texts: Option<usize>,
    /// Write the weights into this folder: `map.json` for a follower that knows the map, `walker.json` for one that walks.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Fits the weights of both followers, prints how they do on the buildings that were left out, and writes the files.
///
/// # Errors
/// When the data or the texts cannot be read, or a file cannot be written.
pub fn fit_follower_weights(flags: &FitFollowerArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let (scenes, files) = read_texts(&flags.data, &flags.episodes)?;
    let names: BTreeSet<SceneId> = scenes.iter().map(|scene| scene.name.clone()).collect();
    let left_out = left_out(&names);
    // The texts about the buildings that are left out, file by file, and all other texts together.
    let (mut apart, mut fitted) = (Vec::new(), Vec::new());
    for (number, (file, texts)) in flags.episodes.iter().zip(files).enumerate() {
        let (out_texts, fit_texts): (Vec<WalkedText>, Vec<WalkedText>) =
            texts.into_iter().partition(|text| left_out.contains(&scenes[text.scene].name));
        apart.push((file_name(file), out_texts));
        fitted.extend(fit_texts.into_iter().map(|text| WalkedText { file: number, ..text }));
    }
    fitted.shuffle(&mut seeded_rng(flags.seed, &["fit-follower"]));
    fitted.truncate(flags.texts.unwrap_or(usize::MAX));
    let names = left_out.iter().map(SceneId::as_str).collect::<Vec<_>>().join(" ");
    output.say(format!("{} texts; left out: {names}", fitted.len()));
    let print_scores = |follower: &str, score: &dyn Fn(&[WalkedText]) -> String| {
        for (file, texts) in &apart {
            output.say(format!("{follower}, on the buildings left out of {file}: {}", score(texts)));
        }
    };
    print_scores("by hand", &|texts| score_with_map(&scenes, texts, &FeatureWeights::by_hand()));
    let map = fit_map(flags, &scenes, &fitted, output);
    print_scores("with the map", &|texts| score_with_map(&scenes, texts, &map));
    for (number, file) in flags.episodes.iter().enumerate() {
        let texts: Vec<&WalkedText> = fitted.iter().filter(|text| text.file == number).collect();
        output.say(format!("shares of the texts of {} that a change gains more for:", file_name(file)));
        output.say(gains::gain_table(&scenes, &texts, &map));
    }
    let start = OnwardWeights { done: map.clone(), going: map.clone(), ..OnwardWeights::by_hand() };
    let walking = fit_walker(flags, &scenes, &fitted, &start, output);
    print_scores("walking", &|texts| walker::score_walker(&scenes, texts, &walking));
    if let Some(out) = &flags.out {
        let files: Vec<String> = flags.episodes.iter().map(|file| file_name(file)).collect();
        let origin = format!("people's texts of {}, without the last ten buildings by name", files.join(" and "));
        let episode_flags: String = files.iter().map(|file| format!(" --episodes {file}")).collect();
        let FitFollowerArgs { seed, rounds, walker_rounds, .. } = flags;
        let command = format!(
            "wayword-measure fit-follower --data DATA{episode_flags} --seed {seed} --rounds {rounds} --walker-rounds \
             {walker_rounds} --out DIR"
        );
        for (name, text) in
            [("map.json", map.to_json(&origin, &command)), ("walker.json", walking.to_json(&origin, &command))]
        {
            write_file(&out.join(name), text)?;
        }
    }
    Ok(())
}

/// The name of a file, without its folder.
fn file_name(file: &Path) -> String {
    file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Fits the follower that knows the map: in each round, over all texts in batches, it moves the weights so that people's walks become
/// likelier than other walks from the same start.
fn fit_map(
    flags: &FitFollowerArgs,
    scenes: &[FollowerScene],
    texts: &[WalkedText],
    output: &CommandOutput,
) -> FeatureWeights {
    let plan = FitPlan { rounds: flags.rounds, rate: 0.04, batch: 48, hold: 2e-4, hold_fine: 5.0 };
    let trees: Vec<WalkTree> = texts.par_iter().map(|text| walk_tree(scenes, text)).collect();
    let items: Vec<(&WalkedText, &WalkTree)> = texts.iter().zip(&trees).collect();
    let mut learner = WeightLearner::new(plan, &FeatureWeights::by_hand());
    for round in 0..plan.rounds {
        let mut loss = 0.0;
        for batch in items.chunks(plan.batch) {
            let weights = learner.current_weights();
            let slopes = batch.par_chunks(TEXTS_PER_CHUNK).map(|items| {
                let mut slope = FitSlope::default();
                items.iter().for_each(|(text, tree)| add_text_slope(&mut slope, scenes, text, tree, &weights));
                slope
            });
            let slope = slopes.reduce(FitSlope::default, |a, b| a.plus(&b));
            loss += slope.loss;
            learner.step_down(round, &slope);
        }
        output.say(format!("map, round {}: loss {:.3}", round + 1, loss / items.len().max(1) as f64));
    }
    learner.finish()
}

/// Adds what one text teaches to the slope of a batch: its walk against the other walks, and its turns against flipped ones.
fn add_text_slope(
    slope: &mut FitSlope,
    scenes: &[FollowerScene],
    text: &WalkedText,
    tree: &WalkTree,
    weights: &FeatureWeights,
) {
    let building = &scenes[text.scene].building;
    let true_trial = GuideTrial::new(&text.guide, building);
    if let Some(goal) = tree.find_walk(&text.walk) {
        slope.add_text(&true_trial, tree, goal, weights);
        // The same walk by an empty text teaches how long people's walks are, for texts of which no word is understood.
        let empty_guide = Guide::read_text("");
        slope.add_empty_text(&GuideTrial::new(&empty_guide, building), tree, goal, weights);
    }
    let walk = WalkTree::single_walk(building, &text.walk, text.heading_rad);
    for flipped in flip_turns(&text.guide) {
        slope.add_contrast(&true_trial, &GuideTrial::new(&flipped, building), &walk, weights, CONTRAST_WEIGHT);
    }
}

/// Fits the follower without a map, which decides at each viewpoint. It begins with the weights `start`.
fn fit_walker(
    flags: &FitFollowerArgs,
    scenes: &[FollowerScene],
    texts: &[WalkedText],
    start: &OnwardWeights,
    output: &CommandOutput,
) -> OnwardWeights {
    let plan = FitPlan { rounds: flags.walker_rounds, rate: 0.03, batch: 32, hold: 1e-4, hold_fine: 5.0 };
    let mut learner = OnwardLearner::new(plan, start);
    for round in 0..plan.rounds {
        let (mut loss, mut decisions) = (0.0, 0);
        for (number, batch) in texts.chunks(plan.batch).enumerate() {
            let weights = learner.current_weights();
            let slopes = batch.par_iter().enumerate().map(|(at, text)| {
                let mut slope = OnwardSlope::default();
                // Half of the texts are walked along the shortest way, the other half by the walker's own decisions.
                let is_own = (round + number + at) % 2 == 0;
                walker::teach_walker(&scenes[text.scene], text, &weights, is_own, &mut slope);
                slope
            });
            let slope = slopes.reduce(OnwardSlope::default, |a, b| a.plus(&b));
            (loss, decisions) = (loss + slope.loss, decisions + slope.decisions);
            learner.step_down(round, &slope);
        }
        let mean = loss / decisions.max(1) as f64;
        output.say(format!("walker, round {}: loss {mean:.3} of {decisions} decisions", round + 1));
    }
    learner.finish()
}

/// The walks that are possible from the start of a text's walk. The follower compares people's walk with them.
fn walk_tree(scenes: &[FollowerScene], text: &WalkedText) -> WalkTree {
    WalkTree::from_prior(&scenes[text.scene].building, text.walk[0], text.heading_rad, WalkPrior::default())
}

/// Success rate and SPL (success weighted by path length) of the likeliest walk of each text, for the follower that knows the map.
fn score_with_map(scenes: &[FollowerScene], texts: &[WalkedText], weights: &FeatureWeights) -> String {
    let scores = texts.par_iter().map(|text| {
        let scene = &scenes[text.scene];
        let tree = walk_tree(scenes, text);
        let fit = WalkFit::new(&GuideTrial::new(&text.guide, &scene.building), &tree, weights);
        best_walk(&fit, &tree).map_or([0.0; 2], |walk| text.score_walk(scene, &tree.viewpoints(walk)))
    });
    texts::mean_scores(scores)
}
