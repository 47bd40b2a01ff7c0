//! The sentences around the figures of a comparison: subject, warnings, and notes on how to read it. Every format shows the same and
//! escapes the text itself.

use super::figures::{DEAF_MARK, RoundedFigure, deaf_agents, other_path_swaps, printable_name};
use wayword_metrics::{TrajectoryMetric, TrajectorySuccessRule};
use wayword_navigation::comparison::{
    AgentComparison, AgentKind, ComparisonInfo, ComparisonRow, InstructionSet, ListeningVerdict, MIN_PATHS, SwapEffect,
};
use wayword_run::count::count_phrase;

/// The agents that read every clause: without the map, and with it.
const READER_AGENT: &str = "reader";
const READER_MAP: &str = "reader-map";
/// The agent by a language model.
const TOOLS_AGENT: &str = "tools";

/// The platform and episodes of the comparison, with the number of items and paths.
pub(super) fn describe_subject(about: &ComparisonInfo) -> String {
    format!(
        "{}, {}: {} on {}",
        printable_name(&about.platform),
        printable_name(&about.episodes),
        count_phrase(about.items, "item"),
        count_phrase(about.paths, "path")
    )
}

/// The rule of success.
pub(super) fn describe_success(rule: TrajectorySuccessRule) -> String {
    let rule = match rule {
        TrajectorySuccessRule::Distance => {
            "the agent stops less than 3 m from the goal (R2R's rule; REVERIE's own is stricter)"
        }
        TrajectorySuccessRule::Visible => "the target is visible where the agent stops (REVERIE's rule)",
    };
    format!("Success: {rule}.")
}

/// A set, its source and its size.
pub(super) fn describe_set(set: &InstructionSet) -> String {
    let from = if set.source.is_empty() || set.source == set.name {
        String::new()
    } else {
        format!(" ({})", printable_name(&set.source))
    };
    let left_out = match set.left_out {
        0 => String::new(),
        left_out => format!("; {} left out, because another set lacks them", count_phrase(left_out, "item")),
    };
    format!(
        "{}{from}: {} of {:.1} words{left_out}",
        printable_name(&set.name),
        count_phrase(set.texts, "text"),
        set.words
    )
}

/// Warnings, shown first: agents with rows that give no evidence about the instructions, because another path's instruction does not
/// make them worse, or this was not tested enough.
pub(super) fn list_warnings(comparison: &AgentComparison) -> Vec<String> {
    let describe_loss = |swapped: &SwapEffect| {
        let lost = swapped.lost.figures.get(&TrajectoryMetric::SuccessRate);
        lost.map_or_else(String::new, |lost| {
            let paths = count_phrase(lost.clusters, "path");
            format!(
                " (it costs {} points of SR on {paths})",
                RoundedFigure::from_estimate(TrajectoryMetric::SuccessRate, lost)
            )
        })
    };
    let note = |swapped: &SwapEffect| {
        format!(
            "{DEAF_MARK} {} is not shown to do worse with another path's instruction{}, so its rows say nothing about the instructions.",
            printable_name(&swapped.agent),
            describe_loss(swapped)
        )
    };
    let mut warnings: Vec<String> = deaf_agents(comparison).map(note).collect();
    let is_tested = |agent: &str| {
        other_path_swaps(comparison)
            .any(|swapped| swapped.agent == agent && swapped.listening != ListeningVerdict::TooFew)
    };
    let mut untested: Vec<String> = Vec::new();
    for row in comparison.rows.iter().filter(|row| row.kind == AgentKind::Agent && !is_tested(&row.agent)) {
        let agent = printable_name(&row.agent);
        if !untested.contains(&agent) {
            untested.push(agent);
        }
    }
    if !untested.is_empty() {
        let agents = untested.join(", ");
        warnings.push(format!(
            "{agents}: the swap test with another path's instruction covers fewer than {MIN_PATHS} paths, so its rows may say nothing about the instructions."
        ));
    }
    warnings
}

/// The agents that are shown to follow their instructions, and by how much.
pub(super) fn listener_notes(comparison: &AgentComparison) -> Vec<String> {
    let note = |swapped: &SwapEffect| {
        let lost = swapped
            .lost
            .figures
            .get(&TrajectoryMetric::SuccessRate)
            .filter(|_| swapped.listening == ListeningVerdict::Shown)?;
        let lost = RoundedFigure::from_estimate(TrajectoryMetric::SuccessRate, lost);
        let paths = count_phrase(swapped.lost.figures.get(&TrajectoryMetric::SuccessRate)?.clusters, "path");
        let agent = printable_name(&swapped.agent);
        Some(format!(
            "{agent} follows its instructions: another path's instruction costs it {lost} points of SR on {paths}."
        ))
    };
    other_path_swaps(comparison).filter_map(note).collect()
}

/// How all figures were made, and how to read them.
pub(super) fn all_notes(comparison: &AgentComparison) -> Vec<String> {
    let mut notes = table_notes(comparison);
    notes.extend(difference_notes(comparison));
    notes.push(version_note(&comparison.about));
    notes
}

/// The notes for a table without differences and swaps.
pub(super) fn notes_of_table(comparison: &AgentComparison) -> Vec<String> {
    let mut notes = table_notes(comparison);
    notes.push(version_note(&comparison.about));
    notes
}

fn version_note(about: &ComparisonInfo) -> String {
    format!("Made by Wayword {}.", printable_name(&about.wayword))
}

fn table_notes(comparison: &AgentComparison) -> Vec<String> {
    let about = &comparison.about;
    let mut notes = vec![
        format!(
            "A row is the mean over the {}, and an item the mean over its texts. Rates and shares are in per cent.",
            count_phrase(about.items, "item")
        ),
        format!(
            "Intervals [low, high] cover {}: percentile bootstrap, {} resamples, seed {}, clustered by path ({} on {}), because items on one path are not independent.",
            level_text(about.level),
            about.resamples,
            about.seed,
            count_phrase(about.items, "item"),
            count_phrase(about.paths, "path")
        ),
    ];
    notes.extend(grounding_notes(comparison));
    if about.parameters.keys().any(|agent| ![READER_AGENT, TOOLS_AGENT].contains(&agent.as_str())) {
        notes.push(format!("Instructions are split into phrases by {}.", printable_name(&about.splitter)));
    }
    notes.extend(reader_notes(comparison));
    if comparison.rows.iter().any(|row| row.kind != AgentKind::Agent) {
        notes.push(
            "A lower bound reads no instruction. An agent that knows the map also knows the label of every room, and reads which room is meant. The upper bound knows the goal."
                .to_owned(),
        );
    }
    notes
}

/// The information that the reading agents get besides the instruction. Ground truth is named, so that it is not mistaken for perception.
fn reader_notes(comparison: &AgentComparison) -> Vec<String> {
    let about = &comparison.about;
    let has = |agent: &str| comparison.rows.iter().any(|row| row.agent == agent);
    let mut notes = Vec::new();
    if has(READER_AGENT) {
        let things = match about.grounder.starts_with("labels") {
            true => "and where each labelled object within 3 m is".to_owned(),
            false => {
                format!("and which things its text names score high enough by {}", printable_name(&about.grounder))
            }
        };
        notes.push(format!(
            "{READER_AGENT} is told at each viewpoint the ways out, the name of the room {things}. Rooms and labels are ground truth, not perception."
        ));
    }
    if let Some(prior) = about.prior.as_deref().filter(|_| has(READER_MAP)) {
        let walks = match prior.strip_prefix("shortest:") {
            Some(hops) => format!("the shortest path to each viewpoint {} hops away", printable_name(hops)),
            None => "walks of two shortest pieces".to_owned(),
        };
        notes.push(format!(
            "{READER_MAP} knows the whole graph, every room and every label: ground truth, not perception. It chooses among {walks}. What it reaches by an empty text, its weights alone reach: only what it gains over that comes from the instruction."
        ));
    }
    let has_weights = !notes.is_empty();
    notes.extend(about.tools.as_ref().filter(|_| has(TOOLS_AGENT)).map(|(llm, see)| tool_agent_note(llm, see)));
    if has_weights {
        notes
            .push("The weights of the agents that read were fitted to the train splits of R2R and REVERIE.".to_owned());
    }
    notes
}

/// The information that the agent by a language model gets, and how its walks are scored.
fn tool_agent_note(llm: &str, see: &str) -> String {
    let sees = match see {
        "labels" => {
            "It is told the room, and labels of what is around it with their distances: ground truth, not perception"
                .to_owned()
        }
        "pictures" => "It is shown four pictures of what is around it".to_owned(),
        see => format!("It is told what {} says of four pictures around it", printable_name(see)),
    };
    format!(
        "{TOOLS_AGENT} is {}, which calls tools to look around, to step and to stop. {sees}. Replies of no use are counted over all walks; \"ended by a limit\" counts walks that ended at the most hops, calls or money, in circles, or after replies of no use. All walks are scored as they stand.",
        printable_name(llm)
    )
}

/// How to read differences and swaps, if there are any.
fn difference_notes(comparison: &AgentComparison) -> Vec<String> {
    let mut notes = Vec::new();
    if comparison.rows.iter().any(|row| row.against_first.is_some()) || !comparison.swaps.is_empty() {
        notes.push(
            "McNemar's p (on the first text of each item) is descriptive, because it treats items as independent and they are not."
                .to_owned(),
        );
    }
    if comparison.rows.iter().any(|row| row.against_first.is_some()) {
        notes.push(
            "\"Only this\" and \"only first\" count the items on which only one of the two sets leads to success."
                .to_owned(),
        );
    }
    if !comparison.swaps.is_empty() {
        notes.push(
            "Swaps: the loss is the figure with the original texts minus the figure with the swapped ones, over the texts that the swap changes. An agent follows what was swapped if the interval of its loss of SR is above 0."
                .to_owned(),
        );
    }
    notes
}

/// How the views are scored. Ground-truth labels are named, so that they are not mistaken for perception.
fn grounding_notes(comparison: &AgentComparison) -> Vec<String> {
    let about = &comparison.about;
    let nature =
        |grounder: &str| if grounder.starts_with("labels") { ": ground-truth labels, not perception" } else { "" };
    let detects = |agent: &str| agent.starts_with("glip");
    let encoder = about
        .encoder
        .as_deref()
        .map_or_else(String::new, |encoder| format!(", encoded by {}", printable_name(encoder)));
    let mut notes =
        vec![format!("Views are scored by {}{encoder}{}.", printable_name(&about.grounder), nature(&about.grounder))];
    if about.grounder.starts_with("labels") && about.rule == TrajectorySuccessRule::Visible {
        notes.push(
            "The same labels score the views and decide whether the target is visible, so an agent recognises success more easily than one that has to see."
                .to_owned(),
        );
    }
    notes.extend(never_passed_note(comparison));
    if about.parameters.keys().any(|agent| agent != TOOLS_AGENT) {
        notes.push(match about.swept {
            true => "The thresholds of the agents were chosen on REVERIE's train split.".to_owned(),
            false => {
                "The thresholds of the agents were not chosen for this grounder: read its rows with care.".to_owned()
            }
        });
    }
    if about.failed > 0 {
        notes.push(format!(
            "{} could not be walked, because a model failed on one of their texts.",
            count_phrase(about.failed, "item")
        ));
    }
    if comparison.rows.iter().any(|row| detects(&row.agent)) {
        let (detector, nature) = (printable_name(&about.detector), nature(&about.detector));
        notes.push(if about.detector.starts_with("labels") {
            format!("GLIP-Nav uses a label detector ({detector}{nature}): --detector names a network.")
        } else {
            let score = about.detector_score.as_deref().unwrap_or("the score of its best box");
            format!("GLIP-Nav walks by the boxes of {detector}, each phrase looked for by itself where phrases meet: {score}.")
        });
    }
    if about.grounder.starts_with("labels") && comparison.sets.len() > 1 {
        notes.push(
            "Instructions that were written from the same labels share the grounder's words. If such a set does better than people's here, that does not mean that it would with an agent that has to see."
                .to_owned(),
        );
    }
    notes
}

/// Why OSR equals SR for some sets and not for others, where labels score the views: no agent passes the target of such a set.
fn never_passed_note(comparison: &AgentComparison) -> Option<String> {
    let mean = |row: &ComparisonRow, metric| row.figures.get(&metric).map(|figure| figure.mean);
    // The rows are those of agents that may stop too late. Equal means are the same walks, so they are equal to the last digit.
    let passes = |name: &str| {
        let rows =
            comparison.rows.iter().filter(|row| row.kind == AgentKind::Agent && row.set.as_deref() == Some(name));
        let both =
            |row| Some((mean(row, TrajectoryMetric::SuccessRate)?, mean(row, TrajectoryMetric::OracleSuccessRate)?));
        let rates: Vec<(f64, f64)> = rows.filter_map(both).filter(|(_, oracle)| *oracle > 0.0).collect();
        (!rates.is_empty()).then(|| rates.iter().any(|(success, oracle)| success < oracle))
    };
    let sets = || comparison.sets.iter().map(|set| set.name.as_str());
    let never: Vec<String> = sets().filter(|name| passes(name) == Some(false)).map(printable_name).collect();
    let labels_decide =
        comparison.about.grounder.starts_with("labels") && comparison.about.rule == TrajectorySuccessRule::Visible;
    let is_told = labels_decide && sets().any(|name| passes(name) == Some(true));
    (is_told && !never.is_empty()).then(|| {
        format!(
            "OSR equals SR for {}: these texts name the target by its label, and the labels score the views, so an agent stops wherever the target is in sight and never walks past it.",
            never.join(", ")
        )
    })
}

/// A level in words: 0.95 is `95 %`.
fn level_text(level: f64) -> String {
    format!("{} %", (1000.0 * level).round() / 10.0)
}
