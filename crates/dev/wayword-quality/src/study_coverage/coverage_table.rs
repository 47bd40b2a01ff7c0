//! Simulates many studies of each kind and compares their intervals with the true values.

use super::assignment::{EffectSize, SimulatedDesign};
use super::figure::SimulatedFigure;
use rayon::prelude::*;
use serde::Serialize;
use wayword_core::seeded_rng;

/// The sizes of the simulated studies: persons, and answers per person.
const SIMULATED_DESIGNS: [SimulatedDesign; 3] = [
    SimulatedDesign { persons: 30, each: 1 },
    SimulatedDesign { persons: 30, each: 10 },
    SimulatedDesign { persons: 60, each: 5 },
];

/// The result for one figure in one kind of study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct CoverageCell {
    pub(super) figure: SimulatedFigure,
    pub(super) design: SimulatedDesign,
    pub(super) effects: EffectSize,
    /// The number of simulated studies.
    pub(super) studies: u64,
    /// The number of intervals if every study gave all of them.
    wanted: u64,
    /// The number of intervals that the studies gave.
    pub(super) given: u64,
    /// Intervals that cover the truth.
    pub(super) covered: u64,
    /// The mean width of the intervals, in the unit of the figure.
    mean_width: f64,
}

impl CoverageCell {
    /// The percentage of intervals that cover the truth.
    pub(super) fn covered_percent(&self) -> Option<f64> {
        (self.given > 0).then(|| 100.0 * self.covered as f64 / self.given as f64)
    }
}

/// Simulates every figure in every kind of study.
pub(super) fn simulate_all(studies: u64, seed: u64) -> Vec<CoverageCell> {
    let mut cells = Vec::new();
    for figure in SimulatedFigure::ALL {
        let truths = EffectSize::ALL.map(|effects| figure.true_values(effects));
        for design in SIMULATED_DESIGNS {
            let tried = EffectSize::ALL.iter().zip(&truths);
            cells.extend(tried.map(|(effects, truth)| simulate_cell(figure, design, *effects, truth, studies, seed)));
        }
    }
    cells
}

/// Simulates one figure in one kind of study, and compares its intervals with `truth`, one value for each interval.
fn simulate_cell(
    figure: SimulatedFigure,
    design: SimulatedDesign,
    effects: EffectSize,
    truth: &[f64],
    studies: u64,
    seed: u64,
) -> CoverageCell {
    let kind = format!("{figure} {design} {}", effects.name());
    let simulate_study = |n: u64| {
        let mut rng = seeded_rng(seed, &["study coverage", &kind, &n.to_string()]);
        let found = figure.simulate_intervals(design, effects, &mut rng);
        let covers = found.iter().zip(truth).filter(|(interval, truth)| (interval.low..=interval.high).contains(truth));
        let width: f64 = found.iter().map(|interval| interval.high - interval.low).sum();
        (found.len() as u64, covers.count() as u64, width)
    };
    // Collected in order, so that the sum of widths does not depend on the threads.
    let tried: Vec<(u64, u64, f64)> = (0..studies).into_par_iter().map(simulate_study).collect();
    let given = tried.iter().map(|(given, ..)| given).sum();
    let covered = tried.iter().map(|(_, covered, _)| covered).sum();
    let mean_width = tried.iter().map(|(.., width)| width).sum::<f64>() / (given as f64).max(1.0);
    CoverageCell { figure, design, effects, studies, wanted: studies * truth.len() as u64, given, covered, mean_width }
}

/// The cells as a table: a row for each figure.
pub(super) fn coverage_rows(cells: &[CoverageCell]) -> Vec<Vec<String>> {
    let columns = SIMULATED_DESIGNS
        .iter()
        .flat_map(|design| EffectSize::ALL.map(|effects| format!("{design} {}", effects.name())));
    let head = std::iter::once("figure".to_owned()).chain(columns).collect();
    let row = |same_figure: &[CoverageCell]| {
        let figure = same_figure.iter().take(1).map(|cell| cell.figure.to_string());
        figure.chain(same_figure.iter().map(cell_text)).collect()
    };
    let rows = cells.chunk_by(|a, b| a.figure == b.figure).map(row);
    std::iter::once(head).chain(rows).collect()
}

/// A cell as text: the percentage that covers the truth, with that of given intervals in brackets where some are missing.
fn cell_text(cell: &CoverageCell) -> String {
    let Some(percent) = cell.covered_percent() else { return "-".to_owned() };
    // Rounded down, so that 100 means all.
    let given = (1000 * cell.given / cell.wanted.max(1)) as f64 / 10.0;
    if cell.given == cell.wanted { format!("{percent:.1}") } else { format!("{percent:.1} ({given:.1})") }
}

#[cfg(test)]
mod tests;
