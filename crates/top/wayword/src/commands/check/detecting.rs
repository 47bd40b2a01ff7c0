//! What a detector says of the things that texts name, where a platform has no labels.

use super::walks::Walk;
use crate::{
    calls::Calls,
    cli::Detecting,
    error::Error,
    looking_for::figures,
    output::Output,
    plan::Models,
    run::fresh_id,
    settings::{Asked, AskedRoles, Service, Settings},
};
use std::{collections::BTreeSet, sync::Arc};
use wayword_checks::{Evidence, detected::DetectorFigures};
use wayword_core::{Caption, Detector, Frame, Gaze, Look, Motion, Platform};
use wayword_language::{
    lexicon::thing,
    reading::{What, read},
};
use wayword_synthesis::detection::{Seeker, seek_claims};

/// A detector, and what was measured of it.
pub(super) struct Eyes {
    detector: Arc<dyn Detector>,
    figures: DetectorFigures,
    /// Keeps the ledger open.
    _calls: Calls,
}

impl Eyes {
    /// The detector that the flags name; `None` where they name none.
    pub(super) fn open(args: &Detecting, settings: &Settings, output: &Output) -> Result<Option<Self>, Error> {
        let Some(name) = &args.detector else { return Ok(None) };
        let asked = Asked {
            roles: AskedRoles { detector: Some(name.clone()), ..AskedRoles::default() },
            service: Service { device: args.device.clone(), ledger: args.ledger.clone(), ..Service::default() },
            ..Asked::default()
        };
        let mut job = asked.job()?;
        job.settings.platform.clone_from(&settings.platform);
        Calls::ready(&job, output)?;
        let Some(calls) = Models::of(&job)?.open(|| Ok(fresh_id("check")), output)? else { return Ok(None) };
        let detector = calls.detector(name)?;
        let figures = figures(args.detector_figures.as_deref(), detector.as_ref())?;
        Ok(Some(Self { detector, figures, _calls: calls }))
    }

    /// What it says of all things that the texts of a path name. `None` where they name none, or there are no pictures.
    pub(super) fn evidence(&self, platform: &dyn Platform, walk: &Walk) -> Result<Option<Evidence>, Error> {
        let claims: BTreeSet<String> = walk.texts.iter().flat_map(|text| things(&text.words)).collect();
        let gazes = |frame: &Frame| match walk.path.motion {
            Motion::Known => Gaze::around(frame.pose.heading).to_vec(),
            Motion::Unknown => vec![Gaze::quarter(frame.pose.heading)],
        };
        let looks = |frame: &Frame| -> Vec<Look> {
            gazes(frame).into_iter().map(|gaze| Look { gaze, caption: Caption::default() }).collect()
        };
        let looks = walk.path.frames.iter().map(looks).collect();
        let seeker = Seeker { detector: self.detector.as_ref(), figures: &self.figures, nouns: &[] };
        let seen = seek_claims(platform, &walk.path, looks, &claims, seeker)?;
        Ok(Evidence::from_detector(&walk.path, &seen))
    }
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
