//! Collects the things of a walk, each once, with the side on which one passes it.

use crate::{
    Evidence, SeenThing,
    evidence::{SightingGroup, WalkEyes, group_sightings},
};
use std::{
    collections::BTreeSet,
    f64::consts::{FRAC_PI_3, FRAC_PI_4},
    ops::RangeInclusive,
};
use wayword_core::{DVec3, Side};
use wayword_language::lexicon::normalise_name;

/// A picture ahead shows what has its middle within this angle of the heading, degrees: its edge is nearer.
const AHEAD_DEG: f64 = 60.0;
/// A walker knows a thing that was ahead at most this many frames before.
pub const AHEAD_FRAMES: usize = 4;

/// A thing that was seen along a walk.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RememberedThing {
    /// Its name.
    pub name: String,
    /// Its id, where it comes from labels.
    pub object: Option<wayword_core::ObjectId>,
    /// Its colour, where one is known and no glimpse has another.
    pub colour: Option<String>,
    /// Its further colours.
    pub more_colours: Vec<String>,
    /// Its material, where one is known and no glimpse has another.
    pub material: Option<String>,
    /// Its pattern, or what it shows.
    pub detail: Option<String>,
    /// Whether most glimpses show several of its kind there.
    pub several: bool,
    /// Whether a witness thought that it catches the eye.
    pub stands_out: bool,
    /// Whether only witnesses named it, and no label lists it.
    pub is_unlisted: bool,
    /// Where it is, metres, world frame.
    pub position: Option<DVec3>,
    /// The room that it stands in, where labels say it.
    pub room: Option<String>,
    /// From which frames it is seen, ascending.
    pub glimpses: Vec<ThingGlimpse>,
    /// Where one passes it, if one does.
    pub passed: Option<ThingPassing>,
}

/// A thing as it is seen from one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThingGlimpse {
    /// The frame.
    pub frame: usize,
    /// Its direction from the frame's heading, radians in (-π, π], positive right.
    pub turn_rad: Option<f64>,
    /// Its distance, metres.
    pub distance_m: Option<f64>,
    /// Whether a witness who knows no distance called it far.
    pub is_far: bool,
}

/// How one passes a thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThingPassing {
    /// The frame nearest to where one passes it.
    pub frame: usize,
    /// The side on which it lies then: left or right.
    pub side: Side,
    /// How far along the walk that is, metres; the number of the frame where distances are not known.
    pub along_m: f64,
}

impl RememberedThing {
    /// The first frame from which it is seen.
    #[must_use]
    pub fn first_seen(&self) -> usize {
        self.glimpses.first().map_or(0, |glimpse| glimpse.frame)
    }

    /// The last frame from which it is seen.
    #[must_use]
    pub fn last_seen(&self) -> usize {
        self.glimpses.last().map_or(0, |glimpse| glimpse.frame)
    }

    /// Whether a walker saw it ahead from one of these frames. Where directions are not known, being seen is enough.
    #[must_use]
    pub fn is_ahead_from(&self, frames: &RangeInclusive<usize>) -> bool {
        let is_ahead = |glimpse: &ThingGlimpse| glimpse.turn_rad.is_none_or(|rad| rad.abs() <= AHEAD_DEG.to_radians());
        self.glimpses.iter().any(|glimpse| frames.contains(&glimpse.frame) && is_ahead(glimpse))
    }

    /// How it is seen from a frame.
    #[must_use]
    pub fn glimpse_from(&self, frame: usize) -> Option<&ThingGlimpse> {
        self.glimpses.iter().find(|glimpse| glimpse.frame == frame)
    }
}

/// The hops of a walk with these eyes at which it comes nearest to a position, by the floor, and how near that is, metres.
pub(super) fn nearest_hops(eyes: &[DVec3], position: DVec3) -> Option<(Vec<usize>, f64)> {
    /// Hops are equally near up to this, metres.
    const EQUALLY_NEAR_M: f64 = 0.02;
    let at = position.truncate();
    let last = eyes.len().checked_sub(2)?;
    let (mut all, mut is_within) = (Vec::new(), false);
    let mut nearest_m = f64::INFINITY;
    for (hop, pair) in eyes.windows(2).enumerate() {
        let (from, along) = (pair[0].truncate(), (pair[1] - pair[0]).truncate());
        let part = (at - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        let far_m = (from + along * part.clamp(0.0, 1.0) - at).length();
        if far_m < nearest_m {
            // What lies before the start or behind the end is at no hop.
            (nearest_m, is_within) = (far_m, (hop > 0 || part >= 0.0) && (hop < last || part <= 1.0));
        }
        all.push(far_m);
    }
    let hops = all.iter().enumerate().filter(|(_, far_m)| **far_m <= nearest_m + EQUALLY_NEAR_M);
    is_within.then(|| (hops.map(|(hop, _)| hop).collect(), nearest_m))
}

/// The things of a walk. `eyes` has no eyes where the motion is unknown.
pub(super) fn remember_things(evidence: &Evidence, eyes: &WalkEyes) -> Vec<RememberedThing> {
    let sightings: Vec<(usize, &SeenThing)> = evidence
        .frames
        .iter()
        .enumerate()
        .flat_map(|(at, seen)| seen.things.iter().map(move |thing| (at, thing)))
        .collect();
    let groups = group_sightings(&sightings, &evidence.frames, eyes);
    let remember = |group: SightingGroup| {
        let members: Vec<(usize, &SeenThing)> = group.members.iter().map(|member| sightings[*member]).collect();
        join_sightings(&members, &group, eyes)
    };
    groups.into_iter().map(remember).filter(|thing| !normalise_name(&thing.name).is_empty()).collect()
}

/// One remembered thing from all sightings of it.
fn join_sightings(members: &[(usize, &SeenThing)], group: &SightingGroup, eyes: &WalkEyes) -> RememberedThing {
    let (_, first) = members[0];
    let position = group.position;
    let mut glimpses: Vec<ThingGlimpse> = Vec::new();
    for (frame, thing) in members {
        if glimpses.last().is_none_or(|last| last.frame != *frame) {
            let by_place = || Some((position? - eyes.at(*frame)?).length());
            let distance_m = thing.distance_m.or_else(by_place);
            let is_far = thing.is_far;
            glimpses.push(ThingGlimpse { frame: *frame, turn_rad: thing.turn_rad, distance_m, is_far });
        }
    }
    let of_all = |look: fn(&SeenThing) -> Option<&String>| {
        let mut looks = members.iter().filter_map(|(_, thing)| look(thing));
        looks.next().filter(|first| looks.all(|other| other == *first)).cloned()
    };
    // Where labels and witnesses give different colours, none is sure.
    let is_disputed = members.iter().any(|(_, thing)| thing.disputed_colour.is_some());
    // A colour that few sightings have may be that of another thing.
    let named: Vec<&String> = members.iter().flat_map(|(_, thing)| &thing.more_colours).collect();
    let is_usual = |colour: &&&String| named.iter().filter(|other| other == colour).count() * 2 >= members.len();
    let more_colours: BTreeSet<String> = named.iter().filter(is_usual).map(|colour| (*colour).clone()).collect();
    let passed = match (&group.places, position) {
        (Some(places), _) => agreed_passing(places, &eyes.eyes),
        (None, Some(position)) => passed_at(position, &eyes.eyes),
        (None, None) => passed_by_glimpses(&glimpses),
    };
    // What was not seen yet was not passed.
    let seen_from = members[0].0.saturating_sub(1);
    let passed = passed.filter(|passed| passed.frame >= seen_from);
    RememberedThing {
        name: first.name.clone(),
        object: first.object.clone(),
        colour: of_all(|thing| thing.colour.as_ref()).filter(|_| !is_disputed),
        more_colours: more_colours.into_iter().collect(),
        material: of_all(|thing| thing.material.as_ref()),
        detail: members.iter().find_map(|(_, thing)| thing.detail.clone()),
        several: members.iter().filter(|(_, thing)| thing.several).count() * 2 > members.len(),
        stands_out: members.iter().any(|(_, thing)| thing.stands_out),
        is_unlisted: members.iter().all(|(_, thing)| thing.is_unlisted),
        position,
        room: first.room.clone(),
        glimpses,
        passed,
    }
}

/// A thing is passed where it lies at the side of a hop, at most this far before its beginning or after its end, metres.
const PASSING_SLACK_M: f64 = 0.3;
/// A thing farther off the way than this is not passed, metres.
const BESIDE_M: f64 = 4.0;
/// Things of a storey lie from so much below the eye to so much above it, metres.
const STOREY_M: [f64; 2] = [-1.9, 1.4];
/// A thing nearer to the line of the walk than this lies on neither side, metres.
const IN_THE_WAY_M: f64 = 0.15;

/// Whether a thing at a position is on the storey of an eye.
pub(super) fn shares_storey(position: DVec3, eye: DVec3) -> bool {
    (STOREY_M[0]..=STOREY_M[1]).contains(&(position.z - eye.z))
}

/// Where and on which side one passes a position: at the hop that comes nearest to it.
fn passed_at(position: DVec3, eyes: &[DVec3]) -> Option<ThingPassing> {
    let mut best: Option<(f64, ThingPassing)> = None;
    let mut walked_m = 0.0;
    for (at, hop) in eyes.windows(2).enumerate() {
        let (along, to) = ((hop[1] - hop[0]).truncate(), (position - hop[0]).truncate());
        let length_m = along.length();
        if length_m > 0.0 {
            let along_m = to.dot(along) / length_m;
            let off_m = along.perp_dot(to) / length_m;
            let beside = (-PASSING_SLACK_M..=length_m + PASSING_SLACK_M).contains(&along_m);
            let is_near = (IN_THE_WAY_M..=BESIDE_M).contains(&off_m.abs());
            // Lengths along the walk count the slope of stairs.
            let slope = (hop[1] - hop[0]).length() / length_m;
            let is_here = hop.iter().any(|eye| shares_storey(position, *eye));
            if beside && is_near && is_here && best.as_ref().is_none_or(|(nearest, _)| off_m.abs() < *nearest) {
                let side = if off_m > 0.0 { Side::Left } else { Side::Right };
                let frame = if along_m * 2.0 > length_m { at + 1 } else { at };
                best = Some((off_m.abs(), ThingPassing { frame, side, along_m: walked_m + along_m * slope }));
            }
        }
        walked_m += (hop[1] - hop[0]).length();
    }
    best.map(|(_, passed)| passed)
}

/// For a thing without a position: one passes it if it is ahead first and then at one's side.
fn passed_by_glimpses(glimpses: &[ThingGlimpse]) -> Option<ThingPassing> {
    glimpses.windows(2).find_map(|pair| {
        let (before, now) = (pair[0].turn_rad?, pair[1].turn_rad?);
        let side = if now < 0.0 { Side::Left } else { Side::Right };
        let passes = before.abs() < FRAC_PI_3 && now.abs() >= FRAC_PI_3 && now.abs() < 3.0 * FRAC_PI_4;
        passes.then_some(ThingPassing { frame: pair[1].frame, side, along_m: pair[1].frame as f64 })
    })
}

/// The side on which one passes a thing is known where this share of its places agree.
const SAME_SIDE_SHARE: f64 = 0.9;

/// How one passes a thing that is at one of these places, where nearly all agree on the side.
fn agreed_passing(places: &[DVec3], eyes: &[DVec3]) -> Option<ThingPassing> {
    let mut passings: Vec<ThingPassing> = places.iter().filter_map(|place| passed_at(*place, eyes)).collect();
    passings.sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
    let middle = *passings.get(passings.len() / 2)?;
    let agreeing = passings.iter().filter(|passing| passing.side == middle.side).count();
    (agreeing as f64 >= SAME_SIDE_SHARE * places.len() as f64).then_some(middle)
}
