//! Presents a comparison of agents to people: on a terminal, as Markdown, as LaTeX, and as an HTML page with replays of walks.

mod figures;
mod forest;
mod latex;
mod markdown;
mod notes;
mod page;
mod screen;

pub use latex::latex;
pub use markdown::markdown;
pub use screen::screen;

use super::{
    Take, broken, replace,
    replay::{Entry, Replay, ReplayView},
    templates,
};
use minijinja::{Value, context};
use page::PageView;
use serde::Serialize;
use std::{fmt, path::Path};
use wayword_navigation::comparison::Comparison;
use wayword_run::{count::count, error::Error};

/// Result of writing the page of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Written {
    /// The page.
    pub page: String,
    /// Number of walks that it shows step by step.
    pub replays: usize,
    /// Number of walks that it leaves out.
    pub left_out: usize,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} step by step", self.page, count(self.replays, "walk"))?;
        if self.left_out > 0 { write!(f, "; {} left out (see --items)", self.left_out) } else { Ok(()) }
    }
}

/// The comparison as a page of its own, without replays.
///
/// # Errors
/// When the page cannot be drawn, which is a bug.
pub fn html(comparison: &Comparison) -> Result<String, Error> {
    let mut page = String::new();
    render(comparison, &[], 0, &mut |part| {
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
pub fn write(out: &Path, comparison: &Comparison, replays: &[Replay<'_>], left_out: usize) -> Result<Written, Error> {
    replace(out, |take| render(comparison, replays, left_out, take))?;
    Ok(Written { page: out.display().to_string(), replays: replays.len(), left_out })
}

/// Gives the page to `take`, part by part.
fn render(
    comparison: &Comparison,
    replays: &[Replay<'_>],
    replays_left_out: usize,
    take: &mut Take<'_>,
) -> Result<(), Error> {
    let templates = templates().map_err(broken)?;
    let draw = |name: &str, view: Value| templates.get_template(name)?.render(view);
    let entries: Vec<Entry> = replays.iter().enumerate().map(|(at, replay)| Entry::new(at + 1, replay)).collect();
    let page = context! { replays => entries, replays_left_out, ..Value::from_serialize(PageView::new(comparison)) };
    take(&draw("comparison.html", page).map_err(broken)?)?;
    for (at, replay) in replays.iter().enumerate() {
        take(&draw("replay.html", Value::from_serialize(ReplayView::new(at + 1, replay))).map_err(broken)?)?;
    }
    take(include_str!("../foot.html"))
}

#[cfg(test)]
mod tests;
