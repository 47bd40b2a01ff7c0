//! Turns the evidence about a claimed place into features, the numbers that weights are fitted to.

use super::{
    claim_sight::{ClaimCase, ClaimSight, MissedClaim, class_name},
    claims::PlaceClaim,
    relation::WalkerRelation,
    weights::SilenceWeights,
};
use crate::evidence::{Evidence, ListedDistance, NEAR_M, PathSurroundings};
use wayword_language::lexicon::{ThingClass, find_thing, room_name};

/// Whether the evidence shows a claimed place, lacks it, or cannot decide. `around`: the things and rooms that the
/// building lists; without them, a place that no frame shows stays undecided.
#[must_use]
pub fn sight_of_claim(
    claim: &PlaceClaim,
    evidence: &Evidence,
    around: Option<&PathSurroundings>,
    weights: &SilenceWeights,
) -> ClaimSight {
    let at_stop = claim.relation == WalkerRelation::Stop;
    if is_everywhere(claim) || shown_by_frames(claim, evidence, at_stop) {
        return ClaimSight::Shown;
    }
    let Some(around) = around else { return ClaimSight::Unknown };
    if claim.class == ThingClass::Door && crosses_rooms(evidence) || is_doorway(claim) && crosses_rooms(evidence) {
        return ClaimSight::Shown;
    }
    let distance = claim_distance(claim, around);
    let off_m = if at_stop { distance.end_m } else { distance.path_m };
    if off_m <= NEAR_M {
        return ClaimSight::Shown;
    }
    match claim.is_only_room() {
        true if room_is_unknown(claim, evidence, around) => ClaimSight::Unknown,
        true => ClaimSight::Missed(missed_room(claim, distance, around, weights)),
        false if matches!(claim.class, ThingClass::Unknown | ThingClass::Fabric | ThingClass::Door) => {
            ClaimSight::Unknown
        }
        false => ClaimSight::Missed(missed_object(claim, distance, around, weights)),
    }
}

/// Walls, floors and corners are everywhere: naming them is no claim.
fn is_everywhere(claim: &PlaceClaim) -> bool {
    matches!(find_thing(&claim.name).map(|thing| thing.name), Some("wall" | "floor" | "ceiling" | "corner"))
}

fn is_doorway(claim: &PlaceClaim) -> bool {
    find_thing(&claim.name).is_some_and(|thing| thing.name == "doorway")
}

/// A path from one room into another goes through some opening.
fn crosses_rooms(evidence: &Evidence) -> bool {
    let mut rooms = evidence.frames.iter().flat_map(|frame| &frame.rooms);
    let first = rooms.next();
    rooms.any(|room| Some(room) != first)
}

/// Whether a frame shows the place; for the place of a stop, whether the last frame does.
fn shown_by_frames(claim: &PlaceClaim, evidence: &Evidence, at_stop: bool) -> bool {
    let mut frames = Vec::new();
    if claim.is_room {
        frames.extend(evidence.frames_in_room(&claim.name));
    }
    if claim.is_thing {
        frames.extend(evidence.frames_with_thing(&claim.name));
    }
    if claim.class == ThingClass::Stairs {
        frames.extend(evidence.frames_on_stairs());
    }
    let last = evidence.frames.len().saturating_sub(1);
    frames.iter().any(|frame| !at_stop || *frame == last)
}

fn claim_distance(claim: &PlaceClaim, around: &PathSurroundings) -> ListedDistance {
    let room = if claim.is_room { around.room_distance(&claim.name) } else { ListedDistance::NOWHERE };
    let thing = if claim.is_thing { around.thing_distance(&claim.name) } else { ListedDistance::NOWHERE };
    room.nearer_of(thing)
}

/// A room that may be where no room is known, or that is a storey.
fn room_is_unknown(claim: &PlaceClaim, evidence: &Evidence, around: &PathSurroundings) -> bool {
    let known = room_name(&claim.name);
    let is_storey = matches!(known, None | Some("basement" | "attic"));
    is_storey || around.has_gap() || !around.knows_rooms() || !evidence.frames_without_room().is_empty()
}

/// The word of a feature for how many hops away something is.
fn hop_bin(hops: usize) -> &'static str {
    match hops {
        0 => "0 hops",
        1 => "1 hop",
        2 => "2 hops",
        3 | 4 => "3-4 hops",
        usize::MAX => "no way",
        _ => "5+ hops",
    }
}

/// The word of a feature for a distance: the least of these bounds that is not exceeded.
fn distance_bin(distance_m: f64) -> &'static str {
    match distance_m {
        m if m <= NEAR_M => "near",
        m if m <= 5.0 => "3-5m",
        m if m <= 8.0 => "5-8m",
        m if m <= 15.0 => "8-15m",
        m if m.is_finite() => "15m+",
        _ => "nowhere",
    }
}

/// A coarser word for a distance, for features that combine it with something else.
fn reach_bin(distance_m: f64) -> &'static str {
    match distance_m {
        m if m <= NEAR_M => "near",
        m if m <= 8.0 => "close",
        m if m.is_finite() => "far",
        _ => "nowhere",
    }
}

/// The features of an object that is not listed within reach. Their names are those of `weights.toml`; two properties in
/// one name, such as "class {class} {reach}", have a weight for each pair.
fn missed_object(
    claim: &PlaceClaim,
    distance: ListedDistance,
    around: &PathSurroundings,
    weights: &SilenceWeights,
) -> MissedClaim {
    let at_stop = claim.relation == WalkerRelation::Stop;
    let nearest_m = if at_stop { distance.end_m } else { distance.path_m };
    let hops = hop_bin(if at_stop { distance.end_hops } else { distance.path_hops });
    let (class, relation) = (class_name(claim.class), claim.relation.name());
    let (bin, reach) = (distance_bin(nearest_m), reach_bin(nearest_m));
    let mut features: Vec<(String, f64)> = [
        "bias".to_owned(),
        format!("off {bin}"),
        hops.to_owned(),
        format!("{hops} {reach}"),
        format!("class {class}"),
        format!("class {class} {reach}"),
        format!("relation {relation}"),
        format!("relation {relation} {reach}"),
    ]
    .map(|name| (name, 1.0))
    .into();
    if at_stop {
        features.push((format!("path {}", self::distance_bin(distance.path_m)), 1.0));
    }
    let listed = ((1 + if at_stop { around.objects_at_end() } else { 0 }) as f64).ln();
    let density = if at_stop { listed } else { around.objects_per_frame().ln_1p() };
    features.push(("listed nearby".into(), density));
    features.push((format!("listed nearby {reach}"), density));
    let count = around.count_things(&claim.name);
    features.push(("listed in the building".into(), (count as f64).ln_1p()));
    if count > 0 {
        let home = if around.passes_home_of(&claim.name) { "passes its room" } else { "passes no room of it" };
        features.push((home.into(), 1.0));
        features.push((format!("{home} {reach}"), 1.0));
    } else {
        features.push(("size of the building".into(), (around.listing_viewpoints() as f64).ln_1p()));
    }
    if around.has_kin(claim.class, at_stop) {
        features.push((format!("kin {reach}"), 1.0));
        features.push((format!("kin {class}"), 1.0));
    }
    if let Some(homes) = weights.homes_of(claim.class) {
        let passes = homes.iter().any(|home| around.near_rooms().contains(home));
        let home = if passes { "room of the class" } else { "no room of the class" };
        features.push((home.into(), 1.0));
        features.push((format!("{home} {class}"), 1.0));
        features.push((format!("{home} {reach}"), 1.0));
        features.push((format!("{home} {class} {reach}"), 1.0));
        if at_stop {
            let ends = homes.iter().any(|home| around.end_rooms().contains(home));
            let home = if ends { "ends in its room" } else { "ends in no room of it" };
            features.push((format!("{home} {class}"), 1.0));
            features.push((format!("{home} {reach}"), 1.0));
        }
    }
    if let Some(thing) = find_thing(&claim.name) {
        features.push((format!("salience {} {reach}", thing.salience), 1.0));
    }
    let case = if at_stop { ClaimCase::ThingAtStop } else { ClaimCase::Thing };
    MissedClaim { case, features, nearest_m }
}

/// The features of a room that is not listed within reach, with names as in [`missed_object`].
fn missed_room(
    claim: &PlaceClaim,
    distance: ListedDistance,
    around: &PathSurroundings,
    weights: &SilenceWeights,
) -> MissedClaim {
    let at_stop = claim.relation == WalkerRelation::Stop;
    let nearest_m = if at_stop { distance.end_m } else { distance.path_m };
    let hops = hop_bin(if at_stop { distance.end_hops } else { distance.path_hops });
    let relation = claim.relation.name();
    let group = weights.room_group(&claim.name);
    let (bin, reach) = (distance_bin(nearest_m), reach_bin(nearest_m));
    let mut features: Vec<(String, f64)> = [
        "bias".to_owned(),
        format!("{group} {bin}"),
        format!("{group} {hops}"),
        format!("{group} {relation}"),
        format!("{group} {relation} {reach}"),
    ]
    .map(|name| (name, 1.0))
    .into();
    if at_stop {
        features.push((format!("path {}", self::distance_bin(distance.path_m)), 1.0));
        for room in around.end_rooms() {
            features.push((format!("{group} ends in {}", weights.room_group(room)), 1.0));
        }
    }
    features.push(("rooms nearby".into(), around.near_rooms().len() as f64));
    let case = match (nearest_m.is_finite(), at_stop) {
        (false, _) => ClaimCase::RoomLacking,
        (true, true) => ClaimCase::RoomAtStop,
        (true, false) => ClaimCase::Room,
    };
    MissedClaim { case, features, nearest_m }
}
