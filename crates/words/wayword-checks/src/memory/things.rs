//! Collects the things of a walk, each once: sightings from several frames are joined if they can be of one thing, and
//! the thing's position and the side on which one passes it follow from them.

use crate::{Evidence, SeenThing};
use std::{
    f64::consts::{FRAC_PI_3, FRAC_PI_4},
    ops::RangeInclusive,
};
use wayword_core::{DVec3, Heading, Side};
use wayword_language::lexicon::{names_agree, normalise_name};

/// A picture ahead shows what lies within this angle of the heading, degrees.
const AHEAD_DEG: f64 = 50.0;
/// A walker knows a thing that was ahead at most this many frames before.
pub const AHEAD_FRAMES: usize = 4;

/// A thing that was seen along a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct RememberedThing {
    /// Its name.
    pub name: String,
    /// Its id, where it comes from labels.
    pub object: Option<wayword_core::ObjectId>,
    /// Its colour, where one is known and no glimpse has another.
    pub colour: Option<String>,
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

/// Sightings without ids that lie up to this far apart are of one thing, metres.
const SAME_THING_M: f64 = 0.8;
/// The same limit where the positions come from measured distances. Those lead to the visible face
/// of a thing, which is its front from one side and its back from the other.
const SAME_FRONT_M: f64 = 1.5;
/// Two directions cross where they differ by more than this, radians.
const CROSSING_RAD: f64 = 0.17;
/// Things without a known position are taken to be up to this far from the eye, metres.
const MAX_RAY_M: f64 = 8.0;

/// A sighting with the eye that had it.
struct EyeSighting<'a> {
    /// The frame from which the thing is seen.
    frame: usize,
    /// The thing as the frame shows it.
    thing: &'a SeenThing,
    /// Its direction, where poses are known.
    towards: Option<Heading>,
    /// The position of the eye, where poses are known.
    eye: Option<DVec3>,
}

impl EyeSighting<'_> {
    /// How far away the thing is measured to be, metres, and where it lies by that.
    fn measured_place(&self) -> Option<(f64, DVec3)> {
        let (far_m, eye, towards) = (self.thing.distance_m?, self.eye?, self.towards?);
        Some((far_m, eye + towards.unit_vector() * far_m))
    }
}

/// The things of a walk. `eyes` is empty where the motion is unknown.
pub(super) fn remember_things(evidence: &Evidence, eyes: &[DVec3], headings: &[Heading]) -> Vec<RememberedThing> {
    let mut groups: Vec<Vec<EyeSighting<'_>>> = Vec::new();
    for (frame, seen) in evidence.frames.iter().enumerate() {
        let before = groups.len();
        for thing in &seen.things {
            let eye = eyes.get(frame).copied();
            let turned = |turn_rad: f64| headings.get(frame).map(|heading| heading.turned_by(turn_rad));
            let sighted = EyeSighting { frame, thing, eye, towards: eye.and(thing.turn_rad).and_then(turned) };
            // Of one frame, two sightings without ids are two things.
            let joins = |(at, group): &(usize, &Vec<EyeSighting<'_>>)| match &thing.object {
                Some(id) => group[0].thing.object.as_ref() == Some(id),
                None => *at < before && group.iter().all(|other| other.frame != frame) && is_same(group, &sighted),
            };
            match groups.iter().enumerate().find(joins).map(|(at, _)| at) {
                Some(at) => groups[at].push(sighted),
                None => groups.push(vec![sighted]),
            }
        }
    }
    groups
        .into_iter()
        .filter(|group| !normalise_name(&group[0].thing.name).is_empty())
        .map(|group| join_sightings(&group, eyes))
        .collect()
}

/// Whether a sighting without an id is of the thing that earlier sightings are of: the names agree, no colour differs,
/// and the directions can meet.
fn is_same(group: &[EyeSighting<'_>], new: &EyeSighting<'_>) -> bool {
    let Some(last) = group.last() else { return false };
    let same_colour = match (&last.thing.colour, &new.thing.colour) {
        (Some(a), Some(b)) => a == b,
        _ => true,
    };
    if group[0].thing.object.is_some() || !same_colour || !names_agree(&last.thing.name, &new.thing.name) {
        return false;
    }
    if let (Some(a), Some(b)) = (last.thing.position, new.thing.position) {
        return a.distance(b) <= SAME_THING_M;
    }
    if let (Some(a), Some(b)) = (last.measured_place(), new.measured_place()) {
        return a.1.distance(b.1) <= SAME_FRONT_M;
    }
    match (last.eye.zip(last.towards), new.eye.zip(new.towards)) {
        (Some(a), Some(b)) => can_meet(a, b),
        // Without directions, a name in consecutive frames means one thing.
        _ => new.frame - last.frame <= 1,
    }
}

/// Whether two rays over the floor can show one thing: they cross ahead of both eyes, or run along one line.
fn can_meet(a: (DVec3, Heading), b: (DVec3, Heading)) -> bool {
    match ray_crossing(a, b) {
        Some((_, far_a, far_b)) => far_a.min(far_b) > 0.0 && far_a.max(far_b) <= MAX_RAY_M,
        None => a.1.turn_to(b.1).abs() < FRAC_PI_4,
    }
}

/// Where two rays cross over the floor, and how far from either eye.
fn ray_crossing(a: (DVec3, Heading), b: (DVec3, Heading)) -> Option<(DVec3, f64, f64)> {
    let (along_a, along_b) = (a.1.unit_vector().truncate(), b.1.unit_vector().truncate());
    let across = along_a.perp_dot(along_b);
    if across.abs() < libm::sin(CROSSING_RAD) {
        return None;
    }
    let gap = (b.0 - a.0).truncate();
    let (far_a, far_b) = (gap.perp_dot(along_b) / across, gap.perp_dot(along_a) / across);
    let at = a.0.truncate() + along_a * far_a;
    Some((at.extend(a.0.z), far_a, far_b))
}

/// One remembered thing from all sightings of it.
fn join_sightings(group: &[EyeSighting<'_>], eyes: &[DVec3]) -> RememberedThing {
    let first = group[0].thing;
    let position = thing_position(group);
    let mut glimpses: Vec<ThingGlimpse> = Vec::new();
    for sighted in group {
        if glimpses.last().is_none_or(|last| last.frame != sighted.frame) {
            let by_place = || Some((position? - sighted.eye?).length());
            let distance_m = sighted.thing.distance_m.or_else(by_place);
            glimpses.push(ThingGlimpse { frame: sighted.frame, turn_rad: sighted.thing.turn_rad, distance_m });
        }
    }
    let mut colours = group.iter().filter_map(|sighted| sighted.thing.colour.as_ref());
    let colour = colours.next().filter(|first| colours.all(|other| other == *first)).cloned();
    let passed = match position {
        Some(position) => passed_at(position, eyes),
        None => passed_by_glimpses(&glimpses),
    };
    RememberedThing {
        name: first.name.clone(),
        object: first.object.clone(),
        colour,
        position,
        room: first.room.clone(),
        glimpses,
        passed,
    }
}

/// The position of a thing: that of its labels, or else by the distance from the nearest frame, or else where two of
/// its directions cross.
fn thing_position(group: &[EyeSighting<'_>]) -> Option<DVec3> {
    let listed = group.iter().find_map(|sighted| sighted.thing.position);
    let rays: Vec<(DVec3, Heading)> = group.iter().filter_map(|sighted| sighted.eye.zip(sighted.towards)).collect();
    let crossed = || {
        let (first, last) = (rays.first()?, rays.last()?);
        ray_crossing(*first, *last).filter(|(_, a, b)| a.min(*b) > 0.0 && a.max(*b) <= MAX_RAY_M).map(|(at, ..)| at)
    };
    listed.or_else(|| nearest_sighting(group)).or_else(crossed)
}

/// The place of the sighting from the least distance.
fn nearest_sighting(group: &[EyeSighting<'_>]) -> Option<DVec3> {
    let measured = group.iter().filter_map(EyeSighting::measured_place);
    measured.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
}

/// A thing is passed where it lies at the side of a hop, at most this far before its beginning or after its end, metres.
const PASSING_SLACK_M: f64 = 0.3;
/// A thing farther off the way than this is not passed, metres.
const BESIDE_M: f64 = 4.0;
/// A thing nearer to the line of the walk than this lies on neither side, metres.
const IN_THE_WAY_M: f64 = 0.15;

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
            if beside && is_near && best.as_ref().is_none_or(|(nearest, _)| off_m.abs() < *nearest) {
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
