//! Checks rooms and objects in an open world.

use super::{
    Calibration,
    claims::{Claim, claims},
    features::sight,
    relation::Relation,
    sides,
    sight::{Missed, Sight},
    weights::{Table, Weights},
};
use crate::{Subject, evidence::Source, finding, landmarks::is_beyond};
use wayword_core::{Check, Finding, Verdict};
use wayword_language::reading::{Reading, What};

/// The places of a text that are wrong, and those that cannot be checked.
pub(super) fn places(reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    let evidence = subject.evidence;
    let weights = Weights::shipped();
    let mut findings = Vec::new();
    let claims = claims(reading);
    let sights = sights(&claims, subject, weights);
    for (claim, sight) in claims.into_iter().zip(sights) {
        let What::Place(place) = &reading.events[claim.event].what else { continue };
        let wrong = match &sight {
            Sight::Shown => {
                sides::unclear_side(place, subject).or_else(|| colour(place.colour.as_deref(), &claim, subject))
            }
            _ if evidence.source == Source::Detector && place.is_thing && evidence.denies_thing(&place.name) => {
                let reason = format!("the detector finds no {:?} along the path, and would have found one", claim.name);
                Some((Verdict::Fail, reason))
            }
            Sight::Unknown => {
                Some((Verdict::Unverified, format!("the program cannot check whether there is {:?}", claim.name)))
            }
            // It is in the room at the end, or is the room next to it, and no frame has to show it.
            Sight::Missed(_) if is_beyond(place, evidence) => None,
            Sight::Missed(missed) => Some(missing(&claim, missed, weights, subject.reach.calibration)),
        };
        findings.extend(wrong.map(|(verdict, reason)| finding(Check::Landmarks, verdict, reason, Some(claim.span))));
    }
    if evidence.source == Source::Nothing && findings.is_empty() {
        let reason = "the program does not know what can be seen along the path";
        findings.push(finding(Check::Landmarks, Verdict::Unverified, reason, None));
    }
    findings
}

/// The sight of each claim, in view of the others.
fn sights(claims: &[Claim], subject: Subject<'_>, weights: &Weights) -> Vec<Sight> {
    let alone = |claim| sight(claim, subject.evidence, subject.reach.surroundings, weights);
    let sights: Vec<Sight> = claims.iter().map(alone).collect();
    let in_company = |(at, mut sight): (usize, Sight)| {
        if let Sight::Missed(missed) = &mut sight {
            missed.keep_company(sights[..at].iter().chain(&sights[at + 1..]));
        }
        sight
    };
    sights.iter().cloned().enumerate().map(in_company).collect()
}

/// The verdict on a place that is not listed within reach.
fn missing(claim: &Claim, missed: &Missed, weights: &Weights, calibration: Option<&Calibration>) -> (Verdict, String) {
    let offset = calibration.map_or(0.0, |calibration| calibration.offset(claim, missed));
    let ratio = weights.log_ratio(missed).map(|ratio| ratio + offset);
    let passes_threshold = |(ratio, table): (f64, &Table)| ratio >= table.fails_at.ln();
    let fails = missed.can_fail() && ratio.zip(weights.table(missed.case)).is_some_and(passes_threshold);
    let place = if claim.relation == Relation::Stop { "where the path ends" } else { "along the path" };
    let name = &claim.name;
    match (fails, missed.nearest_m.is_finite()) {
        (false, _) => (Verdict::Unverified, format!("the labels list no {name:?} {place}, which says little")),
        (true, true) => {
            (Verdict::Fail, format!("no {name:?} is {place}: the nearest is {:.1} m off", missed.nearest_m))
        }
        (true, false) => (Verdict::Fail, format!("no {name:?} is {place}: the building lists none")),
    }
}

/// The doubt about a colour: the labels of a place need not be those of the thing that the text means.
fn colour(told: Option<&str>, claim: &Claim, subject: Subject<'_>) -> Option<(Verdict, String)> {
    let told = told?;
    let things = subject.evidence.frames.iter().flat_map(|frame| &frame.things);
    let known = things.filter(|thing| wayword_language::lexicon::agree(&thing.name, &claim.name));
    let fits = known
        .filter_map(|thing| thing.colour.as_deref())
        .any(|colour| colour == told || colour.ends_with(&format!(" {told}")) || told.ends_with(&format!(" {colour}")));
    (!fits).then(|| (Verdict::Unverified, format!("the program cannot check whether {:?} is {told}", claim.name)))
}
