//! Lets a detector look for the things that texts name, on a platform without labels.

use super::walks::Walk;
use crate::{
    calls::Calls, check::args::Detecting, error::Error, looking_for::Lookout, output::Output, plan::Models,
    run_folder::fresh_id,
};
use std::collections::BTreeSet;
use wayword_checks::Evidence;
use wayword_core::Platform;
use wayword_language::{
    lexicon::thing,
    reading::{What, read},
};
use wayword_synthesis::detection::seek_claims;

/// Opens the detector that the flags name; `None` if they name none.
pub(super) fn lookout(args: &Detecting, output: &Output) -> Result<Option<Lookout>, Error> {
    if args.detector.is_none() {
        return Ok(None);
    }
    let job = args.asked().job()?;
    Calls::ready(&job, output)?;
    let calls = Models::of(&job)?.open(&fresh_id("check"), output)?;
    Lookout::of(&job.settings, calls.as_ref(), &[])
}

/// The detector's evidence about all things that the texts of a path name. `None` if they name no things, or there are no
/// pictures.
pub(super) fn evidence(lookout: &Lookout, platform: &dyn Platform, walk: &Walk) -> Result<Option<Evidence>, Error> {
    let claims: BTreeSet<String> = walk.texts.iter().flat_map(|text| things(&text.words)).collect();
    let seen = seek_claims(platform, &walk.path, &claims, lookout.seeker())?;
    Ok(Evidence::from_detector(&walk.path, &seen))
}

/// The things that a text names, as far as the lexicon has them.
fn things(text: &str) -> Vec<String> {
    let events = read(text, &BTreeSet::new()).events.into_iter();
    let places = events.filter_map(|event| match event.what {
        What::Place(place) => (place.is_thing && thing(&place.name).is_some()).then_some(place.name),
        _ => None,
    });
    places.collect()
}
