//! What has to be said beside the figures, in words: the same for every format. Nothing here is escaped yet.

use super::figures::{DEAF, Figure, deaf, name, other_path};
use wayword_metrics::{Metric, Rule};
use wayword_navigation::comparison::{About, Comparison, Kind, Set, Swapped};

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
        let figures = &swapped.lost.figures;
        figures.get(&Metric::SuccessRate).map_or_else(
            || "no text could be swapped".to_owned(),
            |lost| format!("it costs {} points of SR", Figure::of(Metric::SuccessRate, lost)),
        )
    };
    let told = |swapped: &Swapped| {
        format!(
            "{DEAF} {}: as good with another path's instruction: its rows say nothing about the instructions ({}).",
            name(&swapped.agent),
            lost(swapped)
        )
    };
    let mut warnings: Vec<String> = deaf(comparison).map(told).collect();
    let is_tested = |agent: &str| other_path(comparison).any(|swapped| swapped.agent == agent);
    let mut untested: Vec<String> = Vec::new();
    for row in comparison.rows.iter().filter(|row| row.kind == Kind::Agent && !is_tested(&row.agent)) {
        let agent = name(&row.agent);
        if !untested.contains(&agent) {
            untested.push(agent);
        }
    }
    if !untested.is_empty() {
        let agents = untested.join(", ");
        warnings.push(format!(
            "{agents}: not tried with another path's instruction: whether the rows say anything about the instructions is not known."
        ));
    }
    warnings
}

/// Who is shown to listen, and by how much.
pub(super) fn listeners(comparison: &Comparison) -> Vec<String> {
    let told = |swapped: &Swapped| {
        let lost = swapped.lost.figures.get(&Metric::SuccessRate).filter(|_| swapped.listens)?;
        let lost = Figure::of(Metric::SuccessRate, lost);
        Some(format!("{} listens: another path's instruction costs it {lost} points of SR.", name(&swapped.agent)))
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
    if comparison.rows.iter().any(|row| row.kind != Kind::Agent) {
        notes.push("Floors know nothing and read nothing; ceilings know what no agent is told.".to_owned());
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
    let mut told = vec![format!("Views are scored by {}{}.", name(&about.grounder), nature(&about.grounder))];
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

/// As 1 item, 2 items.
pub(super) fn count(count: usize, of: &str) -> String {
    format!("{count} {of}{}", if count == 1 { "" } else { "s" })
}
