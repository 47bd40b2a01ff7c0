//! Measures the memory of walks that is made from captions alone: a scripted eye looks along walks through generated houses, and the labels
//! of the houses say which sightings are of one thing, and on which side one passes it.

use crate::stage::{MeasuredWorldArgs, MeasurementStage};
use rayon::prelude::*;
use serde::Serialize;
use std::{collections::BTreeSet, f64::consts::PI, fmt};
use wayword_checks::{Evidence, SeenThing, WalkMemory, memory::RememberedThing};
use wayword_core::{ObjectId, Side, ViewThird};
use wayword_language::lexicon::{names_agree, normalise_name};
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    pipeline::{item_path, path_panoramas},
    plan::RunPlan,
    platforms::RememberingPlatform,
    run_folder::fresh_id,
    team::RoleTeam,
};
use wayword_synthesis::{
    observe::observe_path,
    walk::{FrameSelection, ObservedWalk},
};
use wayword_testkit::provider::scripts::FlawedEye;

/// The eye's errors, as shares: things that it is unsure of, leaves out, and invents.
const HEDGED: f64 = 0.1;
const MISSED: f64 = 0.15;
const INVENTED: f64 = 0.05;
/// Sightings of one thing that are more frames apart need not be joined.
const MAX_GAP_FRAMES: usize = 3;
/// A thing that is passed farther off than this need not be known as passed, metres.
const PASS_M: f64 = 4.0;

/// Counts of right and of all, for one figure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
struct RightOf {
    right: usize,
    all: usize,
}

impl RightOf {
    fn count(&mut self, is_right: bool) {
        self.right += usize::from(is_right);
        self.all += 1;
    }

    fn add(&mut self, other: Self) {
        self.right += other.right;
        self.all += other.all;
    }

    fn share(self) -> f64 {
        self.right as f64 / self.all.max(1) as f64
    }
}

/// How right the memories are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct MemoryFigures {
    /// Pairs of successive sightings of one thing that are joined.
    joined: RightOf,
    /// Pairs of sightings of two things of one name that are kept apart.
    apart: RightOf,
    /// Things that the memory passes, on the side of the labels.
    sides: RightOf,
    /// Things that the labels pass within 4 m and the eye saw surely, that the memory passes too.
    passed: RightOf,
    /// Distances from the end of the walk below 3 m that are right to a metre and a half.
    near_end: RightOf,
}

impl MemoryFigures {
    fn add(&mut self, other: Self) {
        self.joined.add(other.joined);
        self.apart.add(other.apart);
        self.sides.add(other.sides);
        self.passed.add(other.passed);
        self.near_end.add(other.near_end);
    }
}

impl fmt::Display for MemoryFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { joined, apart, sides, passed, near_end } = self;
        for (what, of) in [
            ("sightings of one thing joined", joined),
            ("sightings of two things kept apart", apart),
            ("sides of passed things right", sides),
            ("passed things known as passed", passed),
            ("distances from the end right", near_end),
        ] {
            writeln!(f, "{what:<36}{:>5.1} % of {}", 100.0 * of.share(), of.all)?;
        }
        Ok(())
    }
}

/// Measures the memories of `paths` walks through generated houses.
///
/// # Errors
/// When the eye's provider cannot be started, or a view cannot be had.
pub fn measure_memory(paths: usize, seed: u64, output: &CommandOutput) -> Result<MemoryFigures, CommandError> {
    let world = MeasuredWorldArgs { platform: "house".to_owned(), data: None, scan: None, seed };
    let stage = MeasurementStage::with_eye(&world, |eye| FlawedEye {
        miss_share: MISSED,
        hedge_share: HEDGED,
        hallucinated_share: INVENTED,
        ..eye
    })?;
    let job = stage.looking_job(paths)?;
    let plan = RunPlan::for_looking(&job, &stage.world)?;
    let calls = plan.models.open_calls(&fresh_id("memory"), output)?;
    let team = RoleTeam::new(&job.settings, calls.as_ref(), &stage.world)?;
    let measure = |item| -> Result<MemoryFigures, CommandError> {
        let world = RememberingPlatform::new(&stage.world);
        let path = item_path(item, &job.settings, &world)?;
        let seen = observe_path(&world, &path, FrameSelection::Central, team.observers())?;
        let labels = Evidence::from_labels(&path, &path_panoramas(&world, &path)?);
        let walk = ObservedWalk::new(path, seen);
        Ok(labels.map_or_else(MemoryFigures::default, |labels| compare_memories(&walk, &labels)))
    };
    let all: Vec<MemoryFigures> = plan.items.par_iter().map(measure).collect::<Result<_, _>>()?;
    let mut figures = MemoryFigures::default();
    all.into_iter().for_each(|of_walk| figures.add(of_walk));
    Ok(figures)
}

/// A sure sighting, with the labels that it may be of and the thing of the memory to which it belongs.
struct TracedSighting {
    frame: usize,
    name: String,
    objects: BTreeSet<ObjectId>,
    thing: usize,
}

fn compare_memories(walk: &ObservedWalk, labels: &Evidence) -> MemoryFigures {
    let memory = walk.memory();
    let truth = WalkMemory::from_path(labels, &walk.path);
    let traced = trace_sightings(walk, &memory, labels);
    let mut figures = MemoryFigures::default();
    for (at, new) in traced.iter().enumerate() {
        let one =
            |sighting: &TracedSighting| sighting.objects.iter().next().filter(|_| sighting.objects.len() == 1).cloned();
        let Some(object) = one(new) else { continue };
        let earlier = || traced[..at].iter().rev().filter(|old| old.frame < new.frame);
        if let Some(old) = earlier().find(|old| one(old).as_ref() == Some(&object) && names_agree(&old.name, &new.name))
            && new.frame - old.frame <= MAX_GAP_FRAMES
        {
            figures.joined.count(old.thing == new.thing);
        }
        let others = earlier().filter(|old| names_agree(&old.name, &new.name) && !old.objects.contains(&object));
        others.for_each(|old| figures.apart.count(old.thing != new.thing));
    }
    let object_of = |number: usize| -> Option<&RememberedThing> {
        let objects = traced.iter().filter(|sighting| sighting.thing == number).map(|sighting| &sighting.objects);
        let object = objects.clone().filter(|objects| objects.len() == 1).flatten().next()?;
        let is_sure = objects.clone().all(|objects| objects.contains(object));
        truth.things.iter().find(|thing| thing.object.as_ref() == Some(object)).filter(|_| is_sure)
    };
    let last = memory.frame_count().saturating_sub(1);
    for (number, thing) in memory.things.iter().enumerate() {
        let Some(real) = object_of(number) else { continue };
        if let Some(passed) = thing.passed {
            figures.sides.count(real.passed.is_some_and(|by| by.side == passed.side));
        }
        let is_close = |thing: &RememberedThing| {
            thing.passed.is_some_and(|by| truth.distance_m(thing, by.frame).is_some_and(|far_m| far_m <= PASS_M))
        };
        if is_close(real) {
            figures.passed.count(thing.passed.is_some_and(|by| matches!(by.side, Side::Left | Side::Right)));
        }
        if let Some(far_m) = thing.position.and_then(|_| memory.distance_m(thing, last)).filter(|far_m| *far_m < 3.0) {
            let real_m = truth.distance_m(real, last).unwrap_or(f64::INFINITY);
            figures.near_end.count((real_m - far_m).abs() <= 1.5);
        }
    }
    figures
}

/// The sure sightings of a walk in the order of its frames.
fn trace_sightings(walk: &ObservedWalk, memory: &WalkMemory, labels: &Evidence) -> Vec<TracedSighting> {
    let mut traced = Vec::new();
    for (frame, (at, observation)) in walk.path.frames.iter().zip(&walk.observations).enumerate() {
        for look in &observation.looks {
            let off_rad = at.pose.heading.turn_to(look.gaze.heading);
            let half_rad = look.gaze.horizontal_fov_rad / 2.0;
            for sighting in &look.caption.sightings {
                let Some(place) = sighting.place else { continue };
                let is_it = |thing: &&SeenThing| {
                    let within_rad = thing.turn_rad.map(|rad| wrapped(rad - off_rad));
                    normalise_name(&thing.name) == normalise_name(&sighting.name)
                        && within_rad.is_some_and(|rad| {
                            rad.abs() <= half_rad && ViewThird::from_offset(rad, 2.0 * half_rad) == place
                        })
                };
                let seen = labels.frames.get(frame).into_iter().flat_map(|seen| &seen.things).filter(is_it);
                let objects: BTreeSet<ObjectId> = seen.filter_map(|thing| thing.object.clone()).collect();
                let turn_rad = off_rad + place.turn_rad(look.gaze.horizontal_fov_rad);
                let shows = |thing: &RememberedThing| {
                    let glimpse = thing.glimpse_from(frame).and_then(|glimpse| glimpse.turn_rad);
                    names_agree(&thing.name, &sighting.name) && glimpse.is_some_and(|rad| (rad - turn_rad).abs() < 1e-9)
                };
                if let Some(thing) = memory.things.iter().position(shows).filter(|_| !objects.is_empty()) {
                    traced.push(TracedSighting { frame, name: sighting.name.clone(), objects, thing });
                }
            }
        }
    }
    traced
}

/// An angle in [-π, π).
fn wrapped(rad: f64) -> f64 {
    (rad + PI).rem_euclid(2.0 * PI) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The figures that the program promises, on fewer walks than the command measures.
    #[test]
    fn memories_by_an_eye_join_and_separate_things_as_labels_do() {
        let figures = measure_memory(30, 5, &CommandOutput::new(true, true)).unwrap();
        let MemoryFigures { joined, apart, sides, .. } = figures;
        assert!(joined.all > 200 && apart.all > 100 && sides.all > 20, "{figures}");
        assert!(joined.share() >= 0.95 && apart.share() >= 0.95 && sides.share() >= 0.98, "{figures}");
    }
}
