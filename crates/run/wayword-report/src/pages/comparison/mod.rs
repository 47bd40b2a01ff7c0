//! Presents a comparison of agents to people: on a terminal, as Markdown, as LaTeX, and as an HTML page with replays of walks.

mod figures;
mod forest;
mod latex;
mod markdown;
mod notes;
mod page;
mod screen;

pub use latex::latex_table;
pub use markdown::markdown_tables;
pub use screen::screen_text;

use super::{
    PageSink, load_templates, replace_page,
    replay::{ReplayEntry, ReplayView, WalkReplay},
    template_error,
};
use minijinja::{Value, context};
use page::ComparisonPageView;
use serde::Serialize;
use std::{fmt, path::Path};
use wayword_navigation::comparison::AgentComparison;
use wayword_run::{count::count_phrase, error::CommandError};

/// Result of writing the page of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WrittenComparison {
    /// The page.
    pub page: String,
    /// Number of walks that it shows step by step.
    pub replays: usize,
    /// Number of walks that it leaves out.
    pub left_out: usize,
}

impl fmt::Display for WrittenComparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} step by step", self.page, count_phrase(self.replays, "walk"))?;
        if self.left_out > 0 { write!(f, "; {} left out (see --items)", self.left_out) } else { Ok(()) }
    }
}

/// The comparison as a page of its own, without replays.
///
/// # Errors
/// When the page cannot be drawn, which is a bug.
pub fn comparison_html(comparison: &AgentComparison) -> Result<String, CommandError> {
    let mut page = String::new();
    render_comparison(comparison, &[], 0, &mut |part| {
        page.push_str(part);
        Ok(())
    })?;
    Ok(page)
}

/// Writes the page of a comparison with the replays of some walks; `left_out` others are not shown. An old page is replaced once the
/// new one is complete.
///
/// # Errors
/// When the page cannot be written.
pub fn write_comparison(
    out: &Path,
    comparison: &AgentComparison,
    replays: &[WalkReplay<'_>],
    left_out: usize,
) -> Result<WrittenComparison, CommandError> {
    replace_page(out, |take| render_comparison(comparison, replays, left_out, take))?;
    Ok(WrittenComparison { page: out.display().to_string(), replays: replays.len(), left_out })
}

/// Gives the page to `take`, part by part.
fn render_comparison(
    comparison: &AgentComparison,
    replays: &[WalkReplay<'_>],
    replays_left_out: usize,
    take: &mut PageSink<'_>,
) -> Result<(), CommandError> {
    let templates = load_templates().map_err(template_error)?;
    let draw = |name: &str, view: Value| templates.get_template(name)?.render(view);
    let entries: Vec<ReplayEntry> =
        replays.iter().enumerate().map(|(at, replay)| ReplayEntry::new(at + 1, replay)).collect();
    let page =
        context! { replays => entries, replays_left_out, ..Value::from_serialize(ComparisonPageView::new(comparison)) };
    take(&draw("comparison.html", page).map_err(template_error)?)?;
    for (at, replay) in replays.iter().enumerate() {
        take(&draw("replay.html", Value::from_serialize(ReplayView::new(at + 1, replay))).map_err(template_error)?)?;
    }
    take(include_str!("../foot.html"))
}

#[cfg(test)]
mod tests;
