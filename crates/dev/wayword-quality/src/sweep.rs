//! Tries out the settings of agents on a train split, because the papers do not publish theirs.

use clap::Args;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::{fmt::Write as _, path::PathBuf, sync::Arc};
use wayword_core::{Heading, PhraseGrounder, Platform, seeded_rng};
use wayword_experiments::{demands::PlatformDemands, encoder, episodes};
use wayword_formats::Episode;
use wayword_metrics::{AgentTrajectory, TrajectoryMetric, TrajectorySuccessRule, score_trajectory};
use wayword_navigation::{
    AgentView,
    agents::{AgentStart, BacktrackParameters, PhraseWalkParameters, walk_by_phrases},
    directions::{InstructionSplitter, RuleSplitter, SplitInstruction},
    grounders::{EncoderGrounder, GrounderScope, LexicalGrounder},
};
use wayword_run::{error::CommandError, output::CommandOutput, platforms};

/// The flags of `sweep`.
#[derive(Debug, Args)]
pub struct SweepArgs {
    /// Folder of Matterport3D's and REVERIE's data.
    #[arg(long)]
    data: PathBuf,
    /// Episodes to choose the settings on: a train split, never the one that agents are compared on.
    #[arg(long)]
    episodes: PathBuf,
    /// The grounder that scores views.
    #[arg(long, default_value = "labels/lexical", value_parser = ["labels", "labels/lexical"])]
    grounder: String,
    /// The sentence encoder of `labels`.
    #[arg(long, default_value = "hf/sentence-transformers/all-MiniLM-L6-v2")]
    encoder: String,
    /// Items, drawn by seed.
    #[arg(long, default_value_t = 500)]
    items: usize,
    /// Seed of the draw.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How many of the best settings to show.
    #[arg(long, default_value_t = 8)]
    show: usize,
}

/// One setting with the sums of its figures over the episodes.
struct SweptSetting {
    parameters: PhraseWalkParameters,
    /// The sums of [`SUMMED_METRICS`].
    sums: [f64; 3],
}

/// The figures that are summed; the settings are ranked by the last.
const SUMMED_METRICS: [TrajectoryMetric; 3] =
    [TrajectoryMetric::SuccessRate, TrajectoryMetric::OracleSuccessRate, TrajectoryMetric::Spl];

/// Tries settings of agents on episodes, and prints the best for whole views and for boxes.
///
/// # Errors
/// When the data, the episodes or the encoder cannot be read.
pub fn sweep_settings(flags: &SweepArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let platform = platforms::open_named("matterport", Some(&flags.data), None, None)?;
    let mut episodes = episodes::read_episodes(&flags.episodes, platform.as_ref())?;
    episodes.retain(|episode| !episode.instructions.is_empty() && platform.graph_for_scene(&episode.scene).is_ok());
    episodes.shuffle(&mut seeded_rng(flags.seed, &["sweep"]));
    episodes.truncate(flags.items);
    // Scene by scene, because a platform keeps only the last few scenes in memory.
    episodes.sort_by(|a, b| a.scene.cmp(&b.scene));
    for (name, sees) in
        [("whole views (clip-nav, seq-clip-nav)", GrounderScope::Views), ("boxes (glip-nav)", GrounderScope::Boxes)]
    {
        let grounder = open_grounder(flags, sees)?;
        let without =
            try_settings(platform.as_ref(), &episodes, grounder.as_ref(), &settings_without_back(&flags.grounder))?;
        output.print_result(
            &(),
            settings_table(&format!("{name}: without going back"), &without, episodes.len(), flags.show),
        );
        let Some(best) = without.first() else { continue };
        let with =
            try_settings(platform.as_ref(), &episodes, grounder.as_ref(), &settings_with_back(&best.parameters))?;
        output.print_result(&(), settings_table(&format!("{name}: going back"), &with, episodes.len(), flags.show));
    }
    Ok(())
}

fn open_grounder(flags: &SweepArgs, sees: GrounderScope) -> Result<Box<dyn PhraseGrounder>, CommandError> {
    Ok(match flags.grounder.as_str() {
        "labels" => Box::new(EncoderGrounder::new(sees, Arc::from(encoder::open_encoder(&flags.encoder)?))),
        _ => Box::new(LexicalGrounder::new(sees)),
    })
}

/// All settings that are tried without going back.
fn settings_without_back(grounder: &str) -> Vec<PhraseWalkParameters> {
    let default = PhraseWalkParameters::default_of("clip-nav", grounder);
    let mut all = Vec::new();
    for phrase_threshold in [0.3, 0.4, 0.5, 0.6, 0.8] {
        for stop_threshold in [0.3, 0.4, 0.5, 0.55, 0.6, 0.65, 0.7, 0.8] {
            for stop_with_phrases_left in [0, 1, 12] {
                for max_hops in [10, 15, 20, 30, 40] {
                    for shun_visited in [false, true] {
                        let tried = PhraseWalkParameters {
                            phrase_threshold,
                            stop_threshold,
                            stop_with_phrases_left,
                            max_hops,
                            shun_visited,
                            ..default
                        };
                        all.push(tried);
                    }
                }
            }
        }
    }
    all
}

/// All settings that are tried with going back: `best` with and without it.
fn settings_with_back(best: &PhraseWalkParameters) -> Vec<PhraseWalkParameters> {
    let mut all = vec![*best];
    for window in [3, 6, 8, 12] {
        for threshold in [0.05, 0.1, 0.2, 0.3, 0.4, 0.5] {
            for nodes in [1, 2, 3, 4] {
                all.push(PhraseWalkParameters {
                    back: Some(BacktrackParameters { window, threshold, nodes }),
                    ..*best
                });
            }
        }
    }
    all
}

/// The settings with their figures, the best first.
fn try_settings(
    platform: &dyn Platform,
    episodes: &[Episode],
    grounder: &dyn PhraseGrounder,
    settings: &[PhraseWalkParameters],
) -> Result<Vec<SweptSetting>, CommandError> {
    let demands = PlatformDemands::new(platform);
    let zeros = || vec![[0.0; 3]; settings.len()];
    let add = |mut a: Vec<[f64; 3]>, b: Vec<[f64; 3]>| {
        for (a, b) in a.iter_mut().zip(b) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        a
    };
    let sum_episode = |episode: &Episode| score_episode(platform, &demands, grounder, settings, episode);
    let sums = episodes.par_iter().map(sum_episode).try_reduce(zeros, |a, b| Ok(add(a, b)))?;
    let mut tried: Vec<SweptSetting> =
        settings.iter().zip(sums).map(|(parameters, sums)| SweptSetting { parameters: *parameters, sums }).collect();
    tried.sort_by(|a, b| b.sums[2].total_cmp(&a.sums[2]));
    Ok(tried)
}

/// The figures of the walk by the first instruction of an item, for each setting.
fn score_episode(
    platform: &dyn Platform,
    demands: &PlatformDemands<'_>,
    grounder: &dyn PhraseGrounder,
    settings: &[PhraseWalkParameters],
    episode: &Episode,
) -> Result<Vec<[f64; 3]>, CommandError> {
    let (distances, demand) = demands.for_episode(episode)?;
    let rule =
        if demand.visible_from.is_some() { TrajectorySuccessRule::Visible } else { TrajectorySuccessRule::Distance };
    let heading = episode.start_heading.unwrap_or(Heading::NORTH);
    let start = AgentStart { scene: episode.scene.clone(), viewpoint: episode.viewpoints[0].clone(), heading };
    let agent_view = AgentView::new(platform, grounder, false, &episode.scene)?;
    let directions: Vec<SplitInstruction> =
        RuleSplitter.split_instructions(&[&episode.instructions[0]]).into_iter().collect::<Result<_, _>>()?;
    let figures = |parameters: &PhraseWalkParameters| -> Result<[f64; 3], CommandError> {
        let walked = walk_by_phrases(&agent_view, &start, &directions[0], parameters)?;
        let viewpoints = walked.steps.into_iter().map(|step| step.viewpoint).collect();
        let scored = score_trajectory(&distances, &demand, &AgentTrajectory { viewpoints, object: None });
        let scored = scored.map_err(|problems| CommandError::usage(format!("{problems:?}"), "report this as a bug"))?;
        Ok(SUMMED_METRICS.map(|figure| scored.get(figure, rule).unwrap_or(0.0)))
    };
    settings.iter().map(figures).collect()
}

fn settings_table(name: &str, tried: &[SweptSetting], items: usize, show: usize) -> String {
    let mut text = format!("{name} (settings: {}, items: {items})\n    SR   OSR   SPL\n", tried.len());
    for SweptSetting { parameters, sums } in tried.iter().take(show) {
        let [sr, osr, spl] = sums.map(|sum| 100.0 * sum / items.max(1) as f64);
        let named: Vec<String> =
            parameters.by_name().into_iter().map(|(name, value)| format!("{name} {value}")).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{sr:6.2}{osr:6.2}{spl:6.2}  {}", named.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::TestBuildingFolder;
    use wayword_testkit::{SCAN, viewpoint_id};

    #[test]
    fn every_setting_is_tried_once() {
        let all = settings_without_back("labels/lexical");
        assert_eq!(all.len(), 5 * 8 * 3 * 5 * 2);
        assert_eq!(settings_with_back(&all[0]).len(), 1 + 4 * 6 * 4);
        assert!(all.iter().enumerate().all(|(at, one)| !all[..at].contains(one)));
    }

    /// An agent that may not move stays at the start. The goal of one episode is 1.9 m away, so staying is a success by
    /// the shortest way; that of the other is two hops of 4 m and more away.
    #[test]
    fn figures_are_sums_over_the_episodes_and_the_best_comes_first() {
        let building = TestBuildingFolder::new();
        let world = platforms::open_named("matterport", Some(&building.data_folder()), None, None).unwrap();
        let item = |number: usize, path: &[usize]| {
            let path: Vec<String> = path.iter().map(|at| viewpoint_id(*at)).collect();
            serde_json::json!({
                "distance": 1.0, "scan": SCAN, "path_id": number, "path": path, "heading": 0.0,
                "instructions": ["Walk to the end of the hallway."],
            })
        };
        let file = building.data_folder().join("two.json");
        std::fs::write(&file, serde_json::json!([item(1, &[6, 7]), item(2, &[0, 1, 4])]).to_string()).unwrap();
        let episodes = episodes::read_episodes(&file, world.as_ref()).unwrap();
        let default = PhraseWalkParameters::default_of("clip-nav", "labels/lexical");
        let stays = PhraseWalkParameters { max_hops: 0, back: None, ..default };
        let tried =
            try_settings(world.as_ref(), &episodes, &LexicalGrounder::new(GrounderScope::Views), &[stays, default])
                .unwrap();
        let of_stays = tried.iter().find(|tried| tried.parameters == stays).unwrap();
        assert_eq!(of_stays.sums, [1.0, 1.0, 1.0]);
        assert!(tried[0].sums[2] >= tried[1].sums[2]);
    }

    #[test]
    fn the_table_has_percentages_of_the_items() {
        let default = PhraseWalkParameters::default_of("clip-nav", "labels/lexical");
        let tried = [SweptSetting { parameters: default, sums: [2.0, 3.0, 1.0] }];
        let table = settings_table("agents", &tried, 4, 8);
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("agents (settings: 1, items: 4)"));
        assert_eq!(lines.next(), Some("    SR   OSR   SPL"));
        assert!(lines.next().unwrap().starts_with(" 50.00 75.00 25.00  "), "{table}");
    }
}
