//! `wayword robustness --compared`: how much agents' success varies among sets of instructions, and whether sets rank agents alike.

use crate::compare::{ComparisonSettings, file};
use serde::Serialize;
use std::{collections::BTreeSet, fmt, path::PathBuf};
use wayword_robustness::{
    ratio::BootstrapOptions,
    sets::{AgentSuccess, FollowResult, RankingAgreement, VarianceShares, agent_success_rates, compare_rankings},
};
use wayword_run::{
    error::CommandError,
    run_folder::{read_lines, refuse_other_format},
};

/// The figures of several sets of instructions together.
#[derive(Serialize)]
pub(super) struct SetVarianceReport {
    sets: BTreeSet<String>,
    agents: Vec<AgentSuccess>,
    rankings: Vec<RankingAgreement>,
    /// Confidence level of the intervals, which draw whole scenes.
    level: f64,
}

/// Reads the success of walks from folders of comparisons, and measures how it varies. If there are several folders, the
/// names of their sets begin with the folder's name.
///
/// # Errors
/// When a folder has no walks, or there is a single set.
pub(super) fn compare_sets(folders: &[PathBuf], drawing: BootstrapOptions) -> Result<SetVarianceReport, CommandError> {
    let mut results: Vec<FollowResult> = Vec::new();
    for folder in folders {
        refuse_other_format::<ComparisonSettings>(folder)?;
        let folder_results: Vec<FollowResult> = read_lines(&folder.join(file::FOLLOWED))?;
        if folder_results.is_empty() {
            let problem = format!("{}: it has no {}", folder.display(), file::FOLLOWED);
            return Err(CommandError::usage(problem, "finish it with the same `wayword compare` command"));
        }
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let named = |result: FollowResult| match folders.len() {
            1 => result,
            _ => FollowResult { set: format!("{name}/{}", result.set), ..result },
        };
        results.extend(folder_results.into_iter().map(named));
    }
    let sets: BTreeSet<String> = results.iter().map(|result| result.set.clone()).collect();
    if sets.len() < 2 {
        let problem = "there is a single set, so nothing varies among sets";
        return Err(CommandError::usage(
            problem,
            "compare several: `wayword compare --instructions A=… --instructions B=…`",
        ));
    }
    let agents = agent_success_rates(&results, drawing);
    if agents.is_empty() {
        return Err(CommandError::usage("the sets have no path in common", "compare sets of the same paths"));
    }
    Ok(SetVarianceReport { sets, agents, rankings: compare_rankings(&results, drawing), level: drawing.level })
}

impl fmt::Display for SetVarianceReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} sets: {}", self.sets.len(), self.sets.iter().cloned().collect::<Vec<_>>().join(", "))?;
        writeln!(
            f,
            "\n{:<20} {:>7} {:>7} {:>7} {:>7} {:>6}",
            "success rate, %", "mean", "spread", "least", "most", "paths"
        )?;
        for AgentSuccess { agent, of_set, mean, spread, paths, .. } in &self.agents {
            let ends = of_set.values().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], rate| {
                [f64::min(low, *rate), f64::max(high, *rate)]
            });
            let [mean, spread, least, most] =
                [*mean, spread.unwrap_or(f64::NAN), ends[0], ends[1]].map(|rate| rate * 100.0);
            writeln!(f, "{agent:<20} {mean:>7.1} {spread:>7.1} {least:>7.1} {most:>7.1} {paths:>6}")?;
        }
        let level = self.level * 100.0;
        writeln!(f, "\n{:<20} {:>17} {:>17} {:>17} {:>17}", "shares of variance, %", "scene", "path", "set", "rest")?;
        for AgentSuccess { agent, shares, .. } in &self.agents {
            let Some(VarianceShares { scene, path, set, rest }) = shares else {
                writeln!(
                    f,
                    "{agent:<20} {:>17} (needs two scenes, one of them with two paths, and success that varies)",
                    "-"
                )?;
                continue;
            };
            let cells = [scene, path, set, rest].map(|estimate| {
                let [share, low, high] = estimate.map(|share| share * 100.0);
                format!("{share:.0} [{low:.0}, {high:.0}]")
            });
            writeln!(f, "{agent:<20} {:>17} {:>17} {:>17} {:>17}", cells[0], cells[1], cells[2], cells[3])?;
        }
        writeln!(f, "\nKendall's tau-b of the agents' ranking, with its {level:.0} % interval")?;
        let rows = self.rankings.iter().map(|RankingAgreement { one, other, tau_b, interval }| {
            let tau = tau_b.map_or_else(|| "- (needs two agents that differ)".to_owned(), |tau| format!("{tau:.2}"));
            let ends = interval.map_or_else(String::new, |[low, high]| format!(" [{low:.2}, {high:.2}]"));
            format!("{one} and {other}: {tau}{ends}")
        });
        write!(f, "{}", rows.collect::<Vec<_>>().join("\n"))
    }
}
