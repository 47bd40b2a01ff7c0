//! Lets a detector look for the things that texts name, on a platform without labels.

use super::path_texts::PathTexts;
use crate::{
    calls::ModelCalls, check::args::CheckDetectorArgs, error::CommandError, lookout::DetectorLookout,
    output::CommandOutput, plan::JobModels, run_folder::fresh_id,
};
use std::collections::BTreeSet;
use wayword_checks::Evidence;
use wayword_core::Platform;
use wayword_language::{
    lexicon::find_thing,
    reading::{EventContent, read_instruction},
};
use wayword_synthesis::detection::seek_claims;

/// Opens the detector that the flags name; `None` if they name none.
pub(super) fn open_lookout(
    args: &CheckDetectorArgs,
    output: &CommandOutput,
) -> Result<Option<DetectorLookout>, CommandError> {
    if args.detector.is_none() {
        return Ok(None);
    }
    let job = args.to_asked().into_job()?;
    ModelCalls::check_ready(&job, output)?;
    let calls = JobModels::for_job(&job)?.open_calls(&fresh_id("check"), output)?;
    DetectorLookout::from_settings(&job.settings, calls.as_ref(), &[])
}

/// The detector's evidence about all things that the texts of a path name. `None` if they name no things, or there are no
/// pictures.
pub(super) fn detector_evidence(
    lookout: &DetectorLookout,
    platform: &dyn Platform,
    walk: &PathTexts,
) -> Result<Option<Evidence>, CommandError> {
    let claims: BTreeSet<String> = walk.texts.iter().flat_map(|text| named_things(&text.words)).collect();
    let seen = seek_claims(platform, &walk.path, &claims, lookout.to_seeker())?;
    Ok(Evidence::from_detector(&walk.path, &seen))
}

/// The things that a text names, as far as the lexicon has them.
fn named_things(text: &str) -> Vec<String> {
    let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
    let places = events.filter_map(|event| match event.what {
        EventContent::Place(place) => (place.is_thing && find_thing(&place.name).is_some()).then_some(place.name),
        _ => None,
    });
    places.collect()
}
