//! Compares several sets of texts for the same buildings: how an agent's success varies between the sets, and whether the sets rank
//! agents alike.

use crate::ratio::BootstrapOptions;
use rand::Rng;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::seeded_rng;
use wayword_metrics::{kendall_tau_b, percentile_interval};

/// An agent's success with one text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FollowResult {
    /// The agent.
    pub agent: String,
    /// The set of the text.
    pub set: String,
    /// The scene of its path.
    pub scene: String,
    /// Its path.
    pub path: String,
    /// The item of its text.
    pub item: String,
    /// Which of the item's texts in that set, from 0.
    pub text_index: usize,
    /// 1 if the agent arrived, else 0.
    pub success: f64,
}

/// An agent's success rates with several sets.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AgentSuccess {
    /// The agent.
    pub agent: String,
    /// Its success rate with each set, over the paths that all sets have. Each path counts once, with the mean of its texts.
    pub of_set: BTreeMap<String, f64>,
    /// The mean over sets.
    pub mean: f64,
    /// The standard deviation over sets; `None` for a single set.
    pub spread: Option<f64>,
    /// The number of paths.
    pub paths: usize,
    /// From where the variance of success comes.
    pub shares: Option<VarianceShares>,
}

/// The sources of the variance of success, as shares that add up to 1. Each has a value and the two bounds of its interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VarianceShares {
    /// From scene to scene.
    pub scene: [f64; 3],
    /// From path to path within a scene.
    pub path: [f64; 3],
    /// From set to set.
    pub set: [f64; 3],
    /// The rest: chance, and paths that are harder with one set than with another.
    pub rest: [f64; 3],
}

/// Whether two sets rank agents alike.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankingAgreement {
    /// The first set.
    pub one: String,
    /// The second set.
    pub other: String,
    /// Kendall's tau-b of the agents' success rates; `None` for fewer than two agents, or if all agents tie in one set.
    pub tau_b: Option<f64>,
    /// Its interval, by a bootstrap over whole scenes.
    pub interval: Option<[f64; 2]>,
}

/// By scene and path: for each set the sum and the number of its successes.
type SuccessSums<'a> = BTreeMap<&'a str, BTreeMap<&'a str, Vec<(f64, usize)>>>;

/// Success by path: for each scene its paths, for each path a mean for each set.
type SuccessTable = Vec<Vec<Vec<f64>>>;

/// Computes the success rates of each agent with the sets. Only paths that the agent has walked with every set count.
#[must_use]
pub fn agent_success_rates(followed: &[FollowResult], drawing: BootstrapOptions) -> Vec<AgentSuccess> {
    let sets: Vec<&str> = followed.iter().map(|one| one.set.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
    let agents: BTreeSet<&str> = followed.iter().map(|one| one.agent.as_str()).collect();
    let rates_of_agent = |agent: &str| {
        let table = success_table(followed, agent, &sets);
        let rows: Vec<&Vec<f64>> = table.iter().flatten().collect();
        let mean = |at: usize| rows.iter().map(|row| row[at]).sum::<f64>() / rows.len().max(1) as f64;
        let means: Vec<f64> = (0..sets.len()).map(mean).collect();
        let all = means.iter().sum::<f64>() / means.len().max(1) as f64;
        let squares: f64 = means.iter().map(|one| (one - all) * (one - all)).sum();
        AgentSuccess {
            agent: agent.to_owned(),
            of_set: sets.iter().map(|set| (*set).to_owned()).zip(means.iter().copied()).collect(),
            mean: all,
            spread: (means.len() > 1).then(|| (squares / (means.len() - 1) as f64).sqrt()),
            paths: rows.len(),
            shares: variance_shares(&table, drawing),
        }
    };
    agents.into_iter().map(rates_of_agent).filter(|found| found.paths > 0).collect()
}

/// The success of one agent by scene, path and set. Paths that lack a set are left out.
fn success_table(followed: &[FollowResult], agent: &str, sets: &[&str]) -> SuccessTable {
    let mut sums = SuccessSums::new();
    for one in followed.iter().filter(|one| one.agent == agent) {
        let Ok(at) = sets.binary_search(&one.set.as_str()) else { continue };
        let row = sums.entry(&one.scene).or_default().entry(&one.path).or_insert_with(|| vec![(0.0, 0); sets.len()]);
        row[at] = (row[at].0 + one.success, row[at].1 + 1);
    }
    let row = |row: Vec<(f64, usize)>| {
        let mean = |(sum, count): &(f64, usize)| (*count > 0).then(|| sum / *count as f64);
        row.iter().map(mean).collect::<Option<Vec<f64>>>()
    };
    let scenes = sums.into_values().map(|paths| paths.into_values().filter_map(row).collect::<Vec<_>>());
    scenes.filter(|paths| !paths.is_empty()).collect()
}

/// The shares of variance with their intervals; `None` without two sets, two scenes, and a scene with two paths.
fn variance_shares(table: &SuccessTable, drawing: BootstrapOptions) -> Option<VarianceShares> {
    let all: Vec<&Vec<Vec<f64>>> = table.iter().collect();
    let found = variance_components(&all)?;
    let mut dice = seeded_rng(drawing.seed, &["shares of variance"]);
    let mut drawn: [Vec<f64>; 4] = Default::default();
    for _ in 0..drawing.resamples {
        let scenes: Vec<&Vec<Vec<f64>>> = (0..all.len()).map(|_| all[dice.random_range(0..all.len())]).collect();
        for (values, share) in drawn.iter_mut().zip(variance_components(&scenes).into_iter().flatten()) {
            values.push(share);
        }
    }
    let with_interval = |at: usize| {
        let [low, high] = percentile_interval(drawn[at].clone(), drawing.level).unwrap_or([found[at]; 2]);
        [found[at], low, high]
    };
    Some(VarianceShares {
        scene: with_interval(0),
        path: with_interval(1),
        set: with_interval(2),
        rest: with_interval(3),
    })
}

/// The shares of scene, path, set and the rest, by a random effects model. Paths are nested in scenes and crossed with sets. The
/// components are estimated by the method of moments: mean squares are set equal to their expected values (Searle, Casella, McCulloch,
/// "Variance Components", 1992, ch. 4). A negative component counts as 0.
fn variance_components(scenes: &[&Vec<Vec<f64>>]) -> Option<[f64; 4]> {
    let rows: Vec<&Vec<f64>> = scenes.iter().flat_map(|scene| scene.iter()).collect();
    let (paths, sets) = (rows.len(), rows.first()?.len());
    if sets < 2 || scenes.len() < 2 || paths == scenes.len() {
        return None;
    }
    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0usize), |(sum, count), value| (sum + value, count + 1));
        sum / count.max(1) as f64
    };
    let row_mean = |row: &[f64]| mean(&mut row.iter().copied());
    let grand_mean = mean(&mut rows.iter().map(|row| row_mean(row)));
    let square = |value: f64| value * value;
    let (mut scene_squares, mut path_squares) = (0.0, 0.0);
    for scene in scenes {
        let here = mean(&mut scene.iter().map(|row| row_mean(row)));
        scene_squares += scene.len() as f64 * square(here - grand_mean);
        path_squares += scene.iter().map(|row| square(row_mean(row) - here)).sum::<f64>();
    }
    let set_means: Vec<f64> = (0..sets).map(|at| mean(&mut rows.iter().map(|row| row[at]))).collect();
    let set_squares: f64 = set_means.iter().map(|one| square(one - grand_mean)).sum();
    let rest: f64 = rows
        .iter()
        .map(|row| {
            let here = row_mean(row);
            row.iter().zip(&set_means).map(|(value, set)| square(value - here - set + grand_mean)).sum::<f64>()
        })
        .sum();
    // The numbers of sets, paths and scenes.
    let [s, p, c] = [sets, paths, scenes.len()].map(|count| count as f64);
    // Mean squares: sums of squares divided by their degrees of freedom.
    let ms_rest = rest / ((s - 1.0) * (p - 1.0));
    let ms_path = s * path_squares / (p - c);
    let ms_scene = s * scene_squares / (c - 1.0);
    let ms_set = p * set_squares / (s - 1.0);
    // The effective number of paths per scene, where scenes have different numbers.
    let per_scene = (p - scenes.iter().map(|scene| square(scene.len() as f64)).sum::<f64>() / p) / (c - 1.0);
    let parts = [(ms_scene - ms_path) / (s * per_scene), (ms_path - ms_rest) / s, (ms_set - ms_rest) / p, ms_rest];
    let parts = parts.map(|part| f64::max(part, 0.0));
    let sum: f64 = parts.iter().sum();
    (sum > 0.0).then(|| parts.map(|part| part / sum))
}

/// Computes for each pair of sets whether they rank the agents alike, over the paths that every agent has walked with every set.
#[must_use]
pub fn compare_rankings(followed: &[FollowResult], drawing: BootstrapOptions) -> Vec<RankingAgreement> {
    let sets: Vec<&str> = followed.iter().map(|one| one.set.as_str()).collect::<BTreeSet<_>>().into_iter().collect();
    let agents: BTreeSet<&str> = followed.iter().map(|one| one.agent.as_str()).collect();
    let tables: Vec<SuccessTable> = agents.iter().map(|agent| success_table(followed, agent, &sets)).collect();
    let scenes = tables.iter().map(Vec::len).min().unwrap_or(0);
    // Without the same scenes for all agents, the draws below would not fit every table.
    let is_whole = tables.iter().all(|table| table.len() == scenes);
    let tau = |one: usize, other: usize, drawn: &[usize]| {
        let rate = |table: &SuccessTable, set: usize| {
            let rows: Vec<f64> = drawn.iter().flat_map(|at| table[*at].iter().map(|row| row[set])).collect();
            rows.iter().sum::<f64>() / rows.len().max(1) as f64
        };
        let rates = |set: usize| tables.iter().map(|table| rate(table, set)).collect::<Vec<f64>>();
        kendall_tau_b(&rates(one), &rates(other))
    };
    let pairs = (0..sets.len()).flat_map(|one| (one + 1..sets.len()).map(move |other| (one, other)));
    let agreement_of_pair = |(one, other): (usize, usize)| {
        let whole: Vec<usize> = (0..scenes).collect();
        let mut dice = seeded_rng(drawing.seed, &["rankings", sets[one], sets[other]]);
        let draw = |_| (0..scenes).map(|_| dice.random_range(0..scenes)).collect::<Vec<usize>>();
        let drawn: Vec<Vec<usize>> = (0..drawing.resamples).map(draw).collect();
        let taus: Vec<f64> = drawn.iter().filter_map(|drawn| tau(one, other, drawn)).collect();
        let tau_b = tau(one, other, &whole).filter(|_| is_whole);
        RankingAgreement {
            one: sets[one].to_owned(),
            other: sets[other].to_owned(),
            interval: tau_b.and_then(|_| percentile_interval(taus, drawing.level)),
            tau_b,
        }
    };
    pairs.map(agreement_of_pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DRAWING: BootstrapOptions = BootstrapOptions { resamples: 100, level: 0.95, seed: 3 };

    /// A number from -1 to 1 that depends on words alone.
    fn noise(words: &[&str]) -> f64 {
        seeded_rng(1, words).random_range(-1.0..1.0)
    }

    /// Success as a sum of effects: of the scene, of the path, of the set, and of chance.
    fn made(effects: [f64; 4]) -> Vec<FollowResult> {
        let mut all = Vec::new();
        for scene in 0..40 {
            for path in 0..6 {
                for set in 0..5 {
                    let [scene, path, set] = [scene, path, set].map(|number: usize| number.to_string());
                    let terms = [
                        noise(&["scene", &scene]),
                        noise(&["path", &scene, &path]),
                        noise(&["set", &set]),
                        noise(&["rest", &scene, &path, &set]),
                    ];
                    let success = terms.iter().zip(effects).map(|(term, effect)| term * effect).sum();
                    let path = format!("{scene}-{path}");
                    all.push(FollowResult {
                        agent: "a".into(),
                        set,
                        scene,
                        item: path.clone(),
                        text_index: 0,
                        path,
                        success,
                    });
                }
            }
        }
        all
    }

    #[test]
    fn shares_of_variance_match_the_effects_of_generated_data() {
        // Effects of 1, 2 and 1 have variances as 1 to 4 to 1; of five sets no share is known well, so they have none.
        let shares = agent_success_rates(&made([1.0, 2.0, 0.0, 1.0]), DRAWING)[0].shares.unwrap();
        let found = [shares.scene[0], shares.path[0], shares.set[0], shares.rest[0]];
        for (found, expected) in found.iter().zip([1.0 / 6.0, 4.0 / 6.0, 0.0, 1.0 / 6.0]) {
            assert!((found - expected).abs() < 0.07, "{found} {expected}");
        }
        assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(shares.path[1] < shares.path[0] && shares.path[0] < shares.path[2]);
        let sets = agent_success_rates(&made([0.0, 0.0, 1.0, 0.0]), DRAWING)[0].shares.unwrap();
        assert!((sets.set[0] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_balanced_table_has_the_components_that_arithmetic_gives() {
        // Two scenes of two paths, two sets: mean squares of 8 (scenes), 1 (paths), 2 (sets) and 0 (rest).
        let scenes = [vec![vec![0.0, 1.0], vec![1.0, 2.0]], vec![vec![2.0, 3.0], vec![3.0, 4.0]]];
        let all: Vec<&Vec<Vec<f64>>> = scenes.iter().collect();
        let [scene, path, set, rest] = variance_components(&all).unwrap();
        let parts = [(8.0 - 1.0) / 4.0, 1.0 / 2.0, 2.0 / 4.0, 0.0];
        let sum: f64 = parts.iter().sum();
        for (found, part) in [scene, path, set, rest].iter().zip(parts) {
            assert!((found - part / sum).abs() < 1e-12, "{found} {part}");
        }
    }

    #[test]
    fn only_paths_of_all_sets_count_and_one_set_has_no_spread() {
        let mut all = made([1.0, 1.0, 1.0, 1.0]);
        all.retain(|one| one.path != "0-0" || one.set == "1");
        assert_eq!(agent_success_rates(&all, DRAWING)[0].paths, 239);
        all.retain(|one| one.set == "1");
        let alone = &agent_success_rates(&all, DRAWING)[0];
        assert_eq!((alone.spread, alone.shares, alone.paths), (None, None, 240));
    }

    #[test]
    fn sets_that_rank_agents_alike_have_tau_1() {
        let mut all = Vec::new();
        for (agent, rates) in [("good", [0.9, 0.8]), ("fair", [0.5, 0.6]), ("poor", [0.1, 0.7])] {
            for number in 0..60usize {
                for (set, rate) in ["one", "two"].iter().zip(rates) {
                    let path = number.to_string();
                    let success = f64::from(u8::from(noise(&[&path]).abs() < rate));
                    let scene = (number % 6).to_string();
                    let (agent, set) = (agent.to_owned(), (*set).to_owned());
                    all.push(FollowResult { agent, set, scene, item: path.clone(), text_index: 0, path, success });
                }
            }
        }
        let found = &compare_rankings(&all, DRAWING)[0];
        // By the second set "poor" is better than "fair".
        assert!((found.tau_b.unwrap() - 1.0 / 3.0).abs() < 1e-12, "{found:?}");
        all.retain(|one| one.agent != "poor");
        assert_eq!(compare_rankings(&all, DRAWING)[0].tau_b, Some(1.0));
        all.retain(|one| one.agent == "good");
        assert_eq!(compare_rankings(&all, DRAWING)[0].tau_b, None);
    }
}
