//! Lets a detector look for the things that texts name, on a platform without labels.

use super::path_texts::PathTexts;
use crate::{
    calls::ModelCalls, check::args::CheckDetectorArgs, error::CommandError, lookout::DetectorLookout,
    output::CommandOutput, plan::JobModels, run_folder::fresh_id, settings::EvidenceSources,
};
use std::collections::BTreeSet;
use wayword_checks::Evidence;
use wayword_core::Platform;
use wayword_language::{
    languages::ReadableText,
    lexicon::find_thing,
    reading::{EventContent, read_instruction},
};
use wayword_synthesis::detection::seek_claims;

/// The sources of evidence that the flags choose.
///
/// # Errors
/// When they choose a source that `check` does not have: captions, or a detector that is not named.
pub(super) fn chosen_sources(args: &CheckDetectorArgs) -> Result<EvidenceSources, CommandError> {
    let sources = args.evidence.unwrap_or(EvidenceSources::usual_sources(true));
    let is_detector_named = args.detector.is_some();
    let hint = "give --evidence labels, or --detector MODEL with --evidence detector or labels,detector";
    if args.evidence.is_some() && sources.names_captions() {
        let problem = "--evidence captions: without --run there are no captions to check against";
        return Err(CommandError::usage(problem, format!("{hint}; or check the texts of a run with --run DIR")));
    }
    if args.evidence.is_some() && sources.detector && !is_detector_named {
        return Err(CommandError::usage("--evidence detector: no detector is named", hint));
    }
    Ok(sources)
}

/// Opens the detector that the flags name; `None` if they name none.
pub(super) fn open_lookout(
    args: &CheckDetectorArgs,
    output: &CommandOutput,
) -> Result<Option<DetectorLookout>, CommandError> {
    if args.detector.is_none() {
        return match args.ledger {
            Some(_) => Err(CommandError::usage(
                "--ledger has no effect, because nobody looks at pictures",
                "give --detector MODEL, or --by pictures with --see MODEL; or leave it out",
            )),
            None => Ok(None),
        };
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

/// The things that a text names, in English, as far as the lexicon has them.
pub(crate) fn named_things(text: &str) -> Vec<String> {
    let readable = ReadableText::new(text, None);
    let events = read_instruction(readable.english(), &BTreeSet::new()).events.into_iter();
    let places = events.filter_map(|event| match event.what {
        EventContent::Place(place) => (place.is_thing && find_thing(&place.name).is_some()).then_some(place.name),
        _ => None,
    });
    places.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_that_a_check_lacks_are_refused() {
        let chosen = |sources: Option<&str>, detector: Option<&str>| {
            let args = CheckDetectorArgs {
                evidence: sources.map(|sources| sources.parse().unwrap()),
                detector: detector.map(str::to_owned),
                ..CheckDetectorArgs::default()
            };
            chosen_sources(&args).map_err(|error| error.to_string())
        };
        for (sources, detector) in [
            (None, None),
            (None, Some("hf/a/b")),
            (Some("labels"), None),
            (Some("labels"), Some("hf/a/b")),
            (Some("detector"), Some("hf/a/b")),
            (Some("labels,detector"), Some("hf/a/b")),
        ] {
            assert!(chosen(sources, detector).is_ok(), "{sources:?} {detector:?}");
        }
        assert!(!chosen(Some("labels"), Some("hf/a/b")).unwrap().detector);
        for sources in ["captions", "captions,detector"] {
            let told = chosen(Some(sources), Some("hf/a/b")).unwrap_err();
            assert!(told.contains("there are no captions") && told.contains("--run DIR"), "{told}");
        }
        for sources in ["detector", "labels,detector"] {
            assert!(chosen(Some(sources), None).unwrap_err().contains("no detector is named"), "{sources}");
        }
    }
}
