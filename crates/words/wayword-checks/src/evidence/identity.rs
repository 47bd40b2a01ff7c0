//! Decides which sightings of a walk are of one thing, by name, looks, direction and room, and where that thing may be.
//!
//! Labels have ids. A witness names only the third of a view in which a thing lies, and whether it is near: that is a sector of the floor,
//! and no point. Sightings are of one thing only where their sectors have a place in common. What a door, a storey or several frames
//! separate is one thing only where its looks say so too.

use super::{FrameEvidence, SeenThing, is_wide};
use std::f64::consts::FRAC_PI_4;
use wayword_core::{DVec3, Heading, Path};
use wayword_language::lexicon::{names_agree, same_colour, same_room};

/// The eyes of a walk and the headings along it; no eyes where the motion is unknown.
pub(crate) struct WalkEyes {
    pub(crate) eyes: Vec<DVec3>,
    headings: Vec<Heading>,
}

impl WalkEyes {
    /// The eyes along a path.
    pub(crate) fn along(path: &Path) -> Self {
        let frames = if path.motion.is_known() { path.frames.as_slice() } else { &[] };
        Self {
            eyes: frames.iter().map(|frame| frame.pose.position).collect(),
            headings: frames.iter().map(|frame| frame.pose.heading).collect(),
        }
    }

    /// The eye at a frame.
    pub(crate) fn at(&self, frame: usize) -> Option<DVec3> {
        self.eyes.get(frame).copied()
    }

    /// The direction of a thing in the world, where poses are known.
    fn towards(&self, frame: usize, thing: &SeenThing) -> Option<Heading> {
        Some(self.headings.get(frame)?.turned_by(thing.turn_rad?))
    }
}

/// The sightings of one thing.
#[derive(Debug, Default)]
pub(crate) struct SightingGroup {
    /// The indices of its sightings, in the order of the frames.
    pub(crate) members: Vec<usize>,
    /// Where it is, metres, world frame, if that is known well enough.
    pub(crate) position: Option<DVec3>,
    /// The places where it may be, if witnesses named only sectors.
    pub(crate) places: Option<Vec<DVec3>>,
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
/// Witnesses may lose sight of a thing for this many frames, and for twice as many where its looks are the same.
const MAX_GAP_FRAMES: usize = 3;

/// A sighting with the eye that had it.
#[derive(Clone, Copy)]
struct EyeSighting<'a> {
    /// Its index among all sightings.
    index: usize,
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

    /// Whether the witness placed it in a part of a view, and no more.
    fn is_sector(&self) -> bool {
        self.thing.turn_slack_rad > 0.0 && self.towards.is_some() && self.eye.is_some()
    }
}

/// Groups sightings (frame and thing), which are in the order of their frames.
pub(crate) fn group_sightings(
    sightings: &[(usize, &SeenThing)],
    frames: &[FrameEvidence],
    eyes: &WalkEyes,
) -> Vec<SightingGroup> {
    let mut groups: Vec<Vec<EyeSighting<'_>>> = Vec::new();
    let mut rest = sightings;
    while let Some((frame, _)) = rest.first() {
        let count = rest.iter().take_while(|(other, _)| other == frame).count();
        let from = sightings.len() - rest.len();
        let here: Vec<EyeSighting<'_>> = rest[..count]
            .iter()
            .enumerate()
            .map(|(at, (frame, thing))| EyeSighting {
                index: from + at,
                frame: *frame,
                thing,
                towards: eyes.towards(*frame, thing),
                eye: eyes.at(*frame),
            })
            .collect();
        add_frame(&mut groups, &here, frames);
        rest = &rest[count..];
    }
    groups.into_iter().map(|group| place_group(&group, frames, eyes)).collect()
}

/// Adds the sightings of a frame to the groups before it: ids decide, and else the best fits first. Of one frame, two sightings without ids
/// are two things.
fn add_frame<'a>(groups: &mut Vec<Vec<EyeSighting<'a>>>, here: &[EyeSighting<'a>], frames: &[FrameEvidence]) {
    let before = groups.len();
    let mut fits: Vec<(f64, usize, usize)> = Vec::new();
    let mut placed = vec![false; here.len()];
    for (at, new) in here.iter().enumerate() {
        match &new.thing.object {
            Some(id) => {
                let same = groups.iter().position(|group| group[0].thing.object.as_ref() == Some(id));
                match same {
                    Some(group) => groups[group].push(*new),
                    None => groups.push(vec![*new]),
                }
                placed[at] = true;
            }
            None => {
                let old = groups[..before].iter().enumerate();
                fits.extend(old.filter_map(|(number, group)| Some((fit_to_group(group, new, frames)?, at, number))));
            }
        }
    }
    fits.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut taken = vec![false; before];
    for (_, at, group) in fits {
        if !placed[at] && !taken[group] {
            groups[group].push(here[at]);
            (placed[at], taken[group]) = (true, true);
        }
    }
    let alone = here.iter().zip(placed).filter(|(_, is_placed)| !is_placed);
    groups.extend(alone.map(|(new, _)| vec![*new]));
}

/// How well a sighting without an id fits a group of earlier ones; `None` where it is of another thing.
fn fit_to_group(group: &[EyeSighting<'_>], new: &EyeSighting<'_>, frames: &[FrameEvidence]) -> Option<f64> {
    let last = group.last()?;
    let looks = compare_looks(group, new)?;
    if group[0].thing.object.is_some() || !names_agree(&last.thing.name, &new.thing.name) {
        return None;
    }
    let gap = new.frame - last.frame;
    let nearness = 1.0 / gap.max(1) as f64;
    if let (Some(a), Some(b)) = (last.thing.position, new.thing.position) {
        return (a.distance(b) <= SAME_THING_M).then_some(nearness + 1.0);
    }
    if let (Some(a), Some(b)) = (last.measured_place(), new.measured_place()) {
        return (a.1.distance(b.1) <= SAME_FRONT_M).then_some(nearness + 1.0);
    }
    let needs_looks = gap > MAX_GAP_FRAMES || is_separated(frames, last, new);
    let is_apart = gap > 2 * MAX_GAP_FRAMES || (gap > MAX_GAP_FRAMES && is_separated(frames, last, new));
    if is_apart || (needs_looks && looks != LooksMatch::Same && !is_next_sight(last, new)) {
        return None;
    }
    if last.is_sector() && new.is_sector() {
        let share = shared_places(group, new);
        let least = match looks {
            LooksMatch::Same => 0.0,
            LooksMatch::Unknown if needs_looks => SAME_SPOT_SHARE,
            LooksMatch::Unknown => {
                if gap > 1 {
                    SURE_SHARE
                } else {
                    0.0
                }
            }
        };
        return (share > least).then_some(share + nearness + if looks == LooksMatch::Same { 0.5 } else { 0.0 });
    }
    let may_meet = match (last.eye.zip(last.towards), new.eye.zip(new.towards)) {
        (Some(a), Some(b)) => can_meet(a, b),
        // Without directions, a name in consecutive frames means one thing.
        _ => gap <= 1,
    };
    may_meet.then_some(nearness)
}

/// Without looks, and after a frame without a sighting, this share of a group's places has to fit.
const SURE_SHARE: f64 = 0.15;
/// The same from one frame to the next, where a change of rooms lies between them.
const SAME_SPOT_SHARE: f64 = 0.5;
/// Such frames are at most this far apart, metres.
const NEXT_HOP_M: f64 = 1.3;

/// Whether a sighting follows at once on one of a thing that does not lie in every room, as rugs do.
fn is_next_sight(last: &EyeSighting<'_>, new: &EyeSighting<'_>) -> bool {
    let hop_m = last.eye.zip(new.eye).map(|(a, b)| a.distance(b));
    new.frame == last.frame + 1 && hop_m.is_some_and(|hop_m| hop_m <= NEXT_HOP_M) && !is_wide(&new.thing.name)
}

/// How the looks of two sightings agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LooksMatch {
    /// A colour, a material or a detail is the same, and none differs.
    Same,
    /// No look of the one is known of the other.
    Unknown,
}

/// How the looks of a sighting agree with a group; `None` where one differs.
fn compare_looks(group: &[EyeSighting<'_>], new: &EyeSighting<'_>) -> Option<LooksMatch> {
    let mut is_same = false;
    for EyeSighting { thing, .. } in group.iter().rev().take(MAX_COMPARED) {
        let colours = |thing: &SeenThing| thing.colour.iter().chain(&thing.more_colours).cloned().collect::<Vec<_>>();
        let (old, here) = (colours(thing), colours(new.thing));
        if !old.is_empty() && !here.is_empty() {
            if !old.iter().any(|a| here.iter().any(|b| same_colour(a, b))) {
                return None;
            }
            is_same = true;
        }
        match (&thing.material, &new.thing.material) {
            (Some(a), Some(b)) if a != b => return None,
            (Some(_), Some(_)) => is_same = true,
            _ => {}
        }
    }
    Some(if is_same { LooksMatch::Same } else { LooksMatch::Unknown })
}

/// Whether a storey, or a change of rooms that both witnesses know, lies between two sightings. What was far may be seen through a door.
fn is_separated(frames: &[FrameEvidence], last: &EyeSighting<'_>, new: &EyeSighting<'_>) -> bool {
    let (Some(a), Some(b)) = (frames.get(last.frame), frames.get(new.frame)) else { return true };
    let differs = a.level.zip(b.level).is_some_and(|(a, b)| a != b);
    let is_other_room = !a.rooms.is_empty()
        && !b.rooms.is_empty()
        && !a.rooms.iter().any(|room| b.rooms.iter().any(|other| same_room(room, other)));
    differs || (is_other_room && !(last.thing.is_far && new.frame - last.frame <= MAX_GAP_FRAMES))
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

/// A witness calls near what is at most so far away, and far what is farther, metres, with some slack.
const NEAR_M: [f64; 2] = [0.3, 4.6];
const FAR_M: [f64; 2] = [3.4, 10.0];
/// Places of a sector lie so far apart, metres, and in so many directions to either side of its middle.
const PLACE_STEP_M: f64 = 0.4;
const SIDE_STEPS: i32 = 2;
/// A witness may be wrong by so much about the edge of a third, radians.
const EDGE_RAD: f64 = 0.09;
/// The last sightings of a group are compared with a new one, this many.
const MAX_COMPARED: usize = 8;

/// How far away a thing may be, metres.
fn reach_m(thing: &SeenThing) -> [f64; 2] {
    if thing.is_far { FAR_M } else { NEAR_M }
}

/// Places all over the sector in which a sighting has its thing.
fn places_in_sector(sighting: &EyeSighting<'_>) -> Vec<DVec3> {
    let (Some(eye), Some(towards)) = (sighting.eye, sighting.towards) else { return Vec::new() };
    let [from_m, to_m] = reach_m(sighting.thing);
    let steps = ((to_m - from_m) / PLACE_STEP_M) as i32;
    let place = |side: i32, step: i32| {
        let off_rad = sighting.thing.turn_slack_rad * f64::from(side) / f64::from(SIDE_STEPS);
        eye + towards.turned_by(off_rad).unit_vector() * (from_m + f64::from(step) * PLACE_STEP_M)
    };
    (-SIDE_STEPS..=SIDE_STEPS).flat_map(|side| (0..=steps).map(move |step| place(side, step))).collect()
}

/// Whether a place lies in the sector of a sighting.
fn is_in_sector(place: DVec3, sighting: &EyeSighting<'_>) -> bool {
    let (Some(eye), Some(towards)) = (sighting.eye, sighting.towards) else { return true };
    let [from_m, to_m] = reach_m(sighting.thing);
    let far_m = (place - eye).truncate().length();
    let off_rad = Heading::towards(eye, place).map_or(0.0, |to| towards.turn_to(to).abs());
    (from_m - PLACE_STEP_M..=to_m + PLACE_STEP_M).contains(&far_m)
        && off_rad <= sighting.thing.turn_slack_rad + EDGE_RAD
}

/// The places in the sector of a group's last sighting that lie in the sectors of its other late ones.
fn places_of_group(group: &[EyeSighting<'_>]) -> Vec<DVec3> {
    let Some(last) = group.last() else { return Vec::new() };
    let all = places_in_sector(last);
    // A witness errs now and then: then fewer of the late ones count.
    let counts = [MAX_COMPARED, MAX_COMPARED / 2, 2, 1];
    let places = counts.into_iter().map(|count| -> Vec<DVec3> {
        let late = &group[group.len().saturating_sub(count)..];
        all.iter().copied().filter(|place| late.iter().all(|other| is_in_sector(*place, other))).collect()
    });
    places.into_iter().find(|places| !places.is_empty()).unwrap_or_default()
}

/// The share of a group's places that lie in the sector of a new sighting.
fn shared_places(group: &[EyeSighting<'_>], new: &EyeSighting<'_>) -> f64 {
    let places = places_of_group(group);
    let shared = places.iter().filter(|place| is_in_sector(**place, new)).count();
    shared as f64 / places.len().max(1) as f64
}

/// A place is known where all that fit lie this near to their middle on average, metres.
const KNOWN_PLACE_M: f64 = 0.9;

/// The group with its place: that of its labels, or else by the distance from the nearest frame, or else where its directions meet.
fn place_group(group: &[EyeSighting<'_>], frames: &[FrameEvidence], eyes: &WalkEyes) -> SightingGroup {
    let members = group.iter().map(|sighting| sighting.index).collect();
    if group.iter().all(EyeSighting::is_sector) {
        let places = unseen_later(places_of_group(group), group, frames, eyes);
        let middle = places.iter().sum::<DVec3>() / places.len().max(1) as f64;
        let spread_m = places.iter().map(|place| place.distance(middle)).sum::<f64>() / places.len().max(1) as f64;
        let is_known = !places.is_empty() && spread_m <= KNOWN_PLACE_M;
        return SightingGroup { members, position: is_known.then_some(middle), places: Some(places) };
    }
    let listed = group.iter().find_map(|sighted| sighted.thing.position);
    let rays: Vec<(DVec3, Heading)> = group.iter().filter_map(|sighted| sighted.eye.zip(sighted.towards)).collect();
    let crossed = || {
        let (first, last) = (rays.first()?, rays.last()?);
        ray_crossing(*first, *last).filter(|(_, a, b)| a.min(*b) > 0.0 && a.max(*b) <= MAX_RAY_M).map(|(at, ..)| at)
    };
    let measured = group.iter().filter_map(EyeSighting::measured_place).min_by(|a, b| a.0.total_cmp(&b.0));
    let position = listed.or(measured.map(|(_, place)| place)).or_else(crossed);
    SightingGroup { members, position, places: None }
}

/// A thing this near and this far to the side of the middle of a view would be named, metres and radians.
const PLAIN_SIGHT_M: f64 = 3.0;
const PLAIN_SIGHT_RAD: f64 = 0.6;

/// The places of a group but those in plain sight of the frames behind its last sighting, whose witnesses do not name it. All places if
/// none is left.
fn unseen_later(
    places: Vec<DVec3>,
    group: &[EyeSighting<'_>],
    frames: &[FrameEvidence],
    eyes: &WalkEyes,
) -> Vec<DVec3> {
    let Some(last) = group.last() else { return places };
    let silent =
        |frame: usize| frames.get(frame).is_some_and(|seen| seen.lists_things && !seen.may_show(&last.thing.name));
    let is_in_sight = |place: DVec3, frame: usize| {
        let (Some(eye), Some(heading)) = (eyes.at(frame), eyes.headings.get(frame)) else { return false };
        let off_rad = Heading::towards(eye, place).map_or(0.0, |to| heading.turn_to(to).abs());
        off_rad <= PLAIN_SIGHT_RAD && (place - eye).truncate().length() <= PLAIN_SIGHT_M
    };
    let later = last.frame + 1..=last.frame + 2;
    let is_seen = |place: &DVec3| later.clone().filter(|frame| silent(*frame)).all(|frame| is_in_sight(*place, frame));
    let has_silent = later.clone().any(silent);
    let kept: Vec<DVec3> = places.iter().copied().filter(|place| !(has_silent && is_seen(place))).collect();
    if kept.is_empty() { places } else { kept }
}
