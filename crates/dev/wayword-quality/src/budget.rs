//! Compares what a run has spent with the budget that stops it.

use crate::stage::{MeasuredWorldArgs, MeasurementStage};
use wayword_core::Platform;
use wayword_run::{
    calls::CallSpending,
    error::CommandError,
    item::run_items,
    output::CommandOutput,
    settings::{RunJob, Service},
};

/// What a run with a budget made, and what it spent.
#[derive(Debug)]
struct BudgetFigures {
    /// Frames of all paths that were asked for.
    frames: usize,
    /// Items that were made.
    done: usize,
    /// The requests of the run and their cost.
    spent: CallSpending,
}

/// Makes a run that a budget of `max_usd` US dollars stops, and prints its spending next to the budget.
///
/// # Errors
/// When the platform cannot be opened, a path cannot be found, or the calls cannot be set up.
pub fn measure_budget(
    world: &MeasuredWorldArgs,
    paths: usize,
    max_usd: f64,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let BudgetFigures { frames, done, spent } = budget_figures(&MeasurementStage::new(world, 0.15)?, paths, max_usd)?;
    let lines = [
        format!("paths: {paths}, frames: {frames}; paths made before the budget stopped the run: {done}"),
        format!("budget ${max_usd:.4}, spent ${:.4}, requests: {}", spent.usd + spent.maybe_usd, spent.requests),
        format!("within the budget: {}", spent.usd + spent.maybe_usd <= max_usd),
    ];
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// Makes the run, with a price list in which every token costs something.
fn budget_figures(stage: &MeasurementStage, paths: usize, max_usd: f64) -> Result<BudgetFigures, CommandError> {
    let job = stage.writing_job(paths)?;
    let service = Service { max_usd: Some(max_usd), prices: Some(stage.write_prices()?), ..job.service };
    let job = RunJob { service, ..job };
    let platform: &dyn Platform = &stage.world;
    let mut frames = 0;
    for item in run_items(&job.settings, platform)? {
        frames += item.find_path(&job.settings, platform)?.frames.len();
    }
    let (made, spent) = stage.make_items(&job)?;
    Ok(BudgetFigures { frames, done: made.iter().filter(|made| made.is_ok()).count(), spent })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::TestBuildingFolder;

    /// The cost of the calls in the ledger at 10 dollars per million tokens in and 20 out, in US dollars.
    fn worked_out(stage: &MeasurementStage) -> f64 {
        let usd = |row: &wayword_ledger::LedgerEntry| {
            (10.0 * row.answer.tokens_in as f64 + 20.0 * row.answer.tokens_out as f64) / 1e6
        };
        stage.calls().unwrap().iter().map(usd).sum()
    }

    #[test]
    fn spending_is_the_price_of_the_tokens_and_a_far_budget_stops_no_item() {
        let building = TestBuildingFolder::new();
        let stage = MeasurementStage::new(&building.matterport_world(), 0.15).unwrap();
        let BudgetFigures { frames, done, spent } = budget_figures(&stage, 3, 1e6).unwrap();
        assert!(frames >= 3 * 5, "paths of four to seven hops: {frames} frames");
        assert_eq!((done, spent.requests), (3, stage.provider.log().received));
        assert!(spent.usd > 0.0 && (spent.usd - worked_out(&stage)).abs() < 1e-9, "{spent:?}");
    }

    #[test]
    fn a_budget_stops_the_run_before_it_is_exceeded() {
        let building = TestBuildingFolder::new();
        let stage = MeasurementStage::new(&building.matterport_world(), 0.15).unwrap();
        let BudgetFigures { done, spent, .. } = budget_figures(&stage, 3, 0.02).unwrap();
        assert!(done < 3, "{done}");
        assert!(spent.usd <= 0.02 && (spent.usd - worked_out(&stage)).abs() < 1e-9, "{spent:?}");
    }
}
