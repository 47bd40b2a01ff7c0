//! What has to be said beside the figures, in words: the same for every format. Nothing here is escaped yet.

use super::figures::{DEAF, Figure, deaf, name, other_path};
use crate::count::count;
use wayword_metrics::{Metric, Rule};
use wayword_navigation::comparison::{About, AgentKind, Comparison, FEWEST_PATHS, Listening, Set, Swapped};

/// What was compared, and on how much.
pub(super) fn subject(about: &About) -> String {
    format!(
        "{}, {}: {} on {}",
        name(&about.platform),
        name(&about.episodes),
        count(about.items, "item"),
        count(about.paths, "path")
    )
}

/// What counts as success.
pub(super) fn success(rule: Rule) -> String {
    let rule = match rule {
        Rule::Distance => "under 3 m of the goal (R2R's rule; on REVERIE's items it is the lenient one)",
        Rule::Visible => "target visible at the stopping viewpoint (REVERIE's rule)",
    };
    format!("Success: {rule}.")
}

/// A set, its source and its size.
pub(super) fn set(set: &Set) -> String {
    let from = if set.source.is_empty() || set.source == set.name {
        String::new()
    } else {
        format!(" ({})", name(&set.source))
    };
    let left_out = match set.left_out {
        0 => String::new(),
        left_out => format!("; {} left out, since another set lacks them", count(left_out, "item")),
    };
    format!("{}{from}: {} of {:.1} words{left_out}", name(&set.name), count(set.texts, "text"), set.words)
}

/// What comes before anything else: whose rows say nothing, and why.
pub(super) fn warnings(comparison: &Comparison) -> Vec<String> {
    let lost = |swapped: &Swapped| {
        let lost = swapped.lost.figures.get(&Metric::SuccessRate);
        lost.map_or_else(String::new, |lost| {
            let paths = count(lost.clusters, "path");
            format!(" (it costs {} points of SR on {paths})", Figure::of(Metric::SuccessRate, lost))
        })
    };
    let told = |swapped: &Swapped| {
        format!(
            "{DEAF} {}: not shown to do worse with another path's instruction{}: nothing about the instructions can be read from its rows.",
            name(&swapped.agent),
            lost(swapped)
        )
    };
    let mut warnings: Vec<String> = deaf(comparison).map(told).collect();
    let is_tested = |agent: &str| {
        other_path(comparison).any(|swapped| swapped.agent == agent && swapped.listening != Listening::TooFew)
    };
    let mut untested: Vec<String> = Vec::new();
    for row in comparison.rows.iter().filter(|row| row.kind == AgentKind::Agent && !is_tested(&row.agent)) {
        let agent = name(&row.agent);
        if !untested.contains(&agent) {
            untested.push(agent);
        }
    }
    if !untested.is_empty() {
        let agents = untested.join(", ");
        warnings.push(format!(
            "{agents}: not tried with another path's instruction on at least {FEWEST_PATHS} paths: whether the rows say anything about the instructions is not known."
        ));
    }
    warnings
}

/// Who is shown to listen, and by how much.
pub(super) fn listeners(comparison: &Comparison) -> Vec<String> {
    let told = |swapped: &Swapped| {
        let lost = swapped.lost.figures.get(&Metric::SuccessRate).filter(|_| swapped.listening == Listening::Shown)?;
        let lost = Figure::of(Metric::SuccessRate, lost);
        let paths = count(swapped.lost.figures.get(&Metric::SuccessRate)?.clusters, "path");
        let agent = name(&swapped.agent);
        Some(format!("{agent} listens: another path's instruction costs it {lost} points of SR on {paths}."))
    };
    other_path(comparison).filter_map(told).collect()
}

/// How all figures were made, and how they are to be read.
pub(super) fn notes(comparison: &Comparison) -> Vec<String> {
    let mut notes = of_table(comparison);
    notes.extend(of_differences(comparison));
    notes.push(made_by(&comparison.about));
    notes
}

/// The same, where the table stands alone.
pub(super) fn notes_of_table(comparison: &Comparison) -> Vec<String> {
    let mut notes = of_table(comparison);
    notes.push(made_by(&comparison.about));
    notes
}

fn made_by(about: &About) -> String {
    format!("Made by Wayword {}.", name(&about.wayword))
}

fn of_table(comparison: &Comparison) -> Vec<String> {
    let about = &comparison.about;
    let mut notes = vec![
        format!(
            "An item's figure is the mean over its texts, a row's the mean over the {}. Rates and shares are in per cent.",
            count(about.items, "item")
        ),
        format!(
            "Intervals [low, high] cover {}: percentile bootstrap, {} resamples, seed {}, clustered by path, since items on one path are not independent: {} on {}.",
            level(about.level),
            about.resamples,
            about.seed,
            count(about.items, "item"),
            count(about.paths, "path")
        ),
    ];
    notes.extend(grounding(comparison));
    notes.push(format!("Instructions are taken apart by {}.", name(&about.splitter)));
    if comparison.rows.iter().any(|row| row.kind != AgentKind::Agent) {
        notes.push(
            "Floors know nothing and read nothing; who knows the map knows every room's label too, and reads the room; the ceiling knows the goal."
                .to_owned(),
        );
    }
    notes
}

/// How differences and swaps are to be read, where there are any.
fn of_differences(comparison: &Comparison) -> Vec<String> {
    let mut notes = Vec::new();
    if comparison.rows.iter().any(|row| row.against_first.is_some()) || !comparison.swaps.is_empty() {
        notes.push(
            "McNemar's p, of each item's first text, is descriptive: it takes items for independent, which they are not. Beside it: items on which one of the two alone succeeds."
                .to_owned(),
        );
    }
    if !comparison.swaps.is_empty() {
        notes.push(
            "Swaps: lost is by the original texts less by the swapped ones, on the texts that the swap changes; an agent listens to what was swapped where the whole interval of the lost SR is above 0."
                .to_owned(),
        );
    }
    notes
}

/// Who scored the views, said so that nobody takes ground truth for perception.
fn grounding(comparison: &Comparison) -> Vec<String> {
    let about = &comparison.about;
    let nature = |grounder: &str| if grounder.starts_with("labels") { ": ground truth, not perception" } else { "" };
    let detects = |agent: &str| agent.starts_with("glip");
    let encoder =
        about.encoder.as_deref().map_or_else(String::new, |encoder| format!(", encoded by {}", name(encoder)));
    let mut told = vec![format!("Views are scored by {}{encoder}{}.", name(&about.grounder), nature(&about.grounder))];
    if about.grounder.starts_with("labels") && about.rule == Rule::Visible {
        told.push(
            "The labels that score views are those by which the target counts as visible: success is easier to tell here than with eyes."
                .to_owned(),
        );
    }
    told.push(match about.swept {
        true => "What agents decide by was swept on REVERIE's train split.".to_owned(),
        false => "What agents decide by was not swept for this grounder: read its rows with care.".to_owned(),
    });
    if about.failed > 0 {
        told.push(format!(
            "{} could not be walked, since a model failed on one of their texts.",
            count(about.failed, "item")
        ));
    }
    if comparison.rows.iter().any(|row| detects(&row.agent)) {
        told.push(format!(
            "GLIP-Nav walks by a label detector ({}{}); the GLIP network is not in this program.",
            name(&about.detector),
            nature(&about.detector)
        ));
    }
    if about.grounder.starts_with("labels") && comparison.sets.len() > 1 {
        told.push(
            "Instructions that were written from the same labels share the grounder's words: that such a set does better than people's here does not say that it would with eyes."
                .to_owned(),
        );
    }
    told
}

/// As 95 %.
fn level(level: f64) -> String {
    format!("{} %", (1000.0 * level).round() / 10.0)
}
