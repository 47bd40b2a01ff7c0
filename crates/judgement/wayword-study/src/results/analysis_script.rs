//! Writes `analysis.R`, which computes the figures again from the CSV files, so that others can check and extend the analysis.

use super::{StudyReport, escape};
use std::fmt::Write;
use wayword_metrics::ConfidenceInterval;

/// The part of the script that is the same for each study.
const SCRIPT_BODY: &str = include_str!("analysis.R");

/// The script: what this study measures, then the computation.
pub(super) fn render_script(results: &StudyReport) -> String {
    let mut script = format!(
        "# {}: figures with intervals, from the CSV files beside this script.\n\
         # Rscript analysis.R [FOLDER]    needs R alone; with the package lme4 it also fits mixed models.\n\
         # Wayword {} wrote it; results.json has the same figures.\n\n",
        escape::to_table_name(&results.title),
        results.wayword
    );
    let names = |names: Vec<&str>| names.into_iter().map(r_text).collect::<Vec<_>>().join(", ");
    let conditions = results.conditions.iter().map(|condition| condition.name.as_str()).collect();
    let versions = results.versions.iter().map(|version| version.name).collect();
    append_text(
        &mut script,
        format_args!(
            "folder <- if (length(commandArgs(TRUE)) > 0) commandArgs(TRUE)[1] else \".\"\n\
             mode <- {}\nlevel <- {}\nconditions <- c({})\nversions <- c({})\n",
            r_text(results.mode.name()),
            results.level,
            names(conditions),
            names(versions)
        ),
    );
    script.push_str("# Each figure: whether it is a share, its value for one answer, and the range of such values.\nmeasures <- list(\n");
    for (at, measure) in results.measures.iter().enumerate() {
        let [low, high] = measure.range;
        let range = ConfidenceInterval { low: low.unwrap_or(f64::NEG_INFINITY), high: high.unwrap_or(f64::INFINITY) };
        append_text(
            &mut script,
            format_args!(
                "  {} = list(share = {}, value = function(a) {}, range = c({}, {})){}\n",
                measure.name,
                if measure.kind == super::MeasureKind::Share { "TRUE" } else { "FALSE" },
                measure.r_expression(results.scales),
                r_number(range.low),
                r_number(range.high),
                if at + 1 < results.measures.len() { "," } else { "" }
            ),
        );
    }
    script.push_str(")\n\n");
    script + SCRIPT_BODY
}

/// A text as R writes it.
fn r_text(text: &str) -> String {
    let plain = escape::to_single_line(text).replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{plain}\"")
}

fn r_number(number: f64) -> String {
    match number {
        number if number == f64::INFINITY => "Inf".to_owned(),
        number if number == f64::NEG_INFINITY => "-Inf".to_owned(),
        number => number.to_string(),
    }
}

fn append_text(script: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = script.write_fmt(text);
}
