//! Checks rooms and objects in an open world.

use super::{
    Calibration,
    claim_sight::{ClaimSight, MissedClaim},
    claims::{PlaceClaim, read_claims},
    features::sight_of_claim,
    relation::WalkerRelation,
    sides,
    weights::{SilenceWeights, WeightTable},
};
use crate::{CheckSubject, evidence::EvidenceSource, landmarks::is_beyond, new_finding};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::reading::{EventContent, TextReading};

/// The places of a text that are wrong, and those that cannot be checked.
pub(super) fn check_places(reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    let evidence = subject.evidence;
    let weights = SilenceWeights::shipped();
    let mut findings = Vec::new();
    let claims = read_claims(reading);
    let sights = sights_in_company(&claims, subject, weights);
    for (claim, sight) in claims.into_iter().zip(sights) {
        let EventContent::Place(place) = &reading.events[claim.event].what else { continue };
        let wrong = match &sight {
            ClaimSight::Shown => {
                sides::unclear_side(place, subject).or_else(|| unclear_colour(place.colour.as_deref(), &claim, subject))
            }
            _ if evidence.source == EvidenceSource::Detector
                && place.is_thing
                && evidence.denies_thing(&place.name) =>
            {
                let reason = format!("the detector finds no {:?} along the path, and would have found one", claim.name);
                Some((Verdict::Fail, reason))
            }
            ClaimSight::Unknown => {
                Some((Verdict::Unverified, format!("the program cannot check whether there is {:?}", claim.name)))
            }
            // The place is in the room at the end, or is a room next to that one, so no frame has to show it.
            ClaimSight::Missed(_) if is_beyond(place, evidence) => None,
            ClaimSight::Missed(missed) => Some(verdict_on_missing(&claim, missed, weights, subject.reach.calibration)),
        };
        findings.extend(
            wrong.map(|(verdict, reason)| new_finding(CheckKind::Landmarks, verdict, reason, Some(claim.span))),
        );
    }
    if evidence.source == EvidenceSource::Nothing && findings.is_empty() {
        let reason = "the program does not know what can be seen along the path";
        findings.push(new_finding(CheckKind::Landmarks, Verdict::Unverified, reason, None));
    }
    findings
}

/// The sight of each claim, with features for how many of the other claims the evidence shows and misses.
fn sights_in_company(claims: &[PlaceClaim], subject: CheckSubject<'_>, weights: &SilenceWeights) -> Vec<ClaimSight> {
    let alone = |claim| sight_of_claim(claim, subject.evidence, subject.reach.surroundings, weights);
    let sights: Vec<ClaimSight> = claims.iter().map(alone).collect();
    let in_company = |(at, mut sight): (usize, ClaimSight)| {
        if let ClaimSight::Missed(missed) = &mut sight {
            missed.add_company_features(sights[..at].iter().chain(&sights[at + 1..]));
        }
        sight
    };
    sights.iter().cloned().enumerate().map(in_company).collect()
}

/// The verdict on a place that is not listed within reach.
fn verdict_on_missing(
    claim: &PlaceClaim,
    missed: &MissedClaim,
    weights: &SilenceWeights,
    calibration: Option<&Calibration>,
) -> (Verdict, String) {
    let offset = calibration.map_or(0.0, |calibration| calibration.offset_for(claim, missed));
    let ratio = weights.log_ratio(missed).map(|ratio| ratio + offset);
    let passes_threshold = |(ratio, table): (f64, &WeightTable)| ratio >= table.fails_at.ln();
    let fails = missed.can_fail() && ratio.zip(weights.table_for(missed.case)).is_some_and(passes_threshold);
    let place = if claim.relation == WalkerRelation::Stop { "where the path ends" } else { "along the path" };
    let name = &claim.name;
    match (fails, missed.nearest_m.is_finite()) {
        (false, _) => (Verdict::Unverified, format!("the labels list no {name:?} {place}, which says little")),
        (true, true) => {
            (Verdict::Fail, format!("no {name:?} is {place}: the nearest is {:.1} m off", missed.nearest_m))
        }
        (true, false) => (Verdict::Fail, format!("no {name:?} is {place}: the building lists none")),
    }
}

/// The doubt about the colour `claimed`: the labels of a place need not be those of the thing that the text means.
fn unclear_colour(claimed: Option<&str>, claim: &PlaceClaim, subject: CheckSubject<'_>) -> Option<(Verdict, String)> {
    let claimed = claimed?;
    let things = subject.evidence.frames.iter().flat_map(|frame| &frame.things);
    let known = things.filter(|thing| wayword_language::lexicon::names_agree(&thing.name, &claim.name));
    let fits = known.filter_map(|thing| thing.colour.as_deref()).any(|colour| {
        colour == claimed || colour.ends_with(&format!(" {claimed}")) || claimed.ends_with(&format!(" {colour}"))
    });
    (!fits).then(|| (Verdict::Unverified, format!("the program cannot check whether {:?} is {claimed}", claim.name)))
}
