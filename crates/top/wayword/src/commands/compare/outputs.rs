//! The files that a comparison writes to its folder.

use super::{file, score::Judge};
use crate::{error::Error, report, run::write_whole};
use std::{collections::BTreeMap, fs, path::Path};
use wayword_formats::submission::{self, Posed, Submitted};
use wayword_metrics::Demand;
use wayword_navigation::{
    comparison::{Comparison, Results, UNREAD},
    walk::Walk,
};

/// What one reading of the walks gathers.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) results: Results,
    /// By agent and set.
    submissions: BTreeMap<(String, String), Vec<Submitted>>,
}

impl Gathered {
    /// Reads every walk once.
    ///
    /// # Errors
    /// When one cannot be read or scored.
    pub(super) fn of(folder: &Path, judge: &Judge<'_>) -> Result<Self, Error> {
        let mut gathered = Self::default();
        judge.each(folder, |walk, score, _: &Demand| {
            gathered.results.add(&walk, judge.cluster(&walk.item), score);
            if walk.set != UNREAD && !walk.set.contains('~') {
                gathered.submissions.entry((walk.agent.clone(), walk.set.clone())).or_default().push(submitted(&walk));
            }
            Ok(())
        })?;
        Ok(gathered)
    }
}

/// A walk as the official evaluators take it.
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
    let submissions = folder.join(file::SUBMISSIONS);
    fs::create_dir_all(&submissions).map_err(Error::io(&submissions, "make the folder"))?;
    for ((agent, set), submitted) in &gathered.submissions {
        submission::write(&submissions.join(format!("{agent}.{set}.json")), submitted)?;
    }
    Ok(())
}
