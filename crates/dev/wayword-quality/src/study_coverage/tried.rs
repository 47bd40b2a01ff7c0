//! Simulates many studies of each kind and compares their intervals with the true values.

use super::assigned::{Design, Effects};
use super::figure::Figure;
use rayon::prelude::*;
use serde::Serialize;
use wayword_core::rng;

/// The sizes of the simulated studies: persons, and answers per person.
const DESIGNS: [Design; 3] =
    [Design { persons: 30, each: 1 }, Design { persons: 30, each: 10 }, Design { persons: 60, each: 5 }];

/// The result for one figure in one kind of study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Cell {
    pub(super) figure: Figure,
    pub(super) design: Design,
    pub(super) effects: Effects,
    pub(super) studies: u64,
    /// The number of intervals if every study gave all of them.
    wanted: u64,
    /// The number of intervals that the studies gave.
    pub(super) given: u64,
    /// Intervals that cover the truth.
    pub(super) covered: u64,
    mean_width: f64,
}

impl Cell {
    /// The percentage of intervals that cover the truth.
    pub(super) fn percent(&self) -> Option<f64> {
        (self.given > 0).then(|| 100.0 * self.covered as f64 / self.given as f64)
    }
}

/// Simulates every figure in every kind of study.
pub(super) fn all(studies: u64, seed: u64) -> Vec<Cell> {
    let mut cells = Vec::new();
    for figure in Figure::ALL {
        let truths = Effects::ALL.map(|effects| figure.truth(effects));
        for design in DESIGNS {
            let tried = Effects::ALL.iter().zip(&truths);
            cells.extend(tried.map(|(effects, truth)| cell(figure, design, *effects, truth, studies, seed)));
        }
    }
    cells
}

fn cell(figure: Figure, design: Design, effects: Effects, truth: &[f64], studies: u64, seed: u64) -> Cell {
    let kind = format!("{figure} {design} {}", effects.name());
    let one = |n: u64| {
        let mut rng = rng(seed, &["study coverage", &kind, &n.to_string()]);
        let found = figure.intervals(design, effects, &mut rng);
        let covers = found.iter().zip(truth).filter(|(interval, truth)| (interval.low..=interval.high).contains(truth));
        let width: f64 = found.iter().map(|interval| interval.high - interval.low).sum();
        (found.len() as u64, covers.count() as u64, width)
    };
    // Collected in order, so that the sum of widths does not depend on the threads.
    let tried: Vec<(u64, u64, f64)> = (0..studies).into_par_iter().map(one).collect();
    let given = tried.iter().map(|(given, ..)| given).sum();
    let covered = tried.iter().map(|(_, covered, _)| covered).sum();
    let mean_width = tried.iter().map(|(.., width)| width).sum::<f64>() / (given as f64).max(1.0);
    Cell { figure, design, effects, studies, wanted: studies * truth.len() as u64, given, covered, mean_width }
}

/// The cells as a table: a row for each figure.
pub(super) fn rows(cells: &[Cell]) -> Vec<Vec<String>> {
    let columns = DESIGNS.iter().flat_map(|design| Effects::ALL.map(|effects| format!("{design} {}", effects.name())));
    let head = std::iter::once("figure".to_owned()).chain(columns).collect();
    let row = |of: &[Cell]| {
        let figure = of.iter().take(1).map(|cell| cell.figure.to_string());
        figure.chain(of.iter().map(shown)).collect()
    };
    let rows = cells.chunk_by(|a, b| a.figure == b.figure).map(row);
    std::iter::once(head).chain(rows).collect()
}

fn shown(cell: &Cell) -> String {
    let Some(percent) = cell.percent() else { return "-".to_owned() };
    // Rounded down, so that 100 means all.
    let given = (1000 * cell.given / cell.wanted.max(1)) as f64 / 10.0;
    if cell.given == cell.wanted { format!("{percent:.1}") } else { format!("{percent:.1} ({given:.1})") }
}

#[cfg(test)]
mod tests;
