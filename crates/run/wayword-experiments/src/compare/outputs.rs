//! Writes the files of a comparison: the result, the tables, each walk's success, and submissions for the official evaluators.

use super::{file, score::Judge};
use std::{collections::BTreeMap, fs, path::Path};
use wayword_formats::submission::{self, Posed, Submitted};
use wayword_metrics::Demand;
use wayword_navigation::{
    comparison::{Comparison, Results, UNREAD},
    walk::Walk,
};
use wayword_report::pages as report;
use wayword_robustness::sets::Followed;
use wayword_run::{error::Error, run_folder::write_whole};

/// Everything that the files need from the walks, collected in one pass.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) results: Results,
    /// The success of each walk by a text of a set.
    followed: Vec<Followed>,
    /// The trajectories by agent and set.
    submissions: BTreeMap<(String, String), Vec<Submitted>>,
}

impl Gathered {
    /// Collects it from the walks of a folder.
    ///
    /// # Errors
    /// When one cannot be read or scored.
    pub(super) fn of(folder: &Path, judge: &Judge<'_>) -> Result<Self, Error> {
        let mut gathered = Self::default();
        judge.each(folder, |walk, score, _: &Demand| {
            let cluster = judge.cluster(&walk.item);
            if walk.set != UNREAD && !walk.set.contains('~') {
                gathered.followed.extend(judge.followed(&walk, &score));
                gathered.submissions.entry((walk.agent.clone(), walk.set.clone())).or_default().push(submitted(&walk));
            }
            gathered.results.add(&walk, cluster, score);
            Ok(())
        })?;
        Ok(gathered)
    }
}

/// A walk in the form that the official evaluators read.
fn submitted(walk: &Walk) -> Submitted {
    let posed = |step: &wayword_navigation::walk::Step| Posed {
        viewpoint: step.viewpoint.clone(),
        heading: step.heading_rad,
        elevation_rad: 0.0,
    };
    Submitted {
        instr_id: format!("{}_{}", walk.item, walk.text_index),
        trajectory: walk.steps.iter().map(posed).collect(),
        object: walk.object.clone(),
    }
}

/// Writes result, tables and submissions.
///
/// # Errors
/// When a file cannot be written.
pub(super) fn write(folder: &Path, comparison: &Comparison, gathered: &Gathered) -> Result<(), Error> {
    let json = serde_json::to_string_pretty(comparison)
        .map_err(|error| Error::usage(format!("the result cannot be kept: {error}"), "report this as a bug"))?;
    write_whole(&folder.join(file::COMPARISON), &json)?;
    write_whole(&folder.join(file::MARKDOWN), &report::comparison::markdown(comparison))?;
    write_whole(&folder.join(file::LATEX), &report::comparison::latex(comparison))?;
    let mut lines = String::new();
    for one in &gathered.followed {
        let line = serde_json::to_string(one)
            .map_err(|error| Error::usage(format!("a walk cannot be kept: {error}"), "report this as a bug"))?;
        lines.push_str(&line);
        lines.push('\n');
    }
    write_whole(&folder.join(file::FOLLOWED), &lines)?;
    let submissions = folder.join(file::SUBMISSIONS);
    fs::create_dir_all(&submissions).map_err(Error::io(&submissions, "make the folder"))?;
    for ((agent, set), submitted) in &gathered.submissions {
        submission::write(&submissions.join(format!("{agent}.{set}.json")), submitted)?;
    }
    Ok(())
}
