//! Where the walk ends: the thing at which a text stops is near, and the room that it names as the goal is that of the
//! last frame.

use super::finding;
use crate::{
    evidence::{Evidence, Source},
    open::{Claim, Relation, claims},
};
use wayword_core::{Check, Finding, Verdict};
use wayword_language::{
    lexicon::{Class, agree, same_room},
    reading::{Place, Reading, What},
};

/// "Stop by the sofa": its centre is no farther than this from the eye, metres. That is 2 m along the floor for what
/// stands on it.
const NEAR_M: f64 = 2.5;

/// What is wrong with the end of a text that was written from labels. Captions tell no distances, and too little of the
/// room of a single frame.
pub(super) fn end(reading: &Reading, evidence: &Evidence) -> Vec<Finding> {
    if evidence.source != Source::Labels {
        return Vec::new();
    }
    let claims = claims(reading);
    let wrong = [stop(&claims, evidence), goal(&claims, reading, evidence)];
    wrong
        .into_iter()
        .flatten()
        .map(|(span, reason)| finding(Check::Landmarks, Verdict::Fail, reason, Some(span)))
        .collect()
}

/// The thing at which the text stops, where none of its name is near the end.
fn stop(claims: &[Claim], evidence: &Evidence) -> Option<([usize; 2], String)> {
    let is_thing = |claim: &&Claim| claim.is_thing && !claim.is_room && claim.relation == Relation::Stop;
    let claim = claims.iter().find(is_thing)?;
    let is_wide = matches!(claim.class, Class::Stairs | Class::Fabric | Class::Floor | Class::Unknown);
    if is_wide || !evidence.denies_thing_at_end(&claim.name) {
        return None;
    }
    let alike = evidence.final_things().iter().filter(|thing| agree(&thing.name, &claim.name));
    let far_m = alike.map(|thing| thing.distance_m.unwrap_or(0.0)).fold(f64::INFINITY, f64::min);
    let name = &claim.name;
    let reason = match far_m {
        near_m if near_m <= NEAR_M => return None,
        f64::INFINITY => format!("no {name:?} is seen where the path ends"),
        _ => format!("the nearest {name:?} is {far_m:.1} m from where the path ends"),
    };
    Some((claim.span, reason))
}

/// The room that the text names as its goal, where the path ends in another one.
fn goal(claims: &[Claim], reading: &Reading, evidence: &Evidence) -> Option<([usize; 2], String)> {
    let claim = goal_room(claims, reading)?;
    let rooms = &evidence.frames.last()?.rooms;
    let is_there = |room: &String| same_room(room, &claim.name);
    if rooms.is_empty() || rooms.iter().any(is_there) || !evidence.denies_room(&claim.name) {
        return None;
    }
    Some((claim.span, format!("the path ends in the {}, and not in the {}", rooms.join(" or "), claim.name)))
}

/// The room in which the text stops, or else the last one that it goes to, if it goes no farther after it.
fn goal_room<'c>(claims: &'c [Claim], reading: &Reading) -> Option<&'c Claim> {
    let stop = claims.iter().find(|claim| claim.is_only_room() && claim.relation == Relation::Stop);
    stop.or_else(|| {
        let goes = |what: &What| match what {
            What::Turn(_) | What::Climb(_) | What::Onward => true,
            What::Place(Place { going, .. }) => going.is_some(),
            _ => false,
        };
        let last = reading.events.iter().rposition(|event| goes(&event.what))?;
        let is_goal = |claim: &&Claim| matches!(claim.relation, Relation::Enter | Relation::Towards);
        claims.iter().filter(is_goal).find(|claim| claim.event == last && claim.is_only_room())
    })
}
