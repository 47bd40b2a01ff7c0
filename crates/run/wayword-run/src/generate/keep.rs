//! Writes the outcome of an item into the run folder.

use crate::{
    error::CommandError,
    item::RunItem,
    pictures,
    pipeline::{MadeItem, RunPlatform},
    run_folder::{FailedItem, PathMap, RejectedText, RunFolder, WalkRecord, extra_fields},
    styles::MeasuredStyle,
};
use wayword_core::FailureKind;
use wayword_formats::{jsonl::InstructionRecord, text_hash::add_text_hash};
use wayword_synthesis::repair::WritingOutcome;
use wayword_world::mask_credentials;

/// The outcome of an item.
pub(super) enum ItemFate {
    /// The run folder holds it, as instructions and rejected texts.
    Made,
    /// The run folder holds it as an item that failed. The same command tries it again.
    Failed(FailureKind, String),
    /// It was given up because no more calls are possible, with the reason. The same command tries it again.
    Stopped(CommandError),
}

/// Writes the outcome of an item into the run folder: pictures and path first, so that no instruction is there without its
/// evidence.
pub(super) fn keep_item(
    run: &mut RunFolder,
    world: RunPlatform<'_>,
    item: &RunItem,
    made: Result<MadeItem, CommandError>,
    styles: &[MeasuredStyle],
) -> Result<ItemFate, CommandError> {
    match made.and_then(|made| write_made_item(run, world, item, made, styles)) {
        Ok(()) => Ok(ItemFate::Made),
        Err(error) => match error.item_failure() {
            Some(failure) => {
                let reason = mask_credentials(&error.to_string()).into_owned();
                run.errors.append(&FailedItem { item: item.id(), failure, reason: reason.clone() })?;
                Ok(ItemFate::Failed(failure, reason))
            }
            None if error.ends_sending() || matches!(error, CommandError::Interrupted) => Ok(ItemFate::Stopped(error)),
            None => Err(error),
        },
    }
}

/// Writes an item that was made: its path with its pictures, then a line for each text.
fn write_made_item(
    run: &mut RunFolder,
    world: RunPlatform<'_>,
    item: &RunItem,
    made: MadeItem,
    styles: &[MeasuredStyle],
) -> Result<(), CommandError> {
    let map = PathMap::around_path(&made.walk.path, world.platform)?;
    if let Some(data) = world.data {
        data.keep_scene(&made.walk.path.scene)?;
    }
    let has_pictures = pictures::write_pictures(&run.frames_folder(), &item.id(), &made.pictures)?;
    run.walks.append(&WalkRecord {
        platform: world.platform.name().to_owned(),
        map,
        path: made.walk.path.clone(),
        observations: made.walk.observations,
        originals: item.original_texts().to_vec(),
        has_pictures,
        used: made.used,
    })?;
    let per_style = made.outcomes.len().div_ceil(styles.len().max(1));
    let names = styles.iter().flat_map(|MeasuredStyle { style, .. }| (0..per_style).map(move |number| (style, number)));
    for ((outcome, cost), (style, number)) in made.outcomes.into_iter().zip(made.costs).zip(names) {
        match outcome {
            WritingOutcome::Accepted(instruction) => {
                let mut record = InstructionRecord::new(world.platform.name(), made.walk.path.clone(), instruction);
                record.extra = extra_fields(&item.path_id(), number);
                add_text_hash(&mut record.extra, &record.instruction.text);
                cost.iter().for_each(|cost| cost.add_to(&mut record.extra));
                run.instructions.append(&record)?;
            }
            WritingOutcome::Rejected { last, reason, drafts } => {
                run.rejected.append(&RejectedText {
                    item: item.id(),
                    style: style.name.clone(),
                    reason,
                    last,
                    number,
                    drafts,
                    cost,
                })?;
            }
        }
    }
    Ok(())
}
