//! A run that a budget stops: what it has spent against the bound.

use crate::stage::{Stage, World};
use wayword::{
    error::Error,
    item::items,
    output::Output,
    settings::{Job, Service},
};
use wayword_core::Platform;

pub(super) fn measure(world: &World, paths: usize, max_usd: f64, output: &Output) -> Result<(), Error> {
    let stage = Stage::new(world, 0.15)?;
    let job = stage.job(paths)?;
    let service = Service { max_usd: Some(max_usd), prices: Some(stage.prices()?), ..job.service };
    let job = Job { service, ..job };
    let platform: &dyn Platform = &stage.world;
    let mut frames = 0;
    for item in items(&job.settings, platform)? {
        frames += item.path(&job.settings, platform)?.frames.len();
    }
    let (made, spent) = stage.make(&job)?;
    let done = made.iter().filter(|made| made.is_ok()).count();
    let lines = [
        format!("{paths} paths, {frames} frames; {done} were made before the budget stopped the rest"),
        format!("bound ${max_usd:.4}, spent ${:.4}, {} requests", spent.usd + spent.maybe_usd, spent.requests),
        format!("within the bound: {}", spent.usd + spent.maybe_usd <= max_usd),
    ];
    output.data(&(), lines.join("\n"));
    Ok(())
}
