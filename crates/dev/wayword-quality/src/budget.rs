//! Compares what a run has spent with the budget that stops it.

use crate::stage::{Stage, World};
use wayword_core::Platform;
use wayword_run::{
    calls::Spent,
    error::Error,
    item::items,
    output::Output,
    settings::{Job, Service},
};

/// What a run with a budget made, and what it spent.
#[derive(Debug)]
struct Figures {
    frames: usize,
    /// Items that were made.
    done: usize,
    spent: Spent,
}

pub fn measure(world: &World, paths: usize, max_usd: f64, output: &Output) -> Result<(), Error> {
    let Figures { frames, done, spent } = figures(&Stage::new(world, 0.15)?, paths, max_usd)?;
    let lines = [
        format!("paths: {paths}, frames: {frames}; paths made before the budget stopped the run: {done}"),
        format!("budget ${max_usd:.4}, spent ${:.4}, requests: {}", spent.usd + spent.maybe_usd, spent.requests),
        format!("within the budget: {}", spent.usd + spent.maybe_usd <= max_usd),
    ];
    output.data(&(), lines.join("\n"));
    Ok(())
}

fn figures(stage: &Stage, paths: usize, max_usd: f64) -> Result<Figures, Error> {
    let job = stage.job(paths)?;
    let service = Service { max_usd: Some(max_usd), prices: Some(stage.prices()?), ..job.service };
    let job = Job { service, ..job };
    let platform: &dyn Platform = &stage.world;
    let mut frames = 0;
    for item in items(&job.settings, platform)? {
        frames += item.path(&job.settings, platform)?.frames.len();
    }
    let (made, spent) = stage.make(&job)?;
    Ok(Figures { frames, done: made.iter().filter(|made| made.is_ok()).count(), spent })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up::Building;

    /// The cost of the calls in the ledger at 10 dollars per million tokens in and 20 out, in US dollars.
    fn worked_out(stage: &Stage) -> f64 {
        let usd = |row: &wayword_ledger::Row| {
            (10.0 * row.answer.tokens_in as f64 + 20.0 * row.answer.tokens_out as f64) / 1e6
        };
        stage.calls().unwrap().iter().map(usd).sum()
    }

    #[test]
    fn spending_is_the_price_of_the_tokens_and_a_far_budget_stops_no_item() {
        let building = Building::new();
        let stage = Stage::new(&building.world(), 0.15).unwrap();
        let Figures { frames, done, spent } = figures(&stage, 3, 1e6).unwrap();
        assert!(frames >= 3 * 5, "paths of four to seven hops: {frames} frames");
        assert_eq!((done, spent.requests), (3, stage.provider.log().received));
        assert!(spent.usd > 0.0 && (spent.usd - worked_out(&stage)).abs() < 1e-9, "{spent:?}");
    }

    #[test]
    fn a_budget_stops_the_run_before_it_is_exceeded() {
        let building = Building::new();
        let stage = Stage::new(&building.world(), 0.15).unwrap();
        let Figures { done, spent, .. } = figures(&stage, 3, 0.02).unwrap();
        assert!(done < 3, "{done}");
        assert!(spent.usd <= 0.02 && (spent.usd - worked_out(&stage)).abs() < 1e-9, "{spent:?}");
    }
}
