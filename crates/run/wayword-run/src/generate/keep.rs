//! Writes the outcome of an item into the run folder.

use crate::{
    error::Error,
    item::Item,
    pictures,
    pipeline::{Made, RunPlatform},
    run_folder::{FailedItem, Map, Rejected, RunFolder, WalkRecord, extra},
    styles::Measured,
};
use wayword_core::Failure;
use wayword_formats::jsonl::Record;
use wayword_synthesis::repair::Outcome;

/// The outcome of an item.
pub(super) enum Fate {
    /// The run folder holds it, as instructions and rejected texts.
    Made,
    /// The run folder holds it as an item that failed. The same command tries it again.
    Failed(Failure, String),
    /// It was given up because no more calls are possible, with the reason. The same command tries it again.
    Stopped(Error),
}

/// Writes the outcome of an item into the run folder: pictures and path first, so that no instruction is there without its
/// evidence.
pub(super) fn keep(
    run: &mut RunFolder,
    world: RunPlatform<'_>,
    item: &Item,
    made: Result<Made, Error>,
    styles: &[Measured],
) -> Result<Fate, Error> {
    match made.and_then(|made| made_item(run, world, item, made, styles)) {
        Ok(()) => Ok(Fate::Made),
        Err(error) => match error.failure() {
            Some(failure) => {
                let reason = error.to_string();
                run.errors.append(&FailedItem { item: item.id(), failure, reason: reason.clone() })?;
                Ok(Fate::Failed(failure, reason))
            }
            None if error.ends_sending() || matches!(error, Error::Interrupted) => Ok(Fate::Stopped(error)),
            None => Err(error),
        },
    }
}

fn made_item(
    run: &mut RunFolder,
    world: RunPlatform<'_>,
    item: &Item,
    made: Made,
    styles: &[Measured],
) -> Result<(), Error> {
    let map = Map::around(&made.walk.path, world.platform)?;
    if let Some(data) = world.data {
        data.keep(&made.walk.path.scene)?;
    }
    let has_pictures = pictures::keep(&run.frames(), &item.id(), &made.pictures)?;
    run.walks.append(&WalkRecord {
        platform: world.platform.name().to_owned(),
        map,
        path: made.walk.path.clone(),
        observations: made.walk.observations,
        originals: item.originals().to_vec(),
        has_pictures,
    })?;
    let per_style = made.outcomes.len().div_ceil(styles.len().max(1));
    let names = styles.iter().flat_map(|Measured { style, .. }| (0..per_style).map(move |number| (style, number)));
    for (outcome, (style, number)) in made.outcomes.into_iter().zip(names) {
        match outcome {
            Outcome::Accepted(instruction) => {
                let mut record = Record::new(world.platform.name(), made.walk.path.clone(), instruction);
                record.extra = extra(&item.path_id(), number);
                run.instructions.append(&record)?;
            }
            Outcome::Rejected { last, reason } => {
                run.rejected.append(&Rejected { item: item.id(), style: style.name.clone(), reason, last, number })?;
            }
        }
    }
    Ok(())
}
