//! Writes what became of an item.

use crate::{
    error::Error,
    item::Item,
    pictures,
    pipeline::Made,
    run::{Map, Rejected, RunFolder, WalkRecord, extra},
    styles::Measured,
};
use wayword_core::{Instruction, ModelError, Platform};
use wayword_formats::jsonl::Record;
use wayword_synthesis::repair::Outcome;

/// What became of an item.
pub(super) enum Fate {
    /// It stands in the run folder, as instructions or as an error.
    Kept,
    /// It was given up because nothing more can be asked for, with the reason. The same command takes it up again.
    Stopped(ModelError),
}

/// Writes what became of an item: pictures and walk first, so that an instruction never stands without its evidence.
pub(super) fn keep(
    run: &mut RunFolder,
    platform: &dyn Platform,
    item: &Item,
    made: Result<Made, Error>,
    styles: &[Measured],
) -> Result<Fate, Error> {
    match made.map_err(Error::into_model_error) {
        Ok(made) => made_item(run, platform, item, made, styles)?,
        Err(Ok(stop)) if stop.ends_run() => return Ok(Fate::Stopped(stop)),
        Err(Ok(failed)) => run.errors.append(&rejected(item, "", failed.to_string(), None))?,
        Err(Err(error)) => run.rejected.append(&rejected(item, "", error.to_string(), None))?,
    }
    Ok(Fate::Kept)
}

fn made_item(
    run: &mut RunFolder,
    platform: &dyn Platform,
    item: &Item,
    made: Made,
    styles: &[Measured],
) -> Result<(), Error> {
    let has_pictures = pictures::keep(&run.frames(), &item.id(), &made.pictures)?;
    run.walks.append(&WalkRecord {
        platform: platform.name().to_owned(),
        map: Map::around(&made.walk.path, platform)?,
        path: made.walk.path.clone(),
        observations: made.walk.observations,
        originals: item.originals().to_vec(),
        has_pictures,
    })?;
    for (outcome, Measured { style, .. }) in made.outcomes.into_iter().zip(styles) {
        match outcome {
            Outcome::Accepted(instruction) => {
                let mut record = Record::new(platform.name(), made.walk.path.clone(), instruction);
                record.extra = extra(&item.path_id());
                run.instructions.append(&record)?;
            }
            Outcome::Rejected { last, reason } => run.rejected.append(&rejected(item, &style.name, reason, last))?,
        }
    }
    Ok(())
}

fn rejected(item: &Item, style: &str, reason: String, last: Option<Instruction>) -> Rejected {
    Rejected { item: item.id(), style: style.to_owned(), reason, last }
}
