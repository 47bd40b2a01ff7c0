//! Tries out the settings of agents on a train split, because the papers do not publish theirs.

use clap::Args;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::{fmt::Write as _, path::PathBuf, sync::Arc};
use wayword_core::{Grounder, Heading, Platform, rng};
use wayword_experiments::{demands::Demands, encoder, episodes};
use wayword_formats::Episode;
use wayword_metrics::{Metric, Rule, Trajectory, score};
use wayword_navigation::{
    AgentView,
    agents::{Back, Parameters, Start, walk_by_phrases},
    directions::{ByRules, Directions, Splitter},
    grounders::{Lexical, Sees, Similar},
};
use wayword_run::{error::Error, output::Output, platforms};

/// The flags of `sweep`.
#[derive(Debug, Args)]
pub struct Flags {
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
struct Tried {
    parameters: Parameters,
    sums: [f64; 3],
}

/// The figures that are summed; the settings are ranked by the last.
const FIGURES: [Metric; 3] = [Metric::SuccessRate, Metric::OracleSuccessRate, Metric::Spl];

pub fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let platform = platforms::open_named("matterport", Some(&flags.data), None, None)?;
    let mut episodes = episodes::read(&flags.episodes, platform.as_ref())?;
    episodes.retain(|episode| !episode.instructions.is_empty() && platform.graph(&episode.scene).is_ok());
    episodes.shuffle(&mut rng(flags.seed, &["sweep"]));
    episodes.truncate(flags.items);
    // Scene by scene, because a platform keeps only the last few scenes in memory.
    episodes.sort_by(|a, b| a.scene.cmp(&b.scene));
    for (name, sees) in [("whole views (clip-nav, seq-clip-nav)", Sees::Views), ("boxes (glip-nav)", Sees::Boxes)] {
        let grounder = grounder(flags, sees)?;
        let without = swept(platform.as_ref(), &episodes, grounder.as_ref(), &walks(&flags.grounder))?;
        output.data(&(), table(&format!("{name}: without going back"), &without, episodes.len(), flags.show));
        let Some(best) = without.first() else { continue };
        let with = swept(platform.as_ref(), &episodes, grounder.as_ref(), &backs(&best.parameters))?;
        output.data(&(), table(&format!("{name}: going back"), &with, episodes.len(), flags.show));
    }
    Ok(())
}

fn grounder(flags: &Flags, sees: Sees) -> Result<Box<dyn Grounder>, Error> {
    Ok(match flags.grounder.as_str() {
        "labels" => Box::new(Similar::new(sees, Arc::from(encoder::encoder(&flags.encoder)?))),
        _ => Box::new(Lexical::new(sees)),
    })
}

/// All settings that are tried without going back.
fn walks(grounder: &str) -> Vec<Parameters> {
    let default = Parameters::default_of("clip-nav", grounder);
    let mut all = Vec::new();
    for phrase_threshold in [0.3, 0.4, 0.5, 0.6, 0.8] {
        for stop_threshold in [0.3, 0.4, 0.5, 0.55, 0.6, 0.65, 0.7, 0.8] {
            for stop_with_phrases_left in [0, 1, 12] {
                for max_hops in [10, 15, 20, 30, 40] {
                    for shun_visited in [false, true] {
                        let tried = Parameters {
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

/// All settings that are tried for going back.
fn backs(best: &Parameters) -> Vec<Parameters> {
    let mut all = vec![*best];
    for window in [3, 6, 8, 12] {
        for threshold in [0.05, 0.1, 0.2, 0.3, 0.4, 0.5] {
            for nodes in [1, 2, 3, 4] {
                all.push(Parameters { back: Some(Back { window, threshold, nodes }), ..*best });
            }
        }
    }
    all
}

/// The settings with their figures, the best first.
fn swept(
    platform: &dyn Platform,
    episodes: &[Episode],
    grounder: &dyn Grounder,
    settings: &[Parameters],
) -> Result<Vec<Tried>, Error> {
    let demands = Demands::new(platform);
    let nothing = || vec![[0.0; 3]; settings.len()];
    let add = |mut a: Vec<[f64; 3]>, b: Vec<[f64; 3]>| {
        for (a, b) in a.iter_mut().zip(b) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        a
    };
    let of_episode = |episode: &Episode| of_episode(platform, &demands, grounder, settings, episode);
    let sums = episodes.par_iter().map(of_episode).try_reduce(nothing, |a, b| Ok(add(a, b)))?;
    let mut tried: Vec<Tried> =
        settings.iter().zip(sums).map(|(parameters, sums)| Tried { parameters: *parameters, sums }).collect();
    tried.sort_by(|a, b| b.sums[2].total_cmp(&a.sums[2]));
    Ok(tried)
}

/// Figures of the first instruction of an item, for each setting.
fn of_episode(
    platform: &dyn Platform,
    demands: &Demands<'_>,
    grounder: &dyn Grounder,
    settings: &[Parameters],
    episode: &Episode,
) -> Result<Vec<[f64; 3]>, Error> {
    let (distances, demand) = demands.of(episode)?;
    let rule = if demand.visible_from.is_some() { Rule::Visible } else { Rule::Distance };
    let heading = episode.start_heading.unwrap_or(Heading::NORTH);
    let start = Start { scene: episode.scene.clone(), viewpoint: episode.viewpoints[0].clone(), heading };
    let agent_view = AgentView::new(platform, grounder, false, &episode.scene)?;
    let directions: Vec<Directions> =
        ByRules.split(&[&episode.instructions[0]]).into_iter().collect::<Result<_, _>>()?;
    let figures = |parameters: &Parameters| -> Result<[f64; 3], Error> {
        let walked = walk_by_phrases(&agent_view, &start, &directions[0], parameters)?;
        let viewpoints = walked.steps.into_iter().map(|step| step.viewpoint).collect();
        let scored = score(&distances, &demand, &Trajectory { viewpoints, object: None });
        let scored = scored.map_err(|problems| Error::usage(format!("{problems:?}"), "report this as a bug"))?;
        Ok(FIGURES.map(|figure| scored.get(figure, rule).unwrap_or(0.0)))
    };
    settings.iter().map(figures).collect()
}

fn table(name: &str, tried: &[Tried], items: usize, show: usize) -> String {
    let mut text = format!("{name} (settings: {}, items: {items})\n    SR   OSR   SPL\n", tried.len());
    for Tried { parameters, sums } in tried.iter().take(show) {
        let [sr, osr, spl] = sums.map(|sum| 100.0 * sum / items.max(1) as f64);
        let named: Vec<String> =
            parameters.named().into_iter().map(|(name, value)| format!("{name} {value}")).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{sr:6.2}{osr:6.2}{spl:6.2}  {}", named.join(", "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up::Building;
    use wayword_testkit::{SCAN, viewpoint_id};

    #[test]
    fn every_setting_is_tried_once() {
        let all = walks("labels/lexical");
        assert_eq!(all.len(), 5 * 8 * 3 * 5 * 2);
        assert_eq!(backs(&all[0]).len(), 1 + 4 * 6 * 4);
        assert!(all.iter().enumerate().all(|(at, one)| !all[..at].contains(one)));
    }

    /// An agent that may not move stays at the start. The goal of one episode is 1.9 m away, so staying is a success by
    /// the shortest way; that of the other is two hops of 4 m and more away.
    #[test]
    fn figures_are_sums_over_the_episodes_and_the_best_comes_first() {
        let building = Building::new();
        let world = platforms::open_named("matterport", Some(&building.data()), None, None).unwrap();
        let item = |number: usize, path: &[usize]| {
            let path: Vec<String> = path.iter().map(|at| viewpoint_id(*at)).collect();
            serde_json::json!({
                "distance": 1.0, "scan": SCAN, "path_id": number, "path": path, "heading": 0.0,
                "instructions": ["Walk to the end of the hallway."],
            })
        };
        let file = building.data().join("two.json");
        std::fs::write(&file, serde_json::json!([item(1, &[6, 7]), item(2, &[0, 1, 4])]).to_string()).unwrap();
        let episodes = episodes::read(&file, world.as_ref()).unwrap();
        let default = Parameters::default_of("clip-nav", "labels/lexical");
        let stays = Parameters { max_hops: 0, back: None, ..default };
        let tried = swept(world.as_ref(), &episodes, &Lexical::new(Sees::Views), &[stays, default]).unwrap();
        let of_stays = tried.iter().find(|tried| tried.parameters == stays).unwrap();
        assert_eq!(of_stays.sums, [1.0, 1.0, 1.0]);
        assert!(tried[0].sums[2] >= tried[1].sums[2]);
    }

    #[test]
    fn the_table_has_percentages_of_the_items() {
        let default = Parameters::default_of("clip-nav", "labels/lexical");
        let tried = [Tried { parameters: default, sums: [2.0, 3.0, 1.0] }];
        let table = table("agents", &tried, 4, 8);
        let mut lines = table.lines();
        assert_eq!(lines.next(), Some("agents (settings: 1, items: 4)"));
        assert_eq!(lines.next(), Some("    SR   OSR   SPL"));
        assert!(lines.next().unwrap().starts_with(" 50.00 75.00 25.00  "), "{table}");
    }
}
